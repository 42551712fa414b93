"""Accuracy on worse copies of the real clips, the first pictures of each: `measure`."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.real.clips import Clip
from benchmarks.real.copies.copy import Copy, write_copy
from benchmarks.real.copies.section import CODED, LIT, PALE, Followed
from benchmarks.real.detection import Seeker
from benchmarks.real.following import Recorder, follow
from benchmarks.real.starts import QUICK_CLICKS, start_at
from benchmarks.regression.figures import MEAN_SHARE, NOTHING, QUANTILE, SOME, Figure

PICTURES = 150  # of each copy: some rows of the long clips, all of the short ones
SECTION, ALL = "worse copies", "all"
GROUPS = {"coded hard": CODED, "light that jumps": LIT, "pale": PALE}


def look(copy: Copy, clip: Clip, folder: Path) -> Followed:
    """Make the first pictures of a copy, follow the ball from three clicks in one frame, search labelled frames."""
    written = write_copy(copy, clip, folder, PICTURES)
    starts = [start_at(written.tight[0], place) for place in QUICK_CLICKS]
    recorder, seeker = Recorder(written, starts), Seeker(written)
    for frame, answers in follow(written, recorder.followers):
        recorder.take(frame.index, answers)
        seeker.take(frame)
    return Followed(written, recorder.runs(), seeker.detected())


def measure(clips: Sequence[Clip]) -> list[Figure]:
    """Measure all copies of the clips that are there."""
    known = {clip.name: clip for clip in clips}
    found: dict[str, list[Followed]] = {}
    with tempfile.TemporaryDirectory() as name:
        for group, copies in GROUPS.items():
            found[group] = [look(copy, known[copy.clip], Path(name)) for copy in copies if copy.clip in known]
    by_group = [figure for group, members in found.items() if members for figure in figures_of(group, members)]
    return [*by_group, *figures_of(ALL, [each for members in found.values() for each in members])]


def figures_of(group: str, members: Sequence[Followed]) -> list[Figure]:
    """Name the numbers of some copies, each counting the same."""
    where = SECTION, group
    scores = [[run.score(each.clip) for run in each.runs] for each in members]
    valid = [float(np.mean([one.valid_percent or 0.0 for one in by_copy])) for by_copy in scores]
    nothing = [run.nothing for each in members for run in each.runs]
    right = [100.0 * each.detected.right / each.detected.shown for each in members if each.detected.shown]
    return [
        Figure.of(where, "mean valid, %", float(np.mean(valid)), MEAN_SHARE, noise=2.0 if group != ALL else None),
        Figure.of(where, "10 % quantile, %", float(np.quantile(valid, 0.1)), QUANTILE),
        Figure.of(where, "give nothing, %", 100.0 * float(np.mean(nothing)), NOTHING),
        Figure.of(where, "far answers", sum(one.false_locks for each in scores for one in each), SOME),
        Figure.of(where, "detect right, %", float(np.mean(right)), MEAN_SHARE, noise=2.0 if group != ALL else None),
        Figure.of(where, "detect false", sum(each.detected.false for each in members), SOME),
    ]
