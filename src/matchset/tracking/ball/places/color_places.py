"""Where in a picture discs of the ball's color stand out from what is around them: `places_of_color`.

A window of the picture is read in cells, a few to a radius. Of each cell the mean color of a square and of the ring
around it is taken (center-surround, Itti et al., 1998). A place is likelier the more both differ, and the less the
square's mean differs from the ball's; or by the same difference of the color table's scores. Its maxima are where the
network of discs is asked.

A picture costs no more than so many cells: of a larger window a part is read, the next part in the next picture.
"""

import math
from collections.abc import Sequence
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import WHITE, ColorModel
from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.places.color_places_kernel import CellScales, weigh_cells

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Image = npt.NDArray[np.uint8]


class ColorPlaceParameters(msgspec.Struct, frozen=True):
    """Which places are proposed; chosen by hand.

    Parameters
    ----------
    radius_cells : float
        Radius in cells: more is finer and takes longer.
    middle, inner, outer : int
        Sides of the square whose mean color is read, and of the ring around it, cells; odd.
    contrast : float
        Difference of both that is half as good as a large one, units of CIE Lab.
    lightness, chroma : float
        Standard deviations of a ball's color, units of CIE Lab.
    table : float
        What a full difference of the color table's scores is worth.
    most : int
        How many places are proposed.
    least : float
        Least merit of a place, of 1.
    larger : float
        The network is led from circles so many times as large as the radius that is looked for.
    cells : int
        How many cells of a picture are read at most: more finds a ball sooner and takes longer.
    alike : float
        Likeness of a cell to the ball's color, of 1, from which it is of one region with its neighbors.
    other_size, most_size : float
        The region itself is proposed, too, where its radius is so many times the one that is looked for: a ball that
        came nearer.
    """

    radius_cells: float = 2.0
    middle: int = 3
    inner: int = 5
    outer: int = 7
    contrast: float = 10.0
    lightness: float = 15.0
    chroma: float = 10.0
    table: float = 0.7
    most: int = 3
    least: float = 0.1
    larger: float = 1.15
    cells: int = 16_000
    alike: float = 0.5
    other_size: float = 1.5
    most_size: float = 3.5


SIGN = 0x80  # format: of 8 bits; turned round, a signed number is one more than 128 less
NO_SCORES = np.empty((0, 0), np.uint8)  # format: of a table that has nothing to say
NOTHING = np.empty((0, 0), np.float32)  # format: sums over those
COLOR = 3  # format: channels of a picture with color


