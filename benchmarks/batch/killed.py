"""A batch of 200 videos on a scheduler of Dask, killed three times: `measure_killed`."""

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import msgspec

from benchmarks.batch.batches import Work, track_alone
from benchmarks.batch.load import Others
from benchmarks.batch.videos import TINY, Videos
from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.results.manifest import FILE
from matchset.batch.workers.worker import THREADS

LONGEST = 300.0  # s, far more than anything here takes
TABLE = "tracks.csv"
KILLS = 0.2, 0.45, 0.7  # after which share of the videos somebody is killed


class Kill(msgspec.Struct, frozen=True):
    """Somebody was killed.

    Parameters
    ----------
    who : str
    after : int
        Videos that were finished by then.
    """

    who: str
    after: int


class Killed(msgspec.Struct, frozen=True):
    """What was left.

    Parameters
    ----------
    videos : int
    kills : list of Kill
    runs : int
        How often the command was typed.
    codes : list of int
        Its exit codes; negative: it was killed.
    noted, different : int
        Lines of the manifest, and videos in them.
    same : int
        Tables that are byte for byte those of `track`.
    again : int
        Tables that were whole before a kill and were written again afterwards.
    left : int
        Files and folders that nobody has cleared away.
    batch, undisturbed : float
        From the first start to the last end, and the same by one command that nobody disturbs, s.
    others : float or None
        Share of the processors that other programs used.
    seconds : float
    """

    videos: int
    kills: list[Kill]
    runs: int
    codes: list[int]
    noted: int
    different: int
    same: int
    again: int
    left: int
    batch: float
    undisturbed: float
    others: float | None
    seconds: float


class _Cluster:
    """A scheduler and two workers, each a process, on this computer."""

    def __init__(self) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = str(probe.getsockname()[1])
        self.address = f"tcp://127.0.0.1:{self.port}"
        self._scheduler: subprocess.Popen[bytes] | None = None
        self.workers: list[subprocess.Popen[bytes]] = []

    def start(self) -> None:
        """Start what does not run."""
        if self._scheduler is None:
            words = "dask_scheduler", "--host", "127.0.0.1", "--port", self.port, "--no-dashboard"
            self._scheduler = _started("distributed.cli." + words[0], *words[1:])
        while len(self.workers) < 2:
            told = self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard"
            self.workers.append(_started("distributed.cli.dask_worker", *told))

    def kill_scheduler(self) -> None:
        """Kill the scheduler; its workers end when they miss it, and are not waited for."""
        if self._scheduler is not None:
            _kill(self._scheduler)
            self._scheduler = None

    def kill(self) -> None:
        """Kill all."""
        self.kill_scheduler()
        while self.workers:
            _kill(self.workers.pop())


class _Batch:
    """The command, and what it has written."""

    def __init__(self, videos: Videos, out: Path) -> None:
        self.videos, self.out, self.codes = videos, out, list[int]()

    def start(self, address: str) -> "subprocess.Popen[bytes]":
        """Type the command."""
        words = "batch", str(self.videos.folder), "--out", str(self.out), "--color", str(self.videos.color)
        return _started("matchset", *words, "--scheduler", address)

    def wait(self, count: int, process: "subprocess.Popen[bytes]") -> None:
        """Wait until so many videos are noted."""
        _until(lambda: len(self.lines()) >= count or process.poll() is not None)
        if process.poll() is not None:
            raise ValueError(f"the batch has ended before {count} videos, with {process.returncode}")

    def end(self, process: "subprocess.Popen[bytes]") -> None:
        """Wait for its end."""
        self.codes.append(process.wait(LONGEST))

    def lines(self) -> list[VideoOutcome]:
        """Return what the manifest says."""
        path = self.out / FILE
        lines = path.read_bytes().split(b"\n")[1:-1] if path.is_file() else []
        return [msgspec.json.decode(line, type=VideoOutcome) for line in lines]

    def tables(self) -> dict[str, tuple[int, int]]:
        """Return the tables that are whole, each with what changes when it is written again."""
        found = {}
        for path in self.out.glob(f"*/{TABLE}"):
            with contextlib.suppress(FileNotFoundError):
                stat = path.stat()
                found[path.parent.name] = stat.st_ino, stat.st_mtime_ns
        return found


