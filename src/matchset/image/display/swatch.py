"""Which colors a color model takes for the target: a picture to look at (`swatch_of`), and `colors_in_words`."""

from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.uint8]
Scores = Callable[[Image], npt.NDArray[np.int8]]

HUES, SATURATIONS, VALUES = 90, 32, 16  # geometry: of the plane of colors; the best of the values counts
CELL = 4  # geometry: side of a cell of the picture, px
LEVELS, HIGH = 256, 40  # geometry: gray levels, and height of their bands, px
FADED = 0.82  # geometry: share of light gray in what is not the target
GROUND, TARGET = 235, (190, 40, 255)  # geometry: the light gray; color of the band over the target's levels, BGR


def swatch_of(scores: Scores, gray: bool, channels: int) -> Image:
    """Paint what a model takes for the target.

    Parameters
    ----------
    scores : callable
        `ColorModel.scores`.
    gray : bool
        Whether only brightness counts.
    channels : int
        3 or 1: the pixels that the model is for.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR. For a color the plane of hue (to the right) and saturation (upward), the target's colors in full, all
        others faded. For brightness a band of gray levels, black at the left, with the target's marked below.
    """
    return _levels(scores, channels) if gray or channels == 1 else _plane(scores)


def colors_in_words(table: npt.NDArray[np.int8]) -> str:
    """Say how much of all colors or gray levels a table takes for the target, and their mean.

    Parameters
    ----------
    table : ndarray of shape (32768,) or (256,), int8
        `ColorModel.table`.
    """
    hits, color = table > 0, table.size > LEVELS
    share = f"{100.0 * float(hits.mean()):.1f} % of all {'colors' if color else 'gray levels'}"
    if not hits.any():
        return share
    cells = np.flatnonzero(hits)
    if not color:
        return f"{share}, around level {cells.mean():.0f}"
    b, g, r = (8.0 * float((cells >> shift & 31).mean()) + 3.5 for shift in (10, 5, 0))
    return f"{share}, around BGR {b:.0f} {g:.0f} {r:.0f}"


def _plane(scores: Scores) -> Image:
    hue, saturation, value = np.meshgrid(
        np.arange(HUES) * 180 // HUES, np.linspace(255, 0, SATURATIONS), np.linspace(40, 255, VALUES), indexing="ij"
    )
    hsv = np.stack((hue, saturation, value), axis=-1).round().astype(np.uint8)
    pixels = cv2.cvtColor(hsv.reshape(HUES, -1, 3), cv2.COLOR_HSV2BGR).reshape(HUES, SATURATIONS, VALUES, 3)
    found = scores(np.asarray(pixels, np.uint8))
    best = ((found > 0) * np.arange(VALUES)).argmax(axis=2)[..., None]  # the brightest one
    whiteness = np.take_along_axis(found, best, axis=2)[..., 0]
    brightest = pixels[:, :, -1].astype(np.float64)
    faded = FADED * GROUND + (1.0 - FADED) * brightest
    own = np.take_along_axis(pixels, best[..., None], axis=2)[:, :, 0]
    plane = np.where((whiteness > 0)[..., None], own, faded).astype(np.uint8).transpose(1, 0, 2)
    return np.ascontiguousarray(plane.repeat(CELL, axis=0).repeat(CELL, axis=1))


def _levels(scores: Scores, channels: int) -> Image:
    ramp = np.arange(LEVELS, dtype=np.uint8)
    found = scores(np.stack([ramp] * 3, axis=-1) if channels == 3 else ramp)
    band = np.full((2 * HIGH, LEVELS, 3), GROUND, np.uint8)
    band[:HIGH] = ramp[None, :, None]
    band[HIGH + 4 :, found > 0] = TARGET
    return band
