"""From votes for centers to circles: the strongest peaks, their radii, and a robust fit to the boundary points."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.linalg import invert_3x3

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

X, Y, RADIUS, SHARE = range(4)  # geometry: columns of circles
TINY = 1e-9  # cells


def sum_votes(votes: Singles) -> Singles:
    """Votes summed over 5 x 5 cells: normals on a coarse grid are off by a few degrees."""
    return np.asarray(cv2.boxFilter(votes, -1, (5, 5), normalize=False, borderType=cv2.BORDER_CONSTANT), np.float32)


def pick_peaks(total: Singles, least: float, apart: float, most: int) -> Floats:
    """Strongest maxima of the votes; of two that are near to each other the stronger one.

    Parameters
    ----------
    total : ndarray of shape (rows, columns), float32
    least : float
        Votes of a peak.
    apart : float
        Distance in x or y that two peaks must have.
    most : int
        How many at most.

    Returns
    -------
    ndarray of shape (k, 2), float64
        x and y, strongest first.
    """
    places, peaks = np.empty(total.size // 2 + total.shape[0], np.int64), np.empty((most, 2))
    return peaks[: find_peaks(total, np.float32(least), apart, places, peaks)]


@kernel(refcount=False)
def find_peaks(total: Singles, least: np.float32, apart: float, places: npt.NDArray[np.int64], peaks: Floats) -> int:
    """Write the peaks; see `pick_peaks`.

    Parameters
    ----------
    total : (rows, columns) float32
    least : float32
    apart : float
    places : (n,) int64, written
        Room for all maxima: of two cells side by side at most one is a maximum.
    peaks : (most, 2), written

    Returns
    -------
    int
        How many there are.
    """
    height, width = total.shape
    maxima = found = 0
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            v = total[i, j]
            if v < least or v < total[i, j - 1] or v < total[i - 1, j] or v <= total[i, j + 1] or v <= total[i + 1, j]:
                continue
            places[maxima] = i * width + j
            maxima += 1
    best = -1
    while found < peaks.shape[0]:
        last, best, highest = best, -1, np.float32(-math.inf)
        left = 0
        for k in range(maxima):
            i, j = places[k] // width, places[k] % width
            near = abs(j - last % width) < apart and abs(i - last // width) < apart
            if last >= 0 and (near or places[k] == last):
                continue
            places[left] = places[k]
            left += 1
            if total[i, j] > highest:
                highest, best = total[i, j], places[k]
        maxima = left
        if best < 0:
            break
        peaks[found, 0], peaks[found, 1] = best % width, best // width
        found += 1
    return found


@kernel(refcount=False)
def find_radii(edges: Floats, circles: Floats, votes: Floats, aim: float) -> None:
    """Write the radius at which the share of the circle that boundary points confirm is largest.

    Parameters
    ----------
    edges : (n, 4)
        See `voting.find_edges`.
    circles : (k, 4), written
        x, y are read, the radius is written, cells.
    votes : (n,), written
        Room for the votes of each radius: 3 more than the largest radius in cells.
    aim : float
        See `voting.SearchParameters`.
    """
    longest = votes.shape[0] - 3
    for k in range(circles.shape[0]):
        for m in range(votes.shape[0]):
            votes[m] = 0.0
        for i in range(edges.shape[0]):
            dx, dy = edges[i, 0] - circles[k, 0], edges[i, 1] - circles[k, 1]
            distance = math.sqrt(dx * dx + dy * dy)
            if distance < longest and dx * edges[i, 2] + dy * edges[i, 3] > aim * distance:
                votes[int(distance + 0.5)] += 1.0 / (distance + 0.5)
        best, most = 1, 0.0
        for m in range(1, longest + 1):
            near = votes[m - 1] + votes[m] + votes[m + 1]
            if near > most:
                most, best = near, m
        circles[k, 2] = best


@kernel(refcount=False)
def fit_circles(edges: Floats, circles: Floats, limits: Floats, sums: Floats, inverse: Floats) -> None:
    """Take one step of a robust fit of circles to the boundary points near them, with Tukey's weights.

    Parameters
    ----------
    edges : (n, 4)
        See `voting.find_edges`.
    circles : (k, 4), written
        x, y, radius, cells; share of the circle that boundary points confirm.
    limits : (4,)
        `aim_fine`, `band`, `band_growth` and `damping` of `voting.SearchParameters`.
    sums, inverse : (3, 4) and (3, 3), written
        Room for the normal equations: a kernel that makes no arrays compiles faster.
    """
    aim, band, growth, damping = limits[0], limits[1], limits[2], limits[3]
    for k in range(circles.shape[0]):
        for a in range(3):
            for b in range(4):
                sums[a, b] = 0.0
        width = band + growth * circles[k, 2]
        far = circles[k, 2] + 2.0 * width  # well beyond the band: no root is taken of what has no weight
        for i in range(edges.shape[0]):
            dx, dy = edges[i, 0] - circles[k, 0], edges[i, 1] - circles[k, 1]
            squared = dx * dx + dy * dy
            if squared > far * far:
                continue
            distance = math.sqrt(squared) + TINY
            off = (distance - circles[k, 2]) / width
            if off * off >= 1.0 or dx * edges[i, 2] + dy * edges[i, 3] < aim * distance:
                continue
            weight = (1.0 - off * off) ** 2
            row = dx / distance, dy / distance, 1.0, off * width
            for a in range(3):
                for b in range(a, 4):
                    sums[a, b] += weight * row[a] * row[b]
        confirmed = sums[2, 2]
        for a in range(3):
            sums[a, a] += damping
        if invert_3x3(sums, inverse):
            for a in range(3):
                for b in range(3):
                    circles[k, a] += inverse[a, b] * sums[b, 3]
        radius = circles[k, 2] if circles[k, 2] > 0.7 else 0.7  # half the diagonal of a cell
        circles[k, 2] = radius
        circles[k, 3] = confirmed / (2.0 * math.pi * (radius if radius > 1.0 else 1.0))
