"""The recipe of most tutorials: blur, HSV, inRange, erode, dilate, smallest circle around the largest contour."""

import cv2
import msgspec
import numpy as np

from benchmarks.common.contour import enclosing
from benchmarks.common.mask import COLOR_CHOICES
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_range

NAME = "hobby recipe: blur, HSV, inRange, minEnclosingCircle"
NEEDS = "color"


class Parameters(msgspec.Struct, frozen=True):
    """Kernel of the Gaussian blur, px; rounds of erosion and dilation; the color's range."""

    blur: int = 11
    rounds: int = 2
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4


CHOICES: Choices = {
    **COLOR_CHOICES,
    "blur": (3, 5, 7, 11),
    "rounds": (0, 1, 2, 3),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame anew."""
    low, high = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    size, rounds = (parameters.blur, parameters.blur), parameters.rounds
    square = np.ones((3, 3), np.uint8)

    def step(image: Image) -> Circle3 | None:
        mask = cv2.inRange(cv2.cvtColor(cv2.GaussianBlur(image, size, 0), cv2.COLOR_BGR2HSV), low, high)
        mask = cv2.dilate(cv2.erode(mask, square, iterations=rounds), square, iterations=rounds)
        return enclosing(np.asarray(mask, np.uint8))

    return step
