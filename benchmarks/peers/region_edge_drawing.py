"""EdgeDrawing's ellipses on the HSV mask in a region around the last circle: the most exact of the simple ways."""

import cv2
import msgspec

from benchmarks.common.ellipses import edge_drawing
from benchmarks.common.mask import COLOR_CHOICES
from benchmarks.common.region import around_the_last
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range

NAME = "region + HSV mask, EdgeDrawing"
NEEDS = "circle"


class Parameters(msgspec.Struct, frozen=True):
    """Gaussian blur of the mask, px; its opening, px; the color's range; half the region: reach * radius + margin."""

    blur: int = 5
    opening: int = 3
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    reach: float = 1.45
    margin: float = 12.0


CHOICES: Choices = {
    **COLOR_CHOICES,
    "blur": (3, 5, 9),
    "opening": (0, 3),
    "reach": (1.25, 1.45),
    "margin": (12.0, 20.0),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Look around the last circle; the largest ellipse is taken."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    size = (parameters.blur, parameters.blur)
    detect = edge_drawing(36, 8)

    def find(image: Image) -> Circle3 | None:
        mask = hsv_mask(image, bounds, parameters.opening)
        found = detect(cv2.GaussianBlur(mask, size, 0))  # type: ignore[arg-type]
        return max(found, key=lambda circle: circle[2], default=None)

    return around_the_last(find, start, parameters.reach, parameters.margin)
