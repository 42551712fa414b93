"""From a line that a person drew along a rim to a shape: `shape_along`."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from matchset.live.targets.messages import Outline
from matchset.shapes.circle import Circle
from matchset.shapes.shape import Shape, from_hull

Floats = npt.NDArray[np.float64]

SMALLEST = 2.0  # format: px, the half-width below which a drawn outline is a slip of the hand
LARGEST = 4.0  # geometry: radii of a circle over the length of its drawn arc, above which the line is straight


def drawn_shape(begin: Outline, family: type[Any]) -> Shape:
    """Return the shape of a family along what a person drew; see `shape_along`."""
    return shape_along(family, np.reshape(begin.points[: len(begin.points) // 2 * 2], (-1, 2)))


def shape_along(family: type[Any], points: Floats) -> Shape:
    """Return the shape of a family whose rim runs along a drawn line.

    A circle is fitted to the points, so that an arc of it will do (least squares of x² + y² = 2ax + 2by + c); of other
    families the closed line counts.

    Parameters
    ----------
    family : type
    points : ndarray of shape (n, 2), float64
        Points of the line, in order, px.

    Raises
    ------
    ValueError
        If no shape follows from it.
    """
    if family is Circle:
        return circle_along(points)
    hull = cv2.convexHull(points.astype(np.float32))[:, 0].astype(np.float64)
    width, height = np.ptp(hull, axis=0).tolist()
    shapes = list(from_hull(family, hull)) if min(width, height) >= 2.0 * SMALLEST else []
    if not shapes:
        raise ValueError("this line encloses nothing: draw once around the rim")
    return shapes[0]  # type: ignore[no-any-return]


def circle_along(points: Floats) -> Circle:
    """Return the circle along an arc.

    Raises
    ------
    ValueError
        If the points lie on a straight line, or all in one place.
    """
    middle = points.mean(axis=0)
    about = points - middle
    equations = np.column_stack((2.0 * about, np.ones(len(about))))
    (x, y, square), _, rank, _ = np.linalg.lstsq(equations, (about**2).sum(axis=1), rcond=None)
    radius = float(np.sqrt(max(square + x * x + y * y, 0.0)))
    drawn = float(np.hypot(*np.diff(points, axis=0).T).sum())
    if rank < 3 or radius > LARGEST * drawn:
        raise ValueError("this line is straight: draw along the rim, a third of the way around or more")
    if radius < SMALLEST:
        raise ValueError("this outline is too small: zoom in and draw along the rim")
    return Circle(float(middle[0] + x), float(middle[1] + y), radius)
