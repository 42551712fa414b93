"""From a click or a box to the pixels of the target: region growing in chroma."""

from itertools import pairwise

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.chroma import chroma

Mask = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float32]

TOLERANCES = 0.012 * 1.2 ** np.arange(19)  # chroma distances that are tried, in rising order
LIGHTNESS = 0.06  # chroma distance that an octave of lightness counts as: light may vary over the target
LARGEST = 0.4  # share of the picture beyond which a region has leaked into the background
STEADY = 1.12  # growth of the area from one tolerance to the next that still counts as standing still


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