def places_of_color(
    image: Image,
    known: tuple[Floats, ColorModel],
    around: tuple[Circle3, float],
    turn: int,
    covered: Sequence[Circle3],
    limits: ColorPlaceParameters,
) -> list[Circle3]:
    """Find places of a ball's color in a window, the likeliest first.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    known : (ndarray of shape (3,), float64, ColorModel)
        Median color of the ball, CIE Lab, and what its color is.
    around : ((x, y, radius), float)
        Middle of the window and the radius that is looked for; and half the window's side, px.
    turn : int
        Says which part of a large window is read.
    covered : sequence of (x, y, radius)
        Circles that are left out, px; at least a square of cells around each center.
    limits : ColorPlaceParameters

    Returns
    -------
    list of (x, y, radius)
        Circles from which the network is led, px.
    """
    (x, y, radius), reach = around
    height, width = image.shape[:2]
    step = max(radius / limits.radius_cells, 1.0)
    left, top = max(int(x - reach), 0), max(int(y - reach), 0)
    right, bottom = min(int(x + reach) + 1, width), min(int(y + reach) + 1, height)
    columns, rows = int((right - left) / step), int((bottom - top) / step)
    if columns < 2 or rows < 2:
        return []
    parts = math.ceil(columns * rows / limits.cells)
    if parts > 1:
        part, high, overlap = turn % parts, bottom - top, limits.outer / 2.0 * step
        bottom = int(min(top + high * (part + 1) / parts + overlap, height))
        top = int(max(top + high * part / parts - overlap, 0))
        rows = max(int((bottom - top) / step), 1)
    merits, likeness = _merits(image[top:bottom, left:right], (columns, rows), known, limits)
    across, down = (right - left) / columns, (bottom - top) / rows
    for at_x, at_y, around_px in covered:
        cells = max(round(around_px / across), limits.middle // 2)
        cv2.circle(merits, (int((at_x - left) / across), int((at_y - top) / down)), cells, 0.0, -1)
    maxima = _maxima(merits, limits)
    if not maxima:
        return []
    size = math.sqrt(across * down)
    found = _regions(likeness, maxima, radius / size, limits)
    found += [(*each, limits.larger * radius / size) for each in _one_of_each(maxima, found)]
    return [(left + (x + 0.5) * across - 0.5, top + (y + 0.5) * down - 0.5, cells * size) for x, y, cells in found]


def _merits(
    part: Image, size: tuple[int, int], known: tuple[Floats, ColorModel], limits: ColorPlaceParameters
) -> tuple[Singles, Singles]:
    """Merit of each cell and its likeness to the ball's color, 0 ... 1; `size`: columns and rows."""
    (own, color), (columns, rows) = known, size
    twice = cv2.resize(part, (2 * columns, 2 * rows), interpolation=cv2.INTER_NEAREST)
    mean = cv2.resize(twice, size, interpolation=cv2.INTER_AREA)
    cells = np.asarray(mean.reshape(rows, columns, -1), np.uint8)
    colored = cells if cells.shape[2] == COLOR else cv2.cvtColor(cells, cv2.COLOR_GRAY2BGR)
    knows = not (color.is_local or color.gray) and color.channels == cells.shape[2]
    scores = color.scores(cells).reshape(rows, columns).view(np.uint8) ^ np.uint8(SIGN) if knows else NO_SCORES
    scales = CellScales(
        limits.middle**2,
        limits.outer**2 - limits.inner**2,
        limits.lightness,
        limits.chroma,
        limits.contrast,
        limits.table,
        WHITE,
    )
    merits, likeness = np.empty((2, rows, columns), np.float32)
    sums = _sums(cv2.cvtColor(colored, cv2.COLOR_BGR2Lab), limits)
    weigh_cells(sums, _sums(scores, limits), own.astype(np.float32), scales, merits, likeness)
    return merits, likeness


def _sums(cells: Any, limits: ColorPlaceParameters) -> tuple[Singles, Singles, Singles]:
    """Sum over the middle, the inner and the outer square around each cell."""
    if not cells.size:
        return NOTHING, NOTHING, NOTHING
    middle, inner, outer = (
        cv2.boxFilter(cells, cv2.CV_32F, (side, side), normalize=False, borderType=cv2.BORDER_REPLICATE)
        for side in (limits.middle, limits.inner, limits.outer)
    )
    return middle, inner, outer


def _regions(
    likeness: Singles, maxima: list[tuple[int, int]], radius: float, limits: ColorPlaceParameters
) -> list[tuple[float, float, float]]:
    """Circles as large as the regions of the ball's color around maxima, where these are larger; cells."""
    _, labels, stats, middles = cv2.connectedComponentsWithStats(
        (likeness > limits.alike).astype(np.uint8), connectivity=4
    )
    found = list[tuple[float, float, float]]()
    for label in dict.fromkeys(int(labels[row, column]) for column, row in maxima):
        size = math.sqrt(float(stats[label, cv2.CC_STAT_AREA]) / math.pi)
        if label and limits.other_size < size / radius < limits.most_size:
            x, y = middles[label].tolist()
            found.append((x, y, size))
    return found


def _one_of_each(maxima: list[tuple[int, int]], regions: list[tuple[float, float, float]]) -> list[tuple[float, float]]:
    """Maxima of which no two are within one region: they are parts of it."""
    found = list[tuple[float, float]]()
    taken = set[int]()
    for x, y in maxima:
        around = [k for k, region in enumerate(regions) if math.dist((x, y), region[:2]) < region[2]]
        if not taken.intersection(around[:1]):
            found.append((float(x), float(y)))
        taken.update(around[:1])
    return found


def _maxima(merits: Singles, limits: ColorPlaceParameters) -> list[tuple[int, int]]:
    """Columns and rows of the cells of most merit, no two within a radius."""
    found = list[tuple[int, int]]()
    while len(found) < limits.most:
        _, most, _, (column, row) = cv2.minMaxLoc(merits)
        if most < limits.least:
            break
        found.append((column, row))
        cv2.circle(merits, (column, row), round(limits.radius_cells), 0.0, -1)
    return found
