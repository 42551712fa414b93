"""What a ball and its marker look like, as color models: `Colors`, learned from one picture by `learn_colors`."""

from typing import NamedTuple

from matchset.image.color import ColorModel
from matchset.image.frame import Frame

# geometry: in the sample picture, from the marker's middle to a pixel of the ball beside it, as a share of the width
BALL_BESIDE_MARKER = 0.0625


class Colors(NamedTuple):
    """Color models of the ball, with its marker, and of the marker: the paper's filters a and b."""

    ball: ColorModel
    marker: ColorModel


def learn_colors(sample: Frame) -> Colors:
    """Learn the colors from a picture of the ball in the middle, its marker toward the camera.

    Parameters
    ----------
    sample : Frame
        The ball at about 1 m: its marker holds the middle, and a point 3 marker radii to the left shows the ball.
    """
    height, width = sample.image.shape[:2]
    x, y = (width - 1) / 2.0, (height - 1) / 2.0
    marker = ColorModel.pick(sample.image, x, y)
    ball = ColorModel.pick(sample.image, x - BALL_BESIDE_MARKER * width, y)
    return Colors(ball | marker, marker)
