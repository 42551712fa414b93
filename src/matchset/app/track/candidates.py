"""Ball-like things in a picture of which nothing is known yet: `find_candidates`.

Circles are proposed by `blobs.py` and judged by the picture itself: how much of the rim is an edge, how
colorful the inside is against its surroundings, how even, how large. No randomness: the same picture always
gives the same numbers.
"""

from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.track.blobs import CircleTuple, propose_circles

Floats = npt.NDArray[np.float64]
Lab = npt.NDArray[np.float32]
Gray = npt.NDArray[np.uint8]

WORK_SIDE_PX = 640
"""Longer side of the picture that is searched; a larger one is shrunk to it."""

CONVINCING = 0.15
"""Least score of a candidate that is worth tracking without asking."""

_LEAST_SCORE = 0.02
_LEAST_SHARE = 0.15  # of the best one's score
_RAYS = 64


class Candidate(msgspec.Struct, frozen=True):
    """A ball-like thing.

    Parameters
    ----------
    x, y : float
        Center, px.
    radius : float
        Radius, px.
    pick : tuple of int
        A pixel inside it of its prevailing color: where to click.
    score : float
        How ball-like it is, 0 ... 1.
    """

    x: float
    y: float
    radius: float
    pick: tuple[int, int]
    score: float


def find_candidates(image: Gray, limit: int = 9) -> list[Candidate]:
    """Find what may be a ball.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.
    limit : int
        How many at most.

    Returns
    -------
    list of Candidate
        Most ball-like first.
    """
    scale = min(1.0, WORK_SIDE_PX / max(image.shape[:2]))
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1.0 else image
    lab = _lab(small)
    judged = sorted(((_score(lab, circle), circle) for circle in propose_circles(lab)), reverse=True)
    kept: list[tuple[float, CircleTuple]] = []
    for score, circle in judged:
        if score < max(_LEAST_SCORE, _LEAST_SHARE * judged[0][0]) or len(kept) == limit:
            break
        if not any(_same(circle, other) for _, other in kept):
            kept.append((score, circle))
    return [_candidate(lab, circle, score, scale) for score, circle in kept]


def _lab(image: npt.NDArray[Any]) -> Lab:
    """CIE Lab, smoothed as much as its noise asks for, with lightness counting less than chroma."""
    color = image if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    # The median of a Laplacian's magnitude tells the noise: edges are too few to move it.
    roughness = np.abs(cv2.Laplacian(color[..., 1], cv2.CV_32F))
    sigma = min(3.0, 1.0 + float(np.median(roughness)) / 12.0)
    smooth = cv2.GaussianBlur(color, (0, 0), sigma).astype(np.float32) / 255.0
    lab = cv2.cvtColor(smooth, cv2.COLOR_BGR2LAB).astype(np.float32, copy=False)
    gray = float(np.percentile(np.abs(lab[..., 1:]), 99.0)) < 4.0
    # Shade moves lightness and hardly chroma; a gray picture has nothing else.
    lab[..., 0] *= 1.0 if gray else 0.4
    return lab


def _score(lab: Lab, circle: CircleTuple) -> float:
    """Judge a circle by the picture: rim x contrast x color x evenness x size, each 0 ... 1."""
    x, y, radius = circle
    angles = 2.0 * np.pi * np.arange(_RAYS) / _RAYS
    step = min(max(2.0, 0.08 * radius), 5.0)
    core, middle, inner, outer = (
        _sample(lab, x + r * np.cos(angles), y + r * np.sin(angles))
        for r in (0.5 * radius, max(radius - 2.0 * step, 0.5 * radius), radius - step, radius + step)
    )
    seen = np.isfinite(outer[:, 0])
    if seen.sum() < 0.6 * _RAYS:
        return 0.0
    color = np.nanmedian(np.concatenate([core, inner]), axis=0)
    off = np.linalg.norm((np.concatenate([core, inner]) - color)[:, 1:], axis=1)
    rim = np.linalg.norm(inner - outer, axis=1)[seen]
    shade = np.linalg.norm(inner - middle, axis=1)[seen]
    share = float(np.mean((rim > 4.0) & (rim > 0.8 * shade)))
    contrast = 0.15 + float(np.median(rim)) / 25.0
    vivid = 0.3 + float(np.linalg.norm(color[1:])) / 30.0
    even = 1.0 / (1.0 + float(np.nanmedian(off)) / 10.0)
    size = min(1.0, radius / 48.0) * float(seen.mean())
    return share * share * share * min(1.0, contrast) * min(1.0, vivid) * even * size


def _sample(lab: Lab, x: Floats, y: Floats) -> Floats:
    """Colors at points, NaN outside the picture."""
    height, width = lab.shape[:2]
    columns, rows = np.round(x).astype(int), np.round(y).astype(int)
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    colors = np.full((len(x), 3), np.nan)
    colors[inside] = lab[rows[inside], columns[inside]]
    return colors


def _same(one: CircleTuple, other: CircleTuple) -> bool:
    near = np.hypot(one[0] - other[0], one[1] - other[1]) < 0.7 * max(one[2], other[2])
    return bool(near and 0.4 < one[2] / other[2] < 2.5)


def _candidate(lab: Lab, circle: CircleTuple, score: float, scale: float) -> Candidate:
    x, y, radius = circle
    height, width = lab.shape[:2]
    rows, columns = np.mgrid[0:height, 0:width]
    distance = np.hypot(columns - x, rows - y)
    disc = lab[distance < 0.75 * radius]
    off = np.linalg.norm(lab - np.median(disc, axis=0), axis=2)
    # Among equally typical pixels the middle one is the safest click.
    best = np.argmin(np.where(distance < 0.5 * radius, off + 4.0 * distance / radius, np.inf))
    row, column = divmod(int(best), width)
    pick = round((column + 0.5) / scale - 0.5), round((row + 0.5) / scale - 0.5)
    return Candidate((x + 0.5) / scale - 0.5, (y + 0.5) / scale - 0.5, radius / scale, pick, score)
