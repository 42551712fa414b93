"""What every shape says of itself besides its parameters: center, box, a dictionary, one line, a small drawing."""

import math
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from matchset.numeric.words import one_line, short
from matchset.shapes.shape import outline

Floats = npt.NDArray[np.float64]

BOX_POINTS = 720  # geometry: points of a smooth outline whose box is asked for
DRAWN_POINTS = 120  # geometry: points of a smooth outline in a drawing
DRAWN_PX = 150  # format: longer side of a drawing
SURROUNDINGS = 0.2  # geometry: margin around the shape in a drawing, in its size
_UNITS = {"angle": "rad", "scale": "", "xx": "", "xy": "", "yx": "", "yy": ""}


def unit_of(parameter: str) -> str:
    """Return the unit of a shape's parameter: rad for an angle, none for what maps a template, else px."""
    return _UNITS.get(parameter, "px")


class Described:
    """Base of the families of this package: center, box, dictionary and one line of a shape."""

    __slots__ = ()
    parameters: ClassVar[tuple[str, ...]]

    @property
    def center(self) -> tuple[float, float]:
        """Center (x, y), px."""
        this: Any = self
        x, y = this.state[:2].tolist()
        return x, y

    @property
    def bbox(self) -> tuple[float, float, float, float]:
        """Least upright box around the outline: left, top, right, bottom, px; pixel centers are at integers."""
        return _box(outline(self, BOX_POINTS))

    def to_dict(self) -> dict[str, float]:
        """Parameters by their names, px and rad, as in `tracks.csv`; ready for JSON."""
        return {name: float(getattr(self, name)) for name in self.parameters}

    @one_line
    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={_shown(self, name)}' for name in self.parameters)})"


def _shown(shape: object, name: str) -> str:
    return short(getattr(shape, name))


def box_of(shape: Any) -> tuple[float, float, float, float]:
    """Return the `bbox` of any shape, also of a family that has none: left, top, right, bottom, px."""
    return shape.bbox if isinstance(shape, Described) else _box(outline(shape, BOX_POINTS))


def _box(points: Floats) -> tuple[float, float, float, float]:
    left, top = points.min(axis=0).tolist()
    right, bottom = points.max(axis=0).tolist()
    return left, top, right, bottom


def drawing_of(shape: Any, points: Floats) -> str:
    """SVG of an outline with its edge points, for notebooks, in the colors of annotated videos.

    Parameters
    ----------
    shape : Shape
    points : ndarray of shape (m, 2), float64
        px.

    Returns
    -------
    str
        Empty where a number is not finite.
    """
    ring = outline(shape, DRAWN_POINTS)
    seen = np.vstack((ring, points.reshape(-1, 2)))
    low, high = seen.min(axis=0), seen.max(axis=0)
    size = float((high - low).max()) * (1.0 + 2.0 * SURROUNDINGS)
    if not (math.isfinite(size) and size > 0.0):
        return ""
    scale, middle = DRAWN_PX / size, 0.5 * (low + high)
    ring, points = (0.5 * DRAWN_PX + scale * (each - middle) for each in (ring, points.reshape(-1, 2)))
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in ring.tolist())
    dots = "".join(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='1.6'/>" for x, y in points.tolist())
    return (
        f"<svg width='{DRAWN_PX}' height='{DRAWN_PX}' style='background:#3c3c3c'>"
        f"<polygon points='{path}' fill='none' stroke='#ff28be' stroke-width='1.5'/><g fill='white'>{dots}</g></svg>"
    )
