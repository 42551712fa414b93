"""How much silence of a live source is borne (`Silence`), and how often one is opened again (`Pauses`)."""

import math
from collections.abc import Callable
from typing import NamedTuple, Self

import msgspec

from matchset.numeric.arguments import check_number, require_positive


class ReopeningParameters(msgspec.Struct, frozen=True):
    """When a live source that is gone is opened again.

    Chosen by hand, from how streams stop; no benchmark has a network.

    Parameters
    ----------
    stream_s : float
        How long a stream from the network is opened again and again where nobody says so, s. A Wi-Fi that changes its
        access point takes 1 to 5 s, a small network camera restarts in 5 to 8 s. More waits in vain for one that is
        switched off; less ends a run that could have gone on.
    device_s : float
        The same of a camera of this computer, s: 0, none. One that is plugged in again may have another number, and
        where another one has this number now, that would be opened in its place.
    first_pause_s : float
        Pause before the second attempt, s; the first one is made at once. Less finds it sooner, and asks a computer
        that is busy starting more often.
    growth : float
        What each pause is longer than the one before by.
    longest_pause_s : float
        The longest pause, s. More finds a source later, that long at most; less asks one that stays away more often.
    """

    stream_s: float = 10.0
    device_s: float = 0.0
    first_pause_s: float = 0.1
    growth: float = 2.0
    longest_pause_s: float = 2.0


class Silence(NamedTuple):
    """How much silence of a live source is borne.

    Attributes
    ----------
    timeout : float
        Longest time without a picture, s.
    reconnect : float or None
        How long it is opened again and again after that, s; 0: not at all. None: what `ReopeningParameters` says.
    note : callable or None
        Told in a line of each loss and each return, by the thread that reads the source; must not wait.
    """

    timeout: float = 2.0
    reconnect: float | None = None
    note: Callable[[str], None] | None = None

    def checked(self) -> Self:
        """Return it, or raise ValueError for a time that is none."""
        check_number("timeout", self.timeout)
        require_positive(self, ("timeout",))
        if self.reconnect is not None:
            check_number("reconnect", self.reconnect)
            if not 0.0 <= self.reconnect < math.inf:
                raise ValueError(f"reconnect must be a time in s, 0 for none, got {self.reconnect}")
        return self


class Pauses:
    """Times to wait before each attempt to open a source that is gone.

    Parameters
    ----------
    parameters : ReopeningParameters
    """

    def __init__(self, parameters: ReopeningParameters) -> None:
        self._parameters, self._next = parameters, 0.0

    def begin(self, delivered_s: float) -> None:
        """Begin anew, unless the source has delivered for less than the pause that is next, s."""
        if delivered_s >= self._next:
            self._next = 0.0

    def next(self) -> float:
        """Return the next pause, s."""
        pause, parameters = self._next, self._parameters
        longer = max(parameters.first_pause_s, parameters.growth * pause)
        self._next = min(longer, parameters.longest_pause_s)
        return pause
