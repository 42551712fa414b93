"""Where shapes may be: a coarse grid of scores, its boundary, and votes for centers (Epstein & Feldman, Alg. 2).

The paper tries every circle and keeps the one with the largest match-set. Here each boundary point of the coarse grid
votes for the centers it could belong to, along its inward normal, with weight 1/distance, so that every full circle
collects about 2 pi whatever its size; only the winners are then matched in the picture itself.
"""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Cells = npt.NDArray[np.int32]
MOST_EDGES = 1500  # boundary cells that may vote; more are thinned out evenly
BORDER = 12  # cells of radius up to which votes are counted finely
LEAST = 4.0  # area of a region that is worth a look, cells


class SearchParameters(msgspec.Struct, frozen=True):
    """How the whole frame is searched.

    Parameters
    ----------
    whole_frame : bool
        Whether a tracker searches the whole frame while it follows nothing; without, something else must find the shape
        and `start` the tracker.
    cells : int
        The grid has about this many columns, of 2 to 8 px each: more finds smaller shapes and takes longer.
    votes : float
        Least votes of a candidate, summed over 5 x 5 cells; a full circle collects about 30.
    share : float
        Least share of a candidate's outline that boundary cells must confirm.
    candidates : int
        How many candidates are looked at in the picture itself.
    """

    whole_frame: bool = True
    cells: int = 160
    votes: float = 1.6
    share: float = 0.25
    candidates: int = 12


