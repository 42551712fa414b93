"""OpenCV's newer Hough transform for circles (HOUGH_GRADIENT_ALT) on the gray whole frame."""

import cv2
import msgspec

from benchmarks.common.hough import hough_circles
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_range

NAME = "HoughCircles (ALT), gray whole frame"
NEEDS = "color"


class Parameters(msgspec.Struct, frozen=True):
    """Blur, px; accumulator, px; Scharr's upper threshold; perfection of the circle, 0 ... 1; least radius, px."""

    blur: int = 9
    dp: float = 1.5
    edge: float = 300.0
    perfection: float = 0.8
    least_radius: int = 8


CHOICES: Choices = {
    "blur": (5, 9, 13),
    "perfection": (0.5, 0.65, 0.8),
    "edge": (100.0, 200.0, 300.0),
    "dp": (1.5, 2.0),
    "least_radius": (4, 12),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame; of the circles with the ball's color inside, the largest."""
    bounds = hsv_range(start, 22, 0.4, 0.3)

    def step(image: Image) -> Circle3 | None:
        found = hough_circles(
            image,
            cv2.HOUGH_GRADIENT_ALT,
            bounds,
            parameters.blur,
            parameters.dp,
            parameters.edge,
            parameters.perfection,
            parameters.least_radius,
        )
        return max(found, key=lambda circle: circle[2], default=None)

    return step
