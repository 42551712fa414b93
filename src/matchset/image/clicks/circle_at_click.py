"""The most ball-like circle around a click: `circle_at`."""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.candidates import lab_of, propose_circles
from matchset.image.circle_score import SCORE, score_circle
from matchset.image.clicks.clear_disc import NearParameters

Bytes = npt.NDArray[np.uint8]
Circle3 = tuple[float, float, float]


class ClickParameters(msgspec.Struct, frozen=True):
    """Where circles around a click are looked for: in windows of about one size, each in a scale of its own.

    Chosen by hand on `python -m benchmarks --only real`.

    Parameters
    ----------
    half_widths : tuple of float
        Half the side of the windows around the click, px; the whole picture comes last.
    window_px : int
        Side to which a window is brought: a smaller one is enlarged, a larger one reduced. More finds circles more
        exactly and takes longer.
    max_enlargement : float
        Largest factor of that.
    offset : float
        How far from the center of a circle the click may be, in radii.
    full_size : float
        Radius from which a circle in a window is not taken to be chance because it is small, px of the window.
    min_score, clear_score : float
        Least score of a circle, and the score from which windows of other sizes are not looked at.
    same_px : float
        Circles that agree to so many px of the window are one.
    around, around_rim, around_score : float
        A circle around the best one, at most so many times as large, whose outline is an edge in this share of the
        directions, takes its place if whatever the color it scores at least this share: then the best one is the lit
        or painted part of a ball. More than 0.75 leaves such parts; less than 0.65 takes in the ground of some balls.
    around_least : float
        Radius from which a circle is one around another and not the same, in radii.
    near : NearParameters
        Which discs are compared where no circle stands out.
    """

    half_widths: tuple[float, ...] = (140.0, 36.0)
    window_px: int = 280
    max_enlargement: float = 4.0
    offset: float = 0.95
    full_size: float = 24.0
    min_score: float = 0.05
    clear_score: float = 0.3
    same_px: float = 1.5
    around: float = 2.0
    around_rim: float = 0.7
    around_score: float = 0.7
    around_least: float = 1.25
    near: NearParameters = NearParameters()


DEFAULT = ClickParameters()


def circle_at(image: Bytes, x: float, y: float, limits: ClickParameters = DEFAULT) -> tuple[float, Circle3] | None:
    """Find the most ball-like circle that holds a point.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.
    x, y : float
        The point, px.
    limits : ClickParameters

    Returns
    -------
    tuple of float and (x, y, radius), or None
        Its score, 0 ... 1, and where it is, px; None where no circle stands out.
    """
    best: _Seen | None = None
    seen: list[_Seen] = []
    for half in (*limits.half_widths, float(max(image.shape[:2]))):
        seen += _circles_around(image, (x, y), half, limits)
        best = max(seen, key=lambda each: each.score, default=None)
        if best is not None and best.score > limits.clear_score:
            break
    if best is None or best.score <= limits.min_score:
        return None
    best = _whole_ball(best, seen, limits)
    return best.score, best.circle


class _Seen(NamedTuple):
    """A circle, px of the picture, with its scores and its score whatever the color."""

    score: float
    outline: float
    rim: float
    circle: Circle3


def _circles_around(image: Bytes, click: tuple[float, float], half: float, limits: ClickParameters) -> list[_Seen]:
    """Circles that hold a click, in a window around it."""
    x, y = click
    left, top = max(round(x - half), 0), max(round(y - half), 0)
    window = image[top : round(y + half) + 1, left : round(x + half) + 1]
    scale = min(limits.window_px / max(window.shape[:2]), limits.max_enlargement)
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
    lab = lab_of(np.ascontiguousarray(cv2.resize(window, None, fx=scale, fy=scale, interpolation=how)))
    place = (x - left + 0.5) * scale - 0.5, (y - top + 0.5) * scale - 0.5
    seen = []
    for circle in _distinct(propose_circles(lab, place), limits.same_px):
        if np.hypot(circle[0] - place[0], circle[1] - place[1]) > limits.offset * circle[2]:
            continue
        score = score_circle(lab, circle)
        size = min(1.0, circle[2] / limits.full_size) / min(1.0, circle[2] / SCORE.full_size)
        whole = (circle[0] + 0.5) / scale - 0.5 + left, (circle[1] + 0.5) / scale - 0.5 + top, circle[2] / scale
        seen.append(_Seen(score.whole * size, score.outline * size, score.rim, whole))
    return seen


def _whole_ball(best: _Seen, seen: list[_Seen], limits: ClickParameters) -> _Seen:
    """Circle with the clearest outline around the best one, if it is about as clear; otherwise the best one."""
    x, y, radius = best.circle
    around = [
        each
        for each in seen
        if limits.around_least < each.circle[2] / radius < limits.around
        and math.hypot(each.circle[0] - x, each.circle[1] - y) + radius < each.circle[2]
        and each.rim >= limits.around_rim
        and each.outline > limits.around_score * best.outline
    ]
    return max(around, key=lambda each: each.outline, default=best)


def _distinct(circles: list[Circle3], same_px: float) -> list[Circle3]:
    """One of the circles that agree to about a pixel: many thresholds show the same region."""
    return list({tuple(round(value / same_px) for value in circle): circle for circle in circles}.values())
