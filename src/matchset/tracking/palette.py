"""The tracker's own colors: what suits a picture, and how a well-confirmed shape teaches them."""

import math
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from matchset.image.brightness import level_across
from matchset.image.color import ColorModel
from matchset.image.color_adaptation import adapt_table
from matchset.numeric.jit import inlined
from matchset.shapes.shape import Shape, outline
from matchset.tracking.memory import CONFIRMED, INSIDE, SEEN, Views
from matchset.tracking.parameters import ADAPT_INSIDE, ADAPT_RATE, ADAPT_SUPPORT

S = TypeVar("S", bound=Shape)
Image = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]
Singles = npt.NDArray[np.float32]


def suited(color: ColorModel, image: Image, shape: Shape | None) -> ColorModel:
    """Model of a picture: a color as it is; brightness with the level of the picture, or that of a shape in it.

    Parameters
    ----------
    color : ColorModel
    image : ndarray of shape (h, w, channels), uint8
    shape : Shape or None
        Where the target is, roughly, if that is known.
    """
    if not color.gray or shape is None:
        return color.for_image(image)
    x, y = shape.state[:2].tolist()
    level = level_across(image, outline(shape), x, y)
    return color.for_image(image, None if math.isnan(level) else level)


@inlined
def teach(image: Image, table: Scores, log_odds: Singles, first: Singles, parts: Views, turn: int) -> None:
    """Learn the color from a shape that was just fitted, if it is whole and well confirmed.

    Parameters
    ----------
    image : (h, w, channels) uint8
    table, log_odds : (32768,) or (256,) int8 and float32, written
        Those of the `ColorModel`.
    first : the same shape, float32
        The log-odds as they were at first.
    parts : Views
    turn : int
        Which quarter of the outline's surroundings teaches: 0 to 3.
    """
    fit, limits, shares = parts.fit, parts.track, parts.rays[:, parts.rays.shape[1] - 1]
    whole = fit[SEEN] == parts.outline.shape[0] and fit[CONFIRMED] >= limits[ADAPT_SUPPORT] * fit[SEEN]
    if whole and limits[ADAPT_RATE] > 0.0 and fit[INSIDE] >= limits[ADAPT_INSIDE]:
        x, y = parts.state[0], parts.state[1]
        adapt_table(image, log_odds, first, table, parts.outline, shares, x, y, turn, limits[ADAPT_RATE])
