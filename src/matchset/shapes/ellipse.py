"""The ellipse.

The tracker follows the state (x, y, m11, m12, m22) of ``p = center + M (cos t, sin t)`` with the symmetric matrix M. It
is as well-behaved at a circle as anywhere: no angle is in it. Semi-axes and angle are M's eigenvalues and eigenvectors.
"""

import math
from collections.abc import Callable
from typing import ClassVar

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import are_finite
from matchset.shapes import linear_outline as linear
from matchset.shapes.described import Described

Floats = npt.NDArray[np.float64]


class EllipseParameters(msgspec.Struct, frozen=True):
    """How the angle of an ellipse behaves where it is almost a circle.

    Chosen by hand; `tests/shapes/test_found_and_followed.py` would show a change.

    Parameters
    ----------
    round_px : float
        Where half the difference of the semi-axes is this small, px, the angle follows a measured change by half.
    least_difference_px : float
        Least difference of the semi-axes, px, by which the angle's covariance is computed.
    """

    round_px: float = 0.2
    least_difference_px: float = 0.1


DEFAULT = EllipseParameters()


class Ellipse(Described, msgspec.Struct, frozen=True):
    """An ellipse in the picture.

    Parameters
    ----------
    x, y : float
        Center, px.
    a, b : float
        Semi-axes, px, greater than 0. At first sight a >= b; later each keeps its name, whichever is longer.
    angle : float
        From +x toward +y to the a axis, rad. Between -pi/2 and pi/2 at first sight; then it goes on without jumps.

    Raises
    ------
    ValueError
        If a number is not finite or a semi-axis is not positive.
    """

    x: float
    y: float
    a: float
    b: float
    angle: float

    parameters: ClassVar[tuple[str, ...]] = ("x", "y", "a", "b", "angle")

    def __post_init__(self) -> None:
        if not (are_finite(self.x, self.y, self.a, self.b, self.angle) and self.a > 0.0 and self.b > 0.0):
            raise ValueError(f"an ellipse needs finite numbers and positive semi-axes, got {self}")

    @property
    def bbox(self) -> tuple[float, float, float, float]:
        """Least upright box around it: left, top, right, bottom, px; pixel centers are at integers."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        wide, high = math.hypot(self.a * c, self.b * s), math.hypot(self.a * s, self.b * c)
        return self.x - wide, self.y - high, self.x + wide, self.y + high

    @property
    def state(self) -> Floats:
        """State that the tracker follows: x, y, m11, m12, m22, (5,)."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        a, b = self.a, self.b
        return np.array([self.x, self.y, a * c * c + b * s * s, (a - b) * c * s, a * s * s + b * c * c])

    @classmethod
    def from_state(cls, state: Floats, near: "Ellipse | None" = None) -> "Ellipse":
        """Ellipse of a state.

        Parameters
        ----------
        state : ndarray of shape (5,), float64
        near : Ellipse, optional
            The last one: axes keep their names, and the angle goes on from its angle. Where the ellipse is almost a
            circle its direction is noise, and the angle stays.

        Raises
        ------
        ValueError
            If the numbers are no ellipse.
        """
        x, y, m11, m12, m22 = state.tolist()
        turn = 0.0 if near is None else near.angle
        c, s = math.cos(2.0 * turn), math.sin(2.0 * turn)
        half, across = 0.5 * (m11 - m22), m12
        along, across = c * half + s * across, c * across - s * half  # in the frame of the last axes
        off = 0.5 * math.atan2(across, along)
        if near is not None:
            if off > 0.25 * math.pi:
                off -= 0.5 * math.pi
            elif off < -0.25 * math.pi:
                off += 0.5 * math.pi
            square = along * along + across * across
            off *= square / (square + DEFAULT.round_px * DEFAULT.round_px) if square > 0.0 else 0.0
        middle = 0.5 * (m11 + m22)
        reach = math.cos(2.0 * off) * along + math.sin(2.0 * off) * across
        return cls(x, y, middle + reach, middle - reach, turn + off)

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Floats | None = None) -> "Ellipse":
        """Ellipse of a center and half-width, px: a circle, or with the proportions and direction of a state."""
        size = 0.0 if like is None else linear.half_width(like)
        if like is None or size <= 0.0:
            return cls(x, y, radius, radius, 0.0)
        return cls.from_state(np.array([x, y, *(radius / size * like[2:])]))

    @classmethod
    def from_hull(cls, hull: Floats) -> "list[Ellipse]":
        """Ellipse with the second moments of a region, (m, 2) px."""
        moments = cv2.moments(hull.astype(np.float32).reshape(-1, 1, 2))
        area = moments["m00"]
        if area <= 0.0:
            return []
        square = np.array([[moments["mu20"], moments["mu11"]], [moments["mu11"], moments["mu02"]]]) * 4.0 / area
        values, vectors = np.linalg.eigh(square)  # a full ellipse has M M' = 4 times its second moments
        matrix = vectors @ np.diag(np.sqrt(np.maximum(values, 0.25))) @ vectors.T
        x, y = moments["m10"] / area, moments["m01"] / area
        return [cls.from_state(np.array([x, y, matrix[0, 0], matrix[0, 1], matrix[1, 1]]))]

    @property
    def slopes(self) -> Floats:
        """Derivative of the parameters by the state, (5, 5); of a circle's angle as if its axes differed a little."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        apart = math.copysign(max(abs(self.a - self.b), DEFAULT.least_difference_px), self.a - self.b)
        return np.array(
            [
                (1.0, 0.0, 0.0, 0.0, 0.0),
                (0.0, 1.0, 0.0, 0.0, 0.0),
                (0.0, 0.0, c * c, 2.0 * c * s, s * s),
                (0.0, 0.0, s * s, -2.0 * c * s, c * c),
                (0.0, 0.0, -c * s / apart, (c * c - s * s) / apart, c * s / apart),
            ]
        )

    @staticmethod
    def places(n: int) -> Floats:
        """Tell `trace` of n places, see `linear.places_of`."""
        t = 2.0 * math.pi * (np.arange(n) + 0.5) / n
        return linear.places_of(
            np.column_stack((np.cos(t), np.sin(t))),
            _basis(np.cos(t), np.sin(t), 1.0),
            _basis(-np.sin(t), np.cos(t), 0.0),
        )

    trace: ClassVar[Callable[[Floats, Floats, Floats], None]] = staticmethod(linear.trace)
    half_width: ClassVar[Callable[[Floats], float]] = staticmethod(linear.half_width)


def _basis(c: Floats, s: Floats, one: float) -> Floats:
    """How a place moves with x, y, m11, m12, m22: (n, 5, 2)."""
    found = np.zeros((len(c), 5, 2))
    found[:, 0, 0] = found[:, 1, 1] = one
    found[:, 2, 0], found[:, 4, 1] = c, s
    found[:, 3, 0], found[:, 3, 1] = s, c
    return found
