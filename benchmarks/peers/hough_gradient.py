"""OpenCV's Hough transform for circles on the gray whole frame: what the paper compares itself with."""

import cv2
import msgspec

from benchmarks.common.hough import hough_circles
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_range

NAME = "HoughCircles (gradient), gray whole frame"
NEEDS = "color"


class Parameters(msgspec.Struct, frozen=True):
    """Blur, px; the accumulator's cell, px; Canny's upper threshold; votes; least radius, px; the spot check's hue."""

    blur: int = 9
    dp: float = 1.5
    edge: float = 100.0
    votes: float = 30.0
    least_radius: int = 8
    hue: int = 22


CHOICES: Choices = {
    "votes": (15.0, 22.0, 30.0, 45.0),
    "blur": (9, 13),
    "edge": (60.0, 100.0, 160.0),
    "dp": (1.0, 1.5, 2.0),
    "least_radius": (4, 10),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame; of the circles with the ball's color inside, the one with most votes."""
    bounds = hsv_range(start, parameters.hue, 0.4, 0.3)

    def step(image: Image) -> Circle3 | None:
        found = hough_circles(
            image,
            cv2.HOUGH_GRADIENT,
            bounds,
            parameters.blur,
            parameters.dp,
            parameters.edge,
            parameters.votes,
            parameters.least_radius,
        )
        return next(iter(found), None)

    return step
