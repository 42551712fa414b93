"""Families made from a convex template: `Similar` moves, turns and scales it, `Affine` maps it by any matrix.

`family_of` makes a class for a template. All of them share their compiled code: a template is told to `trace` by the
places (see `linear`).
"""

import copyreg
import functools
import math
import types
from collections.abc import Callable
from typing import Any, ClassVar, Literal, Self

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import are_finite
from matchset.shapes import linear_outline as linear
from matchset.shapes.described import Described
from matchset.shapes.orientation import likely_turns, root_of, symmetries
from matchset.shapes.shape import center_of

Floats = npt.NDArray[np.float64]
Motion = Literal["similarity", "affine"]


class Template(msgspec.Struct, frozen=True, eq=False):
    """A convex outline.

    Parameters
    ----------
    corners : ndarray of shape (k, 2), float64
        In its own units, as seen from its center of area, in the order in which x turns to y.
    size : float
        Radius of the circle of equal area.
    same : list of ndarray of shape (2, 2)
        Matrices that map it onto itself, the identity first.
    """

    corners: Floats
    size: float
    same: list[Floats]


class _FamilyType(msgspec.StructMeta):
    """Type of the families: one that was made is pickled as what it was made from, since no module has its name."""


class Similar(Described, msgspec.Struct, frozen=True, metaclass=_FamilyType):
    """A template that was moved, turned and scaled.

    Parameters
    ----------
    x, y : float
        Where its center of area is, px.
    scale : float
        px per unit of the template, greater than 0.
    angle : float
        By how much it is turned from +x toward +y, rad; it goes on without jumps.

    Raises
    ------
    ValueError
        If a number is not finite or the scale is not positive.
    """

    x: float
    y: float
    scale: float
    angle: float

    parameters: ClassVar[tuple[str, ...]] = ("x", "y", "scale", "angle")
    template: ClassVar[Template]

    def __post_init__(self) -> None:
        if not (are_finite(self.x, self.y, self.scale, self.angle) and self.scale > 0.0):
            raise ValueError(f"a {type(self).__name__} needs finite numbers and a positive scale, got {self}")

    @property
    def state(self) -> Floats:
        """State that the tracker follows: center, and the template's size times scale as a vector, px, (4,)."""
        size = self.template.size * self.scale
        return np.array([self.x, self.y, size * math.cos(self.angle), size * math.sin(self.angle)])

    @property
    def corners(self) -> Floats:
        """Corners in the picture, (k, 2), px."""
        c, s = self.scale * math.cos(self.angle), self.scale * math.sin(self.angle)
        return np.asarray(self.template.corners @ np.array([[c, s], [-s, c]]) + [self.x, self.y])

    @classmethod
    def from_state(cls, state: Floats, near: Self | None = None) -> Self:
        """Shape of a state, ValueError if it is none; its angle, within whole turns, nearest to that of `near`."""
        x, y, p, q = state.tolist()
        angle = math.atan2(q, p)
        if near is not None:
            angle += 2.0 * math.pi * round((near.angle - angle) / (2.0 * math.pi))
        return cls(x, y, math.hypot(p, q) / cls.template.size, angle)

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Floats | None = None) -> Self:
        """Shape of a center and half-width, px: upright, or with the direction of a state."""
        angle = 0.0 if like is None else math.atan2(float(like[3]), float(like[2]))
        return cls(x, y, radius / cls.template.size, angle)

    @classmethod
    def from_hull(cls, hull: Floats) -> list[Self]:
        """Shapes of the hull's center and area, in the directions in which its outline fits best."""
        x, y, area = center_of(hull)
        if area <= 0.0:
            return []
        scale = math.sqrt(area / math.pi) / cls.template.size
        return [cls(x, y, scale, turn) for turn in likely_turns(hull - (x, y), scale * cls.template.corners)]

    @classmethod
    def nearest(cls, state: Floats, reference: Floats) -> Floats:
        """Of the states with the same outline the one nearest to a reference."""
        p, q = state[2:].tolist()
        turns = [
            each for each in cls.template.same if abs(each[0, 0] - each[1, 1]) + abs(each[0, 1] + each[1, 0]) < 1e-2
        ]
        equal = [(p * m[0, 0] - q * m[1, 0], q * m[0, 0] + p * m[1, 0]) for m in turns]
        best = min(equal, key=lambda each: math.dist(each, reference[2:].tolist()))
        return np.array([state[0], state[1], *best])

    @property
    def slopes(self) -> Floats:
        """Derivative of the parameters by the state, (4, 4)."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        size, far = self.template.size, self.template.size * self.scale
        return np.array(
            [
                (1.0, 0.0, 0.0, 0.0),
                (0.0, 1.0, 0.0, 0.0),
                (0.0, 0.0, c / size, s / size),
                (0.0, 0.0, -s / far, c / far),
            ]
        )

    @classmethod
    def places(cls, n: int) -> Floats:
        """Tell `trace` of n places, see `linear.places_of`."""
        points, directions = _places(cls.template, n)
        return linear.places_of(points, _turning(points, 1.0), _turning(directions, 0.0))

    trace: ClassVar[Callable[[Floats, Floats, Floats], None]] = staticmethod(linear.trace)
    half_width: ClassVar[Callable[[Floats], float]] = staticmethod(linear.half_width)


class Affine(Described, msgspec.Struct, frozen=True, metaclass=_FamilyType):
    """A template under an affine map: ``(x, y) + [[xx, xy], [yx, yy]] (u, v)`` for a point (u, v) from its center.

    Parameters
    ----------
    x, y : float
        Where its center of area is, px.
    xx, xy, yx, yy : float
        The matrix, px per unit of the template, of positive determinant.

    Raises
    ------
    ValueError
        If a number is not finite or the determinant is not positive.
    """

    x: float
    y: float
    xx: float
    xy: float
    yx: float
    yy: float

    parameters: ClassVar[tuple[str, ...]] = ("x", "y", "xx", "xy", "yx", "yy")
    template: ClassVar[Template]

    def __post_init__(self) -> None:
        if not (
            are_finite(self.x, self.y, self.xx, self.xy, self.yx, self.yy)
            and self.xx * self.yy - self.xy * self.yx > 0.0
        ):
            raise ValueError(f"a {type(self).__name__} needs finite numbers and a positive determinant, got {self}")

    @property
    def state(self) -> Floats:
        """State that the tracker follows: center, and the matrix times the template's size, px, (6,)."""
        size = self.template.size
        return np.array([self.x, self.y, size * self.xx, size * self.xy, size * self.yx, size * self.yy])

    @property
    def corners(self) -> Floats:
        """Corners in the picture, (k, 2), px."""
        across = np.array([[self.xx, self.yx], [self.xy, self.yy]])
        return np.asarray(self.template.corners @ across + [self.x, self.y])

    @classmethod
    def from_state(cls, state: Floats, near: Self | None = None) -> Self:  # noqa: ARG003 - its description is unique
        """Shape of a state, ValueError if it is none."""
        x, y, *matrix = state.tolist()
        return cls(x, y, *(value / cls.template.size for value in matrix))

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Floats | None = None) -> Self:
        """Shape of a center and half-width, px: as the template, or with the proportions of a state."""
        size = 0.0 if like is None else linear.half_width(like)
        if like is None or size <= 0.0:
            scale = radius / cls.template.size
            return cls(x, y, scale, 0.0, 0.0, scale)
        return cls.from_state(np.array([x, y, *(radius / size * like[2:])]))

    @classmethod
    def from_hull(cls, hull: Floats) -> list[Self]:
        """Shapes of the hull's center and second moments, in the directions in which its outline fits best."""
        x, y, area = center_of(hull)
        if area <= 0.0:
            return []
        there, own = root_of(hull - (x, y)), root_of(cls.template.corners)
        even = (hull - (x, y)) @ np.linalg.inv(there).T
        found = []
        for turn in likely_turns(even, cls.template.corners @ np.linalg.inv(own).T):
            c, s = math.cos(turn), math.sin(turn)
            matrix = there @ np.array([[c, -s], [s, c]]) @ np.linalg.inv(own)
            found.append(cls(x, y, *matrix.ravel().tolist()))
        return found

    @classmethod
    def nearest(cls, state: Floats, reference: Floats) -> Floats:
        """Of the states with the same outline the one nearest to a reference."""
        matrix = state[2:].reshape(2, 2)
        equal = [(matrix @ each).ravel() for each in cls.template.same]
        best = min(equal, key=lambda each: float(np.linalg.norm(each - reference[2:])))
        return np.array([state[0], state[1], *best])

    @property
    def slopes(self) -> Floats:
        """Derivative of the parameters by the state, (6, 6)."""
        return np.diag([1.0, 1.0, *[1.0 / self.template.size] * 4])

    @classmethod
    def places(cls, n: int) -> Floats:
        """Tell `trace` of n places, see `linear.places_of`."""
        points, directions = _places(cls.template, n)
        return linear.places_of(points, _mapping(points, 1.0), _mapping(directions, 0.0))

    trace: ClassVar[Callable[[Floats, Floats, Floats], None]] = staticmethod(linear.trace)
    half_width: ClassVar[Callable[[Floats], float]] = staticmethod(linear.half_width)


