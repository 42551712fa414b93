"""When a core of the machine did not run at all: `Witnesses`, a process for each core that does nothing but look.

A virtual machine's cores are taken away by others, for tens of milliseconds at a time; nothing that runs on them can
prevent that. A witness has the highest real-time priority, is bound to its core, and sleeps for a millisecond at a
time: when it wakes late, no other process of that core could have run either, but for one in the kernel.
"""

import contextlib
import multiprocessing
import os
import time
from typing import Any, NamedTuple, Self

CONTEXT = multiprocessing.get_context("spawn")
SLEEP = 0.001  # s
SHORTEST = 0.004  # s that a witness wakes late, from which on it is noted
HIGHEST = 99


class Standstill(NamedTuple):
    """A time in which a core did not run.

    Attributes
    ----------
    begin, end : float
        s on the monotonic clock.
    """

    begin: float
    end: float


class Witnesses:
    """One witness for each core that this process may use, until the end of a `with` block.

    Attributes
    ----------
    seen : list of Standstill
        In the order of time; complete after the block.
    """

    def __init__(self) -> None:
        self.seen: list[Standstill] = []
        self._stop = CONTEXT.Value("i", 0)
        self._ends: list[Any] = []

    def __enter__(self) -> Self:
        for core in sorted(os.sched_getaffinity(0)):
            here, there = CONTEXT.Pipe(duplex=False)
            process = CONTEXT.Process(target=_look, args=(core, there, self._stop), daemon=True)
            process.start()
            self._ends.append((here, process))
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.value = 1
        for here, process in self._ends:
            self.seen += [Standstill(*each) for each in here.recv()]
            process.join()
        self.seen.sort()

    def within(self, begin: float, end: float) -> float:
        """Return for how long, s, a core or more stood still in a time."""
        spent, until = 0.0, begin
        for each in self.seen:
            first, last = max(each.begin, until), min(each.end, end)
            if last > first:
                spent, until = spent + last - first, last
        return spent


def _look(core: int, tell: Any, stop: Any) -> None:
    seen = []
    with contextlib.suppress(AttributeError, OSError):  # not Linux; not allowed: then it sees waiting, too
        os.sched_setaffinity(0, {core})
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(HIGHEST))
    last = time.monotonic()
    while not stop.value:
        time.sleep(SLEEP)
        now = time.monotonic()
        if now - last > SLEEP + SHORTEST:
            seen.append((last + SLEEP, now))
        last = now
    tell.send(seen)
