"""When the next channel frame is due: `FrameTimer`, at a fixed rate that follows the module's own."""

import math


class FrameTimer:
    """Says when a frame is due.

    A module transmits at its own rate, and says about five times a second how long its interval is and how much too
    early the last frame came. The time between frames becomes that interval, and moves until frames come in time: the
    commands are then as fresh as they can be, and none is sent twice.

    Parameters
    ----------
    period : float
        Time between frames at first, s.
    shortest, longest : float
        Limits of the period, s.
    step : float
        Largest share of the period by which one of them is made longer or shorter.
    now : float
        s; the first frame is due at once.

    Attributes
    ----------
    period : float
        Time between frames, s.
    lag : float
        By how much later frames are to come than they do, s.
    due : float
        When the next one is, s.
    """

    def __init__(self, period: float, shortest: float, longest: float, step: float, now: float) -> None:
        self.period, self._shortest, self._longest, self._step = period, shortest, longest, step
        self.lag, self.due = 0.0, now

    def correct(self, interval: float, early: float) -> None:
        """Follow the module: its interval, and by how much the last frame came too early, s (less than 0: too late).

        A module that wants frames more often than the shortest period gets every second or third. What makes no sense,
        an interval of 0 or beyond the longest, changes nothing.
        """
        if not 0.0 < interval <= self._longest:
            return
        self.period = interval * math.ceil(self._shortest / interval - 1e-9)
        self.lag = math.remainder(early, interval)

    def sent(self, now: float) -> None:
        """Note that a frame was sent; the next is due a period after this one was, or after now if that is past."""
        move = min(max(self.lag, -self._step * self.period), self._step * self.period)
        self.lag -= move
        self.due += self.period + move
        if self.due <= now:  # the computer was busy: no burst of what was missed
            self.due = now + self.period
