"""Has a change made it worse on real footage, or slower as a user has it? `make bench-real`, about twenty minutes.

All figures are held against those in `kept.toml`; what is worse beyond noise fails. `--store` writes them, and the page
`benchmarks/REAL.md`. `--quick` is the fast part, which `make bench-quick` has too.
"""

import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from benchmarks.machine import ROOT
from benchmarks.real.clips import find_clips
from benchmarks.regression.figures import EXCEPTIONS, NEVER, Figure
from benchmarks.regression.kept import Kept, Origin, missing, read, worse, write
from benchmarks.regression.page import PAGE, markdown, number
from benchmarks.regression.raised import counted
from benchmarks.regression.sections import SECTIONS, TIME, Job, chosen
from benchmarks.workers import one_thread

DATA = ROOT.parent / "shared" / "data"
PHOTOGRAPHS = ROOT.parent / "photographs"


def main(
    data: Annotated[Path, typer.Option(help="Folder with the real clips.")] = DATA,
    photographs: Annotated[Path, typer.Option(help="Folder with photographs, for random videos.")] = PHOTOGRAPHS,
    only: Annotated[str, typer.Option(help="accuracy, time, or names of sections, joined by commas.")] = "",
    quick: Annotated[bool, typer.Option("--quick", help="The fast part, one to two minutes.")] = False,
    slack: Annotated[float, typer.Option(help="Factor on the limits of times, for noisy or other machines.")] = 1.0,
    store: Annotated[bool, typer.Option("--store", help="Write what is measured, and REAL.md.")] = False,
) -> None:
    """Measure, compare with what is kept, exit with 1 if something is worse beyond noise."""
    if slack < 1.0:
        raise typer.BadParameter(f"the slack is at least 1, got {slack}")
    if store and quick:
        raise typer.BadParameter("a fast part is not stored: --store goes without --quick")
    console = Console(highlight=False)
    job, notes = job_of(data, photographs, quick)
    console.print(*notes, sep="\n", end="\n" if notes else "")
    if not job.clips:
        raise typer.BadParameter(f"no clips in {data}")
    try:
        names = chosen(only, quick, job.photographs is not None)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    kept, measured = read(), list[Figure]()
    for name in names:
        figures, origin = measure(name, job, console)
        measured += figures
        if store:  # section by section: an interrupted run keeps what it has
            kept = kept.without(name, SECTIONS[name].figures).replaced({name: origin}, figures)
            write(kept)
            PAGE.write_text(markdown(kept), encoding="utf-8")
    raise typer.Exit(0 if store else verdict(console, measured, kept, slack, () if quick else names))


def job_of(data: Path, photographs: Path, quick: bool) -> tuple[Job, list[str]]:
    """Find clips and photographs, and say what is missing."""
    clips, notes = find_clips(data)
    there = photographs if photographs.is_dir() else None
    if there is None and not quick:
        notes.append(f"no photographs in {photographs} (python -m benchmarks.training.photographs {photographs})")
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


def verdict(
    console: Console, measured: list[Figure], kept: Kept, slack: float, complete: tuple[str, ...] | list[str]
) -> int:
    """Print all figures beside those that are kept and return the exit code.

    Parameters
    ----------
    console : Console
    measured : list of Figure
    kept : Kept
    slack : float
        Factor on the limits of times.
    complete : sequence of str
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
    console.print("\n".join(words) or "nothing is worse than what is kept, beyond noise")
    return 1 if words else 0


if __name__ == "__main__":
    typer.run(main)
