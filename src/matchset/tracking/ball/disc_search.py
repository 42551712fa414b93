"""Where in a picture discs stand out from what is around them: `DiscSearch`.

A ball that was thrown is many radii from where it was expected, perhaps smeared, and its color may not tell it from the
picture. But about its size is known, and the color of its middle. The picture is read in cells, a quarter of the radius
wide, and of each the mean color of a square and of the ring around it (center-surround, Itti et al., 1998), by sums
over all cells above and left (Viola and Jones, 2001). A place is likelier the more both differ, and the less the
square's mean differs from the color that was seen. The maxima of that are where the network of discs is asked.

A picture costs no more than so many cells: of a larger window a part is read, the next part in the next picture.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.lab_cells import write_lab
from matchset.image.frame import channels_last
from matchset.numeric.jit import kernel
from matchset.tracking.motion import Gate

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Single = np.float32
Singles = npt.NDArray[np.float32]


class DiscSearchParameters(msgspec.Struct, frozen=True):
    """Which discs are looked at; chosen by hand.

    Parameters
    ----------
    reach : float
        Half the side of the window around where the target should be, half-widths for each frame that it was missed.
    radius_cells : float
        Radius in cells: more is finer and takes longer.
    middle, inner, outer : int
        Half the sides of the square whose mean color is read, and of the ring around it, cells.
    contrast : float
        Difference of both that is half as good as a large one, units of CIE Lab.
    lightness, chroma : float
        Standard deviations of a target's color, units of CIE Lab.
    apart : float
        Least distance of two discs, radii.
    most : int
        How many discs are looked at: each takes a look of the network or more.
    least : float
        Least merit of a disc, of 1.
    larger : float
        A lost target's size may be that of its lit part: the network is led from circles so many times as large.
    same : float
        Share of the half-width by which places that are the same may differ.
    cells : int
        How many cells of a picture are read at most while a target is lost: more finds it sooner and takes longer.
    again : int
        For how many pictures a place at which no ball was seen is not looked at again.
    """

    reach: float = 3.0
    radius_cells: float = 4.0
    middle: int = 2
    inner: int = 5
    outer: int = 7
    contrast: float = 10.0
    lightness: float = 15.0
    chroma: float = 10.0
    apart: float = 1.0
    most: int = 3
    least: float = 0.1
    larger: float = 1.3
    same: float = 0.3
    cells: int = 16000
    again: int = 8


@kernel(refcount=False)
def write_sums(image: Image, first: Floats, step: float, lab: Singles, sums: Floats) -> None:
    """Write the sums of the colors of all cells above and left of each corner.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1), uint8
    first : (2,), float64
        Left and top of the first cell, px.
    step : float
        Side of a cell, px; four pixels of each are read.
    lab : (3,), float32, written
        Working memory.
    sums : (rows + 1, columns + 1, 3), float64, written
        CIE Lab.
    """
    height, width, channels = image.shape
    middle, last = channels // 2, channels - 1
    quarter = np.float32(0.25)
    for column in range(sums.shape[1]):
        for k in range(3):
            sums[0, column, k] = 0.0
    for row in range(sums.shape[0] - 1):
        y = first[1] + step * row
        upper = min(max(int(y + 0.25 * step), 0), height - 1)
        lower = min(max(int(y + 0.75 * step), 0), height - 1)
        for k in range(3):
            sums[row + 1, 0, k] = 0.0
        a_sum = b_sum = l_sum = 0.0
        for column in range(sums.shape[1] - 1):
            x = first[0] + step * column
            left = min(max(int(x + 0.25 * step), 0), width - 1)
            right = min(max(int(x + 0.75 * step), 0), width - 1)
            p, q, r, s = image[upper, left], image[upper, right], image[lower, left], image[lower, right]
            blue = quarter * np.float32(np.int64(p[0]) + q[0] + r[0] + s[0])
            green = quarter * np.float32(np.int64(p[middle]) + q[middle] + r[middle] + s[middle])
            red = quarter * np.float32(np.int64(p[last]) + q[last] + r[last] + s[last])
            write_lab(blue, green, red, lab)
            l_sum, a_sum, b_sum = l_sum + lab[0], a_sum + lab[1], b_sum + lab[2]
            below, above = sums[row + 1, column + 1], sums[row, column + 1]
            below[0], below[1], below[2] = above[0] + l_sum, above[1] + a_sum, above[2] + b_sum


@kernel(refcount=False, entry=False)
def _mean(sums: Floats, row: int, column: int, half: int, out: Floats) -> int:
    """Write the sum of the colors of the cells of a square that are in the window; how many these are."""
    top, bottom = max(row - half, 0), min(row + half + 1, sums.shape[0] - 1)
    left, right = max(column - half, 0), min(column + half + 1, sums.shape[1] - 1)
    for k in range(3):
        out[k] = sums[bottom, right, k] - sums[top, right, k] - sums[bottom, left, k] + sums[top, left, k]
    return int((bottom - top) * (right - left))


@kernel(refcount=False)
def write_merits(sums: Floats, color: Floats, limits: Floats, own: Floats, merits: Singles) -> None:
    """Write how likely a disc is at each cell, 0 ... 1.

    Parameters
    ----------
    sums : (rows + 1, columns + 1, 3), float64
        See `write_sums`.
    color : (3,), float64
        Of the target, CIE Lab.
    limits : (6,), float64
        Middle, inner, outer, contrast, lightness and chroma: see `DiscSearchParameters`.
    own : (3, 3), float64, written
        Working memory.
    merits : (rows, columns), float32, written
    """
    middle, inner, outer = int(limits[0]), int(limits[1]), int(limits[2])
    disc, within, around = own[0], own[1], own[2]
    for row in range(merits.shape[0]):
        for column in range(merits.shape[1]):
            count = _mean(sums, row, column, middle, disc)
            off = ((disc[0] / count - color[0]) / limits[4]) ** 2
            off += ((disc[1] / count - color[1]) / limits[5]) ** 2 + ((disc[2] / count - color[2]) / limits[5]) ** 2
            merits[row, column] = 0.0
            if off > 6.0:  # exp(-3): no merit above the least is lost
                continue
            inside = _mean(sums, row, column, inner, within)
            ring = _mean(sums, row, column, outer, around) - inside
            if ring <= 0:
                continue
            squared = 0.0
            for k in range(3):
                squared += (disc[k] / count - (around[k] - within[k]) / ring) ** 2
            differs = math.sqrt(squared)
            merits[row, column] = math.exp(-0.5 * off) * differs / (differs + limits[3])


@kernel(refcount=False)
def pick_maxima(merits: Singles, reach: int, least: float, places: Floats) -> int:
    """Write the cells of most merit, row and column, best first, and forget those around each; how many there are."""
    rows, columns = merits.shape
    for k in range(places.shape[0]):
        best, at_row, at_column = np.float32(least), -1, -1
        for row in range(rows):
            for column in range(columns):
                if merits[row, column] > best:
                    best, at_row, at_column = merits[row, column], row, column
        if at_row < 0:
            return k
        places[k, 0], places[k, 1] = at_row, at_column
        for row in range(max(at_row - reach, 0), min(at_row + reach + 1, rows)):
            for column in range(max(at_column - reach, 0), min(at_column + reach + 1, columns)):
                merits[row, column] = 0.0
    return int(places.shape[0])


class DiscSearch:
    """Looks for discs about a place, in part after part of what is far off.

    Parameters
    ----------
    limits : DiscSearchParameters
    """

    def __init__(self, limits: DiscSearchParameters) -> None:
        self.limits = limits
        self._own, self._lab = np.empty((3, 3)), np.empty(3, np.float32)
        self._bounds = np.array(
            (limits.middle, limits.inner, limits.outer, limits.contrast, limits.lightness, limits.chroma), np.float64
        )
        self.forget()

    def forget(self) -> None:
        """Begin with the first part again, and know no place in vain."""
        self._parts, self._pictures = [0, 0], 0
        self._in_vain: list[tuple[int, Gate]] = []

    def begin_picture(self) -> None:
        """Count a picture: what was looked at in vain some pictures ago may be looked at again."""
        self._pictures += 1
        self._in_vain = [each for each in self._in_vain if self._pictures - each[0] <= self.limits.again]

    def are_same(self, first: Gate, second: Gate) -> bool:
        """Say whether two places are so near to each other that the network is led to the same disc from both."""
        larger, smaller = max(first.half_width, second.half_width), min(first.half_width, second.half_width)
        return first.distance(second) < self.limits.same * larger and larger < (1.0 + self.limits.same) * smaller

    def in_vain(self, place: Gate) -> None:
        """Note that no ball was seen at a place."""
        self._in_vain.append((self._pictures, place))

    def about(self, image: Image, color: Floats, place: Gate, reach: float) -> list[Gate]:
        """Find discs that stand out around a place, the likeliest first, in the part of the window whose turn it is.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ndarray of shape (3,), float64
            Color of the target's middle, CIE Lab.
        place : Gate
            Where it is looked for, and its size.
        reach : float
            Half the side of the window around that, px; the part in the picture counts.
        """
        step = max(place.half_width / self.limits.radius_cells, 1.0)
        height, width = image.shape[:2]
        left, top = max(place.x - reach, 0.0), max(place.y - reach, 0.0)
        columns = int((min(place.x + reach, width) - left) / step)
        rows = int((min(place.y + reach, height) - top) / step)
        if min(rows, columns) < 1:
            return []
        parts = math.ceil(rows * columns / self.limits.cells)
        if parts > 1:  # strips that overlap by a ring
            anywhere = reach >= max(height, width)  # by turns with a window near by: each has its own turns
            part = self._parts[anywhere] % parts
            self._parts[anywhere] += 1
            begin, end = rows * part // parts, rows * (part + 1) // parts
            begin, end = max(begin - self.limits.outer, 0), min(end + self.limits.outer, rows)
            top, rows = top + begin * step, end - begin
        return self._in_window(image, color, place, (left, top, step), (rows, columns))

    def _in_window(
        self, image: Image, color: Floats, place: Gate, grid: tuple[float, float, float], size: tuple[int, int]
    ) -> list[Gate]:
        """Discs in a window of cells."""
        limits, (left, top, step) = self.limits, grid
        sums, merits = np.empty((size[0] + 1, size[1] + 1, 3)), np.empty(size, np.float32)
        write_sums(channels_last(image), np.array((left, top)), step, self._lab, sums)
        write_merits(sums, color, self._bounds, self._own, merits)
        radius = place.half_width / step
        for _, known in self._in_vain:
            row, column = int((known.y - top) / step), int((known.x - left) / step)
            away = max(round(0.5 * radius), 1)
            merits[max(row - away, 0) : max(row + away + 1, 0), max(column - away, 0) : max(column + away + 1, 0)] = 0.0
        places = np.empty((limits.most, 2))
        count = pick_maxima(merits, math.ceil(limits.apart * radius), limits.least, places)
        return [
            Gate(left + (column + 0.5) * step - 0.5, top + (row + 0.5) * step - 0.5, place.half_width)
            for row, column in places[:count].tolist()
        ]
