"""The picture around a circle in cells, reduced and in CIE Lab: `read_cells`.

A cell is a pixel, or the mean of several of a large circle, so that its radius is at most 20 cells. The conversion is
that of sRGB with the white of D65, by tables.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.patch_format import FARTHEST, LEAST_SIDE, NEAREST, ROOM, SIZE, Image
from matchset.numeric.jit import helper, kernel

Single = np.float32
Singles = npt.NDArray[np.float32]
Floats = npt.NDArray[np.float64]
Window = npt.NDArray[np.int64]

SIDE = 82  # geometry: cells along a side at most: 2 * 1.8 * 20 and the rims
RIM = 2.0  # geometry: how far from a place the cells are that it is read from, cells
MOST_TAPS = 3  # format: pixels of a cell along an axis that are read; of cells of more than two, two of them
EVEN_TAPS = 2  # format: see above
NODES = 4096  # format: of the table of the cube root
CUBE, SLOPE, KNEE = 0.008856, 7.787, 16.0 / 116.0  # format: of CIE Lab, where its cube root is a line
WHITE = np.array((0.950456, 1.0, 1.088754))  # format: X, Y, Z of D65
TO_XYZ = NODES * np.array(  # format: X, Y, Z of the channels of sRGB, in nodes
    ((0.412453, 0.212671, 0.019334), (0.357580, 0.715160, 0.119193), (0.180423, 0.072169, 0.950227))
)
FROM_RED, FROM_GREEN, FROM_BLUE = ((row / WHITE).astype(np.float32) for row in TO_XYZ)
"""Format: X, Y, Z of the channels of sRGB as shares of the white's, in nodes of the table."""

_SHARES = np.arange(256) / 255.0  # format: of gray levels
LINEAR = np.where(_SHARES <= 0.04045, _SHARES / 12.92, ((_SHARES + 0.055) / 1.055) ** 2.4).astype(np.float32)
"""Format: light of a channel in sRGB, 0 ... 1."""
_NODES = np.arange(NODES + 8) / NODES  # format: of the table of the cube root
CUBE_ROOT = np.where(_NODES > CUBE, np.cbrt(_NODES), SLOPE * _NODES + KNEE).astype(np.float32)
"""Format: what CIE Lab takes of a share of the white's light."""


@kernel(refcount=False, entry=False)
def window_of(height: int, width: int, circle: Floats, window: Window) -> bool:
    """Write where a picture is cut out around a circle: left, top, width, height, columns and rows of cells.

    Returns
    -------
    bool
        False if hardly anything of it is in the picture.
    """
    x, y, radius = circle[0], circle[1], circle[2]
    if not (abs(x) < 1e6 and abs(y) < 1e6 and radius < 1e6):
        return False
    left, top = max(math.floor(x - ROOM * radius) - 2, 0), max(math.floor(y - ROOM * radius) - 2, 0)
    wide = min(math.ceil(x + ROOM * radius) + 3, width) - left
    high = min(math.ceil(y + ROOM * radius) + 3, height) - top
    if wide < LEAST_SIDE or high < LEAST_SIDE:
        return False
    scale = min(SIZE / radius, 1.0)
    window[0], window[1], window[2], window[3] = left, top, wide, high
    window[4], window[5] = wide, high
    if scale < 1.0:
        window[4], window[5] = max(round(scale * wide), 2), max(round(scale * high), 2)
    return True


@kernel(refcount=False, entry=False)
def _taps(start: int, length: int, cells: int, where: Window, share: Singles) -> int:
    """Write which pixels along an axis are read for each cell, with their shares; how many at most."""
    size = length / cells
    most = 1
    for cell in range(cells):
        low, high = cell * size, (cell + 1) * size
        count = 0
        if size > EVEN_TAPS:
            for k in range(EVEN_TAPS):
                where[cell, k] = start + int(low + (k + 0.5) * size / EVEN_TAPS)
                share[cell, k] = 1.0 / EVEN_TAPS
            count = EVEN_TAPS
        else:
            pixel = int(low)
            while pixel < high - 1e-6 and count < MOST_TAPS:
                where[cell, count] = start + min(pixel, length - 1)
                share[cell, count] = (min(pixel + 1.0, high) - max(float(pixel), low)) / size
                count += 1
                pixel += 1
        for k in range(count, MOST_TAPS):
            where[cell, k], share[cell, k] = where[cell, 0], 0.0
        most = max(most, count)
    return most


