"""Contenders timed side by side: `time_by_turns`.

Every contender walks through a pool of different frames, again and again. In each step every contender does
one frame, one after the other, and who begins changes from step to step: whatever disturbs the machine
disturbs all of them alike, and whoever begins meets a frame that was last touched some tens of megabytes of
other frames ago, and reads it for those that follow. Where a table says "each on a frame of its own" the
contenders stand at different places in the pool, as far apart as can be: then all meet each frame equally cold,
and none finds in the cache what its neighbor has just fetched. A tracker sees its frames in order, none left out.
"""

import contextlib
import gc
import time
from collections.abc import Callable, Iterator, Sequence
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
    idle : callable, optional
        Time so far that does not count, ns: what a program beside this one loses on the way to it and back.
    """

    name: str
    frames: Sequence[ms.Frame]
    begin: Callable[[], Callable[[ms.Frame], Any]]
    offset: int = 0
    idle: Callable[[], int] = int  # int() is 0


class Times(msgspec.Struct, frozen=True):
    """How long a contender took.

    Parameters
    ----------
    ns : ndarray of int64
        Each call, ns.
    places : ndarray of int64
        Which frame of the pool each call was for.
    misses : int
        Calls that returned `Lost`, None or an empty list.
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
        frame, idle = self.contender.frames[self.place], self.contender.idle
        idle_before = idle()
        begin = time.perf_counter_ns()
        result = self.call(frame)
        took = time.perf_counter_ns() - begin
        took -= idle() - idle_before
        if counts:
            self.ns.append(took)
            self.places.append(self.place)
            self.misses += result is None or isinstance(result, ms.Lost) or (isinstance(result, list) and not result)
        self.place += 1
        if self.place == len(self.contender.frames):
            self.place, self.call = 0, self.contender.begin()


def time_by_turns(contenders: Sequence[Contender], steps: int) -> dict[str, Times]:
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
    with _garbage_collector_at_rest():
        for step in range(-WARM_UP, steps):
            first = step % len(runners)
            for runner in runners[first:] + runners[:first]:
                runner.step(step >= 0)
    return {r.contender.name: Times(np.array(r.ns), np.array(r.places), r.misses) for r in runners}


def time_in_pairs(contenders: Sequence[Contender], laps: int, warm_up: int = 10) -> dict[str, Times]:
    """Time contenders on the same frame, one after the other, in an order that is drawn anew for each frame.

    Whoever comes first brings the frame into the cache for the others, and everybody finds his own code and data
    displaced by the others; the drawing of lots makes that alike for all.

    Parameters
    ----------
    contenders : sequence of Contender
        Their pools are of equal length.
    laps : int
        How often everybody goes through his pool.
    warm_up : int
        Frames before that, which do not count.

    Returns
    -------
    dict of str to Times
        By the contender's name.
    """
    count = len(contenders[0].frames)
    if any(len(each.frames) != count for each in contenders):
        raise ValueError(f"pools must be of equal length, got {[len(each.frames) for each in contenders]}")
    rng = np.random.default_rng(0)
    for each in [_Runner(contender) for contender in contenders]:
        for _ in range(min(warm_up, count - 1)):
            each.step(counts=False)
    runners = [_Runner(contender) for contender in contenders]
    with _garbage_collector_at_rest():
        for _ in range(laps * count):
            for turn in rng.permutation(len(runners)):
                runners[turn].step(counts=True)
    return {r.contender.name: Times(np.array(r.ns), np.array(r.places), r.misses) for r in runners}


@contextlib.contextmanager
def _garbage_collector_at_rest() -> Iterator[None]:
    collects = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()
