"""How exact the labels are: `python -m benchmarks.real.labels.agreement --data DIR`.

A tracker can be no more exact than what it is held against. Rows that were labelled once more, blind, are scored
against the labels as a tracker's answers are: the share of them within 5 px is what a careful person reaches.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
import typer
from rich.console import Console

from benchmarks.real.clips import LABELS, find_clips
from matchset.app.track.score import VALID_BELOW_PX, TruthRow, read_truth

BLIND = LABELS / "blind"
HEADINGS = ("clip", "rows", "within 5 px", "\\|Δx\\|", "\\|Δy\\|", "\\|Δr\\|", "sum, px", "labelled twice", "sum, px")


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


def line(name: str, labels: Sequence[TruthRow], folder: Path = BLIND) -> str:
    """Write a clip's line of the table; empty if it was not labelled once more."""
    path = folder / f"{name}.csv"
    blind = read_truth(path) if path.exists() else []
    found = agreement(labels, blind)
    if found is None:
        return ""
    second = folder / "again" / path.name
    twice = agreement(blind, read_truth(second)) if second.exists() else None
    cells = [name, str(found.rows), f"{found.right:.0%}", *(f"{each:.1f}" for each in found.medians)]
    cells += [str(twice.rows), f"{twice.medians[3]:.1f}"] if twice else ["-", "-"]
    return f"| {' | '.join(cells)} |"


def main(data: Annotated[Path, typer.Option(help="Folder of the real clips.")]) -> None:
    """Compare the labels of real clips with those that were made blind."""
    clips, _ = find_clips(data)
    console = Console(width=200)
    for cells in (HEADINGS, ["---", *["---:"] * (len(HEADINGS) - 1)]):
        console.print(f"| {' | '.join(cells)} |", highlight=False, markup=False)
    for clip in clips:
        if text := line(clip.name, clip.truths):
            console.print(text, highlight=False, markup=False)


if __name__ == "__main__":
    typer.run(main)
