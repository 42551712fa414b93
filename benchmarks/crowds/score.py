"""Who kept which name: HOTA, IDF1 and switches of identities by motmetrics, and what only the truth tells: `Score`."""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

import matchset as ms
from benchmarks.crowds.scenes import Seen

MIN_VISIBLE = 0.3  # share of its disc from which a ball counts: what is hidden more may be answered, or not
MIN_IOU = 0.5  # of two discs, from which an answer is of a ball; HOTA takes the mean over its own limits
ALPHAS = np.arange(0.05, 0.99, 0.05)


class Answer(NamedTuple):
    """What a tracker says of a frame: its name of a ball, and where that is."""

    identity: int
    circle: ms.Circle


class Score(NamedTuple):
    """How well names were kept.

    Parameters
    ----------
    hota, idf1 : float
        0 ... 1.
    switches : int
        How often a ball got another name.
    names : int
        Names that were given.
    doubled : int
        Answers of a frame that lie on a ball on which another answer lies, too.
    missed, false : float
        Shares of the balls that count without an answer, and of the answers without a ball.
    """

    hota: float
    idf1: float
    switches: int
    names: int
    doubled: int
    missed: float
    false: float


def iou(one: ms.Circle, other: ms.Circle) -> float:
    """Area that two discs share, over the area that they cover."""
    far = math.hypot(one.x - other.x, one.y - other.y)
    a, b = sorted((one.radius, other.radius))
    if far >= a + b:
        return 0.0
    if far <= b - a:
        shared = math.pi * a * a
    else:
        u = (far * far + a * a - b * b) / (2.0 * far)
        v = far - u
        shared = a * a * math.acos(u / a) - u * math.sqrt(max(a * a - u * u, 0.0))
        shared += b * b * math.acos(v / b) - v * math.sqrt(max(b * b - v * v, 0.0))
    return shared / (math.pi * (a * a + b * b) - shared)


def score(truth: Iterable[list[Seen]], answers: Iterable[list[Answer]]) -> Score:
    """Compare answers with the truth, frame by frame.

    Answers on balls that are hidden more than `MIN_VISIBLE` allows count neither for nor against.
    """
    import motmetrics

    accumulators = {float(limit): motmetrics.MOTAccumulator(auto_id=True) for limit in (*ALPHAS, MIN_IOU)}
    names, doubled = set[int](), 0
    for seen, said in zip(truth, answers, strict=True):
        counted = [each for each in seen if each.visible >= MIN_VISIBLE]
        hidden = [each for each in seen if 0.0 < each.visible < MIN_VISIBLE]
        names |= {each.identity for each in said}
        overlaps = np.array([[iou(ball.circle, answer.circle) for answer in said] for ball in counted])
        overlaps = overlaps.reshape(len(counted), len(said))
        doubled += int(np.maximum((overlaps > MIN_IOU).sum(axis=1) - 1, 0).sum())
        excused = [
            not (overlaps[:, at] > MIN_IOU).any() and any(iou(ball.circle, each.circle) > MIN_IOU for ball in hidden)
            for at, each in enumerate(said)
        ]
        kept = [at for at, free in enumerate(excused) if not free]
        overlaps, said = overlaps[:, kept], [said[at] for at in kept]
        for limit, accumulator in accumulators.items():
            distances = np.where(overlaps >= limit, 1.0 - overlaps, np.nan)
            accumulator.update([each.identity for each in counted], [each.identity for each in said], distances)
    return _summary(accumulators, len(names), doubled)


def _summary(accumulators: dict[float, object], names: int, doubled: int) -> Score:
    import motmetrics

    metrics = motmetrics.metrics.create()
    usual = metrics.compute(
        accumulators[MIN_IOU],
        metrics=["idf1", "num_switches", "num_misses", "num_false_positives", "num_objects", "num_predictions"],
    ).iloc[0]
    alphas = [metrics.compute(accumulators[float(limit)], metrics=["hota_alpha"]).iloc[0, 0] for limit in ALPHAS]
    return Score(
        hota=float(np.mean(alphas)),
        idf1=float(usual["idf1"]),
        switches=int(usual["num_switches"]),
        names=names,
        doubled=doubled,
        missed=float(usual["num_misses"] / max(usual["num_objects"], 1)),
        false=float(usual["num_false_positives"] / max(usual["num_predictions"], 1)),
    )
