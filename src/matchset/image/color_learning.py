"""From a click or a box on the target to the log-odds of a color table.

The region of the target is grown in chroma and lightness, which tell what a color keeps and what it loses when the
light changes; densities of both over target and background then give the log-odds. A BGR pixel with luma
``y = 0.114 b + 0.587 g + 0.299 r`` becomes three numbers,

    u = (b - y) / (b + g + r + 48),   v = (r - y) / (b + g + r + 48),   l = log2((y + 8) / 64).

Brighter or dimmer light moves l and hardly u and v; the 48 keeps dark, noisy pixels near gray. Densities over (u, v, l)
are histograms, smoothed.
"""

import itertools
from itertools import pairwise
from typing import cast

import cv2
import numpy as np
import numpy.typing as npt

Mask = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float32]

TOLERANCES = 0.012 * 1.2 ** np.arange(19)  # chroma distances that are tried, in rising order
LIGHTNESS = 0.06  # chroma distance that an octave of lightness counts as: light may vary over the target
LARGEST = 0.4  # share of the picture beyond which a region has leaked into the background
STEADY = 1.12  # growth of the area from one tolerance to the next that still counts as standing still
LOW = np.array([-0.45, -0.45, -3.2], np.float32)
STEP = np.array([0.02, 0.02, 0.15], np.float32)
SIZE = (62, 62, 37)
UNKNOWN = 0.06, 0.12  # shares of target and background that may have any color at all


def features(image: npt.NDArray[np.uint8]) -> Floats:
    """Smoothed features of every pixel, (h, w, 3): chroma of a color picture, the gray value repeated otherwise.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    smooth = np.asarray(cv2.GaussianBlur(image, (0, 0), 2.0), np.uint8)
    if smooth.ndim == 3:
        return chroma(smooth)
    level = smooth.astype(np.float32) / 400.0
    return np.stack((level, level, np.zeros_like(level)), axis=-1)


def grow(image: npt.NDArray[np.uint8], seed: Mask) -> Mask:
    """Grow the connected region around the seed that is set off from what surrounds it.

    The tolerance is not chosen by hand: the region is grown with rising tolerances, and the one is taken around which
    its area stands still longest, since that is where it has met the target's own edge (as maximally stable extremal
    regions do, Matas et al. 2002).

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    seed : ndarray of shape (h, w), bool
        Pixels known to be target.

    Returns
    -------
    ndarray of shape (h, w), bool
        The seed and what grew from it.
    """
    values = features(image)
    change = values - np.median(values[seed], axis=0)
    change[..., 2] *= LIGHTNESS
    distance = np.sqrt(np.sum(change**2, axis=-1))
    regions = []
    for tolerance in TOLERANCES:
        region = _touching(distance < tolerance, seed)
        if region.sum() > LARGEST * region.size:
            break
        regions.append(region)
    return seed | regions[_steadiest([int(region.sum()) for region in regions])] if regions else seed


def calm(image: npt.NDArray[np.uint8], x: float, y: float) -> Mask:
    """Small disc near a click where the color hardly varies: people click near rims, stripes and highlights too.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    x, y : float
        The click, px.

    Returns
    -------
    ndarray of shape (h, w), bool
        A disc of radius 3 px, at most 7 px from the click.
    """
    values = features(image)
    values[..., 2] *= LIGHTNESS
    mean, square = cv2.blur(values, (7, 7)), cv2.blur(values**2, (7, 7))
    unrest = np.sqrt(np.maximum(square - mean**2, 0.0).sum(axis=-1))
    rows, columns = np.indices(unrest.shape)
    away = np.hypot(columns - x, rows - y)
    best = np.argmin(np.where(away <= 7.0, unrest + 0.002 * away, np.inf))
    row, column = np.unravel_index(best, unrest.shape)
    return np.asarray(np.hypot(columns - column, rows - row) <= 3.0)


def _touching(alike: Mask, seed: Mask) -> Mask:
    """Find the connected components of `alike` that hold a pixel of the seed."""
    _, labels = cv2.connectedComponents(alike.astype(np.uint8), connectivity=4)
    wanted = np.unique(labels[seed])
    return np.asarray(np.isin(labels, wanted[wanted > 0]))


def _steadiest(areas: list[int]) -> int:
    """Index in the middle of the longest run over which the area hardly grows; of equal runs, the larger area's."""
    best, run = (0, 0), 0
    growth = [later / max(sooner, 1) for sooner, later in pairwise(areas)]
    for k, factor in enumerate(growth):
        run = run + 1 if factor < STEADY and areas[k] > 0 else 0
        if run and run >= best[0]:
            best = (run, k + 1 - (run + 1) // 2)
    if best[0]:
        return best[1]
    return int(np.argmin(growth)) if growth else 0


def surroundings(region: Mask) -> Mask:
    """Pixels that are surely not target: outside a circle 1.4 times the one that encloses the region.

    Parameters
    ----------
    region : ndarray of shape (h, w), bool

    Returns
    -------
    ndarray of shape (h, w), bool
    """
    rows, columns = np.nonzero(region)
    points = np.column_stack((columns, rows)).astype(np.int32)
    (x, y), radius = cv2.minEnclosingCircle(points)
    outside = np.ones(region.shape, np.uint8)
    cv2.circle(outside, (round(x), round(y)), int(1.4 * radius) + 4, 0, -1)
    return outside.astype(bool)


def bin_centers() -> npt.NDArray[np.float32]:
    """BGR value in the middle of each of the 32 x 32 x 32 cells, (32768, 3)."""
    level = np.arange(32, dtype=np.float32) * 8.0 + 3.5
    return np.stack(np.meshgrid(level, level, level, indexing="ij"), axis=-1).reshape(-1, 3)


def learned_color(target: npt.NDArray[np.uint8], background: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """Log-odds of the BGR cells: chroma counts, lightness only where the background says so."""
    inside = chroma(target)
    width = np.clip(inside[:, :2].std(axis=0) * len(inside) ** (-1 / 6), 0.018, 0.06)
    wanted = density(inside, (float(width[0]), float(width[1]), 0.9))
    other = density(chroma(background), (0.02, 0.02, 0.3))
    cells = chroma(bin_centers())
    uniform = 1.0 / (0.25 * wanted.size)
    odds = (look_up(wanted, cells) * (1 - UNKNOWN[0]) + UNKNOWN[0] * uniform) / (
        look_up(other, cells) * (1 - UNKNOWN[1]) + UNKNOWN[1] * uniform
    )
    return np.asarray(np.log(odds), np.float32)


def learned_gray(target: npt.NDArray[np.uint8], background: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """Log-odds of the 256 gray values."""
    shares = []
    for pixels, unknown in zip((target, background), UNKNOWN, strict=True):
        counts = np.bincount(pixels.ravel(), minlength=256).astype(np.float32)
        smooth = cv2.GaussianBlur(counts.reshape(1, -1), (0, 0), 6.0, borderType=cv2.BORDER_REPLICATE).ravel()
        shares.append(smooth / smooth.sum() * (1 - unknown) + unknown / 256.0)
    return np.asarray(np.log(shares[0] / shares[1]), np.float32)


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
