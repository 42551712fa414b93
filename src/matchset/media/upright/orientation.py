"""The eight ways in which a picture may lie: turned by quarters, mirrored or not (`Orientation`)."""

from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

QUARTER = 90  # geometry: degrees of a quarter turn


class Orientation(NamedTuple):
    """Where the pixels of a stored picture are shown: x' = a x + c y, y' = b x + d y, and moved into the picture.

    The letters are those of the display matrix of MP4 (ISO/IEC 14496-12, 8.3.2); each is -1, 0 or 1.
    """

    a: int = 1
    b: int = 0
    c: int = 0
    d: int = 1

    @classmethod
    def of_turn(cls, degrees: int, mirror: bool = False) -> "Orientation":
        """Orientation of a picture that is turned clockwise, then mirrored.

        Parameters
        ----------
        degrees : int
            A multiple of 90.
        mirror : bool
            Whether left and right are swapped, after the turn.
        """
        turned = TURNS[degrees // QUARTER % len(TURNS)]
        return turned.then(MIRRORED) if mirror else turned

    @classmethod
    def of_matrix(cls, matrix: tuple[int, int, int, int]) -> "Orientation | None":
        """Orientation of a display matrix a, b, c, d of any scale; None if it turns by no quarters, or is degenerate.

        Parameters
        ----------
        matrix : tuple of 4 int
        """
        largest = max(map(abs, matrix))
        signs = [0 if abs(value) * FINEST <= largest else value // abs(value) for value in matrix]
        found = cls(*signs)
        return found if found in ALL else None

    @property
    def transposed(self) -> bool:
        """Whether rows become columns."""
        return self.a == 0

    def then(self, later: "Orientation") -> "Orientation":
        """Orientation of a picture that is put into this one, and then into another one."""
        return Orientation(
            later.a * self.a + later.c * self.b,
            later.b * self.a + later.d * self.b,
            later.a * self.c + later.c * self.d,
            later.b * self.c + later.d * self.d,
        )

    def apply(self, image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
        """Put a picture into this orientation.

        Parameters
        ----------
        image : ndarray of shape (h, w) or (h, w, 3)

        Returns
        -------
        ndarray
            The same picture where nothing is to be done, otherwise another one.
        """
        if self == AS_STORED:
            return image
        shown = cv2.transpose(image) if self.transposed else image
        swapped = self.a + self.c < 0, self.b + self.d < 0  # left and right, top and bottom
        code = {(True, True): -1, (True, False): 1, (False, True): 0}.get(swapped)
        return np.asarray(shown if code is None else cv2.flip(shown, code), np.uint8)


FINEST = 1000  # geometry: of a display matrix; what is this many times less than its largest number is rounding
AS_STORED, MIRRORED = Orientation(), Orientation(a=-1)
TURNS = (AS_STORED, Orientation(0, 1, -1, 0), Orientation(-1, 0, 0, -1), Orientation(0, -1, 1, 0))
ALL = frozenset(each.then(other) for each in TURNS for other in (AS_STORED, MIRRORED))


def check_turn(degrees: int, name: str = "turn") -> None:
    """Refuse a turn that is not 0, 90, 180 or 270 (ValueError)."""
    if isinstance(degrees, bool) or degrees not in (0, 90, 180, 270):
        raise ValueError(f"{name} must be 0, 90, 180 or 270 degrees, clockwise, got {degrees!r}")
