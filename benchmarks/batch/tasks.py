"""What giving and taking a task costs, measured with tasks that do nothing: `measure_tasks`."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import msgspec

from benchmarks.batch.batches import Ran, Work
from benchmarks.batch.load import Others
from benchmarks.batch.videos import Videos
from matchset.batch.jobs.identity import stat_of, worker_name
from matchset.batch.jobs.job import Job, VideoOutcome
from matchset.batch.workers import dask_cluster, processes
from matchset.batch.workers.dask_cluster import DaskCluster
from matchset.batch.workers.pool import Pool
from matchset.batch.workers.processes import Processes

HERE = 2  # workers of Dask that are there


class Cost(msgspec.Struct, frozen=True):
    """Tasks that do nothing.

    Parameters
    ----------
    name : str
        Who does them.
    workers : int
        Of Dask those that the batch knows.
    tasks : int
    ran : Ran
        `own` is the processor time of the whole process; of Dask's the scheduler and the workers are in it.
    """

    name: str
    workers: int
    tasks: int
    ran: Ran

    @property
    def seconds(self) -> float:
        """A task, by the clock, s."""
        return self.ran.seconds / self.tasks


class Costs(msgspec.Struct, frozen=True):
    """What was measured.

    Parameters
    ----------
    costs : list of Cost
    others : float or None
        Share of the processors that other programs used.
    seconds : float
    """

    costs: list[Cost]
    others: float | None
    seconds: float


def empty_task(job: Job) -> VideoOutcome:
    """Say that a video was followed."""
    size, modified = stat_of(job.video)
    done = VideoOutcome(video=job.video, folder=job.folder, settings=job.settings, state="found", frames=1, found=1)
    return msgspec.structs.replace(done, worker=worker_name(), size=size, modified=modified)


def measure_tasks(videos: Videos, out: Path, count: int, clusters: tuple[int, ...]) -> Costs:
    """Give tasks that do nothing to one and two processes, and to schedulers of Dask with so many workers.

    Parameters
    ----------
    videos : Videos
        For their color.
    out : Path
    count : int
        Tasks.
    clusters : tuple of int
        Numbers of workers of Dask that the batch knows; two of them are there, in this process.
    """
    folder = out / "names"
    folder.mkdir(parents=True, exist_ok=True)
    paths = tuple(folder / f"{number:06d}.mp4" for number in range(count))
    for path in paths:
        path.write_bytes(b"0")
    work = Work(Videos(folder, paths, videos.color), out / "empty")
    costs = list[Cost]()
    with Others() as others:
        for workers in (1, 2):
            with mock.patch.object(processes, "do_job", empty_task), Processes(workers) as pool:
                costs.append(_cost(f"{workers} processes", workers, work, pool, count))
        for workers in clusters:
            with _cluster(workers) as pool:
                costs.append(_cost("Dask", workers, work, pool, count))
    return Costs(costs, others.share, round(others.seconds, 1))


def _cost(name: str, workers: int, work: Work, pool: Pool, count: int) -> Cost:
    work.run(pool)  # the workers load what they need
    return Cost(name, workers, count, work.run(pool))


@contextlib.contextmanager
def _cluster(workers: int) -> Iterator[Pool]:
    """Run a scheduler and its workers in this process, over sockets of this computer."""
    import distributed

    cluster_of: Any = distributed.LocalCluster
    absent = {f"tcp://10.{k >> 16}.{k >> 8 & 255}.{k & 255}:40000": 0 for k in range(workers - HERE)}

    class Named(DaskCluster):
        """A pool that knows of workers which are not there."""

        def _look(self) -> None:
            super()._look()
            self._fit = self._fit | absent

    with (
        mock.patch.object(dask_cluster, "do_job", empty_task),
        cluster_of(
            n_workers=HERE,
            threads_per_worker=1,
            processes=False,
            dashboard_address=":0",
            protocol="tcp",
            host="127.0.0.1",
        ) as cluster,
        Named(cluster.scheduler_address) as pool,
    ):
        yield pool
