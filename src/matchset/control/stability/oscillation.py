"""Swings of a stick, one after the other: `Oscillation` notices a loop that oscillates.

A loop near its limit swings with a period of its own, between 0.2 and 1.6 s for vehicles of this size, and its stick
goes from one side to the other each time. Gusts and noise do that now and then, a loop that oscillates does it again
and again. A swing is the way from one turning point to the next; a turn counts once the stick has come back by a share
of a large swing. The one that goes on counts as soon as it is large, so nothing waits for its end.
"""

from typing import NamedTuple


class SwingLimits(NamedTuple):
    """What is an oscillation.

    Attributes
    ----------
    size : float
        Least swing, from one turning point to the next, in the unit of the stick.
    swing_count : int
        So many in a row.
    max_half_period : float
        Longest swing, s.
    turning_ratio : float
        Share of `size` by which the stick must come back to have turned.
    """

    size: float
    swing_count: int
    max_half_period: float
    turning_ratio: float


class Oscillation:
    """Counts the large swings of one stick.

    Parameters
    ----------
    limits : SwingLimits

    Attributes
    ----------
    swings : int
        Large ones in a row, with the one that goes on.
    """

    def __init__(self, limits: SwingLimits) -> None:
        self.limits = limits
        self.reset()

    def reset(self) -> None:
        """Know nothing."""
        self.swings = self._complete = 0
        self._rising, self._extreme, self._extreme_time = True, 0.0, 0.0
        self._turned, self._turned_time, self._begun = 0.0, 0.0, False

    def update(self, stick: float, now: float) -> bool:
        """Note a stick, and when, s; whether it oscillates."""
        if not self._begun:
            self._begun, self._extreme, self._extreme_time = True, stick, now
            self._turned, self._turned_time = stick, now
        if (stick > self._extreme) if self._rising else (stick < self._extreme):
            self._extreme, self._extreme_time = stick, now
        elif abs(stick - self._extreme) > self.limits.turning_ratio * self.limits.size:
            self._complete = self._complete + 1 if self._is_large(self._extreme, self._extreme_time) else 0
            self._turned, self._turned_time = self._extreme, self._extreme_time
            self._rising, self._extreme, self._extreme_time = not self._rising, stick, now
        self.swings = self._complete + self._is_large(self._extreme, self._extreme_time)
        return self.swings >= self.limits.swing_count

    def _is_large(self, until: float, time: float) -> bool:
        """Whether the swing from the last turning point is large, and quick."""
        return abs(until - self._turned) >= self.limits.size and time - self._turned_time <= self.limits.max_half_period
