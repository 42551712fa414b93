"""The quadrilateral with four free corners: a flat rectangular target in perspective.

The tracker follows the state (center, a, b, d) of the corners ``center + u a + v b + u v d`` with u, v = -1 or 1: eight
numbers in px, the center first. Sides stay straight under a perspective map, so nothing more is needed.
"""

import math
from collections.abc import Callable
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from matchset.numeric.words import one_line, short
from matchset.shapes import linear_outline as linear
from matchset.shapes.described import Described
from matchset.shapes.polygon import convex_corners

Floats = npt.NDArray[np.float64]
U = np.array([-1.0, 1.0, 1.0, -1.0])  # geometry: of the four corners
V = np.array([-1.0, -1.0, 1.0, 1.0])  # geometry: of the four corners
CORNERS_OF = np.column_stack((np.ones(4), U, V, U * V))  # geometry: corners = CORNERS_OF @ (center, a, b, d)
SLOPES = np.kron(CORNERS_OF, np.eye(2))  # geometry: derivative of the corners by the state


class Quadrilateral(Described):
    """A convex quadrilateral in the picture; attributes x0, y0, ... x3, y3 are its parameters.

    Parameters
    ----------
    corners : array_like of shape (4, 2)
        Corners in order around it, px.

    Raises
    ------
    ValueError
        If they are not four finite corners of a convex quadrilateral.
    """

    parameters: ClassVar[tuple[str, ...]] = ("x0", "y0", "x1", "y1", "x2", "y2", "x3", "y3")
    steady: ClassVar[int] = 6  # d, by which opposite sides are not parallel
    __slots__ = ("corners", *parameters)

    corners: Floats

    def __init__(self, corners: npt.ArrayLike) -> None:
        turned = convex_corners(corners, 4)
        given = np.array(corners, np.float64)
        if len(turned) != 4:
            raise ValueError(f"a quadrilateral has four corners, got {given.tolist()}")
        if not np.array_equal(turned, given):  # the other way around: the first corner stays the first
            turned = np.roll(turned, 1, axis=0)
        self._set(turned)

    def _set(self, corners: Floats) -> None:
        corners.setflags(write=False)
        object.__setattr__(self, "corners", corners)
        for name, value in zip(self.parameters, corners.ravel().tolist(), strict=True):
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a quadrilateral is not changed, make another one: {name} = {value!r}")

    @one_line
    def __repr__(self) -> str:
        corners = ", ".join(f"({short(x)}, {short(y)})" for x, y in self.corners.tolist())
        return f"Quadrilateral([{corners}])"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Quadrilateral) and np.array_equal(self.corners, other.corners)

    def __hash__(self) -> int:
        return hash(self.corners.tobytes())

    def __reduce__(self) -> "tuple[type[Quadrilateral], tuple[list[list[float]]]]":
        return Quadrilateral, (self.corners.tolist(),)

    @property
    def state(self) -> Floats:
        """State that the tracker follows: center, a, b, d, (8,)."""
        return (0.25 * CORNERS_OF.T @ self.corners).ravel()

    @classmethod
    def from_state(cls, state: Floats, near: "Quadrilateral | None" = None) -> "Quadrilateral":  # noqa: ARG003
        """Quadrilateral of a state, ValueError if it is none."""
        corners = CORNERS_OF @ state.reshape(4, 2)
        if not 0.0 < linear.half_width(state) < math.inf:
            return cls(corners)  # which says what is wrong
        shape = cls.__new__(cls)  # convex, and known to be: this is done for every frame
        shape._set(corners)
        return shape

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Floats | None = None) -> "Quadrilateral":
        """Quadrilateral of a center and half-width, px: a square, or with the form and direction of a state."""
        size = 0.0 if like is None else linear.half_width(like)
        half = 0.5 * math.sqrt(math.pi) * radius
        rest = [half, 0.0, 0.0, half, 0.0, 0.0] if like is None or size <= 0.0 else (radius / size * like[2:]).tolist()
        return cls.from_state(np.array([x, y, *rest]))

    @classmethod
    def from_hull(cls, hull: Floats) -> "list[Quadrilateral]":
        """Quadrilateral whose sides lie on a hull: those sides are given up whose loss adds least."""
        corners = hull
        while len(corners) > 4:
            corners = _without_a_side(corners)
            if len(corners) == 0:
                return []
        try:
            return [cls(corners)]
        except ValueError:
            return []

    @staticmethod
    def nearest(state: Floats, reference: Floats) -> Floats:
        """Of the four states with the same outline the one nearest to a reference."""
        corners = CORNERS_OF @ state.reshape(4, 2)
        equal = [(0.25 * CORNERS_OF.T @ np.roll(corners, k, axis=0)).ravel() for k in range(4)]
        found: Floats = min(equal, key=lambda each: float(np.linalg.norm(each - reference)))
        return found

    @property
    def slopes(self) -> Floats:
        """Derivative of the corners by the state, (8, 8)."""
        return SLOPES

    @staticmethod
    def places(n: int) -> Floats:
        """Tell `trace` of n places, see `linear.places_of`."""
        square = np.column_stack((U, V))
        points, directions, _ = linear.along_sides(square, n)
        (u, v), (du, dv) = points.T, directions.T
        basis, tangents = np.zeros((n, 8, 2)), np.zeros((n, 8, 2))
        for k in range(2):
            basis[:, k, k], basis[:, 2 + k, k], basis[:, 4 + k, k], basis[:, 6 + k, k] = 1.0, u, v, u * v
            tangents[:, 2 + k, k], tangents[:, 4 + k, k], tangents[:, 6 + k, k] = du, dv, u * dv + v * du
        return linear.places_of(points, basis, tangents)

    trace: ClassVar[Callable[[Floats, Floats, Floats], None]] = staticmethod(linear.trace)
    half_width: ClassVar[Callable[[Floats], float]] = staticmethod(linear.half_width)


def _without_a_side(corners: Floats) -> Floats:
    """Polygon without the side whose neighbors, drawn out until they meet, add the least area; empty if none can go."""
    count, least, best, place = len(corners), math.inf, np.zeros(2), -1
    for i in range(count):
        before, a, b, after = (corners[(i + k) % count] for k in (-1, 0, 1, 2))
        u, v = a - before, b - after
        cross = float(u[0] * v[1] - u[1] * v[0])
        if abs(cross) < 1e-9:
            continue
        w = b - a
        along = float(w[0] * v[1] - w[1] * v[0]) / cross
        beyond = float(w[0] * u[1] - w[1] * u[0]) / cross
        if along < 0.0 or beyond < 0.0:
            continue
        area = 0.5 * abs(float(w[0] * u[1] - w[1] * u[0])) * along
        if area < least:
            least, best, place = area, a + along * u, i
    if place < 0:
        return np.zeros((0, 2))
    kept = [corners[k] for k in range(count) if k not in (place, (place + 1) % count)]
    after_gap = (place + 2) % count
    kept_order = [corners[(after_gap + k) % count] for k in range(count - 2)]
    assert len(kept) == len(kept_order)
    return np.array([*kept_order, best])
