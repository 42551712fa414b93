"""What becomes of a camera's intrinsics when its pictures are turned, mirrored or resampled."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.media.upright.orientation import Orientation

Floats = npt.NDArray[np.float64]
Size = tuple[int, int]
# geometry: places of the numbers of `lens.INTRINSICS` that belong to x and y; p2 is the coefficient of x, p1 that of y
FOCAL, CENTER, TANGENTIAL = (0, 1), (2, 3), (7, 6)


class ChangedPicture(NamedTuple):
    """A linear change of the intrinsics, q' = A q + b.

    Attributes
    ----------
    size : tuple of int
        Width and height of the changed picture, px.
    matrix : ndarray of shape (9, 9)
        A.
    shift : ndarray of shape (9,)
        b.
    """

    size: Size
    matrix: Floats
    shift: Floats

    def intrinsics(self, before: Floats) -> list[float]:
        """Return the intrinsics, (9,), of the changed picture."""
        return [float(value) for value in self.matrix @ before + self.shift]

    def covariance(self, before: Floats) -> tuple[tuple[float, ...], ...]:
        """Return their covariance, (9, 9): A C A^T."""
        after = self.matrix @ before @ self.matrix.T
        return tuple(tuple(map(float, row)) for row in 0.5 * (after + after.T))


def in_orientation(size: Size, orientation: Orientation) -> ChangedPicture:
    """Change of the intrinsics when every picture is put into another orientation.

    A pixel at (x, y) comes to x' = a x + c y, y' = b x + d y, and is moved by the size where that is negative. So does
    the principal point; so do the tangential coefficients (p2, p1), without the move. Focal lengths change places with
    the axes, radial coefficients stay.

    Parameters
    ----------
    size : tuple of int
        Width and height of the pictures before, px.
    orientation : Orientation
    """
    turn = np.array([[orientation.a, orientation.c], [orientation.b, orientation.d]], np.float64)
    width, height = size[::-1] if orientation.transposed else size
    matrix, shift = np.eye(9), np.zeros(9)
    for places, block in ((FOCAL, np.abs(turn)), (CENTER, turn), (TANGENTIAL, turn)):
        matrix[np.ix_(places, places)] = block
    last = np.array([width - 1.0, height - 1.0])
    shift[list(CENTER)] = np.where(turn.sum(axis=1) < 0.0, last, 0.0)
    return ChangedPicture((width, height), matrix, shift)


def resampled(size: Size, wanted: Size) -> ChangedPicture:
    """Change of the intrinsics when every picture is resampled to another size, whole.

    A pixel at x comes to x' = s (x + 1/2) - 1/2 with s = w' / w: so does the principal point; f' = s f.

    Parameters
    ----------
    size, wanted : tuple of int
        Width and height of the pictures before and after, px.
    """
    matrix, shift = np.eye(9), np.zeros(9)
    for axis, (before, after) in enumerate(zip(size, wanted, strict=True)):
        scale = after / before
        matrix[FOCAL[axis], FOCAL[axis]] = matrix[CENTER[axis], CENTER[axis]] = scale
        shift[CENTER[axis]] = 0.5 * (scale - 1.0)
    return ChangedPicture(wanted, matrix, shift)
