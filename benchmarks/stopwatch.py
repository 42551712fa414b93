"""Contenders timed side by side: `race`.

Every contender walks through a pool of different frames, again and again. In each step every contender does
one frame, one after the other, and who begins changes from step to step: whatever disturbs the machine
disturbs all of them alike, and whoever begins meets a frame that was last touched some tens of megabytes of
other frames ago, and reads it for those that follow. Where a table says "each on a frame of its own" the
contenders stand at different places in the pool, as far apart as can be: then all meet each frame equally cold,
and none finds in the cache what its neighbor has just fetched. A tracker sees its frames in order, none left out.
"""

import gc
import time
from collections.abc import Callable, Sequence
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

import matchset as ms

WARM_UP = 40  # steps that do not count


class Contender(msgspec.Struct, frozen=True, kw_only=True):
    """Something to be timed.

    Parameters
    ----------
    name : str
        Unique.
    frames : sequence of Frame
        Its pool.
    begin : callable
        Called, untimed, at the beginning of the pool: what is timed, a function of a frame.
    offset : int
        Where in the pool it begins the first time; a tracker must begin at 0.
    """

    name: str
    frames: Sequence[ms.Frame]
    begin: Callable[[], Callable[[ms.Frame], Any]]
    offset: int = 0


class Times(msgspec.Struct, frozen=True):
    """How long a contender took.

    Parameters
    ----------
    ns : ndarray of int64
        Each call, ns.
    places : ndarray of int64
        Which frame of the pool each call was for.
    misses : int
        Calls that returned `Lost` or an empty list.
    """

    ns: npt.NDArray[np.int64]
    places: npt.NDArray[np.int64]
    misses: int

    @property
    def median_us(self) -> float:
        """Median, us."""
        return float(np.median(self.ns)) / 1e3

    @property
    def least_us(self) -> float:
        """Minimum, us."""
        return float(self.ns.min()) / 1e3

    @property
    def most_us(self) -> float:
        """99th percentile, us."""
        return float(np.percentile(self.ns, 99.0)) / 1e3

    def by_place_us(self) -> npt.NDArray[np.float64]:
        """Median for each frame of the pool, us."""
        return np.array([np.median(self.ns[self.places == p]) for p in range(self.places.max() + 1)]) / 1e3


class _Runner:
    """A contender on its way through its pool."""

    def __init__(self, contender: Contender) -> None:
        self.contender = contender
        self.place = contender.offset
        self.call = contender.begin()
        self.ns: list[int] = []
        self.places: list[int] = []
        self.misses = 0

    def step(self, counts: bool) -> None:
        frame = self.contender.frames[self.place]
        begin = time.perf_counter_ns()
        result = self.call(frame)
        took = time.perf_counter_ns() - begin
        if counts:
            self.ns.append(took)
            self.places.append(self.place)
            self.misses += isinstance(result, ms.Lost) or (isinstance(result, list) and not result)
        self.place += 1
        if self.place == len(self.contender.frames):
            self.place, self.call = 0, self.contender.begin()


def race(contenders: Sequence[Contender], steps: int) -> dict[str, Times]:
    """Time contenders side by side, with the garbage collector at rest.

    Parameters
    ----------
    contenders : sequence of Contender
    steps : int
        Frames for each of them.

    Returns
    -------
    dict of str to Times
        By the contender's name.
    """
    runners = [_Runner(contender) for contender in contenders]
    collects = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        for step in range(-WARM_UP, steps):
            first = step % len(runners)
            for runner in runners[first:] + runners[:first]:
                runner.step(step >= 0)
    finally:
        if collects:
            gc.enable()
    return {r.contender.name: Times(np.array(r.ns), np.array(r.places), r.misses) for r in runners}
