"""Accuracy on random videos, matchset alone, and of clicks into the first frames of others: `measure_videos`."""

from pathlib import Path

import numpy as np

import matchset as ms
from benchmarks.contest.field import OURS
from benchmarks.random_videos.following import Task, follow, photographs_in
from benchmarks.random_videos.video import VideoParameters, frames
from benchmarks.real.detection import is_right
from benchmarks.real.starts import QUICK_CLICKS, start_at
from benchmarks.regression.figures import BEGUN, MEAN_SHARE, NOTHING, QUANTILE, SOME, Figure
from benchmarks.tracking.trial import circle, clicked
from matchset.app.track.score import TruthRow

VIDEOS, CLICKED = range(100, 160), range(1500, 1550)
SECTION, CLICKS, ALL = "random videos", "clicks into random videos", "all"


def measure_videos(photographs: Path) -> list[Figure]:
    """Follow random videos from one click each."""
    scores = [follow(Task(seed, photographs, peers=(OURS,)))[OURS] for seed in VIDEOS]
    valid, where = np.array([each.valid_percent or 0.0 for each in scores]), (SECTION, ALL)
    return [
        Figure.of(where, "mean valid, %", float(valid.mean()), MEAN_SHARE),
        Figure.of(where, "10 % quantile, %", float(np.quantile(valid, 0.1)), QUANTILE),
        Figure.of(where, "false locks", sum(each.false_locks for each in scores), SOME),
    ]


def measure_clicks(photographs: Path) -> list[Figure]:
    """Click at three places of the ball in the first frames of random videos."""
    outcomes = [outcome for seed in CLICKED for outcome in clicks_into(seed, photographs)]
    where = CLICKS, ALL
    right, nothing = (100.0 * outcomes.count(each) / len(outcomes) for each in ("right", "nothing"))
    return [
        Figure.of(where, "begin at the right disc, %", right, BEGUN),
        Figure.of(where, "give nothing, %", nothing, NOTHING, noise=1.0),
    ]


def clicks_into(seed: int, photographs: Path) -> list[str]:
    """Say of each click into a first frame what it began: "right", "wrong" or "nothing"."""
    frame, row = next(frames(seed, photographs_in(photographs), VideoParameters()))
    return [outcome(frame, row, place) for place in QUICK_CLICKS]


def outcome(frame: ms.Frame, row: TruthRow, place: int) -> str:
    """Say what a click at a place of the disc began."""
    start = start_at(row, place)
    try:
        answer = clicked(frame, (start.x, start.y)).update(frame)
    except ValueError:
        return "nothing"
    if isinstance(answer, ms.Lost) or row.circle is None:
        return "nothing"
    return "right" if is_right(circle(answer.shape), row.circle) else "wrong"
