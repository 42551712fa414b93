"""What a ball and its marker look like, as color models: `BallColors`, learned from one picture by `learn_colors`."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame

# geometry: in the sample picture, from the marker's middle to a pixel of the ball beside it, as a share of the width
BALL_BESIDE_MARKER = 0.0625
SMALLER = 0.6  # geometry: largest radius of a marker, as a share of its ball's


class BallColors(NamedTuple):
    """Color models of the ball, with its marker, and of the marker: the paper's filters a and b."""

    ball: ColorModel
    marker: ColorModel


def learn_colors(sample: Frame) -> BallColors:
    """Learn the colors from a picture of the ball in the middle, its marker toward the camera.

    Parameters
    ----------
    sample : Frame
        The ball at about 1 m: its marker holds the middle, and a point 3 marker radii to the left shows the ball.
    """
    height, width = sample.image.shape[:2]
    x, y = (width - 1) / 2.0, (height - 1) / 2.0
    marker = pick_marker(sample.image, x, y)
    ball = ColorModel.pick(sample.image, x - BALL_BESIDE_MARKER * width, y)
    return BallColors(ball | marker, marker)


def pick_marker(image: npt.NDArray[np.uint8], x: float, y: float) -> ColorModel:
    """Learn the color of a marker from a click: of what that may mean, a spot on a ball and not the ball.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    x, y : float
        A point on the marker, px.
    """
    color = ColorModel.pick(image, x, y)
    taken, *others = color.alternatives or (None,)
    smaller = [each for each in others if taken is not None and each.circle[2] < SMALLER * taken.circle[2]]
    if not smaller:
        return color
    likeliest = max(smaller, key=lambda each: each.log_odds)
    return ColorModel.pick(image, x, y, reading=color.alternatives.index(likeliest) + 1)
