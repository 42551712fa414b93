"""HSV mask of the whole frame, largest contour, its center of gravity and area."""

import msgspec

from benchmarks.peers.parts import contour
from benchmarks.peers.parts.start import Choices, Circle3, Image, Start, Step
from benchmarks.peers.parts.target_color import hsv_mask, hsv_range

NAME = "HSV mask, contour, moments"
NEEDS = "color"


class Parameters(msgspec.Struct, frozen=True):
    """Side of the opening, px; the color's range."""

    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 3


CHOICES: Choices = {
    "hue": (8, 12, 16, 22, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6, 0.75),
    "value": (0.1, 0.2, 0.35, 0.5),
    "opening": (0, 3, 5),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame anew."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def step(image: Image) -> Circle3 | None:
        return contour.moments(hsv_mask(image, bounds, parameters.opening))

    return step
