"""The clock of the messages, which goes on while the computer sleeps: `Clock`; and how old pictures are: `PictureAges`.

`time.monotonic`, by which cameras stamp their pictures, stands still meanwhile on Linux and macOS: what was seen before
would look new afterwards.
"""

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence

from matchset.sharing.sent_targets import SentTarget, ages_of

READINGS = 3  # format: of both clocks at the beginning, of which the one counts that nothing has interrupted
KEPT = 8  # format: sleeps that are remembered


def _through_sleep() -> Callable[[], float]:
    """Return the clock of this system that counts sleep, s."""
    clock: int | None = getattr(time, "CLOCK_BOOTTIME", getattr(time, "CLOCK_MONOTONIC", None))
    if clock is None:
        return time.monotonic
    try:
        time.clock_gettime(clock)
    except OSError:  # it is known, but this kernel has none
        return time.monotonic
    return lambda: time.clock_gettime(clock)


class Clock:
    """The clock of the messages beside that of pictures, and how long the computer has slept.

    Parameters
    ----------
    now : callable, optional
        s, going on through sleep. CLOCK_BOOTTIME of Linux, or CLOCK_MONOTONIC of macOS, if not given; where there is
        neither, `time.monotonic`, which Windows does not stop.
    awake : callable
        s: the clock of pictures.
    shortest : float
        Shortest sleep that counts, s. Less takes a pause between the readings of both clocks for one. Chosen by hand:
        the smallest age that matters is 0.5 s.
    """

    def __init__(
        self,
        now: Callable[[], float] | None = None,
        awake: Callable[[], float] = time.monotonic,
        shortest: float = 0.1,
    ) -> None:
        self.now, self.awake = now or _through_sleep(), awake
        self._shortest, self._asleep, self._lock = shortest, 0.0, threading.Lock()
        self._ahead = max(self.ahead for _ in range(READINGS))

    @property
    def ahead(self) -> float:
        """The clock of the messages minus that of pictures, s; less if something comes between both, never more."""
        return self.now() - self.awake()

    @property
    def asleep(self) -> float:
        """How long the computer has slept since this was made, s."""
        with self._lock:
            more = self.ahead - self._ahead
            if more > self._shortest:
                self._ahead, self._asleep = self._ahead + more, self._asleep + more
            return self._asleep


class PictureAges:
    """How old pictures are by `Clock`: those that were taken before the computer slept are older than they say.

    When within the time from one call to the next it slept is not known: what was taken in it counts as before.

    Parameters
    ----------
    clock : Clock
    late : float
        Time before a call, s, at which its `now` was read at most. More takes pictures of so long after a sleep for
        older ones, less those from just before it for new ones. Chosen by hand: who reads it before a picture is
        searched and sent is done within that.
    """

    def __init__(self, clock: Clock, late: float = 1.0) -> None:
        self._clock, self._asleep, self._late = clock, clock.asleep, late
        self._called, self._latest = clock.awake(), -math.inf
        self._sleeps: deque[tuple[float, float]] = deque(maxlen=KEPT)

    def of(self, sent: Sequence[SentTarget], time: float | Mapping[str, float], now: float | None) -> list[float]:
        """Return how old the picture of each target is, s; as `ages_of`, and the clock of pictures if `now` is None."""
        awake = self._clock.awake()
        since, self._called = 0.0 if now is None else min(awake - self._called, self._late), awake
        now = awake if now is None else now
        ages = ages_of(sent, time, now)
        if now < self._latest - self._late:
            self._sleeps.clear()  # the times of another source, or of one that begins anew
            self._latest = now
        self._latest = max(self._latest, now)
        asleep = self._clock.asleep
        if asleep > self._asleep:
            self._sleeps.append((now + since, asleep - self._asleep))  # `now` may be from before, or before that
            self._asleep = asleep
        return [age + sum(slept for end, slept in self._sleeps if now - age < end) for age in ages]
