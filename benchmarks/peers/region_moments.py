"""The contour's moments in a region around the last circle."""

from benchmarks.common import contour
from benchmarks.common.mask import REGION_CHOICES, RegionParameters
from benchmarks.common.region import around_the_last
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range

NAME = "region + HSV mask, contour, moments"
NEEDS = "circle"
Parameters = RegionParameters
CHOICES: Choices = REGION_CHOICES


def follow(start: Start, parameters: Parameters) -> Step:
    """Look around the last circle; in the whole frame where nothing is there."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def find(image: Image) -> Circle3 | None:
        return contour.moments(hsv_mask(image, bounds, parameters.opening))

    return around_the_last(find, start, parameters.reach, parameters.margin)
