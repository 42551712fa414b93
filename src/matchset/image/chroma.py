"""Chroma and lightness: what a color keeps and what it loses when the light changes.

A BGR pixel with luma ``y = 0.114 b + 0.587 g + 0.299 r`` becomes three numbers,

    u = (b - y) / (b + g + r + 48),   v = (r - y) / (b + g + r + 48),   l = log2((y + 8) / 64).

Brighter or dimmer light moves l and hardly u and v; the 48 keeps dark, noisy pixels near gray. Densities over (u, v, l)
are histograms, smoothed.
"""

from typing import cast

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d, map_coordinates

Floats = npt.NDArray[np.float32]

LOW = np.array([-0.45, -0.45, -3.2], np.float32)
STEP = np.array([0.02, 0.02, 0.15], np.float32)
SIZE = (62, 62, 37)


def chroma(pixels: npt.NDArray[np.uint8] | Floats) -> Floats:
    """Chroma and lightness of pixels.

    Parameters
    ----------
    pixels : ndarray of shape (..., 3)
        Blue, green, red, 0 ... 255.

    Returns
    -------
    ndarray of shape (..., 3), float32
        u, v, l of the module's equation.
    """
    values = np.asarray(pixels, np.float32)
    b, g, r = values[..., 0], values[..., 1], values[..., 2]
    y = 0.114 * b + 0.587 * g + 0.299 * r
    whole = b + g + r + 48.0
    return cast(Floats, np.stack(((b - y) / whole, (r - y) / whole, np.log2((y + 8.0) / 64.0)), axis=-1))


def density(points: Floats, blur: tuple[float, float, float]) -> Floats:
    """Smoothed histogram of chroma points that sums to 1.

    Parameters
    ----------
    points : ndarray of shape (n, 3), float32
        u, v, l.
    blur : tuple of float
        Standard deviation of the smoothing along u, v and l, in their own units.

    Returns
    -------
    ndarray of shape `SIZE`, float32
    """
    cells = np.clip(np.round((points - LOW) / STEP).astype(np.int64), 0, np.array(SIZE) - 1)
    flat = np.ravel_multi_index((cells[:, 0], cells[:, 1], cells[:, 2]), SIZE)
    grid = np.bincount(flat, minlength=int(np.prod(SIZE))).reshape(SIZE).astype(np.float32)
    for axis, sigma in enumerate(blur):
        grid = gaussian_filter1d(grid, sigma / float(STEP[axis]), axis=axis, mode="constant")
    return cast(Floats, grid / max(float(grid.sum()), 1e-9))


def look_up(grid: Floats, points: Floats) -> Floats:
    """Value of a density at chroma points, linear between its cells.

    Parameters
    ----------
    grid : ndarray of shape `SIZE`, float32
    points : ndarray of shape (n, 3), float32

    Returns
    -------
    ndarray of shape (n,), float32
    """
    return cast(Floats, map_coordinates(grid, ((points - LOW) / STEP).T, order=1, mode="nearest"))
