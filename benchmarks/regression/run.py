"""Measure sections and hold them against what is kept: `measure`, `verdict`, and `fast_part` for `make bench-quick`."""

import time
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks.machine import ROOT
from benchmarks.real.clips import find_clips
from benchmarks.regression.balls.stills import FOLDER as STILLS
from benchmarks.regression.figures import EXCEPTIONS, NEVER, Figure
from benchmarks.regression.kept import Kept, Origin, missing, read, unknown, worse
from benchmarks.regression.page import number
from benchmarks.regression.raised import counted
from benchmarks.regression.sections import SECTIONS, TIME, Job, chosen
from benchmarks.workers import one_thread

DATA = ROOT.parent / "shared" / "data"
PHOTOGRAPHS = ROOT.parent / "photographs"


def job_of(data: Path, photographs: Path, quick: bool) -> tuple[Job, list[str]]:
    """Find clips and photographs, and say what is missing."""
    clips, notes = find_clips(data)
    if not (data / STILLS).is_dir():
        notes.append(f"`{STILLS}`: skipped, not found")
    there = photographs if photographs.is_dir() else None
    if there is None and not quick:
        notes.append(f"no photographs in {photographs} (python -m training.rendering.photographs {photographs})")
    return Job(clips, data, there, quick), notes


def measure(name: str, job: Job, console: Console) -> tuple[list[Figure], Origin]:
    """Measure a section, and count its exceptions, naming their places."""
    begin = time.perf_counter()
    if name != TIME:
        one_thread()
    with counted() as raised:
        figures = SECTIONS[name].measure(job)
    if name != TIME:  # in processes of their own, which end with an exception
        figures.append(Figure.of((EXCEPTIONS, name), "raised", len(raised), NEVER))
    seconds = time.perf_counter() - begin
    console.print(f"{name}: {seconds:.0f} s", *(each.words for each in raised), sep="\n")
    return figures, Origin.here(seconds)


def verdict(console: Console, measured: list[Figure], kept: Kept, slack: float, complete: Sequence[str] = ()) -> int:
    """Print all figures beside those that are kept and return the exit code.

    Parameters
    ----------
    console : Console
    measured : list of Figure
    kept : Kept
    slack : float
        Factor on the limits of times.
    complete : sequence of str, optional
        Sections that were measured in full: what is kept of them must have been measured.

    Returns
    -------
    int
        1 if something is worse.
    """
    known = {figure.key: figure for figure in kept.figure}
    shown = Table("", "", "", "measured", "kept", "passes to")
    for figure in measured:
        before = known.get(figure.key)
        cells = [number(v, figure.name) for v in (before.value, before.limit(slack))] if before else ["-", "-"]
        passes = before is not None and before.passes(figure.value, slack)
        shown.add_row(*figure.key, number(figure.value, figure.name), *cells, style="" if passes else "red")
    console.print(shown)
    keys = [key for name in complete for key in SECTIONS[name].figures]
    words = worse(measured, kept, slack) + missing(measured, kept, keys)
    console.print(*unknown(measured, kept), sep="\n")
    console.print("\n".join(words) or "nothing is worse than what is kept, beyond noise")
    return 1 if words else 0


def fast_part(console: Console, data: Path, slack: float) -> int:
    """Measure the fast part, say so where there are no clips, and return the exit code."""
    job, _ = job_of(data, PHOTOGRAPHS, quick=True)
    if not job.clips:
        console.print(f"real footage: not measured, no clips in {data}")
    names = chosen(quick=True, clips=bool(job.clips))
    measured = [figure for name in names for figure in measure(name, job, console)[0]]
    return verdict(console, measured, read(), slack)
