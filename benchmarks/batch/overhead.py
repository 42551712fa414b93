"""What a batch does with a video beside `track`, in one warm process: `measure_overhead`."""

import shutil
import time
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.batch.batches import Work, track_alone
from benchmarks.batch.load import Others
from benchmarks.batch.videos import Videos
from matchset.batch.jobs.job import Job
from matchset.batch.jobs.work import do_job

IO = Path("/proc/self/io")


class Pair(msgspec.Struct, frozen=True):
    """One video, by the worker's function and by `track`, one right after the other.

    Parameters
    ----------
    batch, plain : float
        By the clock, s.
    own : tuple of 2 floats
        The same in processor time, which other programs hardly change, s.
    size : int
        Of the video, bytes.
    read, written : int
        What the worker's function asked the system to read and write, bytes; 0 where there is no /proc.
    kept : int
        Of its results, bytes.
    """

    batch: float
    plain: float
    own: tuple[float, float]
    size: int
    read: int
    written: int
    kept: int


class Overhead(msgspec.Struct, frozen=True):
    """What was measured.

    Parameters
    ----------
    pairs : list of Pair
    others : float or None
        Share of the processors that other programs used.
    seconds : float
    """

    pairs: list[Pair]
    others: float | None
    seconds: float

    @property
    def percent(self) -> float:
        """Median over all pairs of how much more processor time it takes, %."""
        return 100.0 * (float(np.median([pair.own[0] / pair.own[1] for pair in self.pairs])) - 1.0)

    @property
    def clock_percent(self) -> float:
        """Median over all pairs of how much longer it takes by the clock, %."""
        return 100.0 * (float(np.median([pair.batch / pair.plain for pair in self.pairs])) - 1.0)

    @property
    def seconds_a_video(self) -> float:
        """Mean of the differences in processor time, s."""
        return float(np.mean([pair.own[0] - pair.own[1] for pair in self.pairs]))

    def mean(self, name: str) -> float:
        """Mean of a figure of the pairs."""
        return float(np.mean([getattr(pair, name) for pair in self.pairs]))


def measure_overhead(videos: Videos, out: Path, rounds: int) -> Overhead:
    """Follow each video twice, in an order that changes; the first round does not count.

    Parameters
    ----------
    videos : Videos
    out : Path
    rounds : int
    """
    work, plain = Work(videos, out / "batch"), out / "plain"
    pairs = list[Pair]()
    with work.jobs() as jobs, Others() as others:
        _pair(jobs[0], plain, True)
        for number in range(rounds):
            pairs += [_pair(job, plain, bool((number + turn) % 2)) for turn, job in enumerate(jobs)]
    return Overhead(pairs, others.share, round(others.seconds, 1))


def _pair(job: Job, folder: Path, batch_first: bool) -> Pair:
    kept = Path(job.out, job.folder)
    shutil.rmtree(kept, ignore_errors=True)
    plain = (0.0, 0.0) if batch_first else _alone(job, folder)
    before, begin, own = _io(), time.perf_counter(), time.process_time()
    outcome = do_job(job)
    batch, own, after = time.perf_counter() - begin, time.process_time() - own, _io()
    if outcome.state != "found":
        raise ValueError(f"nothing is found in {job.video}: {outcome.reason}")
    size = sum(path.stat().st_size for path in kept.iterdir())
    plain = _alone(job, folder) if batch_first else plain
    return Pair(batch, plain[0], (own, plain[1]), job.size, after[0] - before[0], after[1] - before[1], size)


def _alone(job: Job, folder: Path) -> tuple[float, float]:
    begin = time.process_time()
    seconds = track_alone(job, folder)
    return seconds, time.process_time() - begin


def _io() -> tuple[int, int]:
    """Bytes that this process has read and written so far."""
    if not IO.is_file():
        return 0, 0
    read, written = (int(line.split()[1]) for line in IO.read_text(encoding="ascii").splitlines()[:2])
    return read, written
