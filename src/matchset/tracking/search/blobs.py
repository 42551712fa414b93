"""Blobs: places where the target's color prevails, whatever their outline."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.color import WHITE
from matchset.tracking.search.peak_circles import RADIUS, SHARE, X, Y

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Scores = npt.NDArray[np.int16]

INNER, OUTER = 0.8, 1.6  # geometry: half the sides of the squares within and around a blob, radii
BLOB_SIZES = (1.4, 2.0, 2.8)  # geometry: factors of the least radius that is expected, by steps of sqrt(2)


def color_steps(grid: Scores, radii: Sequence[float]) -> list[tuple[float, Singles]]:
    """By how much more a disc around each cell has of the target's color than what is around it.

    The mean in a square about as large as the disc, less that of the frame around it, up to twice as far out: of a
    disc in parts or with a soft rim that is as clear as of a whole and sharp one.

    Parameters
    ----------
    grid : ndarray of shape (rows, columns), int16
        Sum of the scores of two pixels of each cell.
    radii : sequence of float
        Of the discs, cells.

    Returns
    -------
    list of (float, ndarray of shape (rows, columns), float32)
        Of each radius that fits into the grid: differences of the mean whiteness, -2 ... 2.
    """
    whiteness, steps = grid.astype(np.float32) / (2.0 * WHITE), []
    for radius in radii:
        inner = 2 * round(INNER * radius) + 1
        outer = max(2 * round(OUTER * radius) + 1, inner + 2)  # of a disc of less than a cell: the cells around
        if outer < min(whiteness.shape):
            within, around = _box_sums(whiteness, inner), _box_sums(whiteness, outer)
            step = within / inner**2 - (around - within) / (outer**2 - inner**2)
            steps.append((radius, np.asarray(step, np.float32)))
    return steps


def blobs_of(grid: Scores, smallest: float, least: float, most: int) -> list[Floats]:
    """Find places that have more of the target's color than what is around them, as discs of some sizes would.

    Parameters
    ----------
    grid : ndarray of shape (rows, columns), int16
        Sum of the scores of two pixels of each cell.
    smallest : float
        Least radius that is expected, cells.
    least : float
        Difference of a blob.
    most : int
        How many at most.

    Returns
    -------
    list of ndarray of shape (n, 4), float64
        Clearest blob first; for each the discs of all sizes near it: x, y, radius, cells; that difference.
    """
    steps = color_steps(grid, [factor * smallest for factor in BLOB_SIZES])
    peaks = [np.zeros((0, 4)), *(_peaks_of(step, radius, least) for radius, step in steps)]
    blobs = np.concatenate(peaks)
    kept: list[Floats] = []
    for blob in blobs[np.argsort(-blobs[:, SHARE], kind="stable")]:
        if len(kept) == most:
            break
        if all(math.hypot(blob[X] - each[X], blob[Y] - each[Y]) > INNER * blob[RADIUS] for each in kept):
            kept.append(blob)
    return [np.array([_nearest_disc(step, radius, blob) for radius, step in steps]) for blob in kept]


def _peaks_of(step: Singles, radius: float, least: float) -> Floats:
    """Largest differences around, as rows of discs of a radius."""
    size = 2 * round(radius) + 1
    rows, columns = np.nonzero((step >= cv2.dilate(step, np.ones((size, size), np.uint8))) & (step > least))
    return np.column_stack((columns, rows, np.full(len(rows), radius), step[rows, columns]))


def _nearest_disc(step: Singles, radius: float, blob: Floats) -> Floats:
    """Disc of a radius with the largest difference that still holds the middle of a blob."""
    reach = round(radius)
    left, top = max(round(blob[X]) - reach, 0), max(round(blob[Y]) - reach, 0)
    near = step[top : round(blob[Y]) + reach + 1, left : round(blob[X]) + reach + 1]
    row, column = np.unravel_index(int(near.argmax()), near.shape)
    return np.array((left + column, top + row, radius, near[row, column]))


def _box_sums(values: Singles, side: int) -> Singles:
    return np.asarray(
        cv2.boxFilter(values, -1, (side, side), normalize=False, borderType=cv2.BORDER_REPLICATE), np.float32
    )
