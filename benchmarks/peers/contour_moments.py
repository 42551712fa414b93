"""HSV mask of the whole frame, largest contour, its center of gravity and area."""

from benchmarks.common import contour
from benchmarks.common.mask import MASK_CHOICES, MaskParameters
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range

NAME = "HSV mask, contour, moments"
NEEDS = "color"
Parameters = MaskParameters
CHOICES: Choices = MASK_CHOICES


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame anew."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def step(image: Image) -> Circle3 | None:
        return contour.moments(hsv_mask(image, bounds, parameters.opening))

    return step
