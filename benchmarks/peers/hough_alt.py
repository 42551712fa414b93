"""OpenCV's newer Hough transform for circles (HOUGH_GRADIENT_ALT) on the gray whole frame."""

import cv2
import msgspec

from benchmarks.peers.parts.start import Choices, Circle3, Image, Start, Step
from benchmarks.peers.parts.target_color import hsv_range, looks_right

NAME = "HoughCircles (ALT), gray whole frame"
NEEDS = "color"
MOST = 40  # candidates that are checked for color


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
    size = (parameters.blur, parameters.blur)

    def step(image: Image) -> Circle3 | None:
        gray = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), size, 0)
        circles = cv2.HoughCircles(
            gray,
            cv2.HOUGH_GRADIENT_ALT,
            dp=parameters.dp,
            minDist=20,
            param1=parameters.edge,
            param2=parameters.perfection,
            minRadius=parameters.least_radius,
            maxRadius=135,
        )
        if circles is None:
            return None
        rows = circles.reshape(-1, circles.shape[-1])[:MOST]
        found = [(float(c[0]), float(c[1]), float(c[2])) for c in rows]
        right = [circle for circle in found if looks_right(image, circle, bounds)]
        return max(right, key=lambda circle: circle[2], default=None)

    return step
