"""The contract of a shape family: few parameters, an outline, and how the outline moves with them.

What `Shape` asks for every family must have; `docs/add_a_shape.md` writes one from scratch. What a family may have
besides is asked for by the functions below, which know what to do without it.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any, ClassVar, Protocol, Self, TypeVar

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


class Shape(Protocol):
    """What the tracker asks of a family of shapes.

    A family is a class of convex outlines with few parameters. The tracker follows a *state*: as many numbers as there
    are parameters, center x and y first, and perhaps a few modes after them, small deviations that are held near zero.
    The tracker's tolerances are in px, so a number of the state that grows by 1 should move the outline by about 1 px:
    a direction is followed as a vector of the shape's size, not as an angle. Where such numbers are not the parameters
    themselves, the family has `slopes` too.

    Attributes
    ----------
    parameters : tuple of str
        Names of the parameters, which are attributes of the shape: px, rad.
    trace : callable
        ``trace(state, places, outline)``, compiled, writes the outline of a state at n places: from rows of places
        (n, >= 2), see `places`, to the rows of outline (n, >= 4 + s): x and y, px, the outward unit normal, and by how
        much the outline moves along it per unit of each number of the state. It must neither raise nor allocate.
        Compiled with `kernel`, or a function that Numba can compile.
    half_width : callable
        ``half_width(state)``, compiled: half the width of a state's outline, px, what its margins and tolerances are
        measured by; 0 where the state is no shape.
    """

    parameters: ClassVar[tuple[str, ...]]
    trace: ClassVar[Callable[[Floats, Floats, Floats], None]]
    half_width: ClassVar[Callable[[Floats], float]]

    @property
    def state(self) -> Floats:
        """State of this shape, (s,), s >= the number of parameters."""

    @classmethod
    def from_state(cls, state: Floats, near: Self | None = None) -> Self:
        """Shape of a state, ValueError if it is none; of several equal descriptions the one nearest to `near`."""

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Floats | None = None) -> Self:
        """Shape of a center and half-width, px, with the proportions and direction of the state `like`."""


S = TypeVar("S", bound=Shape)


def places(family: type[Any], n: int) -> Floats:
    """Where on an outline of the family the n lines cross it: what `trace` is told.

    A family may say so itself, in a static method ``places(n)``: angle's cosine and sine first, as seen from the
    center, then whatever its `trace` needs to know of a place.

    Returns
    -------
    ndarray of shape (n, >= 2), float64
        By default the cosine and sine of n even angles.
    """
    own = getattr(family, "places", None)
    if own is not None:
        return np.asarray(own(n), np.float64)
    angles = 2.0 * math.pi * (np.arange(n) + 0.5) / n
    return np.column_stack((np.cos(angles), np.sin(angles)))


def slopes(shape: Any) -> Floats | None:
    """Return the derivative of the parameters by the state's first numbers, (p, p); None where they are the same."""
    found: Floats | None = getattr(shape, "slopes", None)
    return found


def nearest(family: type[Any], state: Floats, reference: Floats) -> Floats:
    """Of the states with the same outline the one nearest to a reference: a square has four.

    A family may say so in a static method ``nearest(state, reference)``; without one a state is the only one of its
    outline.
    """
    own = getattr(family, "nearest", None)
    found: Floats = state if own is None else own(state, reference)
    return found


def steady(family: type[Any]) -> float:
    """From which number on a state hardly changes from frame to frame: it then stays where little of it is seen.

    A family may say so in an attribute ``steady``: the perspective of a quadrilateral. Without one all may change.
    """
    return float(getattr(family, "steady", math.inf))


def finds_itself(family: type[Any]) -> bool:
    """Whether the family begins at the hull of a region of its color; otherwise a search votes for circles."""
    return hasattr(family, "from_hull")


def from_hull(family: type[S], hull: Floats) -> Iterable[S]:
    """Shapes of the family that may have this outline, likeliest first.

    A family may say so in a class method ``from_hull(hull)``; without one it begins at the circle of equal area.

    Parameters
    ----------
    family : type
    hull : ndarray of shape (m, 2), float64
        Corners of a rough convex outline, px.
    """
    own = getattr(family, "from_hull", None)
    if own is not None:
        found: Iterable[S] = own(hull)
        return found
    x, y, area = center_of(hull)
    return [family.from_coarse(x, y, math.sqrt(area / math.pi))] if area > 0.0 else []


def corners(shape: Any) -> Floats | None:
    """Corners of the outline, (k, 2), px; None where it has none, and its neighborhood is smooth."""
    found: Floats | None = getattr(shape, "corners", None)
    return found


def outline(shape: Any, count: int = 90) -> Floats:
    """Points of a shape's outline, in order.

    Parameters
    ----------
    shape : Shape
    count : int
        How many, where the outline has no corners.

    Returns
    -------
    ndarray of shape (k, 2), float64
        px.
    """
    found = corners(shape)
    if found is not None:
        return found
    state = shape.state
    rows = np.zeros((count, 4 + len(state)))
    type(shape).trace(state, places(type(shape), count), rows)
    return np.ascontiguousarray(rows[:, :2])


def center_of(hull: Floats) -> tuple[float, float, float]:
    """Center of area, px, and area, px^2, of a polygon."""
    first = hull[0]
    a, b = hull - first, np.roll(hull, -1, axis=0) - first
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    area = 0.5 * float(cross.sum())
    if abs(area) < 1e-12:
        return float(hull[:, 0].mean()), float(hull[:, 1].mean()), 0.0
    x, y = (first + ((a + b) * cross[:, None]).sum(axis=0) / (6.0 * area)).tolist()
    return x, y, abs(area)
