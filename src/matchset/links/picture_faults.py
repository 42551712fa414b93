"""Faults of a grabber: `PictureFaults`, which picture is delivered as new; `PictureTimes`, when, and its time stamp."""

import math

import msgspec
import numpy as np

from matchset.sim.cameras import FIELD
from matchset.sim.world import RATE


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


class PictureTimes(msgspec.Struct, frozen=True, kw_only=True):
    """When pictures are delivered, what their time stamps say, and which do not come; pictures counted from 1.

    Parameters
    ----------
    fps : int
        Pictures per second.
    latency : float
        From the middle of the exposure to the command leaving, s.
    told : float
        The same as the grabber believes it: it stamps a picture with its arrival less this, s.
    jitter : float
        By how much a picture comes earlier or later than it should, at most, s; the stamp is as wrong.
    lost : float
        Share of the pictures that do not come.
    seed : int
    exposed : int
        Steps of the world from the middle of a picture to the end of its exposure: no picture comes before.
    after : int
        Steps by which half-frames are taken later than their number says: the first is the earlier field of frame 1.
    """

    fps: int
    latency: float
    told: float
    jitter: float = 0.0
    lost: float = 0.0
    seed: int = 0
    exposed: int = FIELD
    after: int = 0

    def delivered(self, index: int) -> int:
        """Step of the world at which a picture has been processed; after its exposure at the earliest."""
        latency = self.latency + self._late(index)
        return RATE // self.fps * index + max(round(latency * RATE), self.exposed)

    def stamp(self, index: int) -> float:
        """Time that a picture is stamped with, s."""
        return (RATE // self.fps * index + self.after) / RATE + (self.latency - self.told + self._late(index))

    def is_lost(self, who: int, index: int) -> bool:
        """Whether a follower's picture does not come."""
        return self.lost > 0.0 and bool(np.random.default_rng((self.seed, 0xF1, who, index)).random() < self.lost)

    def _late(self, index: int) -> float:
        """How much later than usual a picture comes, s: never before the one that was taken before it."""
        if not self.jitter:
            return 0.0
        behind = 1.0 / self.fps - 1.0 / RATE
        return max(self._jittered(index - back) - back * behind for back in range(1 + self._longest))

    @property
    def _longest(self) -> int:
        """How many pictures one that is late can hold up."""
        return math.ceil(2.0 * self.jitter * self.fps)

    def _jittered(self, index: int) -> float:
        return self.jitter * float(np.random.default_rng((self.seed, 0x1A, max(index, 0))).uniform(-1.0, 1.0))
