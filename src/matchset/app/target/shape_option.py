"""The option `--shape`: from text to a family of shapes."""

import math
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_limited
from matchset.media.picture import decode_picture
from matchset.shapes.circle import Circle
from matchset.shapes.convex import Convex
from matchset.shapes.ellipse import Ellipse
from matchset.shapes.polygon import Polygon
from matchset.shapes.quadrilateral import Quadrilateral
from matchset.shapes.rectangle import Rectangle

_FAMILIES: dict[str, type[Any]] = {
    "circle": Circle,
    "ellipse": Ellipse,
    "rectangle": Rectangle,
    "quadrilateral": Quadrilateral,
}
# geometry: number of corners
_REGULAR = {"triangle": 3, "pentagon": 5, "hexagon": 6, "octagon": 8}
_POINTS = re.compile(r"\s*(?:-?\d+(?:\.\d+)?,-?\d+(?:\.\d+)?[\s;]+){2,}-?\d+(?:\.\d+)?,-?\d+(?:\.\d+)?\s*")
NAMES = ", ".join([*_FAMILIES, *_REGULAR])


def parse_shape(text: str) -> type[Any]:
    """Read a shape.

    Parameters
    ----------
    text : str
        A name ("circle", "ellipse", "rectangle", "quadrilateral", a regular "triangle", "pentagon", "hexagon" or
        "octagon"); corners, "0,0 4,0 0,3"; or a picture file of an outline, bright inside. With ":affine" at its end,
        the shape may be seen from the side (affine motion model).

    Returns
    -------
    type
        The family of shapes.

    Raises
    ------
    ValueError
        If the text is none of these.
    """
    name_or_file, _, rest = text.partition(":affine")
    if rest:
        raise ValueError(f"behind ':affine' nothing follows, got --shape {text!r}")
    affine = text != name_or_file
    name = name_or_file.strip().lower()
    if name in _FAMILIES:
        if affine:
            raise ValueError(f"--shape {name} has no ':affine'; choose quadrilateral or ellipse")
        return _FAMILIES[name]
    if name in _REGULAR:
        angles = [2.0 * math.pi * k / _REGULAR[name] - 0.5 * math.pi for k in range(_REGULAR[name])]
        return Polygon.of([(math.cos(t), math.sin(t)) for t in angles], "affine" if affine else "similarity")
    if _POINTS.fullmatch(name_or_file):
        corners = [tuple(map(float, each.split(","))) for each in re.split(r"[\s;]+", name_or_file.strip())]
        return Polygon.of(corners, "affine" if affine else "similarity")
    return _outline_of(Path(name_or_file), affine)


def _outline_of(path: Path, affine: bool) -> type[Any]:
    """Read the outline of the bright region of a picture file."""
    try:
        picture = decode_picture(read_limited(path, LIMITS.picture_file), cv2.IMREAD_GRAYSCALE)
    except OSError:
        raise ValueError(
            f"--shape is {NAMES}, corners as '0,0 4,0 0,3', or a picture file; got {str(path)!r}"
        ) from None
    except ValueError as error:
        raise ValueError(f"--shape: {path}: {error}") from None
    if picture is None:
        raise ValueError(f"--shape: {path} is not a picture")
    return Convex.of(np.asarray(picture > 127), "affine" if affine else "similarity")
