"""Batches on 1 to 1,000 machines: where more machines no longer help, and what `--split` does: `growth`, `tails`."""

import itertools
import math
from collections.abc import Sequence

import msgspec
import numpy as np

from benchmarks.batch.simulation.basis import Basis
from benchmarks.batch.simulation.simulate import Cluster, Simulated, Task, simulate
from matchset.batch.split.parts import PARAMETERS as SPLIT

WORKERS = 16  # of a machine
LINK = 10e9 / 8.0  # bytes/s of a machine: 10 Gbit/s
AHEAD = 2
MACHINES = 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000
STORES = {"one server, 10 Gbit/s": 1.25e9, "ten such servers": 12.5e9, "a thousand disks": 125e9}
LENGTHS = {"10 s": 10.0, "1 min": 60.0, "1 h": 3600.0}
LEAST = 5000  # tasks
TURNS = 12  # tasks a worker that are simulated: the rate does not change any more
ALL = 10e15  # bytes
DAY = 86_400.0
HELD = 0.9  # share of the ideal rate up to which more machines help


class Point(msgspec.Struct, frozen=True):
    """A number of machines.

    Parameters
    ----------
    machines : int
    rate : float
        Bytes of video a second.
    share : float
        Of so many times the rate of one machine.
    limit : str
        What is busy most: "processors", "scheduler" or "store".
    """

    machines: int
    rate: float
    share: float
    limit: str

    @property
    def days(self) -> float:
        """For `ALL` bytes."""
        return ALL / self.rate / DAY


def growth(basis: Basis, length: float, bandwidth: float, cost: float | None = None) -> list[Point]:
    """Simulate each number of machines.

    Parameters
    ----------
    basis : Basis
    length : float
        Of each video, s.
    bandwidth : float
        Of the store, bytes/s.
    cost : float, optional
        A task of the scheduler, s; without it that which was measured, by the number of workers.
    """
    points = list[Point]()
    for machines in MACHINES:
        workers = machines * WORKERS
        tasks = basis.draw(max(TURNS * workers, LEAST), length, np.random.default_rng(machines))
        each = basis.cost(workers) if cost is None else cost
        cluster = Cluster(workers, each, AHEAD, min(bandwidth, machines * LINK), LINK)
        done = simulate(tasks, cluster)
        rate = done.rate * sum(task.read for task in tasks) / done.tasks
        alone = points[0].rate if points else rate
        points.append(Point(machines, rate, rate / (alone * machines), _limit(done)))
    return points


def _limit(done: Simulated) -> str:
    busy = {"processors": done.computing, "scheduler": done.scheduler, "store": done.store}
    return max(busy, key=lambda name: busy[name])


def knee(points: Sequence[Point], held: float = HELD) -> float:
    """Return how many machines keep that share of the ideal rate, between simulated ones; inf: all of them."""
    for before, after in itertools.pairwise(points):
        if after.share < held <= before.share:
            part = (before.share - held) / (before.share - after.share)
            return math.exp(math.log(before.machines) + part * math.log(after.machines / before.machines))
    return math.inf if points[-1].share >= held else 0.0


class Tail(msgspec.Struct, frozen=True):
    """A batch of short videos with some long ones among them.

    Parameters
    ----------
    machines : int
    ideal : float
        All computing, divided by the workers, s.
    whole, split : float
        Until the last video has ended, without and with `--split`, s.
    extra : float
        What stretches compute twice, as a share.
    """

    machines: int
    ideal: float
    whole: float
    split: float
    extra: float


def tails(basis: Basis, stretch: float, machines: Sequence[int] = (10, 100, 1000), seed: int = 0) -> list[Tail]:
    """Simulate videos of a minute, of which one in a thousand has an hour; ten for each worker, in any order.

    Parameters
    ----------
    basis : Basis
    stretch : float
        Of `--split`, s.
    machines : sequence of int
    seed : int
    """
    rng, found = np.random.default_rng(seed), []
    for each in machines:
        workers = each * WORKERS
        lengths = np.where(rng.random(10 * workers) < 1e-3, LENGTHS["1 h"], LENGTHS["1 min"])
        whole = [basis.draw(1, length, rng)[0] for length in lengths.tolist()]
        parts = [
            part for task, length in zip(whole, lengths.tolist(), strict=True) for part in _cut(task, length, stretch)
        ]
        bandwidth = min(STORES["a thousand disks"], each * LINK)
        cluster = Cluster(workers, basis.cost(workers), AHEAD, bandwidth, LINK)
        ideal, cut = (sum(task.seconds for task in tasks) / workers for tasks in (whole, parts))
        times = simulate(whole, cluster).seconds, simulate(parts, cluster).seconds
        found.append(Tail(each, ideal, *times, cut / ideal - 1.0))
    return found


def _cut(task: Task, length: float, stretch: float) -> list[Task]:
    if length < 2.0 * SPLIT.shortest * stretch:
        return [task]
    count = max(round(length / stretch), 2)
    own = length / count
    shares = [(own + (SPLIT.overlap if number else 0.0)) / length for number in range(count)]
    return [Task(share * task.seconds, share * task.read, share * task.written) for share in shares]
