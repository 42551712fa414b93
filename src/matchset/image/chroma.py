"""Chroma and lightness: what a color keeps and what it loses when the light changes.

A BGR pixel with luma ``y = 0.114 b + 0.587 g + 0.299 r`` becomes three numbers,

    u = (b - y) / (b + g + r + 48),   v = (r - y) / (b + g + r + 48),   l = log2((y + 8) / 64).

Brighter or dimmer light moves l and hardly u and v; the 48 keeps dark, noisy pixels near gray. Densities over (u, v, l)
are histograms, smoothed.
"""

import itertools
from typing import cast

import cv2
import numpy as np
import numpy.typing as npt

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
        grid = _blur(grid, sigma / float(STEP[axis]), axis)
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
    places = np.clip((points - LOW) / STEP, 0.0, np.array(SIZE, np.float32) - 1.0)
    lower = np.minimum(places.astype(np.int64), np.array(SIZE) - 2)
    share = places - lower
    found = np.zeros(len(points), np.float32)
    for corner in itertools.product((0, 1), repeat=3):
        weight = np.prod(np.where(corner, share, 1.0 - share), axis=1)
        found += weight * grid[tuple((lower + corner).T)]
    return found


def _blur(grid: Floats, sigma: float, axis: int) -> Floats:
    """Smooth along one axis with a Gaussian, in cells; nothing lies outside the grid."""
    rows = np.ascontiguousarray(np.moveaxis(grid, axis, 2))
    size = 2 * int(4.0 * sigma + 0.5) + 1
    weights = cv2.getGaussianKernel(size, sigma)
    flat = cv2.sepFilter2D(rows.reshape(-1, rows.shape[2]), -1, weights, np.ones(1), borderType=cv2.BORDER_CONSTANT)
    return cast(Floats, np.moveaxis(np.asarray(flat).reshape(rows.shape), 2, axis))
