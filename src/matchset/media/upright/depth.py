"""Pictures of more than eight bits, brought to eight: `DepthScaling`.

Cameras of 10, 12 and 14 bits store their numbers in 16: as they stand such pictures are nearly black.
"""

import cv2
import numpy as np
import numpy.typing as npt

DEPTHS = (10, 12, 14, 16)  # format: bits of the cameras that store 16
FULL = 16  # format: bits of the numbers in which they are stored
BRIGHTEST = 255.0  # format: of eight bits


def used_bits(image: npt.NDArray[np.uint16]) -> int:
    """How many bits a picture uses: 10, 12, 14 or 16, by its deepest value.

    Parameters
    ----------
    image : ndarray, uint16
    """
    deepest = int(image.max())
    return next(bits for bits in DEPTHS if deepest < 1 << bits)


def to_bytes(image: npt.NDArray[np.uint16], bits: int) -> npt.NDArray[np.uint8]:
    """Bring a picture to eight bits: 255 v / (2^bits - 1), rounded; what lies above is 255.

    Parameters
    ----------
    image : ndarray, uint16
    bits : int
        That it uses.

    Returns
    -------
    ndarray, uint8
    """
    return np.asarray(cv2.convertScaleAbs(image, alpha=BRIGHTEST / ((1 << bits) - 1)), np.uint8)


class DepthScaling:
    """Brings the pictures of a source to eight bits, all by the depth of the first one that has more.

    Attributes
    ----------
    bits : int
        That it uses; 0 as long as all pictures had eight.
    """

    def __init__(self) -> None:
        self.bits = self._deeper = 0

    def to_bytes(self, image: npt.NDArray[np.uint8] | npt.NDArray[np.uint16]) -> npt.NDArray[np.uint8]:
        """Bring a picture to eight bits; one that has eight is returned as it is."""
        if image.dtype == np.uint8:
            return np.asarray(image, np.uint8)
        deep = np.asarray(image, np.uint16)
        self.bits = self.bits or used_bits(deep)
        self._deeper += used_bits(deep) > self.bits
        return to_bytes(deep, self.bits)

    @property
    def notes(self) -> list[str]:
        """What is to be said of it, so far."""
        if self.bits in (0, FULL):
            return []
        words = f"pictures use {self.bits} of 16 bits, by the first one: they are scaled by {1 << FULL - self.bits}"
        more = f"; {self._deeper} brighter picture{'s are' if self._deeper > 1 else ' is'} cut off there"
        return [words + (more if self._deeper else "")]
