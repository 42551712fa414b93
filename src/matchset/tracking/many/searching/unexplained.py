"""How much of a picture has the color of the balls and is none that is known: `unexplained`.

Pixels of a coarse grid are looked up in the color table. Where their number has not grown
since the picture was searched, nothing new has come, and no search is due.
"""

import functools

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.numeric.jit import collection_paused, kernel
from matchset.tracking.ball.discs import GRAY_CELLS

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


def unexplained(image: Image, color: ColorModel, known: Floats, step: int) -> int:
    """Count the pixels of a grid that have the target's color and are in no circle that is known.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    known : ndarray of shape (n, 3), float64
        Circles, px.
    step : int
        Of the grid, px.
    """
    return int(_unexplained(image, color.table, known, step))


@functools.cache
@collection_paused()
def precompile_unexplained() -> None:
    """Compile it before a picture waits for it."""
    _unexplained(np.zeros((1, 1, 3), np.uint8), np.zeros(1, np.int8), np.zeros((0, 3)), 1)


@kernel(refcount=False)
def _unexplained(image: Image, table: npt.NDArray[np.int8], known: Floats, step: int) -> int:
    """Count the pixels of a grid with a score above 0 outside of all circles.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1), uint8
    table : (32768,) or (256,), int8
    known : (n, 3), float64
    step : int
    """
    last = image.shape[2] - 1
    found = 0
    for row in range(step // 2, image.shape[0], step):
        for column in range(step // 2, image.shape[1], step):
            pixel = image[row, column]
            cell = np.int64(pixel[0])
            if table.shape[0] > GRAY_CELLS:
                cell = np.int64(cell >> 3) << 10 | np.int64(pixel[last // 2] >> 3) << 5 | np.int64(pixel[last] >> 3)
            if table[cell] <= 0:
                continue
            is_free = True
            for k in range(known.shape[0]):
                x, y = column - known[k, 0], row - known[k, 1]
                if x * x + y * y < known[k, 2] * known[k, 2]:
                    is_free = False
                    break
            found += is_free
    return found
