"""How ball-like a circle in a picture is: `score_circle`, from its rim and the color inside; of many `best_circles`."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
LabImage = npt.NDArray[np.float32]
CircleTuple = tuple[float, float, float]


class ScoreParameters(msgspec.Struct, frozen=True):
    """How a proposed circle is scored, and which of them become candidates.

    The score is rim^3 x contrast x vividness x evenness x size, each 0 ... 1. Colors are in CIE Lab with the lightness
    scaled. All were chosen by hand; `tests/app/track/test_learn_command.py` shows a change.

    Parameters
    ----------
    longest_side : int
        Longer side of the picture that is searched, px; a larger picture is reduced to it.
    blur, blur_scale, max_blur : float
        Standard deviation of the smoothing, px: blur + (median magnitude of the Laplacian) / blur_scale, at most
        max_blur.
    lightness : float
        Weight of lightness beside chroma: shading changes lightness most. A gray picture has weight 1.
    gray_chroma : float
        99th percentile of the chroma below which a picture is gray, Lab units.
    convincing : float
        Score from which a candidate is worth tracking without asking the user.
    min_score, min_share : float
        Score of a candidate, absolute and as a share of the best one's.
    rays : int
        Directions in which the rim is sampled.
    min_visible : float
        Share of these directions whose outer sample lies in the picture.
    rim_step : float
        Distance of the samples inside and outside from the rim, as a share of the radius, between `rim_step_low` and
        `rim_step_high`, px.
    rim_step_low, rim_step_high : float
        See `rim_step`.
    rim_edge : float
        Color difference across the rim from which a direction counts as an edge, Lab units.
    rim_shading : float
        The same as a multiple of the difference just inside the rim, which is shading.
    contrast_base, contrast_scale : float
        Contrast is base + median rim difference / scale (Lab units).
    vivid_base, vivid_scale : float
        Vividness is base + chroma of the inside / scale (Lab units).
    even_scale : float
        Evenness is 1 / (1 + median chroma deviation inside / scale) (Lab units).
    full_size : float
        Radius from which the size factor is 1, px.
    same_distance, same_ratio : float
        Two circles are one if their centers are closer than this share of the larger radius, and the ratio of their
        radii lies between this and its inverse.
    """

    longest_side: int = 640
    blur: float = 1.0
    blur_scale: float = 12.0
    max_blur: float = 3.0
    lightness: float = 0.4
    gray_chroma: float = 4.0
    convincing: float = 0.15
    min_score: float = 0.02
    min_share: float = 0.15
    rays: int = 64
    min_visible: float = 0.6
    rim_step: float = 0.08
    rim_step_low: float = 2.0
    rim_step_high: float = 5.0
    rim_edge: float = 4.0
    rim_shading: float = 0.8
    contrast_base: float = 0.15
    contrast_scale: float = 25.0
    vivid_base: float = 0.3
    vivid_scale: float = 30.0
    even_scale: float = 10.0
    full_size: float = 48.0
    same_distance: float = 0.7
    same_ratio: float = 0.4


SCORE = ScoreParameters()


class CircleScore(NamedTuple):
    """How ball-like a circle is, as factors, each 0 ... 1.

    Attributes
    ----------
    rim : float
        Share of the directions in which the outline is an edge.
    contrast, vivid, even : float
        How strong the edge, how vivid and how uniform the color inside.
    size : float
        How large it is, times the share of its outline that lies in the picture.
    """

    rim: float
    contrast: float
    vivid: float
    even: float
    size: float

    @property
    def whole(self) -> float:
        """Score: rim^3 x contrast x vividness x evenness x size."""
        return self.rim * self.rim * self.rim * self.contrast * self.even * self.size * self.vivid


NOT_A_CIRCLE = CircleScore(0.0, 0.0, 0.0, 0.0, 0.0)


class Sample(NamedTuple):
    """The picture around a circle.

    Attributes
    ----------
    image : ndarray of shape (h, w, channels), uint8
        The part of the picture around it; of a large one every second, third, ... pixel.
    circle : (x, y, radius)
        Where it is in that part, px.
    radius : float
        In the picture that it was taken from, px.
    """

    image: npt.NDArray[np.uint8]
    circle: CircleTuple
    radius: float


AROUND = 2.0  # geometry: half the side of what is kept around a circle, radii
KEPT = 160  # format: pixels of a side from which on pixels are left out


def sample_of(image: npt.NDArray[np.uint8], circle: CircleTuple) -> Sample:
    """Keep what is around a circle, and the circle.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    circle : (x, y, radius)
        px.
    """
    x, y, radius = circle
    every = max(int(2.0 * AROUND * radius / KEPT), 1)
    left, top = max(round(x - AROUND * radius), 0), max(round(y - AROUND * radius), 0)
    part = image[top : round(y + AROUND * radius) + 1 : every, left : round(x + AROUND * radius) + 1 : every]
    place = ((x - left) / every, (y - top) / every, radius / every)
    return Sample(np.array(part.reshape(*part.shape[:2], -1)), place, radius)


def score_circle(lab: LabImage, circle: CircleTuple) -> CircleScore:
    """Score a circle by its rim and the color inside.

    Parameters
    ----------
    lab : ndarray of shape (h, w, 3), float32
        The picture in CIE Lab.
    circle : (x, y, radius)
        px.
    """
    x, y, radius = circle
    angles = _angles()
    step = min(max(SCORE.rim_step_low, SCORE.rim_step * radius), SCORE.rim_step_high)
    places = np.array((0.5 * radius, max(radius - 2.0 * step, 0.5 * radius), radius - step, radius + step))[:, None]
    core, middle, inner, outer = _sample(lab, x + places * np.cos(angles), y + places * np.sin(angles))
    visible = np.isfinite(outer[:, 0])
    if visible.sum() < SCORE.min_visible * SCORE.rays:
        return NOT_A_CIRCLE
    interior = np.concatenate([core, inner])
    color = median(interior[np.isfinite(interior[:, 0])])
    deviation = np.linalg.norm((interior - color)[:, 1:], axis=1)
    difference = np.linalg.norm(inner - outer, axis=1)[visible]
    shading = np.linalg.norm(inner - middle, axis=1)[visible]
    rim = float(np.mean((difference > SCORE.rim_edge) & (difference > SCORE.rim_shading * shading)))
    contrast = SCORE.contrast_base + float(median(difference)) / SCORE.contrast_scale
    vivid = SCORE.vivid_base + float(np.linalg.norm(color[1:])) / SCORE.vivid_scale
    even = 1.0 / (1.0 + float(median(deviation[np.isfinite(deviation)])) / SCORE.even_scale)
    size = min(1.0, radius / SCORE.full_size) * float(visible.mean())
    return CircleScore(rim, min(1.0, contrast), min(1.0, vivid), even, size)


def best_circles(lab: LabImage, circles: Sequence[CircleTuple]) -> list[tuple[float, CircleTuple]]:
    """Scores of circles, and the circles, best first: all that are not far worse than the best one.

    A score is no more than its rim allows. Rims are cheap to compare, all at once, and most circles have none.

    Parameters
    ----------
    lab : ndarray of shape (h, w, 3), float32
        The picture in CIE Lab.
    circles : sequence of (x, y, radius)
        px.
    """
    most = _most_scores(lab, circles)
    best, scored = 0.0, list[tuple[float, CircleTuple]]()
    for k in np.argsort(-most, kind="stable").tolist():
        if most[k] < _least_score(best):
            break
        score = score_circle(lab, circles[k]).whole
        best = max(best, score)
        scored.append((score, circles[k]))
    return sorted((each for each in scored if each[0] >= _least_score(best)), reverse=True)


def _least_score(best: float) -> float:
    """Score of a candidate where the best one has this."""
    return max(SCORE.min_score, SCORE.min_share * best)


def _most_scores(lab: LabImage, circles: Sequence[CircleTuple]) -> Floats:
    """Bounds of the scores of circles: rim^3 x size."""
    x, y, radius = np.array(circles, np.float64).reshape(-1, 3, 1).transpose(1, 0, 2)
    step = np.clip(SCORE.rim_step * radius, SCORE.rim_step_low, SCORE.rim_step_high)
    angles = _angles()
    middle, inner, outer = (
        _sample(lab, x + places * np.cos(angles), y + places * np.sin(angles))
        for places in (np.maximum(radius - 2.0 * step, 0.5 * radius), radius - step, radius + step)
    )
    visible = np.isfinite(outer[..., 0]).sum(axis=1)
    difference = np.linalg.norm(inner - outer, axis=2) * (1.0 + 1e-9)  # a bound, however sums are rounded
    shading = np.linalg.norm(inner - middle, axis=2)
    edges = ((difference > SCORE.rim_edge) & (difference > SCORE.rim_shading * shading)).sum(axis=1)
    rim = edges / np.maximum(visible, 1)
    size = np.minimum(1.0, radius[:, 0] / SCORE.full_size) * (visible / SCORE.rays)
    return np.asarray(rim**3 * size * (1.0 + 1e-9), np.float64)


def _angles() -> Floats:
    """Directions in which the rim is sampled, rad."""
    return np.asarray(2.0 * np.pi * np.arange(SCORE.rays) / SCORE.rays, np.float64)


def median(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Median of each column; `np.median` would load `numpy.ma`, which takes longer than all else here."""
    ordered, middle = np.sort(values, axis=0), len(values) // 2
    return ordered[middle] if len(values) % 2 else np.asarray(0.5 * (ordered[middle - 1] + ordered[middle]))


def _sample(lab: LabImage, x: Floats, y: Floats) -> Floats:
    """Return the colors at points, along one axis more; NaN outside the picture."""
    height, width = lab.shape[:2]
    columns, rows = np.rint(x).astype(int), np.rint(y).astype(int)
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    colors = np.full((*x.shape, 3), np.nan)
    colors[inside] = lab[rows[inside], columns[inside]]
    return colors
