"""Has a change made it worse on real footage, or slower as a user has it? `make bench-real`, about twenty minutes.

All figures are held against those in `kept.toml`; what is worse beyond noise fails. `--store` writes them, and the page
`benchmarks/REAL.md`. `--quick` is the fast part, which `make bench-quick` has too.
"""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from benchmarks.regression.figures import Figure
from benchmarks.regression.kept import read, write
from benchmarks.regression.page import PAGE, markdown
from benchmarks.regression.run import DATA, PHOTOGRAPHS, job_of, measure, verdict
from benchmarks.regression.sections import SECTIONS, chosen


def main(
    data: Annotated[Path, typer.Option(help="Folder with the real clips.")] = DATA,
    photographs: Annotated[Path, typer.Option(help="Folder with photographs, for random videos.")] = PHOTOGRAPHS,
    only: Annotated[str, typer.Option(help="accuracy, time, or names of sections, joined by commas.")] = "",
    quick: Annotated[bool, typer.Option("--quick", help="The fast part, two to three minutes.")] = False,
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
    try:
        names = chosen(only, quick, job.photographs is not None)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    if not job.clips and any(SECTIONS[name].footage for name in names):
        raise typer.BadParameter(f"no clips in {data}")
    kept, measured = read(), list[Figure]()
    for name in names:
        figures, origin = measure(name, job, console)
        measured += figures
        if store:  # section by section: an interrupted run keeps what it has
            kept = kept.without(name, SECTIONS[name].figures).replaced({name: origin}, figures)
            write(kept)
            PAGE.write_text(markdown(kept), encoding="utf-8")
    raise typer.Exit(0 if store else verdict(console, measured, kept, slack, () if quick else names))


if __name__ == "__main__":
    typer.run(main)
