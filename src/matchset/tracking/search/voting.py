"""Where shapes may be: a coarse grid of scores, its boundary, and votes for centers (Epstein & Feldman, Alg. 2).

The paper tries every circle and keeps the one with the largest match-set. Here each boundary point of the coarse grid
votes for the centers it could belong to, along its inward normal, with weight 1/distance, so that every full circle
collects about 2 pi whatever its size; only the winners are then matched in the picture itself. Other shapes begin at
the regions of the grid instead. What goes from cell to cell or from point to point is compiled (decision 081).
"""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.numeric.jit import kernel
from matchset.tracking.search.blobs import blobs_of
from matchset.tracking.search.peak_circles import RADIUS, SHARE, X, Y, find_radii, fit_circles, pick_peaks, sum_votes

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Scores = npt.NDArray[np.int16]
Bytes = npt.NDArray[np.uint8]


class SearchParameters(msgspec.Struct, frozen=True):
    """How the whole frame is searched.

    Chosen by hand; ``python -m benchmarks --only false_locks`` and ``--only reacquisition`` would show a change.

    Parameters
    ----------
    whole_frame : bool
        Whether a tracker searches the whole frame for a shape that it lost; without it nothing of a search is compiled.
    cells : int
        The grid has about this many columns, of 2 to 8 px each: more finds smaller shapes and takes longer.
    radius_cells : float
        Cells that the radius of the ball that is expected must have.
    votes : float
        Least votes of a candidate, summed over 5 x 5 cells; a full circle collects about 30.
    share : float
        Least share of a candidate's outline that boundary cells must confirm.
    candidates : int
        How many candidates are looked at in the picture itself.
    voters : int
        About how many boundary cells vote at most; where there are more, every second, third, ... one votes.
    fine_radius : int
        Radius up to which votes are counted in single cells, cells; larger circles are counted in 2 x 2 cells, since
        votes from far away scatter more.
    largest_share : float
        Largest radius, as a share of the grid's longer side.
    gap, gap_growth : float
        Cells of background that a vote may cross on its way to the center: some at once, more per cell of distance.
        More finds targets with marks and highlights, and lets neighbors vote for each other.
    aim_rough, aim_fine : float
        Cosine of the angle between a boundary cell's normal and the direction from the center beyond which the cell
        does not count: where the radius is estimated, and where the circle is fitted.
    band, band_growth : float
        Width of the robust fit of a circle to its boundary cells: in cells, and per cell of radius.
    rounds : int
        Steps of that fit.
    damping : float
        Weight, in boundary cells, with which that fit keeps the circle as it is: where few cells hold it.
    apart : float
        Of peaks nearer to each other than this, in cells of their votes, only the strongest is kept.
    region : float
        Least area of a region that a shape may begin at, cells.
    blobs, least_step : int, float
        In a picture that is asked for, where no candidate is right: how many places that have more of the target's
        color than what is around them are looked at, and by how much more, as a difference of the mean whiteness.
    """

    whole_frame: bool = True
    cells: int = 160
    radius_cells: float = 2.5
    votes: float = 1.6
    share: float = 0.25
    candidates: int = 12
    voters: int = 1500
    fine_radius: int = 12
    largest_share: float = 0.6
    gap: float = 2.0
    gap_growth: float = 0.3
    aim_rough: float = 0.8
    aim_fine: float = 0.7
    band: float = 1.0
    band_growth: float = 0.15
    rounds: int = 3
    damping: float = 0.1
    apart: float = 3.0
    region: float = 4.0
    blobs: int = 12
    least_step: float = 0.4


