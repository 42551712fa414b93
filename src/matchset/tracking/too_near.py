"""Whether a lost target fills the picture: `fills_picture`.

The outline of a shape that comes nearer leaves the picture on all sides; then there are no edges, and the picture has
its color. That is no other loss: who steers by it must go back, not search.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.shapes.shape import Shape

Image = npt.NDArray[np.uint8]

TOO_NEAR = "too near: it fills the picture"


class TooNearParameters(msgspec.Struct, frozen=True):
    """When a lost target fills the picture; chosen by hand.

    Parameters
    ----------
    size : float
        Least half-width with which it was seen last, as a share of the shorter side of the picture: a target that was
        small a moment ago cannot fill it.
    share : float
        Least share of the picture that has the target's color. Less is said sooner, and before walls of its color.
    samples : int
        Pixels that are looked at along each side.
    """

    size: float = 0.35
    share: float = 0.7
    samples: int = 24


def fills_picture(image: Image, color: ColorModel, last: Shape, limits: TooNearParameters) -> bool:
    """Say whether a lost target fills the picture.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    last : Shape
        The target as it was seen last.
    limits : TooNearParameters
    """
    height, width = image.shape[:2]
    if color.gray == "edges" or type(last).half_width(last.state) < limits.size * min(height, width):
        return False
    down, across = math.ceil(height / limits.samples), math.ceil(width / limits.samples)
    few = np.ascontiguousarray(image[down // 2 :: down, across // 2 :: across])
    return bool((color.scores(few) > 0).mean() > limits.share)
