"""A ball that flies many radii while the shutter is open, where somebody clicked it: `streak_at`."""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.disc_network.patch_format import Circle3

Image = npt.NDArray[np.uint8]


class Streak(NamedTuple):
    """A ball that flew some way while the shutter was open.

    Attributes
    ----------
    circle : (x, y, radius)
        In the middle of the exposure, px.
    way : float
        Length of the streak, px.
    """

    circle: Circle3
    way: float


class StreakParameters(msgspec.Struct, frozen=True):
    """Which region of the target's color is a streak; chosen by hand on rendered small balls, seeds 1000-1015.

    Parameters
    ----------
    reach : float
        How far from the click it may end, radii of the circle that was found there: more takes larger things.
    elongation : float
        Least ratio of its length to its width: a ball that moved less is a disc to the network.
    fill : float
        Largest factor between its area and that of a bar as long and as wide, either way: more takes ragged regions.
    """

    reach: float = 6.0
    elongation: float = 2.0
    fill: float = 1.25


def streak_at(image: Image, color: ColorModel, circle: Circle3, limits: StreakParameters) -> Streak | None:
    """Find the ball whose streak was clicked, by the second moments of the region of its color there.

    A bar of width w has the variance ``w^2 / 12`` across. The ball is as wide as its streak, and was in the middle of
    it in the middle of the exposure.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    circle : (x, y, radius)
        Around the click, px.
    limits : StreakParameters

    Returns
    -------
    Streak or None
        None where the region is no streak.
    """
    x, y, radius = circle
    reach = max(limits.reach * radius, 2.0)
    left, top = max(int(x - reach), 0), max(int(y - reach), 0)
    part = np.ascontiguousarray(image[top : max(int(y + reach) + 1, top), left : max(int(x + reach) + 1, left)])
    if not part.size or color.channels != image.shape[2]:
        return None
    alike = (color.scores(part).reshape(part.shape[:2]) > 0).astype(np.uint8)
    _, labels = cv2.connectedComponents(alike, connectivity=4)
    row = min(max(round(y) - top, 0), part.shape[0] - 1)
    column = min(max(round(x) - left, 0), part.shape[1] - 1)
    region = labels == labels[row, column]
    if not alike[row, column] or region[[0, -1]].any() or region[:, [0, -1]].any():  # or it may go on
        return None
    rows, columns = np.nonzero(region)
    variances = np.linalg.eigvalsh(np.cov(np.stack((columns, rows)), ddof=0))
    across, along = (math.sqrt(12.0 * max(float(each), 0.0) + 1.0) for each in variances)  # and that of a pixel
    fill = len(rows) / (across * along)
    if along < radius:  # a speck in what was clicked
        return None
    if along < limits.elongation * across or not 1.0 / limits.fill < fill < limits.fill:
        return None
    return Streak((left + float(columns.mean()), top + float(rows.mean()), 0.5 * across), along)