class Searcher:
    """The grids of a search, made once per picture size.

    Parameters
    ----------
    width, height : int
        Size of the picture, px.
    parameters : SearchParameters
    """

    def __init__(self, width: int, height: int, parameters: SearchParameters | None = None) -> None:
        self.parameters = parameters or SearchParameters()
        self.size = width, height
        self.stride = min(max(width // self.parameters.cells, 2), 8)
        rows, columns = max(height // self.stride, 3), max(width // self.stride, 3)
        self.fits = height >= 3 * self.stride and width >= 3 * self.stride
        self.grid, self.sums, self.smooth = (np.zeros((rows, columns), np.int32) for _ in range(3))
        half = (rows + 1) // 2, (columns + 1) // 2
        self.near, self.far = ([np.zeros(shape, np.float32) for _ in range(3)] for shape in ((rows, columns), half))
        self.edges = np.zeros((max(rows * columns // 3, 64), 4))
        self.peaks = np.zeros((max(self.parameters.candidates // 2, 1), 5))
        self.longest = int(0.6 * max(rows, columns))

    def candidates(self, image: npt.NDArray[np.uint8], color: ColorModel) -> Floats:
        """Rough circles, most of whose outline is confirmed first.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel

        Returns
        -------
        ndarray of shape (k, 4), float64
            x, y, radius, px; share of the outline that boundary cells confirm.
        """
        if not self._look(image, color):
            return np.zeros((0, 4))
        count = find_edges(self.smooth, self.edges)
        near = self._peaks(count, self.near, 1, BORDER, 1)
        far = self._peaks(count, self.far, BORDER - 3, self.longest, 2)
        rough = np.concatenate((near, far))
        rough = rough[rough[:, 3] >= self.parameters.share]
        rough = rough[np.argsort(-rough[:, 3], kind="stable")]
        rough[:, :3] *= self.stride
        rough[:, 0] += 0.25 * self.stride
        rough[:, 1] += 0.5 * self.stride
        return rough

    def hulls(self, image: npt.NDArray[np.uint8], color: ColorModel) -> list[Floats]:
        """Rough convex outlines of the regions that look like the target, largest first.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel

        Returns
        -------
        list of ndarray of shape (m, 2), float64
            px.
        """
        if not self._look(image, color):
            return []
        return region_hulls(self.smooth, self.stride, self.parameters.candidates)

    def _look(self, image: npt.NDArray[np.uint8], color: ColorModel) -> bool:
        """Fill the smoothed grid with what a picture shows; False if the picture is too small for one."""
        if self.fits:
            sample_grid(image, color.table, self.stride, self.grid)
            smooth_grid(self.grid, self.sums, self.smooth)
            smooth_grid(self.smooth, self.sums, self.grid)
            self.smooth, self.grid = self.grid, self.smooth
        return self.fits

    def _peaks(
        self, count: int, grids: list[npt.NDArray[np.float32]], nearest: int, farthest: int, fold: int
    ) -> Floats:
        """Candidates with radii between two numbers of cells: x, y, radius (cells), share."""
        votes, runs, spread = grids
        votes[:] = 0.0
        vote(self.smooth, self.edges, count, nearest, farthest, fold, votes)
        spread_votes(votes, runs, spread)
        least = self.parameters.votes
        found = pick_peaks(spread, self.edges, count, farthest, least, fold, self.peaks)
        return self.peaks[:found, :4].copy()


def region_hulls(smooth: npt.NDArray[np.int32], stride: int, most: int) -> list[Floats]:
    """Find the regions of a grid of scores that are positive.

    Parameters
    ----------
    smooth : ndarray of shape (rows, columns), int32
        Scores, see `smooth_grid`.
    stride : int
        Size of a cell, px.
    most : int
        How many at most.

    Returns
    -------
    list of ndarray of shape (m, 2), float64
        Hulls, px, largest first, in the order in which x turns to y.
    """
    contours, _ = cv2.findContours((smooth > 0).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    areas = [cv2.contourArea(contour) + 0.5 * len(contour) for contour in contours]
    order = sorted(range(len(contours)), key=lambda k: -areas[k])[:most]
    found = []
    for k in order:
        if areas[k] < LEAST or len(contours[k]) < 3:
            continue
        hull = cv2.convexHull(contours[k])[:, 0, :].astype(np.float64)
        if len(hull) < 3:
            continue
        low, high = hull.min(axis=0), hull.max(axis=0)
        middle, size = 0.5 * (low + high), 0.5 * (high - low)
        hull = middle + (hull - middle) * (size + 0.5) / np.maximum(size, 0.5)  # to the rim of the outermost cells
        hull *= stride
        hull += (0.25 * stride, 0.5 * stride)
        x, y = hull[:, 0], hull[:, 1]
        turns = float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
        found.append(hull if turns > 0.0 else np.ascontiguousarray(hull[::-1]))
    return found


@kernel
def sample_grid(image: npt.NDArray[np.uint8], table: npt.NDArray[np.int8], stride: int, grid: Cells) -> None:
    """Sum of the scores of two pixels in every cell of `stride` x `stride` pixels."""
    half = stride // 2
    color = table.size > 256
    for i in range(grid.shape[0]):
        row = np.uintp(i * stride + half)
        for j in range(grid.shape[1]):
            total = 0
            for offset in (0, half):
                column = np.uintp(j * stride + offset)
                cell = np.uint32(image[row, column, 0])
                if color:
                    g, r = np.uint32(image[row, column, 1]), np.uint32(image[row, column, 2])
                    cell = (
                        (cell >> np.uint32(3)) << np.uint32(10)
                        | (g >> np.uint32(3)) << np.uint32(5)
                        | r >> np.uint32(3)
                    )
                total += table[np.uintp(cell)]
            grid[i, j] = total


@kernel
def smooth_grid(grid: Cells, rows: Cells, smooth: Cells) -> None:
    """Sum over 3 x 3 cells; beyond the picture the border repeats."""
    height, width = grid.shape
    for i in range(height):
        rows[i, 0] = 2 * grid[i, 0] + grid[i, 1]
        for j in range(1, width - 1):
            rows[i, j] = grid[i, j - 1] + grid[i, j] + grid[i, j + 1]
        rows[i, width - 1] = grid[i, width - 2] + 2 * grid[i, width - 1]
    for i in range(height):
        above, below = max(i - 1, 0), min(i + 1, height - 1)
        for j in range(width):
            smooth[i, j] = rows[above, j] + rows[i, j] + rows[below, j]


@kernel
def find_edges(smooth: Cells, edges: Floats) -> int:
    """Boundary of the positive region: x, y and outward normal, in cells; returns how many there are."""
    height, width = smooth.shape
    count = 0
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            s = smooth[i, j]
            if s <= 0 or (
                smooth[i, j - 1] > 0 and smooth[i, j + 1] > 0 and smooth[i - 1, j] > 0 and smooth[i + 1, j] > 0
            ):
                continue
            gx = float(smooth[i, j + 1] - smooth[i, j - 1]) * 2.0
            gx += float(smooth[i - 1, j + 1] - smooth[i - 1, j - 1] + smooth[i + 1, j + 1] - smooth[i + 1, j - 1])
            gy = float(smooth[i + 1, j] - smooth[i - 1, j]) * 2.0
            gy += float(smooth[i + 1, j - 1] - smooth[i - 1, j - 1] + smooth[i + 1, j + 1] - smooth[i - 1, j + 1])
            steep = math.sqrt(gx * gx + gy * gy)
            if steep <= 0.0 or count >= edges.shape[0]:
                continue
            nx, ny = -gx / steep, -gy / steep
            beyond = min(8.0 * s / steep, 1.0)
            edges[count, 0], edges[count, 1] = j + beyond * nx, i + beyond * ny
            edges[count, 2], edges[count, 3] = nx, ny
            count += 1
    return count


@kernel
def vote(smooth: Cells, edges: Floats, count: int, nearest: int, farthest: int, fold: int, votes: Singles) -> None:
    """Add 1/distance along the inward normal of every boundary point, as long as the way is mostly target.

    Only distances from `nearest` to `farthest` (cells) vote; `fold` cells of the grid share one of the votes, since far
    votes are spread wider.
    """
    height, width = smooth.shape
    every = 1 + count // MOST_EDGES
    for i in range(0, count, every):
        x, y, nx, ny = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        foreign = 0
        for distance in range(1, farthest + 1):
            column, row = int(x - nx * distance + 0.5), int(y - ny * distance + 0.5)
            if column < 0 or row < 0 or column >= width or row >= height:
                break
            foreign += smooth[row, column] <= 0
            if foreign > 2 + 0.3 * distance:
                break
            if distance >= nearest:
                votes[row // fold, column // fold] += every / np.float32(distance + 0.5)


@kernel
def spread_votes(votes: Singles, rows: Singles, total: Singles) -> None:
    """Sum the votes over 5 x 5 cells: normals on a coarse grid are off by a few degrees."""
    height, width = votes.shape
    for i in range(height):
        run = np.float32(0.0)
        for j in range(min(2, width)):
            run += votes[i, j]
        for j in range(width):
            if j + 2 < width:
                run += votes[i, j + 2]
            if j > 2:
                run -= votes[i, j - 3]
            rows[i, j] = run
    for i in range(height):
        for j in range(width):
            total[i, j] = np.float32(0.0)
        for k in range(max(i - 2, 0), min(i + 3, height)):
            for j in range(width):
                total[i, j] += rows[k, j]


@kernel
def pick_peaks(total: Singles, edges: Floats, count: int, longest: int, least: float, fold: int, peaks: Floats) -> int:
    """Strongest maxima of the votes, each with the circle its boundary points agree on; returns how many.

    A row of `peaks` is x, y, radius (cells), the share of the circle that boundary points confirm, the votes.
    """
    height, width = total.shape
    found = 0
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            v = total[i, j]
            if v < least or v < total[i, j - 1] or v < total[i - 1, j] or v <= total[i, j + 1] or v <= total[i + 1, j]:
                continue
            found = _insert(peaks, found, fold * (j + 0.5) - 0.5, fold * (i + 0.5) - 0.5, v, 3.0 * fold)
    for k in range(found):
        _radius(edges, count, peaks, k, longest)
        for _ in range(3):
            _circle(edges, count, peaks, k)
    return found


@kernel
def _insert(peaks: Floats, found: int, x: float, y: float, v: float, apart: float) -> int:
    """Keep the peaks sorted by votes; of peaks less than `apart` cells from each other only the strongest."""
    for k in range(found):
        if abs(peaks[k, 0] - x) < apart and abs(peaks[k, 1] - y) < apart:
            if v <= peaks[k, 4]:
                return found
            for m in range(k, found - 1):
                peaks[m, 0], peaks[m, 1], peaks[m, 4] = peaks[m + 1, 0], peaks[m + 1, 1], peaks[m + 1, 4]
            found -= 1
            break
    if found == peaks.shape[0] and v <= peaks[found - 1, 4]:
        return found
    found = min(found + 1, peaks.shape[0])
    k = found - 1
    while k > 0 and v > peaks[k - 1, 4]:
        peaks[k, 0], peaks[k, 1], peaks[k, 4] = peaks[k - 1, 0], peaks[k - 1, 1], peaks[k - 1, 4]
        k -= 1
    peaks[k, 0], peaks[k, 1], peaks[k, 4] = x, y, v
    return found


@kernel
def _radius(edges: Floats, count: int, peaks: Floats, k: int, longest: int) -> None:
    """Distance at which the share of the circle that boundary points confirm is largest."""
    x, y = peaks[k, 0], peaks[k, 1]
    votes = np.zeros(longest + 3)
    for i in range(count):
        dx, dy = edges[i, 0] - x, edges[i, 1] - y
        distance = math.sqrt(dx * dx + dy * dy)
        if distance < longest and dx * edges[i, 2] + dy * edges[i, 3] > 0.8 * distance:
            votes[int(distance + 0.5)] += 1.0 / (distance + 0.5)
    best, share = 1, 0.0
    for m in range(1, longest + 1):
        near = votes[m - 1] + votes[m] + votes[m + 1]
        if near > share:
            share, best = near, m
    peaks[k, 2], peaks[k, 3] = best, share / (2.0 * math.pi)


@kernel
def _circle(edges: Floats, count: int, peaks: Floats, k: int) -> None:
    """One step of a robust circle fit to the boundary points near the present circle."""
    x, y, radius = peaks[k, 0], peaks[k, 1], peaks[k, 2]
    a00 = a01 = a02 = a11 = a12 = a22 = b0 = b1 = b2 = 0.0
    width = 1.0 + 0.15 * radius
    for i in range(count):
        dx, dy = edges[i, 0] - x, edges[i, 1] - y
        distance = math.sqrt(dx * dx + dy * dy) + 1e-9
        e = (distance - radius) / width
        if e * e >= 1.0 or dx * edges[i, 2] + dy * edges[i, 3] < 0.7 * distance:
            continue
        w, e = (1.0 - e * e) ** 2, e * width
        ux, uy = dx / distance, dy / distance
        a00, a01, a02 = a00 + w * ux * ux, a01 + w * ux * uy, a02 + w * ux
        a11, a12, a22 = a11 + w * uy * uy, a12 + w * uy, a22 + w
        b0, b1, b2 = b0 + w * ux * e, b1 + w * uy * e, b2 + w * e
    a00, a11, a22 = a00 + 0.1, a11 + 0.1, a22 + 0.1
    c0, c1, c2 = a11 * a22 - a12 * a12, a02 * a12 - a01 * a22, a01 * a12 - a02 * a11
    det = a00 * c0 + a01 * c1 + a02 * c2
    sx = (c0 * b0 + c1 * b1 + c2 * b2) / det
    sy = (c1 * b0 + (a00 * a22 - a02 * a02) * b1 + (a01 * a02 - a00 * a12) * b2) / det
    sr = (c2 * b0 + (a01 * a02 - a00 * a12) * b1 + (a00 * a11 - a01 * a01) * b2) / det
    peaks[k, 0], peaks[k, 1], peaks[k, 2] = x + sx, y + sy, max(radius + sr, 0.7)
    peaks[k, 3] = (a22 - 0.1) / (2.0 * math.pi * max(peaks[k, 2], 1.0))