@helper
def _root(at: Single) -> Single:
    """Cube root of a share of the white's light, in nodes, or the line that CIE Lab takes near black."""
    below = np.uint64(at)  # without a sign no index is checked for one
    part = np.float32(at - np.float32(below))
    return np.float32(CUBE_ROOT[below] + part * (CUBE_ROOT[below + np.uint64(1)] - CUBE_ROOT[below]))


@helper
def write_lab(blue: Single, green: Single, red: Single, out: Singles) -> None:
    """Write CIE Lab of a color, 0 ... 255, L 0 ... 100."""
    half = np.float32(0.5)
    b, g, r = LINEAR[np.uint64(blue + half)], LINEAR[np.uint64(green + half)], LINEAR[np.uint64(red + half)]
    y = FROM_RED[1] * r + FROM_GREEN[1] * g + FROM_BLUE[1] * b
    middle = _root(y)
    out[0] = np.float32(116.0) * middle - np.float32(16.0)
    x = FROM_RED[0] * r + FROM_GREEN[0] * g + FROM_BLUE[0] * b
    z = FROM_RED[2] * r + FROM_GREEN[2] * g + FROM_BLUE[2] * b
    out[1], out[2] = np.float32(500.0) * (_root(x) - middle), np.float32(200.0) * (middle - _root(z))


@helper
def _is_whole(image: Image, window: Window) -> bool:
    """Whether a window does not end at a border of the picture."""
    right, bottom = window[0] + window[2], window[1] + window[3]
    return bool(window[0] > 0 and window[1] > 0 and right < image.shape[1] and bottom < image.shape[0])


@kernel(refcount=False, entry=False)
def read_cells(image: Image, circle: Floats, window: Window, where: Window, share: Singles, cells: Singles) -> None:
    """Write the cells of a window of a picture, CIE Lab, that a patch of a circle is read from.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1), uint8
        BGR or gray.
    circle : (3,), float64
    window : (6,), int64
        See `window_of`.
    where, share : (2, SIDE, MOST_TAPS), int64 and float32, written
        Which pixels are read.
    cells : (SIDE, SIDE, 3), float32, written
    """
    last = image.shape[2] - 1
    middle = last // 2
    across = _taps(window[0], window[2], window[4], where[0], share[0])
    down = _taps(window[1], window[3], window[5], where[1], share[1])
    scale = window[4] / window[2]
    x, y = scale * (circle[0] - window[0] + 0.5) - 0.5, scale * (circle[1] - window[1] + 0.5) - 0.5
    least, most = max(NEAREST * scale * circle[2] - RIM, 0.0), FARTHEST * scale * circle[2] + RIM
    if not _is_whole(image, window):  # places outside are read at the border
        least, most = 0.0, 4.0 * SIDE
    for row in range(window[5]):
        rows, row_shares = where[1, row], share[1, row]
        for column in range(window[4]):
            away = (column - x) * (column - x) + (row - y) * (row - y)
            if away > most * most or away < least * least:
                continue
            columns, column_shares = where[0, column], share[0, column]
            blue = green = red = np.float32(0.0)
            for k in range(down):
                for m in range(across):
                    part = row_shares[k] * column_shares[m]
                    pixel = image[rows[k], columns[m]]
                    blue += part * np.float32(pixel[0])
                    green += part * np.float32(pixel[middle])
                    red += part * np.float32(pixel[last])
            write_lab(blue, green, red, cells[row, column])
