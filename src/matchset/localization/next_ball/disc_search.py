"""Kernels that compare the color inside and around a disc, of which another disc hides a part: `search_disc`."""

import math

import numpy as np
import numpy.typing as npt

from matchset.image.light.color_adaptation import cell_at
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]
Triple = tuple[float, float, float]

# theorem: multiples of the golden angle are spread evenly over a disc (Vogel 1979)
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))

RINGS: Triple = (0.9, 1.1, 1.5)  # geometry: of a disc whose color nobody looks at


def sample_points(inside: int, around: int, rings: Triple) -> Floats:
    """Spread points evenly over the inside of a disc and over its surroundings.

    Parameters
    ----------
    inside, around : int
        How many.
    rings : tuple of 3 floats
        How far the inside goes, where the surroundings begin and how far they go, radii.

    Returns
    -------
    ndarray of shape (inside + around, 3), float64
        x, y in radii, and 1 inside, 0 around.
    """
    inner, begin, end = rings
    k, m = np.arange(inside), np.arange(around)
    away = np.concatenate(
        (inner * np.sqrt((k + 0.5) / inside), np.sqrt(begin**2 + (end**2 - begin**2) * (m + 0.5) / around))
    )
    angle = np.concatenate((k, m)) * GOLDEN_ANGLE
    is_inside = np.arange(inside + around) < inside
    return np.ascontiguousarray(np.column_stack((away * np.cos(angle), away * np.sin(angle), is_inside)))


@kernel(refcount=False)
def compare_disc(
    image: Bytes, table: Scores, disc: Triple, hiding: Triple, points: Floats, weights: Triple
) -> tuple[float, float]:
    """Compare inside and surroundings of a disc, without what another disc hides.

    Parameters
    ----------
    image : (h, w, channels) uint8
    table : (32768,) or (256,) int8
        See `ColorModel`.
    disc, hiding : tuple of 3 floats
        x, y, radius, px.
    points : (n, 3)
        See `sample_points`.
    weights : tuple of 3 floats
        How many points of another color are added to each share, how much the surroundings count, and how much a place
        at the end of the way of `search_disc`.

    Returns
    -------
    score : float
        Share of the inside that has the color, minus so much of that of the surroundings.
    seen : float
        Share of the inside that is in the picture and not hidden.
    """
    few, weight, _ = weights
    x, y, radius = disc
    inside = seen = around = beside = whole = 0
    for i in range(points.shape[0]):
        is_inside = points[i, 2] > 0.0
        whole += is_inside
        column, row = x + radius * points[i, 0], y + radius * points[i, 1]
        if (column - hiding[0]) ** 2 + (row - hiding[1]) ** 2 < hiding[2] * hiding[2]:
            continue
        cell = cell_at(image, column, row)
        if cell < 0:
            continue
        hit = table[cell] > 0
        if is_inside:
            seen += 1
            inside += hit
        else:
            beside += 1
            around += hit
    return inside / (seen + few) - weight * around / (beside + few), seen / max(whole, 1)


@kernel(refcount=False)
def search_disc(
    image: Bytes, table: Scores, disc: Triple, way: Triple, hiding: Triple, points: Floats, weights: Triple
) -> tuple[float, float, float, float]:
    """Find the place of a disc near another one. Seven parameters: a kernel is handed numbers and arrays.

    Parameters
    ----------
    image, table, disc, hiding, points, weights
        See `compare_disc`.
    way : tuple of 3 floats
        How far it is looked for to the sides and in height, and in which steps, px.

    Returns
    -------
    x, y : float
        Where the score is best, a little less the farther away it is; px.
    score, seen : float
        There, see `compare_disc`.
    """
    aside, high, step = way
    columns, rows, farther = int(aside / step + 0.5), int(high / step + 0.5), weights[2]
    best, found, place, share = -2.0, -2.0, (disc[0], disc[1]), 0.0
    for i in range(-rows, rows + 1):
        for j in range(-columns, columns + 1):
            at = disc[0] + j * step, disc[1] + i * step
            score, seen = compare_disc(image, table, (at[0], at[1], disc[2]), hiding, points, weights)
            off = (j * step / max(aside, step)) ** 2 + (i * step / max(high, step)) ** 2
            if score - farther * off > best:
                best, found, place, share = score - farther * off, score, at, seen
    return place[0], place[1], found, share


def precompile(table_size: int, channels: int) -> None:
    """Compile the kernels for color tables and pictures of a kind."""
    image, table, points = (
        np.zeros((4, 4, channels), np.uint8),
        np.zeros(table_size, np.int8),
        sample_points(4, 4, RINGS),
    )
    compare_disc(image, table, *(RINGS,) * 2, points, RINGS)
    search_disc(image, table, *(RINGS,) * 3, points, RINGS)
