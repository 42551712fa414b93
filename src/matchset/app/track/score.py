"""How good a run was: its answers against the truth."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.track.rows import Row
from matchset.app.track.truth import Truth

Circle3 = tuple[float, float, float]

VALID_BELOW_PX = 5.0
"""A detection is valid when its error is smaller (Epstein & Feldman, Eq. 10), px."""


class Score(msgspec.Struct, frozen=True):
    """The figures of a run; None where the truth holds no frames to tell one from.

    The error of an answer is Eq. 10: ``|x - x*| + |y - y*| + |r - r*|``, px. *Tight* frames are those in
    which the ball is visible and the truth is not ``lowconf``.

    Parameters
    ----------
    visible, tight, absent : int
        Frames of the truth with the ball, those of them known well, and those without it.
    answered : int
        Tight frames that were answered; the errors are taken over these.
    mean_error_px, median_error_px, error_95_px : float or None
        Mean, median and 95th percentile of the error.
    valid : int
        Tight frames answered with an error below 5 px.
    valid_percent : float or None
        The same, as a percentage of all tight frames: a `Lost` there is not valid.
    lost : int
        Frames with the ball visible, tight or not, that were not answered.
    lost_percent : float or None
        The same, as a percentage of all frames with the ball visible.
    false_locks : int
        Answers where the ball is absent, or with a center farther than the true radius from the true one.
    trembling_px : float or None
        Mean over consecutive answered tight frames of ``|de_x| + |de_y| + |de_r|``, where e = answer - truth.
    jitter_px : float or None
        Root mean square of the length of the second difference of e, over three consecutive answered tight
        frames.
    """

    visible: int
    tight: int
    absent: int
    answered: int
    mean_error_px: float | None
    median_error_px: float | None
    error_95_px: float | None
    valid: int
    valid_percent: float | None
    lost: int
    lost_percent: float | None
    false_locks: int
    trembling_px: float | None
    jitter_px: float | None


def score(answers: Mapping[int, Circle3 | None], truths: Iterable[Truth], start: int = 0) -> Score:
    """Measure answers against the truth.

    Parameters
    ----------
    answers : mapping of int to (x, y, radius) or None
        By frame: the circle found, px, or None; a frame that is missing was not answered.
    truths : iterable of Truth
        Where the ball is; frames without truth do not count.
    start : int
        The first frame that counts.

    Returns
    -------
    Score
        The figures.
    """
    counted = sorted((truth for truth in truths if truth.frame >= start), key=lambda truth: truth.frame)
    visible = [truth for truth in counted if truth.circle is not None]
    tight = [truth for truth in visible if truth.tight]
    offsets = {
        truth.frame: np.subtract(circle, truth.circle)
        for truth in tight
        if truth.circle is not None and (circle := answers.get(truth.frame)) is not None
    }
    errors = np.array([np.abs(offset).sum() for offset in offsets.values()])
    valid = int((errors < VALID_BELOW_PX).sum())
    lost = sum(answers.get(truth.frame) is None for truth in visible)
    return Score(
        visible=len(visible),
        tight=len(tight),
        absent=len(counted) - len(visible),
        answered=len(offsets),
        mean_error_px=_of(errors, np.mean),
        median_error_px=_of(errors, np.median),
        error_95_px=_of(errors, lambda values: np.percentile(values, 95.0)),
        valid=valid,
        valid_percent=_percent(valid, len(tight)),
        lost=lost,
        lost_percent=_percent(lost, len(visible)),
        false_locks=sum(_is_false_lock(answers.get(truth.frame), truth.circle) for truth in counted),
        trembling_px=_of(_differences(offsets, order=1), lambda steps: np.abs(steps).sum(axis=1).mean()),
        jitter_px=_of(_differences(offsets, order=2), lambda bends: np.sqrt(np.square(bends).sum(axis=1).mean())),
    )


def circles(rows: Iterable[Row]) -> dict[int, Circle3 | None]:
    """Turn the rows of a table into the answers that `score` takes."""
    return {
        row.frame: None if row.shape is None else (row.shape["x"], row.shape["y"], row.shape["radius"]) for row in rows
    }


def _differences(offsets: Mapping[int, npt.NDArray[np.float64]], order: int) -> npt.NDArray[np.float64]:
    runs = [[offsets.get(frame + back) for back in range(-order, 1)] for frame in offsets]
    whole = [run for run in runs if all(offset is not None for offset in run)]
    return np.diff(np.array(whole, dtype=np.float64).reshape(len(whole), order + 1, 3), n=order, axis=1)[:, 0]


def _is_false_lock(answer: Circle3 | None, truth: Circle3 | None) -> bool:
    if answer is None:
        return False
    return truth is None or math.hypot(answer[0] - truth[0], answer[1] - truth[1]) > truth[2]


def _of(values: npt.NDArray[np.float64], statistic: Callable[[npt.NDArray[np.float64]], np.floating]) -> float | None:
    return float(statistic(values)) if len(values) else None


def _percent(part: int, whole: int) -> float | None:
    return 100.0 * part / whole if whole else None


def error_px(answer: Sequence[float], truth: Sequence[float]) -> float:
    """Return the error of one answer, Eq. 10: ``|x - x*| + |y - y*| + |r - r*|``, px."""
    return float(sum(abs(a - b) for a, b in zip(answer, truth, strict=True)))
