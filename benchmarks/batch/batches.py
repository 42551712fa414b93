"""Batches in this process, by pools that are warm already: `Work`."""

import contextlib
import io
import shutil
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec

from benchmarks.batch.videos import Videos
from matchset.app.cli_options import GrayTargetOptions
from matchset.batch.clicking.clicker import NoClicker
from matchset.batch.jobs.job import Job, VideoOutcome
from matchset.batch.jobs.target import TargetChoice
from matchset.batch.jobs.videos import VideoList
from matchset.batch.jobs.work import run_command
from matchset.batch.loop import Batch
from matchset.batch.options import BatchOptions, WorkerOptions
from matchset.batch.plan import Plan
from matchset.batch.progress import BatchCounts
from matchset.batch.results.manifest import Manifest
from matchset.batch.results.store import FolderStore
from matchset.batch.workers.pool import Pool


class Ran(msgspec.Struct, frozen=True):
    """What a batch took.

    Parameters
    ----------
    seconds : float
        From the first look at its videos to the last outcome in its manifest.
    own : float
        Processor time of the process that leads it, s.
    tasks : list of float
        Each task by its worker's clock, s, in the order of their ends.
    workers : int
        How many have worked.
    """

    seconds: float
    own: float
    tasks: list[float]
    workers: int


class Work:
    """Videos that are followed again and again, each time into a folder that was emptied.

    Parameters
    ----------
    videos : Videos
    out : Path
        Where results go.
    split : float, optional
        Length of stretches, s.
    """

    def __init__(self, videos: Videos, out: Path, split: float | None = None) -> None:
        self._options = BatchOptions(
            videos=[str(path) for path in videos.paths],
            out=str(out),
            target=GrayTargetOptions(color=[videos.color]),
            worker=WorkerOptions(split=split),
        )
        self.out = out

    def run(self, pool: Pool) -> Ran:
        """Do all, as `matchset batch` does, without its start and its report (ValueError if one is not done)."""
        outcomes = list[VideoOutcome]()
        with self._plan() as (plan, manifest):
            noted = _Noted(manifest, outcomes)
            begin, own = time.perf_counter(), time.process_time()
            batch = Batch(plan, noted, BatchCounts(plan.videos.count), NoClicker())  # type: ignore[arg-type]
            while batch.step(pool):
                pass
            seconds, own = time.perf_counter() - begin, time.process_time() - own
        lost = [outcome for outcome in outcomes if outcome.state not in ("found", "not found")]
        if lost or len(outcomes) != plan.videos.count:
            raise ValueError(f"{len(outcomes)} of {plan.videos.count} videos have ended, {lost[:1]}")
        tasks = [outcome.seconds for outcome in outcomes]
        return Ran(seconds, own, tasks, len({outcome.worker for outcome in outcomes}))

    @contextlib.contextmanager
    def jobs(self) -> Iterator[list[Job]]:
        """Give the jobs of all videos, none of which is done; in the block they can be."""
        with self._plan() as (plan, _):
            yield [job for job in plan.work() if isinstance(job, Job)]

    @contextlib.contextmanager
    def _plan(self) -> Iterator[tuple[Plan, Manifest]]:
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir(parents=True)
        videos, store = VideoList(self._options.videos), FolderStore(self.out)
        with Manifest(store, videos.common) as manifest:
            choice = TargetChoice(self._options)
            plan = Plan(videos, choice, store, manifest, str(self.out), self._options)
            with store.begun(plan.mark):
                yield plan, manifest


class _Noted:
    """A manifest whose outcomes are kept here, too."""

    def __init__(self, manifest: Manifest, outcomes: list[VideoOutcome]) -> None:
        self._manifest, self._outcomes = manifest, outcomes

    def append(self, outcome: VideoOutcome) -> None:
        """Note what became of a video."""
        self._outcomes.append(outcome)
        self._manifest.append(outcome)


def track_alone(job: Job, folder: Path) -> float:
    """Do what the command `track` does with the video of a job, into a new folder; return how long it took, s."""
    shutil.rmtree(folder, ignore_errors=True)
    begin = time.perf_counter()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        run_command(msgspec.structs.replace(job.options, source=job.video, out=folder, force=True))
    return time.perf_counter() - begin


def track_all(jobs: list[Job], folder: Path) -> list[float]:
    """Do so with several videos, one after the other."""
    return [track_alone(job, folder / Path(job.folder).name) for job in jobs]
