"""OpenCV's Hough transform for circles on the gray whole frame: what the paper compares itself with."""

import cv2
import msgspec

from benchmarks.peers.parts.start import Choices, Circle3, Image, Start, Step
from benchmarks.peers.parts.target_color import hsv_range, looks_right

NAME = "HoughCircles (gradient), gray whole frame"
NEEDS = "color"
MOST = 40  # candidates that are checked for color


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
    size = (parameters.blur, parameters.blur)

    def step(image: Image) -> Circle3 | None:
        gray = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), size, 0)
        circles = cv2.HoughCircles(
            gray,
            cv2.HOUGH_GRADIENT,
            dp=parameters.dp,
            minDist=20,
            param1=parameters.edge,
            param2=parameters.votes,
            minRadius=parameters.least_radius,
            maxRadius=135,
        )
        if circles is None:
            return None
        found = [(float(c[0]), float(c[1]), float(c[2])) for c in circles.reshape(-1, circles.shape[-1])[:MOST]]
        return next((circle for circle in found if looks_right(image, circle, bounds)), None)

    return step
