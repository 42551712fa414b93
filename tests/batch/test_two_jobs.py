"""A worker of a batch that was killed is still at a video that the next one hands out: whose results stay there."""

import contextlib
import itertools
import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from batched_videos import write_ball, write_balls, write_color
from matchset.app.cli_options import GrayTargetOptions
from matchset.app.exit_codes import FOUND
from matchset.batch.jobs import work
from matchset.batch.jobs.counts import noted_table
from matchset.batch.jobs.identity import code_digest
from matchset.batch.jobs.job import Job, VideoOutcome
from matchset.batch.jobs.video_options import Options, track_options
from matchset.batch.jobs.watch import Watch, WatchParameters
from matchset.batch.jobs.work import UnfitWorkerError, do_job, kept_outcome
from matchset.batch.options import BatchOptions
from matchset.batch.results.store import FolderStore, SupersededError, store_at

LONGEST = 60.0  # s, far more than anything here takes
OLD_STEPS, NEW_STEPS = 16, 24  # more than both have
ROW = "frame,time,found,x,y\n0,0.0,1,{},0.0\n"


class Writer(threading.Thread):
    """Writes something, and waits before every step until it is told to go on."""

    def __init__(self, does: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self._does, self._allowed, self._taken, self._ended = does, 0, 0, False
        self._changed = threading.Condition()

    def run(self) -> None:
        try:
            self._does()
        finally:
            with self._changed:
                self._ended = True
                self._changed.notify_all()

    def before_step(self) -> None:
        """Wait until so many steps are allowed."""
        with self._changed:
            self._taken += 1
            self._changed.notify_all()
            assert self._changed.wait_for(lambda: self._taken <= self._allowed, LONGEST)

    def begin(self, steps: int) -> None:
        """Start, and return when so many steps are done and it waits before the next one, or has ended."""
        self._allowed = steps
        self.start()
        with self._changed:
            assert self._changed.wait_for(lambda: self._taken > steps or self._ended, LONGEST)

    def finish(self) -> None:
        """Let it go on to its end."""
        with self._changed:
            self._allowed = sys.maxsize
            self._changed.notify_all()
        self.join(LONGEST)
        assert self._ended


@pytest.fixture(autouse=True)
def steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let everything that changes a disk, or asks or changes objects of fsspec, be a step."""

    def stepped(owner: Any, name: str) -> None:
        real = getattr(owner, name)

        def step(*words: Any, **named: Any) -> Any:
            writer = threading.current_thread()
            if isinstance(writer, Writer):
                writer.before_step()
            return real(*words, **named)

        monkeypatch.setattr(owner, name, step)

    for name in ("rename", "replace", "mkdir", "rmdir"):
        stepped(os, name)
    try:
        from fsspec.implementations.memory import MemoryFileSystem
    except ImportError:
        return
    for name in ("pipe_file", "rm_file", "cat_file"):
        stepped(MemoryFileSystem, name)


@pytest.fixture(params=["folder", "url"])
def job(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Job:
    """A job whose command writes what its settings say."""

    def write(options: Options) -> int:
        assert options.out is not None
        (Path(options.out) / "tracks.csv").write_text(ROW.format(options.points))
        return FOUND

    monkeypatch.setattr(work, "run_command", write)
    if request.param == "url":
        pytest.importorskip("fsspec", reason="fsspec is not installed")
    out = str(tmp_path / "out") if request.param == "folder" else f"memory://{tmp_path.name}/out"
    video = str(write_balls(tmp_path / "clips", 1) / "day0/ball0.mp4")
    options = track_options(BatchOptions(videos=[], out=out), "")
    return Job(video=video, folder="a/b", out=out, options=options, settings="", code=code_digest())


def of_batch(job: Job, out: str, mark: str, points: int) -> Job:
    options = msgspec.structs.replace(job.options, points=points)
    return msgspec.structs.replace(job, out=out, mark=mark, settings=str(points), options=options)


def old_batch(job: Job) -> None:
    """A job of the batch that was killed."""
    with contextlib.suppress(SupersededError, UnfitWorkerError):
        do_job(job)


def new_batch(job: Job, ended: list[VideoOutcome]) -> None:
    """What the next batch does with that video."""
    store = store_at(job.out)
    with store.begun(job.mark):
        ended.append(kept_outcome(store, job) or do_job(job))


def both(job: Job, pauses: tuple[int, int], points: tuple[int, int]) -> bytes:
    """Let an old job pause after so many steps and a new batch after so many, the old one end, and then the new one.

    Returns
    -------
    bytes
        The table that is there then.
    """
    where = f"{job.out}/{pauses[0]}-{pauses[1]}"
    old, new = (of_batch(job, where, mark, each) for mark, each in zip(("old", "new"), points, strict=True))
    killed = store_at(where).begun("old")
    killed.__enter__()  # nobody leaves the block while there is something to do
    ended = list[VideoOutcome]()
    first, second = Writer(lambda: old_batch(old)), Writer(lambda: new_batch(new, ended))
    first.begin(pauses[0])
    second.begin(pauses[1])
    first.finish()
    second.finish()
    (outcome,) = ended
    assert (outcome.state, outcome.settings) == ("found", new.settings)
    store = store_at(where)
    table = noted_table(store, outcome)
    if table is None:  # it is seen that it is another one, so the video is done again
        assert "://" in where
        new_batch(new, ended)
        table = noted_table(store, ended[1])
    assert table is not None
    return table


@pytest.mark.parametrize("points", [(32, 64), (64, 64)])
def test_results_are_those_of_the_batch_that_runs(job: Job, points: tuple[int, int]) -> None:
    for pauses in itertools.product(range(OLD_STEPS), range(NEW_STEPS)):
        assert both(job, pauses, points) == ROW.format(points[1]).encode(), pauses


def test_what_nobody_wants_any_more_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Watch.__init__, "__defaults__", (WatchParameters(look=0.0),))
    asked = list[bool]()

    def is_current(store: FolderStore) -> bool:
        asked.append(len(asked) < 4)
        return asked[-1]

    monkeypatch.setattr(FolderStore, "is_current", is_current)
    video, color = write_ball(tmp_path / "ball.mp4", frames=60), write_color(tmp_path / "ball.npz")
    target = GrayTargetOptions(color=[color])
    options = track_options(BatchOptions(videos=[], out="", target=target), "")
    job = Job(video=str(video), folder="a", out=str(tmp_path / "out"), options=options, settings="", mark="old")
    with FolderStore(tmp_path / "out").begun("old"), pytest.raises(SupersededError, match="another batch writes into"):
        do_job(job)
    assert len(asked) < 10  # not one for each of its frames
    assert not (tmp_path / "out" / "a").exists()
