"""Batches by real processes, of which some are killed with -9: nothing is lost, and hardly anything done twice."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from batched_videos import write_balls, write_color
from dask_programs import free_port, started
from matchset.batch.jobs.job import VideoOutcome

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="kill -9 is of POSIX")
VIDEOS = 12
LONGEST = 240.0  # s, far more than it takes


class Folder:
    """Videos, and what a batch of them has written."""

    def __init__(self, path: Path) -> None:
        self.clips, self.out, self.color = (
            write_balls(path / "clips", VIDEOS, 60),
            path / "out",
            write_color(path / "ball.npz"),
        )

    def start(self, *words: str) -> "subprocess.Popen[str]":
        """Start a batch."""
        command = [sys.executable, "-m", "matchset", "batch", str(self.clips), "--out", str(self.out)]
        more = ["--color", str(self.color), *(words or ("--jobs", "2"))]
        return subprocess.Popen([*command, *more], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    @property
    def outcomes(self) -> list[VideoOutcome]:
        """What has ended so far."""
        path = self.out / "manifest.jsonl"
        lines = path.read_bytes().split(b"\n")[1:-1] if path.is_file() else []
        return [msgspec.json.decode(line, type=VideoOutcome) for line in lines]

    def tables(self) -> dict[str, bytes]:
        """All tables by their names."""
        return {str(path.relative_to(self.out)): path.read_bytes() for path in self.out.rglob("tracks.csv")}


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    return Folder(tmp_path)


def until(happened: Callable[[], bool], process: "subprocess.Popen[str] | None" = None) -> None:
    """Wait until something has happened."""
    end = time.monotonic() + LONGEST
    while not happened():
        assert time.monotonic() < end, "it never happened"
        assert process is None or process.poll() is None, f"the batch ended: {process and process.communicate()}"
        time.sleep(0.01)


def children_of(process: int) -> list[int]:
    """Worker processes of a batch."""
    path = Path(f"/proc/{process}/task/{process}/children")
    numbers = [int(word) for word in path.read_text().split()] if path.is_file() else []
    return [number for number in numbers if b"spawn_main" in Path(f"/proc/{number}/cmdline").read_bytes()]


def end_of(process: "subprocess.Popen[str]") -> tuple[int, str]:
    """Exit code and words of a batch."""
    _, words = process.communicate(timeout=LONGEST)
    return process.returncode, words


@pytest.mark.timeout(600)
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="there is no /proc to find workers in")
def test_killed_worker_and_whole(folder: Folder) -> None:
    first = folder.start()
    until(lambda: len(folder.outcomes) >= 2, first)
    workers = children_of(first.pid)
    os.kill(workers[0], signal.SIGKILL)
    until(lambda: len(folder.outcomes) >= 4, first)
    workers = children_of(first.pid)
    first.kill()
    first.communicate()
    until(lambda: not any(Path(f"/proc/{number}").is_dir() and not is_zombie(number) for number in workers))
    before = len(folder.outcomes)
    assert end_of(folder.start())[0] == 0
    ended = folder.outcomes
    assert len({outcome.video for outcome in ended}) == VIDEOS
    assert len(ended) == VIDEOS  # none is noted twice
    assert before >= 4
    cut = folder.tables()
    folder.out = folder.out.with_name("whole")
    code, _ = end_of(folder.start("--jobs", "1"))
    assert code == 0
    assert folder.tables() == cut


def is_zombie(number: int) -> bool:
    """Whether a process has ended and nobody has asked how."""
    with contextlib.suppress(OSError):
        return Path(f"/proc/{number}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    return True


@pytest.mark.timeout(600)
def test_killed_scheduler_and_worker_of_dask(folder: Folder) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed (extra batch)")
    port = str(free_port())
    address = f"tcp://127.0.0.1:{port}"
    scheduler = "dask_scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"
    worker = "dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"
    with started(*scheduler) as first, started(*worker), started(*worker) as killed:
        batch = folder.start("--scheduler", address)
        until(lambda: len(folder.outcomes) >= 2, batch)
        killed.kill()
        until(lambda: len(folder.outcomes) >= 4, batch)
        first.kill()
        code, words = end_of(batch)
    assert code == 3
    assert f"the scheduler at {address} went away" in words
    with started(*scheduler), started(*worker):
        code, _ = end_of(folder.start("--scheduler", address))
    assert code == 0
    assert sorted(outcome.state for outcome in folder.outcomes) == ["found"] * VIDEOS
    by_dask = folder.tables()
    folder.out = folder.out.with_name("here")
    assert end_of(folder.start())[0] == 0
    assert folder.tables() == by_dask


def test_no_scheduler(folder: Folder) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed (extra batch)")
    code, words = end_of(folder.start("--scheduler", f"tcp://127.0.0.1:{free_port()}"))
    assert code == 3
    assert "no scheduler of Dask answers" in words
