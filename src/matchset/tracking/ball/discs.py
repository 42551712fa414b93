"""Which circles are the same, and the color of a disc's middle: `are_same`, `middle_pixels`, `middle_color`."""

import math

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.disc_network.lab_cells import write_lab
from matchset.image.disc_network.patch_format import Circle3
from matchset.image.disc_network.selection import median
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Image = npt.NDArray[np.uint8]

SIDE = 14  # format: pixels of a disc's middle along a side, at most
GRAY_CELLS = 256  # format: of the table of a gray model
NO_TABLE = np.empty(0, np.int8)  # format: of a model of another kind of picture


def are_same(first: Circle3, second: Circle3, share: float) -> bool:
    """Say whether two circles are so near to each other that the network is led to the same disc from both."""
    larger, smaller = max(first[2], second[2]), min(first[2], second[2])
    return math.dist(first[:2], second[:2]) < share * larger and larger < (1.0 + share) * smaller


def middle_pixels(image: Image, circle: Circle3, share: float) -> Image:
    """Pixels within a share of a disc's radius, evenly spread, at most some 150; of shape (n, channels)."""
    x, y, radius = circle
    count = int(min(SIDE, max(2.0 * share * radius, 1.0)))
    along = (np.arange(count) + 0.5) * (2.0 / count) - 1.0
    within = along[np.newaxis, :] ** 2 + along[:, np.newaxis] ** 2 <= 1.0
    across = np.broadcast_to(along[np.newaxis, :], within.shape)[within]
    down = np.broadcast_to(along[:, np.newaxis], within.shape)[within]
    columns = np.rint(x + share * radius * across).astype(np.int64)
    rows = np.rint(y + share * radius * down).astype(np.int64)
    height, width = image.shape[:2]
    seen = (columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)
    return np.asarray(image[rows[seen], columns[seen]], np.uint8)


def middle_color(image: Image, color: ColorModel, circle: Circle3, share: float) -> tuple[Floats, float] | None:
    """Median color of a disc's middle, and how much of it a color model knows; None if it is not in the picture.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    circle : (x, y, radius)
    share : float
        Of the radius, see `middle_pixels`.

    Returns
    -------
    ndarray of shape (3,), float64
        Of each channel of CIE Lab the median.
    float
        Share of the pixels whose score is above 0.
    """
    lab = np.zeros(3)
    of_table = color.table if color.channels == image.shape[2] else NO_TABLE
    known = _middle_color(image, np.array(circle), share, of_table, np.empty((4, SIDE * SIDE), np.float32), lab)
    return None if known < 0.0 else (lab, known)


@kernel(refcount=False)
def _middle_color(
    image: Image, circle: Floats, share: float, table: npt.NDArray[np.int8], values: Singles, lab: Floats
) -> float:
    """Write the median color of a disc's middle; the share of pixels that the table knows, -1 if none is seen.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1), uint8
    circle : (3,), float64
    share : float
    table : (32768,), (256,) or (0,), int8
    values : (4, 196), float32, written
        Working memory.
    lab : (3,), float64, written
    """
    x, y, reach = circle[0], circle[1], share * circle[2]
    count = int(min(SIDE, max(2.0 * reach, 1.0)))
    last = image.shape[2] - 1
    seen = known = 0
    for k in range(count):
        down = (k + 0.5) * (2.0 / count) - 1.0
        for j in range(count):
            across = (j + 0.5) * (2.0 / count) - 1.0
            column, row = round(x + reach * across), round(y + reach * down)
            inside = across * across + down * down <= 1.0
            if not (inside and 0 <= column < image.shape[1] and 0 <= row < image.shape[0]):
                continue
            pixel = image[row, column]
            blue, green, red = pixel[0], pixel[last // 2], pixel[last]
            write_lab(np.float32(blue), np.float32(green), np.float32(red), values[3])
            for channel in range(3):
                values[channel, seen] = values[3, channel]
            cell = np.int64(blue)
            if table.shape[0] > GRAY_CELLS:
                cell = np.int64(blue >> 3) << 10 | np.int64(green >> 3) << 5 | np.int64(red >> 3)
            known += table.shape[0] > 0 and table[cell] > 0
            seen += 1
    if seen == 0:
        return -1.0
    for channel in range(3):
        lab[channel] = median(values[channel, :seen])
    return known / seen
