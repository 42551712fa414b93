"""The circle, and the near-circle that a ball shows off the camera's axis.

A ball's outline is an ellipse, up to 22 % longer than wide at 35 degrees off axis. The tracker therefore follows the
state (x, y, radius, c, s) of ``rho(t) = radius + c cos 2t + s sin 2t + 3/4 ((c^2 - s^2) cos 4t + 2 c s sin 4t) /
radius``: the ellipse to second order in two small *modes* c and s that are held near zero. Without the last term a
large ball far off the axis would seem to have corners. What a user gets is the least-squares circle of that outline.
"""

import math
from collections.abc import Callable
from typing import ClassVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.shapes.described import Described

Floats = npt.NDArray[np.float64]

INF = math.inf


@kernel(refcount=False)
def _trace(state: Floats, turns: Floats, outline: Floats) -> None:
    """Outline of the state at the given (cos, sin); see `Shape.trace`."""
    x, y, radius, c, s = state[0], state[1], state[2], state[3], state[4]
    unit = 1.0 / max(radius, 1e-9)
    for line in range(outline.shape[0]):
        i = np.uintp(line)
        ux, uy = turns[i, 0], turns[i, 1]
        c2, s2 = ux * ux - uy * uy, 2.0 * ux * uy
        c4, s4 = c2 * c2 - s2 * s2, 2.0 * c2 * s2
        fourth = 0.75 * unit * ((c * c - s * s) * c4 + 2.0 * c * s * s4)
        rho = radius + c * c2 + s * s2 + fourth
        slope = 2.0 * (s * c2 - c * s2) + 3.0 * unit * (2.0 * c * s * c4 - (c * c - s * s) * s4)
        slope /= rho
        along = 1.0 / math.sqrt(1.0 + slope * slope)
        nx, ny = along * (ux + slope * uy), along * (uy - slope * ux)
        outline[i, 0], outline[i, 1] = x + rho * ux, y + rho * uy
        outline[i, 2], outline[i, 3] = nx, ny
        outline[i, 4], outline[i, 5], outline[i, 6] = nx, ny, along * (1.0 - fourth * unit)
        outline[i, 7] = along * (c2 + 1.5 * unit * (c * c4 + s * s4))
        outline[i, 8] = along * (s2 + 1.5 * unit * (c * s4 - s * c4))


@kernel(refcount=False)
def _half_width(state: Floats) -> float:
    """Mean radius of a state, px."""
    return float(state[2])


class Circle(Described, msgspec.Struct, frozen=True):
    """A circle in the picture.

    Parameters
    ----------
    x, y : float
        Center, px.
    radius : float
        Radius, px, greater than 0.

    Raises
    ------
    ValueError
        If a number is not finite or the radius is not positive.
    """

    x: float
    y: float
    radius: float

    parameters: ClassVar[tuple[str, ...]] = ("x", "y", "radius")

    def __post_init__(self) -> None:
        try:  # comparisons are cheaper than `isfinite`
            sound = -INF < self.x < INF and -INF < self.y < INF and 0.0 < self.radius < INF
        except TypeError:  # a word or None
            sound = False
        if not sound:
            raise ValueError(f"a circle needs finite numbers and a positive radius, got {self}")

    @property
    def bbox(self) -> tuple[float, float, float, float]:
        """Least upright box around it: left, top, right, bottom, px; pixel centers are at integers."""
        return self.x - self.radius, self.y - self.radius, self.x + self.radius, self.y + self.radius

    @property
    def state(self) -> Floats:
        """State that the tracker follows: x, y, radius and two elliptic modes, (5,)."""
        return np.array([self.x, self.y, self.radius, 0.0, 0.0])

    @classmethod
    def from_state(cls, state: Floats, near: "Circle | None" = None) -> "Circle":  # noqa: ARG003 - there is one
        """Least-squares circle of a near-circle.

        The ellipse with modes c, s and e^2 = (c^2 + s^2) / radius^2 has, to second order, the least-squares circle of
        (1 + e^2) times the mean of rho.

        Parameters
        ----------
        state : ndarray of shape (5,), float64
        near : Circle, optional
            Of no effect: a circle has one description.

        Raises
        ------
        ValueError
            If the numbers are no circle.
        """
        x, y, radius, c, s = state.tolist()
        return cls(x, y, radius + (c * c + s * s) / radius if radius > 0.0 else radius)

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Floats | None = None) -> "Circle":  # noqa: ARG003
        """Circle from what a search saw: center and half-width, px."""
        return cls(x, y, radius)

    trace: ClassVar[Callable[[Floats, Floats, Floats], None]] = staticmethod(_trace)
    half_width: ClassVar[Callable[[Floats], float]] = staticmethod(_half_width)
