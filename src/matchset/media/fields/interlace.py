"""Whether pictures are interlaced, and which of their fields comes first, by what moves in them: `FieldEvidence`.

Rows of two fields are laid into one another, and the comb that motion makes there is measured: of the fields of one
frame, of a frame's even rows with the odd rows of the frame before, and the other way around. A comb is the higher the
longer the time between its fields, so

| | within a frame | odd rows, then the next even rows | even rows, then the next odd rows |
| --- | --- | --- | --- |
| progressive | 0 | 1 | 1 |
| interlaced, even rows first | 1/2 | 1/2 | 3/2 |
| interlaced, odd rows first | 1/2 | 3/2 | 1/2 |

frame periods. Fine detail and noise are in all three alike, and are not in their differences.
"""

from typing import Literal

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

Fields = Literal["frames", "top", "bottom"]
Samples = npt.NDArray[np.float32]

GREEN = 1  # format: channel of BGR that is most of the brightness
BLOCK = 8  # format: rows of a field, and columns that are looked at, which move together or not
TINY = 1e-9
LEAST_ROWS = 2 * BLOCK + 2  # format: smaller pictures say nothing


class InterlaceParameters(msgspec.Struct, frozen=True):
    """When pictures are taken for interlaced.

    Chosen on rendered clips and on real ones that are progressive (docs/decisions/145-half-frames.md);
    `tests/media/fields/test_interlace.py` would show a change.

    Parameters
    ----------
    columns : int
        How many columns of a picture are looked at. More: surer of small things; slower.
    motion : float
        A pixel moves if it differs from that of the frame before by so many times the median difference ...
    least_motion : float
        ... and by so many gray levels more.
    least_blocks : int
        Pairs of frames in which fewer pixels move say nothing.
    least_pairs : int
        How many pairs of frames must say something.
    sure : float
        How many standard errors the difference between the two orders, or the comb of one frame, must be from nothing.
    interlaced : float
        Difference of the two orders, in combs of one frame period: 1 of interlaced pictures over 1/2, 0 of others over
        1. From this ratio on pictures are interlaced.
    progressive : float
        Up to this ratio they are not; what lies between is not decided.
    most_frames : int
        Frames of a file after which it is left undecided.
    """

    columns: int = 160
    motion: float = 2.0
    least_motion: float = 4.0
    least_blocks: int = 3
    least_pairs: int = 6
    sure: float = 5.0
    interlaced: float = 0.8
    progressive: float = 0.2
    most_frames: int = 150


DEFAULT = InterlaceParameters()


class FieldEvidence:
    """Collects what successive frames say.

    Parameters
    ----------
    parameters : InterlaceParameters, optional

    Attributes
    ----------
    pairs : int
        How many pairs of frames have said something.
    """

    def __init__(self, parameters: InterlaceParameters = DEFAULT) -> None:
        self.parameters, self.pairs = parameters, 0
        self._before: Samples | None = None
        self._sums = np.zeros(2)
        self._products = np.zeros((2, 2))

    def add(self, image: npt.NDArray[np.uint8]) -> None:
        """Look at the next frame, (h, w, 3) or (h, w), uint8."""
        here, before = _smoothed(image, self.parameters.columns), self._before
        self._before = here
        if before is None or before.shape != here.shape or min(here.shape) < LEAST_ROWS:
            return
        found = self._combs(before, here)
        if found is not None:
            self.pairs += 1
            self._sums += found
            self._products += np.outer(found, found)

    def _combs(self, before: Samples, here: Samples) -> npt.NDArray[np.float64] | None:
        """By how much one order combs less than the other, and both more than one frame; None where nothing moves.

        As shares of both: a pair of frames with a field that is missing or torn counts no more than another.
        """
        limits = self.parameters
        even, odd, even_before, odd_before = here[0::2], here[1::2], before[0::2], before[1::2]
        changed = _of_blocks(np.abs(odd - odd_before) + np.abs(even - even_before))
        moves = changed > limits.motion * float(np.median(changed)) + limits.least_motion
        if int(np.count_nonzero(moves)) < limits.least_blocks:
            return None
        one = 0.5 * (_comb(even, odd, moves) + _comb(even_before, odd_before, moves))
        top, bottom = _comb(even, odd_before, moves), _comb(even_before, odd, moves)
        found = np.array((bottom - top, 0.5 * (top + bottom) - one))
        return found / max(float(np.abs(found).sum()), TINY)

    @property
    def verdict(self) -> Fields | None:
        """Which field comes first, or "frames" of pictures that are not interlaced; None while that is not sure."""
        limits, n = self.parameters, self.pairs
        if n < limits.least_pairs:
            return None
        order, comb = (self._sums / n).tolist()
        spread = np.sqrt(np.maximum(np.diag(self._products) / n - (self._sums / n) ** 2, 0.0) / (n - 1))
        if abs(order) > limits.interlaced * comb and abs(order) > limits.sure * spread[0]:
            return "top" if order > 0.0 else "bottom"
        if abs(order) < limits.progressive * comb and comb > limits.sure * spread[1]:
            return "frames"
        return None


def _smoothed(image: npt.NDArray[np.uint8], columns: int) -> Samples:
    """Rows of a picture, an even number that makes whole blocks, each in so many means of its pixels."""
    plane = image[..., GREEN] if image.ndim == 3 else image
    height = (len(plane) - 2) // (2 * BLOCK) * 2 * BLOCK + 2
    wide = min(columns, plane.shape[1]) // BLOCK * BLOCK
    if height < LEAST_ROWS or wide < LEAST_ROWS:
        return np.zeros((0, 0), np.float32)
    small = cv2.resize(np.ascontiguousarray(plane[:height]), (wide, height), interpolation=cv2.INTER_AREA)
    return small.astype(np.float32)


def _of_blocks(values: Samples) -> Samples:
    """Means of blocks of rows of a field; the last one has no field below and is left out."""
    rows, columns = (len(values) - 1) // BLOCK, values.shape[1] // BLOCK
    means: Samples = values[: rows * BLOCK].reshape(rows, BLOCK, columns, BLOCK).mean(axis=(1, 3))
    return means


def _comb(even: Samples, odd: Samples, moves: npt.NDArray[np.bool_]) -> float:
    """Height of the comb of even rows with the odd rows between them, in the blocks that move; summed."""
    comb = np.zeros_like(even)
    comb[:-1] = np.abs(even[:-1] + even[1:] - 2.0 * odd[:-1])
    return float(_of_blocks(comb)[moves].sum())
