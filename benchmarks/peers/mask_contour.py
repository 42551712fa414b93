"""What the contour of the whole frame's HSV mask says: its moments, its ellipse, and the recipe of most tutorials."""

import cv2
import msgspec
import numpy as np

from benchmarks.common import contour
from benchmarks.common.contour import COLOR_CHOICES, MASK_CHOICES, MaskParameters, enclosing
from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range


def follow_moments(start: Start, parameters: MaskParameters) -> Step:
    """Detect in every frame anew."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def step(image: Image) -> Circle3 | None:
        return contour.moments(hsv_mask(image, bounds, parameters.opening))

    return step


def follow_ellipse(start: Start, parameters: MaskParameters) -> Step:
    """Detect in every frame anew."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def step(image: Image) -> Circle3 | None:
        return contour.ellipse(hsv_mask(image, bounds, parameters.opening))

    return step


class HobbyParameters(msgspec.Struct, frozen=True):
    """Kernel of the Gaussian blur, px; rounds of erosion and dilation; the color's range."""

    blur: int = 11
    rounds: int = 2
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4


HOBBY_CHOICES: Choices = {
    **COLOR_CHOICES,
    "blur": (3, 5, 7, 11),
    "rounds": (0, 1, 2, 3),
}


def follow_hobby(start: Start, parameters: HobbyParameters) -> Step:
    """Detect in every frame anew."""
    low, high = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    size, rounds = (parameters.blur, parameters.blur), parameters.rounds
    square = np.ones((3, 3), np.uint8)

    def step(image: Image) -> Circle3 | None:
        mask = cv2.inRange(cv2.cvtColor(cv2.GaussianBlur(image, size, 0), cv2.COLOR_BGR2HSV), low, high)
        mask = cv2.dilate(cv2.erode(mask, square, iterations=rounds), square, iterations=rounds)
        return enclosing(np.asarray(mask, np.uint8))

    return step


PEERS = {
    "contour_moments": Method("HSV mask, contour, moments", "color", MaskParameters, MASK_CHOICES, follow_moments),
    "contour_ellipse": Method("HSV mask, contour, fitEllipse", "color", MaskParameters, MASK_CHOICES, follow_ellipse),
    "hobby": Method(
        "hobby recipe: blur, HSV, inRange, minEnclosingCircle", "color", HobbyParameters, HOBBY_CHOICES, follow_hobby
    ),
}
