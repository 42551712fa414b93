"""HSV mask of the whole frame, largest contour, least-squares ellipse."""

from benchmarks.common import contour
from benchmarks.common.mask import MASK_CHOICES, MaskParameters
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range

NAME = "HSV mask, contour, fitEllipse"
NEEDS = "color"
Parameters = MaskParameters
CHOICES: Choices = MASK_CHOICES


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame anew."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def step(image: Image) -> Circle3 | None:
        return contour.ellipse(hsv_mask(image, bounds, parameters.opening))

    return step
