"""OpenCV's EdgeDrawing on the gray whole frame: EDCircles of the paper's table, in its maintained form."""

import cv2
import msgspec
import numpy as np

from benchmarks.common.ellipses import edge_drawing
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_range, looks_right

NAME = "EdgeDrawing (EDCircles), gray whole frame"
NEEDS = "color"


class Parameters(msgspec.Struct, frozen=True):
    """EdgeDrawing's thresholds, gray levels; Gaussian blur before it, px; the color of the spot check; least radius."""

    gradient: int = 36
    anchor: int = 8
    blur: int = 0
    hue: int = 22
    saturation: float = 0.4
    least_radius: float = 4.0


CHOICES: Choices = {
    "gradient": (12, 20, 36),
    "blur": (0, 5, 9),
    "anchor": (2, 8),
    "least_radius": (3.0, 8.0),
    "hue": (16, 30),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame; of the ellipses with the ball's color inside, the largest."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, 0.3)
    detect = edge_drawing(parameters.gradient, parameters.anchor)

    def step(image: Image) -> Circle3 | None:
        gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        if parameters.blur:
            gray = cv2.GaussianBlur(gray, (parameters.blur, parameters.blur), 0)
        large = [c for c in detect(np.asarray(gray, np.uint8)) if c[2] >= parameters.least_radius]
        right = [c for c in large if looks_right(image, c, bounds)]
        return max(right, key=lambda circle: circle[2], default=None)

    return step