def measure_killed(videos: Videos, out: Path) -> Killed:
    """Kill a worker, then the scheduler, then all; then see what is there.

    Parameters
    ----------
    videos : Videos
        Copies of `TINY` different ones.
    out : Path
    """
    shutil.rmtree(out, ignore_errors=True)
    batch, cluster, kills, again = _Batch(videos, out / "killed"), _Cluster(), list[Kill](), set[str]()
    with Others() as others:
        begin = time.monotonic()
        try:
            _disturbed(batch, cluster, kills, again)
        finally:
            cluster.kill()
        disturbed, begin = time.monotonic() - begin, time.monotonic()
        whole = _Batch(videos, out / "whole")
        try:
            cluster.start()
            whole.end(whole.start(cluster.address))
        finally:
            cluster.kill()
        undisturbed = time.monotonic() - begin
    noted = batch.lines()
    different, same = len({outcome.video for outcome in noted}), _same(batch, out / "alone")
    left = len(list((batch.out / ".unfinished").glob("*"))) if (batch.out / ".unfinished").is_dir() else 0
    counted = len(noted), different, same, len(again), left
    times = round(disturbed, 1), round(undisturbed, 1), others.share, round(others.seconds, 1)
    return Killed(len(videos.paths), kills, len(batch.codes), batch.codes, *counted, *times)


def _disturbed(batch: _Batch, cluster: _Cluster, kills: list[Kill], again: set[str]) -> None:
    first, second, third = (round(share * len(batch.videos.paths)) for share in KILLS)
    cluster.start()
    process = batch.start(cluster.address)
    batch.wait(first, process)
    kills.append(Kill("a worker", len(batch.lines())))
    whole = batch.tables()
    _kill(cluster.workers.pop())
    cluster.start()
    batch.wait(second, process)
    kills.append(Kill("the scheduler", len(batch.lines())))
    again |= _changed(whole, batch.tables())
    cluster.kill_scheduler()
    batch.end(process)
    whole = batch.tables()
    cluster.kill()
    cluster.start()
    process = batch.start(cluster.address)
    batch.wait(third, process)
    again |= _changed(whole, batch.tables())
    kills.append(Kill("all: the batch, the scheduler and both workers", len(batch.lines())))
    process.kill()
    batch.end(process)
    cluster.kill()
    whole = batch.tables()
    cluster.start()
    batch.end(batch.start(cluster.address))
    again |= _changed(whole, batch.tables())


def _changed(before: dict[str, tuple[int, int]], after: dict[str, tuple[int, int]]) -> set[str]:
    return {name for name, stamp in before.items() if after.get(name) != stamp}


def _same(batch: _Batch, folder: Path) -> int:
    """Count the tables that are those of `track`; copies of a video have one."""
    few, expected = msgspec.structs.replace(batch.videos, paths=batch.videos.paths[:TINY]), {}
    with Work(few, folder / "none").jobs() as jobs:
        for job in jobs:
            track_alone(job, folder / "track")
            expected[Path(job.video).name.partition("-")[0]] = (folder / "track" / TABLE).read_bytes()
    paths = list(batch.out.glob(f"*/{TABLE}"))
    return sum(path.read_bytes() == expected[path.parent.name.partition("-")[0]] for path in paths)


def _started(module: str, *words: str) -> "subprocess.Popen[bytes]":
    environment = {**os.environ, **dict.fromkeys(THREADS, "1")}
    command, nothing = [sys.executable, "-m", module, *words], subprocess.DEVNULL
    return subprocess.Popen(command, env=environment, stdout=nothing, stderr=nothing)


def _kill(process: "subprocess.Popen[bytes]") -> None:
    process.send_signal(signal.SIGKILL)
    process.wait()


def _until(happened: Callable[[], bool]) -> None:
    end = time.monotonic() + LONGEST
    while not happened():
        if time.monotonic() > end:
            raise TimeoutError(f"it has not happened in {LONGEST:g} s")
        time.sleep(0.02)