def family_of(name: str, corners: Floats, motion: Motion) -> type[Any]:
    """Make the family of a template; asked again for the same one, it returns the same class.

    Parameters
    ----------
    name : str
        Of the family.
    corners : ndarray of shape (k, 2), float64
        Convex.
    motion : "similarity" or "affine"

    Raises
    ------
    ValueError
        If the motion is neither.
    """
    if motion not in ("similarity", "affine"):
        raise ValueError(f'the motion of a template is "similarity" or "affine", got {motion!r}')
    return _family(name, np.ascontiguousarray(corners, np.float64).tobytes(), motion)


@functools.lru_cache(maxsize=256)
def _family(name: str, corners: bytes, motion: Motion) -> type[Any]:
    points = np.frombuffer(corners).reshape(-1, 2)
    x, y, area = center_of(points)
    kind = Similar if motion == "similarity" else Affine
    own = points - (x, y)
    template = Template(own, math.sqrt(area / math.pi), symmetries(own))
    recipe = name, corners, motion
    words = {"template": template, "recipe": recipe, "__doc__": kind.__doc__, "__module__": __name__}
    return types.new_class(name, (kind,), {"frozen": True}, lambda space: space.update(words))


def _reduced(family: type[Any]) -> str | tuple[Any, ...]:
    """How a family is pickled: by its name, or by the call that makes it."""
    recipe = vars(family).get("recipe")
    return family.__qualname__ if recipe is None else (_family, recipe)