def stride_for(width: int, limits: SearchParameters, radius: float = math.inf) -> int:
    """Size of a cell, px, for pictures of a width in which a ball of a radius is expected, px."""
    coarse = min(max(width // limits.cells, 2), 8)
    return max(min(coarse, int(min(radius, 1e6) / limits.radius_cells)), 1)


class Searcher:
    """Coarse search of pictures of one size.

    Parameters
    ----------
    width, height : int
        Size of the picture, px.
    parameters : SearchParameters
    radius : float, optional
        Of the ball that is expected, px: for a small one the cells are smaller.
    """

    def __init__(
        self, width: int, height: int, parameters: SearchParameters | None = None, radius: float = math.inf
    ) -> None:
        self.parameters = parameters or SearchParameters()
        self.size, self.radius = (width, height), radius
        self.stride = stride_for(width, self.parameters, radius)
        rows, columns = max(height // self.stride, 3), max(width // self.stride, 3)
        self.fits = height >= 3 * self.stride and width >= 3 * self.stride
        self._grid = np.zeros((rows, columns), np.int16)
        self._edges = np.zeros((max(rows * columns // 3, 64), 4))
        limits, longest = self.parameters, int(self.parameters.largest_share * max(rows, columns))
        self._fit_limits = np.array((limits.aim_fine, limits.band, limits.band_growth, limits.damping))
        self._sums, self._inverse = np.zeros((3, 4)), np.zeros((3, 3))
        self._near = Accumulator((rows, columns), (1, limits.fine_radius), 1, limits)
        self._far = Accumulator((rows, columns), (limits.fine_radius - 3, longest), 2, limits)

    def candidates(self, image: Bytes, color: ColorModel) -> Floats:
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
        if not self.fits:
            return np.zeros((0, 4))
        limits, smooth = self.parameters, self._smooth_grid(image, color)
        edges = self._edges[: find_edges(smooth, self._edges)]
        if not len(edges):
            return np.zeros((0, 4))
        way = np.ones_like(smooth) if color.is_hollow else smooth  # to its middle a ring has another color
        rough = np.concatenate((self._near.find_circles(way, edges), self._far.find_circles(way, edges)))
        if not len(rough):
            return rough
        for _ in range(limits.rounds):
            fit_circles(edges, rough, self._fit_limits, self._sums, self._inverse)
        rough = rough[rough[:, SHARE] >= limits.share]
        rough = rough[np.argsort(-rough[:, SHARE], kind="stable")]
        return self._in_pixels(rough)

    def blobs(self, image: Bytes, color: ColorModel) -> list[Floats]:
        """Rough circles in px as of `blobs_of`, for an image as of `candidates`; none where no radius is expected."""
        if not self.fits or not math.isfinite(self.radius):
            return []
        sample_grid(image, color.table, self.stride, self._grid)
        limits, least = self.parameters, self.radius / self.stride
        return [self._in_pixels(each) for each in blobs_of(self._grid, least, limits.least_step, limits.blobs)]

    def _in_pixels(self, circles: Floats) -> Floats:
        circles[:, :SHARE] *= self.stride
        circles[:, X] += 0.25 * self.stride
        circles[:, Y] += 0.5 * self.stride
        return circles

    def hulls(self, image: Bytes, color: ColorModel) -> list[Floats]:
        """Rough convex outlines (m, 2), px, of what looks like the target, largest first; image as of `candidates`."""
        if not self.fits:
            return []
        return region_hulls(self._smooth_grid(image, color), self.stride, self.parameters)

    def _smooth_grid(self, image: Bytes, color: ColorModel) -> Scores:
        """Scores of the cells, each summed twice over 3 x 3 cells; beyond the picture the border repeats."""
        sample_grid(image, color.table, self.stride, self._grid)
        smooth: Scores = self._grid
        for _ in range(2):
            smooth = np.asarray(
                cv2.boxFilter(smooth, -1, (3, 3), normalize=False, borderType=cv2.BORDER_REPLICATE), np.int16
            )
        return smooth


@kernel(refcount=False)
def sample_grid(image: Bytes, table: npt.NDArray[np.int8], stride: int, grid: Scores) -> None:
    """Sum of the scores of two pixels in every cell of `stride` x `stride` pixels.

    Parameters
    ----------
    image : (h, w, channels) uint8
    table : (32768,) or (256,) int8
        See `ColorModel`.
    stride : int
        px.
    grid : (rows, columns) int16, written
    """
    half = stride // 2
    for i in range(grid.shape[0]):
        row = np.uintp(i * stride + half)
        for j in range(grid.shape[1]):
            total = 0
            for offset in (0, half):
                column = np.uintp(j * stride + offset)
                cell = np.uint32(image[row, column, 0])
                if table.size > 256:
                    g, r = np.uint32(image[row, column, 1]), np.uint32(image[row, column, 2])
                    cell = (
                        (cell >> np.uint32(3)) << np.uint32(10)
                        | (g >> np.uint32(3)) << np.uint32(5)
                        | r >> np.uint32(3)
                    )
                total += table[np.uintp(cell)]
            grid[i, j] = total


@kernel(refcount=False)
def find_edges(smooth: Scores, edges: Floats) -> int:
    """Boundary of the positive region of a smoothed grid.

    Parameters
    ----------
    smooth : (rows, columns) int16
    edges : (most, 4), written
        x, y and outward normal of each boundary point, cells; the normal is that of Sobel's gradient.

    Returns
    -------
    int
        How many there are.
    """
    height, width = smooth.shape
    count = 0
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            here, left, right = smooth[i, j], smooth[i, j - 1], smooth[i, j + 1]
            above, below = smooth[i - 1, j], smooth[i + 1, j]
            if here <= 0 or (left > 0 and right > 0 and above > 0 and below > 0):
                continue
            falling, rising = smooth[i + 1, j + 1] - smooth[i - 1, j - 1], smooth[i - 1, j + 1] - smooth[i + 1, j - 1]
            gx = 2.0 * (right - left) + (falling + rising)
            gy = 2.0 * (below - above) + (falling - rising)
            slope = math.sqrt(gx * gx + gy * gy)
            if slope > 0.0 and count < edges.shape[0]:
                nx, ny = -gx / slope, -gy / slope
                beyond = 8.0 * here / slope  # Sobel's stencil weighs 8: to where the score is 0
                if beyond > 1.0:
                    beyond = 1.0
                edges[count, 0], edges[count, 1] = j + beyond * nx, i + beyond * ny
                edges[count, 2], edges[count, 3] = nx, ny
                count += 1
    return count


class Accumulator:
    """Accumulator of the votes for centers, for circles whose radius lies in a range.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns of the grid.
    radii : tuple of int
        Least and largest radius, cells.
    fold : int
        Side of the square of cells that share one count of votes, a power of two.
    limits : SearchParameters

    Attributes
    ----------
    votes : ndarray of float32
        Weight of the votes for each cell, or each square of cells, to be a center.
    """

    def __init__(self, shape: tuple[int, ...], radii: tuple[int, int], fold: int, limits: SearchParameters) -> None:
        self._least_radius, self._fold, self._limits = radii[0], fold, limits
        self._shift = fold.bit_length() - 1
        self.votes = np.zeros([-(-cells // fold) for cells in shape], np.float32)
        distances = np.arange(radii[1] + 1)
        self._distances = distances + 0.5
        self._gaps = np.floor(limits.gap + limits.gap_growth * distances).astype(np.int64)
        self._confirmed = np.zeros(radii[1] + 3)

    def find_circles(self, smooth: Scores, edges: Floats) -> Floats:
        """Circles that the boundary votes for.

        Parameters
        ----------
        smooth : ndarray of shape (rows, columns), int16
        edges : ndarray of shape (n, 4), float64
            See `find_edges`.

        Returns
        -------
        ndarray of shape (k, 4), float64
            x, y, radius, cells; 0.
        """
        limits = self._limits
        self.count_votes(smooth, edges)
        peaks = pick_peaks(sum_votes(self.votes), limits.votes, limits.apart, max(limits.candidates // 2, 1))
        circles = np.zeros((len(peaks), 4))
        if len(peaks):
            circles[:, :RADIUS] = self._fold * (peaks + 0.5) - 0.5
            find_radii(edges, circles, self._confirmed, limits.aim_rough)
        return circles

    def count_votes(self, smooth: Scores, edges: Floats) -> None:
        """Write `votes`; see `find_circles`."""
        every = 1 + len(edges) // self._limits.voters
        weights = every / self._distances
        weights[: self._least_radius] = 0.0
        self.votes.fill(0.0)
        voters = edges if every == 1 else edges[::every].copy()
        vote(smooth, voters, weights, self._gaps, self._shift, self.votes)


@kernel(refcount=False)
def vote(
    smooth: Scores, edges: Floats, weights: Floats, gaps: npt.NDArray[np.int64], shift: int, votes: Singles
) -> None:
    """Add a weight along the inward normal of every boundary point, as long as the way is mostly target.

    Parameters
    ----------
    smooth : (rows, columns) int16
    edges : (n, 4)
        See `find_edges`.
    weights : (m,)
        Of a vote, by its distance in cells.
    gaps : (m,) int64
        Cells of background that are allowed up to that distance.
    shift : int
        Squares of ``2 ** shift`` cells a side share one count.
    votes : float32, written
    """
    height, width = smooth.shape
    for i in range(edges.shape[0]):
        x, y, nx, ny = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        foreign = 0
        for distance in range(1, weights.shape[0]):
            column, row = int(x - nx * distance + 0.5), int(y - ny * distance + 0.5)
            if column < 0 or row < 0 or column >= width or row >= height:
                break
            foreign += smooth[np.uintp(row), np.uintp(column)] <= 0
            if foreign > gaps[distance]:
                break
            if weights[distance] > 0.0:
                votes[np.uintp(row >> shift), np.uintp(column >> shift)] += weights[distance]


def region_hulls(smooth: Scores, stride: int, limits: SearchParameters) -> list[Floats]:
    """Find the regions of a grid of scores that are positive.

    Parameters
    ----------
    smooth : ndarray of shape (rows, columns), int16
        Scores.
    stride : int
        Size of a cell, px.
    limits : SearchParameters

    Returns
    -------
    list of ndarray of shape (m, 2), float64
        Hulls, px, largest first, in the order in which x turns to y.
    """
    contours, _ = cv2.findContours((smooth > 0).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    areas = [cv2.contourArea(contour) + 0.5 * len(contour) for contour in contours]
    order = sorted(range(len(contours)), key=lambda k: -areas[k])[: limits.candidates]
    found = []
    for k in order:
        if areas[k] < limits.region or len(contours[k]) < 3:
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
