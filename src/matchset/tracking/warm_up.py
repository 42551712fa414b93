"""Compile everything before the first frame: `warm_up`."""

from typing import TypeVar

import cv2
import numpy as np

from matchset.image.color import ColorModel
from matchset.shapes.shape import Shape, finds_itself, outline
from matchset.tracking.judge import Judge
from matchset.tracking.look import Look
from matchset.tracking.matcher import Matcher
from matchset.tracking.verdict import is_doubtful, is_near, is_other_shape, missing
from matchset.tracking.voting import Searcher

S = TypeVar("S", bound=Shape)

MIDDLE, SIZE = 31.5, 20.0  # of a shape in a small picture, px


def warm_up(family: type[S], cells: int, channels: int) -> None:
    """Run every kernel of a tracker once on a small picture of the shape, so that no frame waits for the compiler.

    Parameters
    ----------
    family : type
        The family of shapes.
    cells : int
        Size of the color table.
    channels : int
        Of the pictures to come.
    """
    color = ColorModel(np.linspace(-4.0, 4.0, cells, dtype=np.float32))
    matcher: Matcher[S] = Matcher(family, 16)
    shape = family.from_coarse(MIDDLE, MIDDLE, SIZE)
    state, plain = shape.state, np.zeros((64, 64), np.uint8)
    cv2.fillConvexPoly(plain, np.rint(outline(shape)).astype(np.int32), 255)
    image = np.ascontiguousarray(np.repeat(plain[:, :, np.newaxis], channels, axis=2))
    matcher.settle(image, color, state, Look(6.0))
    parts = matcher.parts
    Judge().following(matcher)
    is_other_shape(parts.fit, parts.judge, 1.0)
    is_doubtful(parts.fit, parts.judge, 16)
    is_near(state, family.half_width(state), state, SIZE, 1.0)
    missing(16.0, 16)
    matcher.track(0.0)
    matcher.begin(state, 0.0, 1.0)
    matcher.take_in(1.0)
    matcher.predict(2.0, 1.0)
    matcher.advance(image, color, color.log_odds.copy(), 2.0, 1.0)
    searcher = Searcher(64, 64)
    searcher.hulls(image, color) if finds_itself(family) else searcher.candidates(image, color)
