"""The rotated rectangle.

The tracker follows the state (x, y, u1, u2, h): center, the vector from it to the middle of the side that lies along
the angle, and half the height; all in px, so that a turn is as smooth as a shift.
"""

import math
from collections.abc import Callable
from typing import ClassVar

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import are_finite
from matchset.numeric.jit import kernel
from matchset.shapes.described import Described
from matchset.shapes.linear_outline import along_sides

Floats = npt.NDArray[np.float64]


@kernel
def _trace(state: Floats, places: Floats, outline: Floats) -> None:
    """Outline of the state at places (.., .., a, b, na, nb): a u + b v and the normal there; see `Shape.trace`."""
    x, y, u1, u2, h = state[0], state[1], state[2], state[3], state[4]
    half = math.sqrt(u1 * u1 + u2 * u2)
    unit = 1.0 / max(half, 1e-12)
    c, s = unit * u1, unit * u2
    for line in range(outline.shape[0]):
        i = np.uintp(line)
        a, b, na, nb = places[i, 2], places[i, 3], places[i, 4], places[i, 5]
        nx, ny = na * c - nb * s, na * s + nb * c
        outline[i, 0], outline[i, 1] = x + a * u1 - b * h * s, y + a * u2 + b * h * c
        outline[i, 2], outline[i, 3], outline[i, 4], outline[i, 5] = nx, ny, nx, ny
        turn = nb * a - na * b * h * unit  # along the normal, per px by which the end of u moves across u
        outline[i, 6] = na * a * c - turn * s
        outline[i, 7] = na * a * s + turn * c
        outline[i, 8] = nb * b


@kernel
def _half_width(state: Floats) -> float:
    """Half the width of the square of equal area, px, or of the narrow side, whichever counts."""
    half, h = math.sqrt(state[2] * state[2] + state[3] * state[3]), state[4]
    if h <= 0.0:
        return 0.0
    return float(min(math.sqrt(half * h), 2.0 * min(half, h)))


class Rectangle(Described, msgspec.Struct, frozen=True):
    """A rectangle in the picture, turned by any angle.

    Parameters
    ----------
    x, y : float
        Center, px.
    width, height : float
        Lengths of the sides along the angle and across it, px, greater than 0.
    angle : float
        From +x toward +y to the sides of length `width`, rad. Between -pi/2 and pi/2 at first sight; then it goes on
        without jumps, and each side keeps its name.

    Raises
    ------
    ValueError
        If a number is not finite or a side is not positive.
    """

    x: float
    y: float
    width: float
    height: float
    angle: float

    parameters: ClassVar[tuple[str, ...]] = ("x", "y", "width", "height", "angle")

    def __post_init__(self) -> None:
        if not (
            are_finite(self.x, self.y, self.width, self.height, self.angle) and self.width > 0.0 and self.height > 0.0
        ):
            raise ValueError(f"a rectangle needs finite numbers and positive sides, got {self}")

    @property
    def state(self) -> Floats:
        """State that the tracker follows: x, y, u1, u2, h, (5,)."""
        half = 0.5 * self.width
        return np.array([self.x, self.y, half * math.cos(self.angle), half * math.sin(self.angle), 0.5 * self.height])

    @property
    def corners(self) -> Floats:
        """Corners, (4, 2), px: the ends of u - v, u + v, -u + v, -u - v, with u along the angle and v across it."""
        x, y, u1, u2, h = self.state.tolist()
        c, s = math.cos(self.angle), math.sin(self.angle)
        signs = np.array([(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)])
        return np.asarray(np.array([x, y]) + signs @ np.array([[u1, u2], [-h * s, h * c]]))

    @classmethod
    def from_state(cls, state: Floats, near: "Rectangle | None" = None) -> "Rectangle":
        """Rectangle of a state, ValueError if it is none; its angle, within whole turns, nearest to that of `near`."""
        x, y, u1, u2, h = state.tolist()
        angle = math.atan2(u2, u1)
        if near is not None:
            angle += 2.0 * math.pi * round((near.angle - angle) / (2.0 * math.pi))
        return cls(x, y, 2.0 * math.hypot(u1, u2), 2.0 * h, angle)

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Floats | None = None) -> "Rectangle":
        """Rectangle of a center and half-width, px: a square, or with the proportions and direction of a state."""
        size = 0.0 if like is None else _half_width(like)
        if like is None or size <= 0.0:
            return cls(x, y, 2.0 * radius, 2.0 * radius, 0.0)
        return cls.from_state(np.array([x, y, *(radius / size * like[2:])]))

    @classmethod
    def from_hull(cls, hull: Floats) -> "list[Rectangle]":
        """Smallest rectangle around a region, (m, 2) px."""
        (x, y), (width, height), degrees = cv2.minAreaRect(hull.astype(np.float32))
        if width <= 0.0 or height <= 0.0:
            return []
        angle = math.radians(degrees)
        if height > width:
            width, height, angle = height, width, angle + 0.5 * math.pi
        angle -= math.pi * round(angle / math.pi)
        return [cls(float(x), float(y), float(width), float(height), angle)]

    @staticmethod
    def nearest(state: Floats, reference: Floats) -> Floats:
        """Of the four states with the same outline the one nearest to a reference."""
        x, y, u1, u2, h = state.tolist()
        half = max(math.hypot(u1, u2), 1e-12)
        v1, v2 = -u2 / half * h, u1 / half * h
        equal = [(u1, u2, h), (-u1, -u2, h), (v1, v2, half), (-v1, -v2, half)]
        best = min(equal, key=lambda each: math.dist(each, reference[2:].tolist()))
        return np.array([x, y, *best])

    @property
    def slopes(self) -> Floats:
        """Derivative of the parameters by the state, (5, 5)."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.array(
            [
                (1.0, 0.0, 0.0, 0.0, 0.0),
                (0.0, 1.0, 0.0, 0.0, 0.0),
                (0.0, 0.0, 2.0 * c, 2.0 * s, 0.0),
                (0.0, 0.0, 0.0, 0.0, 2.0),
                (0.0, 0.0, -2.0 * s / self.width, 2.0 * c / self.width, 0.0),
            ]
        )

    @staticmethod
    def places(n: int) -> Floats:
        """Tell `trace` of n places: angle as (cos, sin), place and normal in a square of half-width 1."""
        square = np.array([(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)])
        points, directions, _ = along_sides(square, n)
        around = points / np.hypot(points[:, 0], points[:, 1])[:, np.newaxis]
        return np.column_stack((around, points, directions[:, 1], -directions[:, 0]))

    trace: ClassVar[Callable[[Floats, Floats, Floats], None]] = staticmethod(_trace)
    half_width: ClassVar[Callable[[Floats], float]] = staticmethod(_half_width)
