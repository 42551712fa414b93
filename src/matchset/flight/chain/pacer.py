"""Absolute deadlines: `Pacer` keeps a rate without drift, and skips the deadlines that it missed."""

import time
from collections.abc import Callable


class Pacer:
    """Deadlines at start + k period.

    A late step does not move the deadlines after it; those that passed meanwhile are skipped, so that no step is
    hurried to make up for a late one.

    Parameters
    ----------
    period : float
        s.
    clock, sleep : callable
        For tests.

    Attributes
    ----------
    missed : int
        Deadlines that were skipped.
    longest : float
        The longest time from one deadline that was waited for to the next, s: no vehicle heard nothing for longer.
    """

    def __init__(
        self,
        period: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        if not period > 0.0:
            raise ValueError(f"a period must be positive, got {period} s")
        self.period, self.missed, self.longest = period, 0, 0.0
        self._clock, self._sleep = clock, sleep
        self._start, self._count = clock(), 0
        self._last = self._start

    def wait(self) -> None:
        """Sleep until the next deadline."""
        self._count += 1
        late = self._clock() - (self._start + self._count * self.period)
        if late >= self.period:
            skipped = int(late / self.period)
            self.missed += skipped
            self._count += skipped
        rest = self._start + self._count * self.period - self._clock()
        if rest > 0.0:
            self._sleep(rest)
        now = self._clock()
        self.longest, self._last = max(self.longest, now - self._last), now
