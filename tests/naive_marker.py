"""A patch on a ball, drawn slowly and obviously."""

import math

import numpy as np
import numpy.typing as npt


def picture_of_marker(
    ball: npt.NDArray[np.float64], middle: npt.NDArray[np.float64], size: float, depth: float, finer: int = 6
) -> npt.NDArray[np.uint8]:
    """Blue all over, redder inside the ellipse that a patch of a far sphere shows: every pixel the mean of many points.

    Parameters
    ----------
    ball : (3,)
        x, y, radius, px.
    middle : (2,)
        Middle of the patch's rim, px.
    size, depth : float
        Radius of the patch, and how far the middle of its rim is from the ball's center, in ball radii.
    finer : int
        Points along x and along y in every pixel.
    """
    offset = (middle - ball[:2]) / ball[2]
    # The patch is where the direction n from the ball's center has n.m > depth, m its own direction.
    x, y = offset / depth
    direction = np.array((x, y, math.sqrt(1.0 - x * x - y * y)))
    axis = (np.arange(120 * finer) + 0.5) / finer - 0.5
    columns, rows = np.meshgrid(axis, axis)
    nx, ny = (columns - ball[0]) / ball[2], (rows - ball[1]) / ball[2]
    nz = np.sqrt(np.maximum(1.0 - nx * nx - ny * ny, 0.0))
    inside = (nx * direction[0] + ny * direction[1] + nz * direction[2] > math.sqrt(1.0 - size * size)) & (nz > 0.0)
    share = inside.reshape(120, finer, 120, finer).mean(axis=(1, 3))
    image = np.full((120, 120, 3), (200, 60, 40), np.uint8)
    image[..., 2] = np.rint(40.0 + 120.0 * share)
    return image