copyreg.pickle(_FamilyType, _reduced)


def _places(template: Template, n: int) -> tuple[Floats, Floats]:
    """Places on a template of size 1, and the directions of its sides there."""
    points, directions, _ = linear.along_sides(template.corners / template.size, n)
    return points, directions


def _turning(vectors: Floats, one: float) -> Floats:
    """How ``(x, y) one + [[p, -q], [q, p]] vector`` goes with x, y, p, q: (n, 4, 2)."""
    found = np.zeros((len(vectors), 4, 2))
    found[:, 0, 0] = found[:, 1, 1] = one
    found[:, 2] = vectors
    found[:, 3, 0], found[:, 3, 1] = -vectors[:, 1], vectors[:, 0]
    return found


def _mapping(vectors: Floats, one: float) -> Floats:
    """How ``(x, y) one + [[xx, xy], [yx, yy]] vector`` goes with x, y, xx, xy, yx, yy: (n, 6, 2)."""
    found = np.zeros((len(vectors), 6, 2))
    found[:, 0, 0] = found[:, 1, 1] = one
    found[:, 2, 0], found[:, 3, 0] = vectors[:, 0], vectors[:, 1]
    found[:, 4, 1], found[:, 5, 1] = vectors[:, 0], vectors[:, 1]
    return found
