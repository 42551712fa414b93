"""The model of a batch on machines that share a scheduler and a store: `simulate`.

Each worker asks for a task when it has ended one. The scheduler answers one worker after the other, and takes `cost`
for each. A task reads its video, computes, and writes its results. All that read or write share the store's bandwidth
in equal parts, none with more than its machine's link has; all that compute share the processors.
"""

import heapq
import math
from collections import deque
from collections.abc import Callable, Iterable

import msgspec

FREE = 1e15  # bytes/s: reading takes no time


class Task(msgspec.Struct, frozen=True):
    """One video, or a stretch of one.

    Parameters
    ----------
    seconds : float
        Of computing, s.
    read, written : float
        Bytes.
    """

    seconds: float
    read: float = 0.0
    written: float = 0.0


def alike(_: int) -> float:
    """Return the speed of a worker that nobody makes slower."""
    return 1.0


class Cluster(msgspec.Struct, frozen=True):
    """Machines, and what they share.

    Parameters
    ----------
    workers : int
        Of all machines.
    cost : float
        What the scheduler takes for each task, s.
    ahead : int
        Tasks that each worker is given at once; 2: the next one waits beside it.
    bandwidth : float
        Of the store, or of the links of all machines if that is less, bytes/s.
    link : float
        Of one machine, bytes/s.
    rate : callable
        Speed of each worker when so many compute; 1: as fast as where the tasks were measured.
    """

    workers: int
    cost: float = 0.0
    ahead: int = 1
    bandwidth: float = FREE
    link: float = FREE
    rate: Callable[[int], float] = alike


class Simulated(msgspec.Struct, frozen=True):
    """What came of it.

    Parameters
    ----------
    seconds : float
        Until the last task has ended.
    tasks : int
    rate : float
        Tasks a second, until none was left to be given.
    computing, scheduler, store : float
        Share of that time in which a worker computed (mean over the workers), and in which the scheduler and the store
        were busy; the store is busy as far as its bandwidth is used.
    """

    seconds: float
    tasks: int
    rate: float
    computing: float
    scheduler: float
    store: float


class _Shared:
    """Something that several use at once, each at the same rate."""

    def __init__(self, rate: Callable[[int], float]) -> None:
        self._rate, self._now, self._done = rate, 0.0, 0.0
        self._ends: list[tuple[float, int]] = []
        self.used = 0.0

    def advance(self, now: float) -> None:
        """Let time pass."""
        if self._ends:
            moved = (now - self._now) * self._rate(len(self._ends))
            self._done += moved
            self.used += moved * len(self._ends)
        self._now = now

    def enter(self, worker: int, amount: float) -> None:
        """Begin with so much."""
        if not self._ends:
            self._done = 0.0
        heapq.heappush(self._ends, (self._done + amount, worker))

    @property
    def next(self) -> float:
        """When the next one ends, if nobody enters before."""
        if not self._ends:
            return math.inf
        return self._now + max(self._ends[0][0] - self._done, 0.0) / self._rate(len(self._ends))

    def leave(self) -> int:
        """Return who has ended."""
        return heapq.heappop(self._ends)[1]


class _Run:
    """One simulation on its way."""

    def __init__(self, tasks: Iterable[Task], cluster: Cluster) -> None:
        self._tasks, self._cluster, self.count = iter(tasks), cluster, 0
        self._store = _Shared(lambda count: min(cluster.link, cluster.bandwidth / count))
        self._processors = _Shared(cluster.rate)
        self._arrivals: deque[tuple[float, int, Task]] = deque()
        self._waiting: list[deque[Task]] = [deque() for _ in range(cluster.workers)]
        self._current: list[Task | None] = [None] * cluster.workers
        self._written = [False] * cluster.workers
        self._scheduler, self.computed = 0.0, 0.0
        self._ended, self._given = 0, 0.0

    def run(self) -> Simulated:
        """Go from event to event."""
        for _ in range(self._cluster.ahead):
            for worker in range(self._cluster.workers):
                self._ask(0.0, worker)
        now = 0.0
        while True:
            arrival = self._arrivals[0][0] if self._arrivals else math.inf
            times = arrival, self._store.next, self._processors.next
            first = min(times)
            if first == math.inf:
                break
            now = first
            self._store.advance(now)
            self._processors.advance(now)
            if first == times[0]:
                _, worker, task = self._arrivals.popleft()
                self._waiting[worker].append(task)
                if self._current[worker] is None:
                    self._begin(worker)
            elif first == times[1]:
                self._moved(now, self._store.leave())
            else:
                self._wrote(self._processors.leave())
        if not self.count:
            raise ValueError("there is no task to simulate")
        cluster, whole = self._cluster, max(now, 1e-12)
        used = self._store.used / (cluster.bandwidth * whole)
        return Simulated(
            now,
            self.count,
            self._given,
            self.computed / (whole * cluster.workers),
            self.count * cluster.cost / whole,
            used,
        )

    def _ask(self, now: float, worker: int) -> None:
        task = next(self._tasks, None)
        if task is None:
            self._given = self._given or self._ended / max(now, 1e-12)
            return
        self.count += 1
        self._scheduler = max(self._scheduler, now) + self._cluster.cost
        self._arrivals.append((self._scheduler, worker, task))

    def _begin(self, worker: int) -> None:
        task = self._waiting[worker].popleft()
        self._current[worker], self._written[worker] = task, False
        self._store.enter(worker, task.read)

    def _moved(self, now: float, worker: int) -> None:
        """Go on with a worker that has read its video, or written its results."""
        task = self._current[worker]
        assert task is not None
        if not self._written[worker]:
            self._processors.enter(worker, task.seconds)
            return
        self._current[worker] = None
        self._ended += 1
        self._ask(now, worker)
        if self._waiting[worker]:
            self._begin(worker)

    def _wrote(self, worker: int) -> None:
        task = self._current[worker]
        assert task is not None
        self.computed += task.seconds
        self._written[worker] = True
        self._store.enter(worker, task.written)


def simulate(tasks: Iterable[Task], cluster: Cluster) -> Simulated:
    """Do tasks in their order on a cluster.

    Parameters
    ----------
    tasks : iterable of Task
    cluster : Cluster

    Returns
    -------
    Simulated
    """
    return _Run(tasks, cluster).run()
