"""Brightness in place of color: dark things, light things, and edges of either kind.

Nothing is learned here: a thing is dark if it is darker than a level. The level comes from the picture itself: the gray
value that separates its pixels best in two classes (Otsu 1979), or the middle between both sides of an outline.
"""

import functools
import math
from typing import Literal

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Gray = Literal["", "dark", "light", "edges"]


class BrightnessParameters(msgspec.Struct, frozen=True):
    """How a level between dark and light is found and used.

    Chosen by hand; `tests/image/test_color.py` and ``python -m benchmarks --only real`` would show a change.

    Parameters
    ----------
    levels_per_unit : float
        Gray levels per unit of log-odds: how gradual the step from target to background is. More forgives uneven light
        and gives weaker edges.
    samples : int
        Rows and columns of a picture from which its level is computed, at most.
    inner, outer : float
        Where the gray values on both sides of an outline are read, in half-widths from its center.
    edges_log_odds : float
        Log-odds of everything where edges alone count: so small that the inside decides nothing.
    """

    levels_per_unit: float = 12.0
    samples: int = 96
    inner: float = 0.8
    outer: float = 1.25
    edges_log_odds: float = 1e-2


DEFAULT = BrightnessParameters()


def log_odds_of(
    gray: Gray, level: float, channels: int, parameters: BrightnessParameters = DEFAULT
) -> npt.NDArray[np.float32]:
    """Log-odds of a table for dark or light things, or for edges.

    Parameters
    ----------
    gray : "dark", "light" or "edges"
    level : float
        The gray value between target and background.
    channels : int
        3 for the 32 x 32 x 32 cells of color pictures, 1 for 256 gray values.
    parameters : BrightnessParameters

    Returns
    -------
    ndarray of shape (32768,) or (256,), float32
    """
    values = _lightness() if channels == 3 else np.arange(256, dtype=np.float32)
    if gray == "edges":
        return np.full(values.shape, parameters.edges_log_odds, np.float32)
    sign = 1.0 if gray == "light" else -1.0
    return np.asarray(sign * (values - np.float32(level)) / parameters.levels_per_unit, np.float32)


@functools.cache
def _lightness() -> npt.NDArray[np.float32]:
    """Gray value in the middle of each color cell."""
    level = np.arange(32, dtype=np.float32) * 8.0 + 3.5
    b, g, r = np.meshgrid(level, level, level, indexing="ij")
    return np.asarray(0.114 * b + 0.587 * g + 0.299 * r, np.float32).ravel()


def as_gray(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Gray values (h, w) of a picture (h, w, 3), BGR, (h, w, 1) or (h, w)."""
    if image.ndim == 2:
        return image
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.shape[2] == 3 else image[:, :, 0], np.uint8)


def level_in(image: npt.NDArray[np.uint8], parameters: BrightnessParameters = DEFAULT) -> float:
    """Gray value that parts a picture best in dark and light, from a few thousand of its pixels.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
    parameters : BrightnessParameters
    """
    down, right = (max(length // parameters.samples, 1) for length in image.shape[:2])
    few = np.ascontiguousarray(image[::down, ::right])
    level, _ = cv2.threshold(as_gray(few), 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    return float(level) + 0.5


def level_across(
    image: npt.NDArray[np.uint8], points: Floats, x: float, y: float, parameters: BrightnessParameters = DEFAULT
) -> float:
    """Gray value half way between the two sides of an outline.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
    points : ndarray of shape (n, 2), float64
        The outline, px.
    x, y : float
        Its center, px.
    parameters : BrightnessParameters

    Returns
    -------
    float
        NaN where the picture does not hold both sides.
    """
    center, sides = np.array([x, y]), []
    for share in (parameters.inner, parameters.outer):
        places = np.rint(center + share * (points - center)).astype(np.int64)
        inside = ((places >= 0) & (places < image.shape[1::-1])).all(axis=1)
        if not inside.any():
            return math.nan
        pixels = image[places[inside, 1], places[inside, 0]].reshape(int(inside.sum()), -1).astype(np.float64)
        weights = (0.114, 0.587, 0.299) if pixels.shape[1] == 3 else (1.0,)
        sides.append(float(np.median(pixels @ np.array(weights))))
    return 0.5 * (sides[0] + sides[1])
