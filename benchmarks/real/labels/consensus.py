"""Make the truth of the clips that we labelled: `python -m benchmarks.real.labels.consensus`.

Every row was labelled two or three times: by the offline fit (`fitted`), and by persons who knew neither that nor an
answer of a tracker (`blind`, some clips; `blind_second`, all). A row's circle is the median of them, parameter by
parameter. It is tight where two of them agree, and one of these two was sure of it; else it keeps the circle of the fit
and counts as known to a few pixels only. No tracker has a say in it.
"""

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.real.clips import LABELS
from matchset.app.tables import read_csv
from matchset.app.track.score import TRUTH_COLUMNS, VALID_BELOW_PX, TruthRow, error_px, read_truth

LABELLINGS = ("fitted", "blind", "blind_second")


class ConsensusRule(msgspec.Struct, frozen=True):
    """When labels agree; chosen by what `lowconf` means, before any tracker was scored with it.

    Parameters
    ----------
    within_px : float
        Largest sum of the differences of x, y and radius, px: two persons agree as an answer must that counts as valid.
    within_share : float
        The same in radii, where that is less: small balls are labelled to a fraction of a pixel.
    """

    within_px: float = VALID_BELOW_PX
    within_share: float = 0.25


def consensus(labels: Sequence[TruthRow], rule: ConsensusRule | None = None) -> TruthRow:
    """Merge the labels of one row, that of the fit first.

    Parameters
    ----------
    labels : sequence of TruthRow
    rule : ConsensusRule, optional
    """
    rule, first = rule or ConsensusRule(), labels[0]
    circles = [label.circle for label in labels if label.circle is not None]
    if first.circle is None or not any(_agree(one, other, rule) for one, other in itertools.combinations(labels, 2)):
        return TruthRow(first.frame, first.circle, lowconf=first.circle is not None)
    x, y, radius = np.median(circles, axis=0).tolist()
    return TruthRow(first.frame, (x, y, radius))


def _agree(one: TruthRow, other: TruthRow, rule: ConsensusRule) -> bool:
    if one.circle is None or other.circle is None or not (one.tight or other.tight):
        return False
    return error_px(one.circle, other.circle) <= min(
        rule.within_px, rule.within_share * min(one.circle[2], other.circle[2])
    )


def merged(name: str, folder: Path = LABELS) -> list[TruthRow]:
    """Merge all labellings of a clip."""
    paths = [folder / labelling / f"{name}.csv" for labelling in LABELLINGS]
    fitted, *others = ([*read_truth(path)] if path.exists() else [] for path in paths)
    known: list[Mapping[int, TruthRow]] = [{row.frame: row for row in rows} for rows in others]
    return [consensus([row, *(each[row.frame] for each in known if row.frame in each)]) for row in fitted]


def text(name: str, folder: Path = LABELS) -> str:
    """Write the truth of a clip as a file's text."""
    methods = {int(row.text("frame")): row.text("method") for row in read_csv(folder / "fitted" / f"{name}.csv", ())}
    lines = [",".join(TRUTH_COLUMNS)]
    for row in merged(name, folder):
        if row.circle is None:
            lines.append(f"{name}.mp4,{row.frame},,,,0,{methods[row.frame]}")
            continue
        x, y, radius = row.circle
        method = "consensus" if row.tight else methods[row.frame].removesuffix("|lowconf") + "|lowconf"
        lines.append(f"{name}.mp4,{row.frame},{x:.2f},{y:.2f},{radius:.2f},1,{method}")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the truth of every clip that was labelled."""
    for path in sorted((LABELS / "fitted").glob("*.csv")):
        (LABELS / path.name).write_text(text(path.stem))


if __name__ == "__main__":
    main()
