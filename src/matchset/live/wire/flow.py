"""How many pictures may be on their way to a viewer (`Flow`), and how large they are (`Ladder`)."""

from collections import deque
from typing import NamedTuple

import msgspec


class FlowParameters(msgspec.Struct, frozen=True, kw_only=True):
    """When a viewer gets the next picture.

    Parameters
    ----------
    in_flight : int
        Pictures that were sent and not yet acknowledged, at most. More: older pictures on a slow link; one: half the
        rate. Chosen by measurement on links of 8 and 30 Mbit/s: docs/live.md.
    slow : float
        Time from sending to acknowledgment above which pictures get smaller, s. Chosen by hand: three periods of a
        camera of 30 frames/s, more than which a person notices.
    fast : float
        Time below which they get larger again, s. Chosen by hand: well below `slow`, so that they do not go to and fro.
    steady : int
        Acknowledgments in a row that decide either. More: slower to adapt. Chosen by hand: a third of a second.
    """

    in_flight: int = 2
    slow: float = 0.100
    fast: float = 0.040
    steady: int = 10

    def __post_init__(self) -> None:
        if self.in_flight < 1 or self.steady < 1:
            raise ValueError(f"in_flight and steady must be 1 or more, got {self.in_flight} and {self.steady}")
        if not 0.0 < self.fast < self.slow:
            raise ValueError(f"0 < fast < slow is needed, got {self.fast} and {self.slow}")


class Size(NamedTuple):
    """How a picture is encoded.

    Attributes
    ----------
    quality : int
        Of the JPEG, 1 ... 100.
    scale : float
        Of its sides, 0 ... 1.
    every : int
        Every which picture is sent.
    """

    quality: int
    scale: float = 1.0
    every: int = 1


SIZES = (Size(75), Size(50), Size(50, 0.5), Size(50, 0.5, 3))  # best first: quality, then size, then rate
DEFAULT = FlowParameters()


class Ladder:
    """Which of `SIZES` a viewer gets, by how long its acknowledgments take.

    Parameters
    ----------
    parameters : FlowParameters

    Attributes
    ----------
    step : int
        Index into `SIZES`.
    """

    def __init__(self, parameters: FlowParameters = DEFAULT) -> None:
        self._parameters = parameters
        self.step = self._slow = self._fast = 0

    def note(self, seconds: float) -> None:
        """Take how long an acknowledgment took, s."""
        self._slow = self._slow + 1 if seconds > self._parameters.slow else 0
        self._fast = self._fast + 1 if seconds < self._parameters.fast else 0
        if max(self._slow, self._fast) < self._parameters.steady:
            return
        down = self._slow >= self._parameters.steady
        self.step = min(max(self.step + (1 if down else -1), 0), len(SIZES) - 1)
        self._slow = self._fast = 0


class Flow:
    """Which picture a viewer gets next: the newest one, as soon as few enough are on their way.

    Parameters
    ----------
    parameters : FlowParameters

    Attributes
    ----------
    skipped : int
        Pictures that were replaced by a newer one.
    """

    def __init__(self, parameters: FlowParameters = DEFAULT) -> None:
        self._parameters = parameters
        self._newest: int | None = None
        self._in_flight: deque[tuple[int, float]] = deque()
        self._offered = 0
        self._left_out: int | None = None
        self.ladder, self.skipped = Ladder(parameters), 0

    @property
    def size(self) -> Size:
        """How the next picture is encoded."""
        return SIZES[self.ladder.step]

    def offer(self, sequence: int) -> bool:
        """Tell that there is a new picture; returns whether it may be the next one."""
        self._offered += 1
        self._left_out = None
        if self._offered % self.size.every:
            self.skipped += 1
            self._left_out = sequence
            return False
        self.skipped += self._newest is not None
        self._newest = sequence
        return True

    def settle(self) -> bool:
        """Take the picture that was left out on a slow link, none having come since; returns whether there is one."""
        if self._left_out is None:
            return False
        self._newest, self._left_out = self._left_out, None
        return True

    def take(self, now: float) -> int | None:
        """Return the picture to send now, and note that it was sent; None if none may be.

        Parameters
        ----------
        now : float
            Time, s.
        """
        if self._newest is None or len(self._in_flight) >= self._parameters.in_flight:
            return None
        sequence, self._newest = self._newest, None
        self._in_flight.append((sequence, now))
        return sequence

    def acknowledge(self, sequence: int, now: float) -> float | None:
        """Note that a picture is on the screen.

        Parameters
        ----------
        sequence : int
            Its number. The pictures that were sent before it count as shown, too.
        now : float
            Time, s.

        Returns
        -------
        float or None
            How long it was on its way, s; None if no such picture was.
        """
        if sequence not in (number for number, _ in self._in_flight):
            return None
        while self._in_flight:
            number, sent = self._in_flight.popleft()
            if number == sequence:
                break
        self.ladder.note(now - sent)
        return now - sent
