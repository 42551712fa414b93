"""How likely each cell is a ball's, from sums of colors around it, in compiled code: `weigh_cells`."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Singles = npt.NDArray[np.float32]


class CellScales(NamedTuple):
    """What colors and scores are divided by.

    Attributes
    ----------
    middle, ring : float
        Cells of the square and of the ring around it.
    lightness, chroma : float
        Standard deviations of the ball's color, CIE Lab.
    contrast : float
        Difference of middle and ring that is half as good as a large one.
    table, full : float
        What a full difference of the color table's scores is worth, and how large that is.
    """

    middle: float
    ring: float
    lightness: float
    chroma: float
    contrast: float
    table: float
    full: float


LIGHTNESS = np.float32(100.0 / 255.0)  # format: of 8-bit Lab, whose lightness is scaled
ZERO = np.float32(128.0)  # format: of a signed number in 8 bits


@kernel(refcount=False)
def weigh_cells(
    colors: tuple[Singles, Singles, Singles],
    scores: tuple[Singles, Singles, Singles],
    own: Singles,
    scales: CellScales,
    merits: Singles,
    likeness: Singles,
) -> None:
    """Write the merit of each cell and its likeness to the ball's color, 0 ... 1.

    Parameters
    ----------
    colors : tuple of ndarray of shape (rows, columns, 3), float32
        Sums of 8-bit Lab over the middle, the inner and the outer square around each cell.
    scores : tuple of ndarray of shape (rows, columns) or (0, 0), float32
        The same of the color table's scores plus 128; none where it has nothing to say.
    own : (3,), float32
        Color of the ball, CIE Lab.
    scales : CellScales
    merits, likeness : (rows, columns), float32, written
    """
    middles, inners, outers = colors
    here, inside, outside = scores
    per_middle, per_ring = np.float32(1.0 / scales.middle), np.float32(1.0 / scales.ring)
    per_light, per_chroma = np.float32(1.0 / scales.lightness), np.float32(1.0 / scales.chroma)
    contrast, table, full = np.float32(scales.contrast), np.float32(scales.table), np.float32(scales.full)
    for row in range(merits.shape[0]):
        for column in range(merits.shape[1]):
            squared = apart = np.float32(0.0)
            for k in range(3):
                middle = middles[row, column, k] * per_middle
                away = middle - (outers[row, column, k] - inners[row, column, k]) * per_ring
                off = middle * LIGHTNESS if k == 0 else middle - ZERO
                away = away * LIGHTNESS if k == 0 else away
                off = (off - own[k]) * (per_light if k == 0 else per_chroma)
                squared += off * off
                apart += away * away
            alike = np.float32(math.exp(-0.5 * squared))
            apart = np.float32(math.sqrt(apart))
            merit = alike * (apart / (apart + contrast))
            if here.shape[0] > 0:
                score = here[row, column] * per_middle
                ring = (outside[row, column] - inside[row, column]) * per_ring
                merit = max(merit, (score - ring) * table / (np.float32(2.0) * full))
                alike = max(alike, (score - ZERO) / full)
            merits[row, column], likeness[row, column] = merit, alike
