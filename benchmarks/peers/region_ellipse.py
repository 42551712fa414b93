"""The contour's ellipse in a region around the last circle."""

import msgspec

from benchmarks.peers.parts import contour
from benchmarks.peers.parts.region import around_the_last
from benchmarks.peers.parts.start import Choices, Circle3, Image, Start, Step
from benchmarks.peers.parts.target_color import hsv_mask, hsv_range

NAME = "region + HSV mask, contour, fitEllipse"
NEEDS = "circle"


class Parameters(msgspec.Struct, frozen=True):
    """Side of the opening, px; the color's range; half the region's side: reach * radius + margin, px."""

    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 3
    reach: float = 1.45
    margin: float = 12.0


CHOICES: Choices = {
    "hue": (8, 12, 16, 22, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6, 0.75),
    "value": (0.1, 0.2, 0.35, 0.5),
    "opening": (0, 3, 5),
    "reach": (1.1, 1.25, 1.45),
    "margin": (8.0, 12.0, 20.0),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Look around the last circle; in the whole frame where nothing is there."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def find(image: Image) -> Circle3 | None:
        return contour.ellipse(hsv_mask(image, bounds, parameters.opening))

    return around_the_last(find, start, parameters.reach, parameters.margin)
