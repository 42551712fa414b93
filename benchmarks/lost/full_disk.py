"""A disk that is full at random moments: `python -m benchmarks.lost.full_disk` (20 moments of each command).

The disk is a tmpfs of random size below what the command writes; mounting it needs root. The command must end with
code 2 and one line that names a file on the disk, all that is there must be readable, and be as much as the line says.
"""

import contextlib
import re
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer

from benchmarks.lost.content import content_of
from benchmarks.lost.runs import RUNS, Run, start, write_clip

PAGE = 4096
TIME_OUT = 120.0  # s
Ended = Callable[[Run, Path, Path, Path], tuple[int, str]]
SAID = re.compile(r"(\S+): [^;]*; it holds (\d+)")


class FullDisk(NamedTuple):
    """How a command ended on a full disk.

    Attributes
    ----------
    size : int
        Of the disk, bytes.
    code : int
        Exit code.
    line : str
        What it said.
    wrong : tuple of str
        What should not be.
    """

    size: int
    code: int
    line: str
    wrong: tuple[str, ...]


@contextlib.contextmanager
def small_disk(folder: Path, size: int) -> Iterator[None]:
    """Mount a tmpfs of a size, bytes, on a folder; OSError where that is not allowed."""
    words = ["mount", "-t", "tmpfs", "-o", f"size={size}", "none", str(folder)]
    try:
        subprocess.run(words, check=True, capture_output=True)
    except subprocess.CalledProcessError as error:
        raise OSError(error.stderr.decode().strip()) from error
    try:
        yield
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def size_of(run: Run, clip: Path, folder: Path) -> int:
    """Let a command write where there is room, and return how many bytes its files have."""
    disk, other = folder / "room", folder / "elsewhere"
    for each in (disk, other):
        each.mkdir(exist_ok=True)
    process = start(run, clip, disk, other)
    _, err = process.communicate(timeout=TIME_OUT)
    if process.returncode:
        raise ValueError(f"{run.words} ended with {process.returncode}: {err}")
    return sum((disk / name).stat().st_size for name in run.files)


def ended(run: Run, clip: Path, disk: Path, other: Path) -> tuple[int, str]:
    """Let a process run to its end; returns its exit code and what it said."""
    process = start(run, clip, disk, other)
    try:
        _, err = process.communicate(timeout=TIME_OUT)
    finally:
        process.kill()
    return process.returncode, err


def run_on_full_disk(run: Run, clip: Path, folder: Path, size: int, ended: Ended = ended) -> FullDisk:
    """Let a command write to a disk of a size, bytes, and look at what is left."""
    disk, other = folder / "disk", folder / "elsewhere"
    for each in (disk, other):
        each.mkdir(exist_ok=True)
    with small_disk(disk, size):
        code, err = ended(run, clip, disk, other)
        lines = [line for line in err.splitlines() if not line.startswith("note:") and not line.endswith("...")]
        line = lines[-1] if lines else ""
        wrong = []
        if code != 2:
            wrong.append(f"exit code {code}")
        if len(lines) != 1 or not line.startswith("error: "):
            wrong.append(f"{len(lines)} lines: {err!r}")
        if not any(str(disk / name) in line for name in run.files):
            wrong.append("no file is named")
        wrong += _unreadable(run, disk, line)
    return FullDisk(size, code, line, tuple(wrong))


def _unreadable(run: Run, disk: Path, line: str) -> list[str]:
    """Say which files cannot be read, or hold something else than was said."""
    said = {name: int(count) for name, count in SAID.findall(line)}
    wrong = [f"{path} is left" for path in disk.rglob("*.part")]
    for path in (disk / name for name in run.files):
        if not path.exists() or path.stat().st_size == 0:
            if said.get(str(path), 0):
                wrong.append(f"{path} is empty")
            continue
        try:
            count = content_of(path).number
        except ValueError as error:
            if said.get(str(path), 0) or str(path) not in line:
                wrong.append(str(error))
            continue
        if said.get(str(path), count) != count:
            wrong.append(f"{path} holds {count}")
    return wrong


def main(
    moments: Annotated[int, typer.Option(min=1, help="How many sizes of the disk for each command.")] = 20,
    only: Annotated[str, typer.Option(help="Names of commands, with commas between.")] = "",
    seed: Annotated[int, typer.Option(help="Of the sizes.")] = 100,
) -> None:
    """Fill the disk and look at what is left."""
    bad = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_clip(clip := folder / "clip.avi")
        for title in only.split(",") if only else RUNS:
            run, rng = RUNS[title], np.random.default_rng(seed)
            whole = size_of(run, clip, folder)
            sizes = PAGE * rng.integers(1, max(whole // PAGE, 2), moments)
            ends = [run_on_full_disk(run, clip, folder, int(size)) for size in sizes]
            wrong = [end for end in ends if end.wrong]
            bad += len(wrong)
            print(f"{title:18s} {whole / 1000.0:8.0f} kB: {len(ends) - len(wrong)} of {len(ends)} right", flush=True)
            for end in wrong:
                print(f"  disk of {end.size} bytes: {'; '.join(end.wrong)}; said {end.line!r}")
            print(f"  e.g. {ends[0].line.replace(str(folder), '')}", flush=True)
    raise typer.Exit(bad > 0)


if __name__ == "__main__":
    typer.run(main)
