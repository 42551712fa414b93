"""Printed tags on square cards, and the circle inscribed in a card: what tag systems are compared by."""

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.common.start import Circle3


class Card(msgspec.Struct, frozen=True):
    """A card with a tag and a white rim around it.

    Parameters
    ----------
    dictionary : int
        OpenCV's number of the tag's family.
    cells : int
        Cells on a side of the black square, its border included; the rim is one cell wide.
    """

    dictionary: int
    cells: int

    def picture(self, pixels: int) -> npt.NDArray[np.uint8]:
        """Draw tag 0 with its rim, gray, about that many pixels wide."""
        cell = max(pixels // (self.cells + 2), 1)
        tag = cv2.aruco.generateImageMarker(
            cv2.aruco.getPredefinedDictionary(self.dictionary), 0, cell * self.cells, borderBits=1
        )
        return np.pad(np.asarray(tag, np.uint8), cell, constant_values=255)

    def circle(self, corners: npt.ArrayLike) -> Circle3:
        """Circle inscribed in the card, from the corners of the black square, (4, 2), px."""
        square = np.asarray(corners, np.float64)
        side = float(np.linalg.norm(square - np.roll(square, 1, axis=0), axis=1).mean())
        x, y = square.mean(axis=0).tolist()
        return x, y, side * (self.cells + 2) / (2.0 * self.cells)


APRIL = Card(cv2.aruco.DICT_APRILTAG_36h11, 8)
ARUCO = Card(cv2.aruco.DICT_4X4_50, 6)
