"""How exact the labels are: `python -m benchmarks.real.labels.agreement --data DIR`.

A tracker can be no more exact than what it is held against. Rows that were labelled once more, blind, are scored
against other labels of them as a tracker's answers are: the share of them within 5 px is what a careful person reaches.
"""

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
import typer
from rich.console import Console

from benchmarks.real.clips import LABELS, find_clips
from benchmarks.real.labels.consensus import LABELLINGS
from matchset.app.track.score import VALID_BELOW_PX, TruthRow, read_truth

DIFFERENCES = ("\\|Δx\\|", "\\|Δy\\|", "\\|Δr\\|", "sum, px")
HEADINGS = ("clip", "labels", "rows", "within 5 px", *DIFFERENCES, "labelled twice", "sum, px")


class Agreement(msgspec.Struct, frozen=True):
    """How two labellings of the same rows agree.

    Parameters
    ----------
    rows : int
        That both know well.
    right : float
        Share within 5 px, as a tracker's answer is valid.
    medians : tuple of float
        Of the absolute differences of x, y, radius, and of their sum, px.
    """

    rows: int
    right: float
    medians: tuple[float, float, float, float]


def agreement(one: Sequence[TruthRow], other: Sequence[TruthRow]) -> Agreement | None:
    """Compare two labellings; None if they have no row in common."""
    known = {row.frame: row.circle for row in other if row.tight and row.circle is not None}
    pairs = [(row.circle, known[row.frame]) for row in one if row.tight and row.circle and row.frame in known]
    if not pairs:
        return None
    off = np.abs(np.array([np.subtract(first, second) for first, second in pairs]))
    total = off.sum(axis=1)
    x, y, radius = np.median(off, axis=0).tolist()
    return Agreement(len(pairs), float(np.mean(total < VALID_BELOW_PX)), (x, y, radius, float(np.median(total))))


def labellings(name: str, truths: Sequence[TruthRow], folder: Path = LABELS) -> dict[str, Sequence[TruthRow]]:
    """Return the labels of a clip, by the folder they are in; a truth that is not ours is `truth`."""
    paths = {kind: folder / kind / f"{name}.csv" for kind in LABELLINGS}
    known: dict[str, Sequence[TruthRow]] = {kind: read_truth(path) for kind, path in paths.items() if path.exists()}
    return known if "fitted" in known else {"truth": truths, **known}


def lines(name: str, known: Mapping[str, Sequence[TruthRow]], folder: Path = LABELS) -> list[str]:
    """Write a clip's lines of the table, one for each pair of labellings that have rows in common."""
    written = []
    for one, other in itertools.combinations(known, 2):
        found = agreement(known[one], known[other])
        if found is None:
            continue
        again = folder / other / "again" / f"{name}.csv"
        twice = agreement(known[other], read_truth(again)) if again.exists() else None
        cells = [name, f"{one}, {other}", str(found.rows), f"{found.right:.0%}"]
        cells += [f"{each:.1f}" for each in found.medians]
        cells += [str(twice.rows), f"{twice.medians[3]:.1f}"] if twice else ["-", "-"]
        written.append(f"| {' | '.join(cells)} |")
    return written


def main(data: Annotated[Path, typer.Option(help="Folder of the real clips.")]) -> None:
    """Compare the labels of real clips with those that were made blind."""
    clips, _ = find_clips(data)
    console = Console(width=200)
    for cells in (HEADINGS, ["---", "---", *["---:"] * (len(HEADINGS) - 2)]):
        console.print(f"| {' | '.join(cells)} |", highlight=False, markup=False)
    for clip in clips:
        for text in lines(clip.name, labellings(clip.name, clip.truths)):
            console.print(text, highlight=False, markup=False)


if __name__ == "__main__":
    typer.run(main)
