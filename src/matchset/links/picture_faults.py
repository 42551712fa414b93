"""Faults of a grabber: `PictureFaults` says which picture is delivered in place of the newest one, stamped as new."""

import math

import msgspec


class PictureFaults(msgspec.Struct, frozen=True, kw_only=True):
    """When a grabber delivers old pictures with new times; times in s, pictures counted from 1.

    Parameters
    ----------
    fps : float
        Pictures per second.
    freeze, freeze_for : float
        When it begins to repeat its last picture, and for how long; inf for never, and for ever.
    stale, stale_for : float
        When it begins to deliver pictures that are `stale_age` old, and for how long. They are those that it had
        delivered before, until it comes to those that it had not.
    stale_age : float
        How old these are, s.
    """

    fps: float
    freeze: float = math.inf
    freeze_for: float = math.inf
    stale: float = math.inf
    stale_for: float = math.inf
    stale_age: float = 0.5

    def shown(self, index: int) -> int:
        """Return the number of the picture that is delivered in place of picture `index`."""
        if self.freeze <= index / self.fps < self.freeze + self.freeze_for:
            index = max(math.ceil(self.freeze * self.fps) - 1, 1)
        if self.stale <= index / self.fps < self.stale + self.stale_for:
            index = max(index - round(self.stale_age * self.fps), 1)
        return index

    def oldest(self, index: int) -> int:
        """Return the number of the oldest picture that can be delivered in place of picture `index` or a later one."""
        last = max(index / self.fps, self.stale)
        is_over = last >= self.stale + self.stale_for
        kept = index if is_over else max(index - round(self.stale_age * self.fps), 1)
        return min(self.shown(index), kept)
