"""One and two workers of a batch beside what the machine can do: `measure_speed`."""

import contextlib
import multiprocessing
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.batch.batches import Ran, Work, track_all
from benchmarks.batch.load import Others
from benchmarks.batch.videos import Videos
from matchset.batch.jobs.job import Job
from matchset.batch.workers.processes import Processes
from matchset.batch.workers.worker import begin_worker, warm_up

WAYS = "plain 1", "plain 2", "batch 1", "batch 2"


class Round(msgspec.Struct, frozen=True):
    """The same videos in four ways, one after the other.

    Parameters
    ----------
    plain : tuple of 2 floats
        By `track` in one warm process, and by two side by side, s.
    batch : tuple of 2 Ran
        By a batch with one and with two workers.
    """

    plain: tuple[float, float]
    batch: tuple[Ran, Ran]

    @property
    def machine(self) -> float:
        """How much faster two processes are than one."""
        return self.plain[0] / self.plain[1]

    @property
    def speed_up(self) -> float:
        """How much faster a batch with two workers is than with one."""
        return self.batch[0].seconds / self.batch[1].seconds


class Speed(msgspec.Struct, frozen=True):
    """What was measured.

    Parameters
    ----------
    rounds : list of Round
    videos, read : int
        How many, and their bytes.
    others : float or None
        Share of the processors that other programs used.
    seconds : float
        How long it took.
    """

    rounds: list[Round]
    videos: int
    read: int
    others: float | None
    seconds: float

    def median(self, figure: Callable[[Round], float]) -> float:
        """Median of a figure over the rounds."""
        return float(np.median([figure(each) for each in self.rounds]))

    @property
    def share(self) -> float:
        """Speed-up of the batch as a share of the machine's own."""
        return self.median(lambda each: each.speed_up / each.machine)


class _Plain:
    """Two warm processes that do nothing but `track`."""

    def __init__(self, work: Work, jobs: list[Job]) -> None:
        context, here = multiprocessing.get_context("spawn"), (os.getpid(),)
        self._pools = [ProcessPoolExecutor(1, context, begin_worker, here) for _ in range(2)]
        self._jobs, self._out = jobs, work.out
        for pool in self._pools:
            pool.submit(warm_up, "circle").result()
            pool.submit(track_all, jobs[:1], self._out).result()

    def run(self, count: int) -> float:
        """Follow all videos in so many processes, each an equal part; return how long it took, s."""
        begin = time.perf_counter()
        parts = [self._jobs] if count == 1 else [self._jobs[: len(self._jobs) // 2], self._jobs[len(self._jobs) // 2 :]]
        pairs = zip(self._pools, parts, strict=False)
        for future in [pool.submit(track_all, part, self._out) for pool, part in pairs]:
            future.result()
        return time.perf_counter() - begin

    def close(self) -> None:
        """End them."""
        for pool in self._pools:
            pool.shutdown()


def measure_speed(videos: Videos, out: Path, rounds: int) -> Speed:
    """Follow videos in four ways by turns; who begins changes from round to round.

    Parameters
    ----------
    videos : Videos
        The second half has the same bytes as the first, so that two processes have equal parts.
    out : Path
    rounds : int
    """
    with _everybody(videos, out) as ways, Others() as others:
        made = []
        for number in range(rounds):
            done: dict[str, float | Ran] = {}
            for turn in range(len(WAYS)):
                way = WAYS[(number + turn) % len(WAYS)]
                done[way] = ways[way]()
            plain, batch = tuple(done[way] for way in WAYS[:2]), tuple(done[way] for way in WAYS[2:])
            made.append(Round(plain, batch))  # type: ignore[arg-type]
    size = sum(path.stat().st_size for path in videos.paths)
    return Speed(made, len(videos.paths), size, others.share, round(others.seconds, 1))


@contextlib.contextmanager
def _everybody(videos: Videos, out: Path) -> Iterator[dict[str, Callable[[], float | Ran]]]:
    """Start all processes, and let each of them follow a video before it counts."""
    work, few = Work(videos, out / "batch"), Work(msgspec.structs.replace(videos, paths=videos.paths[:4]), out / "few")
    with work.jobs() as jobs:
        plain = _Plain(Work(videos, out / "plain"), jobs)
    with contextlib.closing(plain), Processes(1) as one, Processes(2) as two:
        for pool in (one, two):
            few.run(pool)
        yield {
            WAYS[0]: lambda: plain.run(1),
            WAYS[1]: lambda: plain.run(2),
            WAYS[2]: lambda: work.run(one),
            WAYS[3]: lambda: work.run(two),
        }
