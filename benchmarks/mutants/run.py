"""Tests mutants, each in a process of its own, in copies of the repository under build/: `Runner`."""

import contextlib
import multiprocessing
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Literal

import msgspec

from benchmarks.mutants.mutant import ROOT, Mutant

Verdict = Literal["killed", "timeout", "alive", "no test"]
"""``timeout``: the tests did not end, which counts as noticed. ``no test``: they fail without the mutant, too."""

PRELOADED = ("numpy", "numba", "hypothesis", "msgspec", "cv2", "ctypes", "pytest")  # format: what every test imports
LINKED = (".toolchain", "tests/emu/avr8js/node_modules")  # format: not in the repository, needed by tests


class Outcome(msgspec.Struct, frozen=True):
    """What became of a mutant."""

    key: str
    tests_key: str
    group: str
    path: str
    before: str
    after: str
    verdict: Verdict
    seconds: float


def copy_repository(target: Path) -> None:
    """Copy the files that git knows, and link what the tests need beside them."""
    names = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split("\n")
    for name in filter(None, names):
        source, copy = ROOT / name, target / name
        if source.is_file() and not (copy.is_file() and copy.read_bytes() == source.read_bytes()):
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, copy)
    for name in LINKED:
        if (ROOT / name).exists() and not (target / name).exists():
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            (target / name).symlink_to(ROOT / name)


def _test(copy: Path, tests: tuple[str, ...]) -> None:
    """Run the tests; the exit code of the process is pytest's.

    Hypothesis tries the same examples each time and lets them take as long as they do: on a busy computer a test that
    is late must not count as one that noticed.
    """
    import hypothesis
    import pytest

    slow = [hypothesis.HealthCheck.too_slow]
    hypothesis.settings.register_profile("mutants", deadline=None, derandomize=True, suppress_health_check=slow)
    hypothesis.settings.load_profile("mutants")
    os.setpgrp()  # so that what the tests start ends with them
    os.chdir(copy)
    sys.path[:0] = [str(copy), str(copy / "src")]
    os.environ["PYTHONPATH"] = os.pathsep.join(sys.path[:2])
    sys.dont_write_bytecode = True
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"  # what the tests start must not find a mutant's code later
    sink = os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, 1)
    os.dup2(sink, 2)
    preloaded = "ignore::pytest.PytestAssertRewriteWarning"  # plugins that were imported before pytest began
    settings = ["-x", "-q", "-p", "no:cacheprovider", "-W", preloaded]
    os._exit(int(pytest.main([*settings, *tests])))


class Runner:
    """Tests mutants, some at a time.

    Parameters
    ----------
    folder : Path
        Where the copies and the results are kept.
    jobs : int
        How many at a time.
    limit : float
        Longest time of the tests of a mutant, s.
    """

    def __init__(self, folder: Path, jobs: int = 1, limit: float = 300.0) -> None:
        self.folder, self.jobs, self.limit = folder, jobs, limit
        self._results = folder / "results.jsonl"
        self._context: Any = multiprocessing.get_context("fork")

    def known(self) -> dict[str, Outcome]:
        """Return what is known from before, by the mutants' keys; of what was run twice the last."""
        if not self._results.exists():
            return {}
        lines = self._results.read_bytes().splitlines()
        return {outcome.key: outcome for outcome in (msgspec.json.decode(line, type=Outcome) for line in lines)}

    def holds(self, mutant: Mutant, known: dict[str, Outcome]) -> bool:
        """Whether a result still says something: one that lived is tried again when its tests have changed."""
        outcome = known.get(mutant.key())
        return outcome is not None and (outcome.verdict != "alive" or outcome.tests_key == mutant.tests_key())

    def run(self, mutants: list[Mutant]) -> Iterator[Outcome]:
        """Test mutants; each outcome is kept on disk as soon as it is known."""
        os.environ["NUMBA_CACHE_DIR"] = str(self.folder / "numba_cache")
        for name in PRELOADED:
            with contextlib.suppress(ImportError):
                __import__(name)
        copies = [self.folder / f"copy_{number}" for number in range(self.jobs)]
        for copy in copies:
            copy_repository(copy)
        sound = self._sound({mutant.tests for mutant in mutants}, copies[0])
        waiting, running = list(reversed(mutants)), dict[BaseProcess, tuple[Mutant, Path, float]]()
        free = list(copies)
        while waiting or running:
            while waiting and free:
                mutant = waiting.pop()
                if mutant.tests not in sound:
                    yield self._keep(mutant, "no test", 0.0)
                    continue
                copy = free.pop()
                path = copy / mutant.path
                path.write_text(mutant.apply(path.read_text(encoding="utf-8")), encoding="utf-8")
                running[self._start(copy, mutant.tests)] = mutant, copy, time.monotonic()
            wait([process.sentinel for process in running], timeout=0.5)
            for process in list(running):
                mutant, copy, begin = running[process]
                seconds = time.monotonic() - begin
                if process.is_alive() and seconds < self.limit:
                    continue
                verdict: Verdict = "timeout" if process.is_alive() else "killed" if process.exitcode else "alive"
                self._end(process)
                del running[process]
                shutil.copyfile(ROOT / mutant.path, copy / mutant.path)
                free.append(copy)
                yield self._keep(mutant, verdict, seconds)

    def _sound(self, sets: set[tuple[str, ...]], copy: Path) -> set[tuple[str, ...]]:
        """Those of the sets of tests that pass without a mutant."""
        sound = set()
        for tests in sorted(sets):
            process = self._start(copy, tests)
            process.join(self.limit)
            if process.exitcode == 0:
                sound.add(tests)
            else:
                print(f"these fail without a mutant, too: {' '.join(tests)} ({process.exitcode})", file=sys.stderr)
            self._end(process)
        return sound

    def _start(self, copy: Path, tests: tuple[str, ...]) -> BaseProcess:
        process: BaseProcess = self._context.Process(target=_test, args=(copy, tests))
        process.start()
        return process

    def _end(self, process: BaseProcess) -> None:
        """End a process and all that it started."""
        if process.is_alive() and process.pid is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, 9)
        process.join()

    def _keep(self, mutant: Mutant, verdict: Verdict, seconds: float) -> Outcome:
        outcome = Outcome(
            mutant.key(),
            mutant.tests_key(),
            mutant.group,
            mutant.path,
            mutant.before,
            mutant.after,
            verdict,
            round(seconds, 1),
        )
        if verdict != "no test":
            with self._results.open("ab") as file:
                file.write(msgspec.json.encode(outcome) + b"\n")
        return outcome
