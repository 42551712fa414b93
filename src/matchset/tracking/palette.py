"""The tracker's own colors: what suits a picture, and how a well-confirmed shape teaches them."""

import math
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from matchset.image.adapt import adapt_table
from matchset.image.color import ColorModel
from matchset.image.gray import level_across
from matchset.shapes.shape import Shape, outline
from matchset.tracking.matcher import Matcher
from matchset.tracking.memory import CONFIRMED, INSIDE, SEEN
from matchset.tracking.parameters import TrackerParameters

S = TypeVar("S", bound=Shape)
Image = npt.NDArray[np.uint8]


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
        return color.seen_in(image)
    x, y = shape.state[:2].tolist()
    level = level_across(image, outline(shape), x, y)
    return color.seen_in(image, None if math.isnan(level) else level)


def learn(
    image: Image,
    matcher: Matcher[S],
    color: ColorModel,
    first: npt.NDArray[np.float32],
    turn: int,
    limits: TrackerParameters,
) -> None:
    """Learn the color from a shape that is whole and well confirmed.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    matcher : Matcher
        Has just fitted the shape.
    color : ColorModel
        Changed.
    first : ndarray of shape (32768,) or (256,), float32
        Its log-odds as they were at first.
    turn : int
        Which quarter of the outline's surroundings teaches.
    limits : TrackerParameters
    """
    seen = matcher.fit(SEEN)
    good = seen == matcher.points and matcher.fit(CONFIRMED) >= limits.adapt_support * seen
    if not (good and limits.adapt_rate > 0.0 and matcher.fit(INSIDE) >= limits.adapt_inside) or color.gray == "edges":
        return
    x, y, parts = float(matcher.state[0]), float(matcher.state[1]), matcher.parts
    shares = parts.rays[:, -1]
    adapt_table(image, color.log_odds, first, color.table, parts.outline, shares, x, y, turn % 4, limits.adapt_rate)
