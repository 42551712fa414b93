"""scikit-image: label the mask, properties of its largest region."""

import math

from benchmarks.common.mask import MASK_CHOICES, MaskParameters
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range

NAME = "scikit-image: label, regionprops"
NEEDS = "color"
LEAST_AREA = 12
Parameters = MaskParameters
CHOICES: Choices = MASK_CHOICES


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame anew; the mask is OpenCV's, since scikit-image's conversion takes 30 times as long."""
    from skimage.measure import label, regionprops

    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def step(image: Image) -> Circle3 | None:
        regions = regionprops(label(hsv_mask(image, bounds, parameters.opening)))
        best = max(regions, key=lambda region: region.area, default=None)
        if best is None or best.area < LEAST_AREA:
            return None
        # The marker is a hole in the mask: the filled area is the disc's.
        y, x = best.centroid
        return float(x), float(y), math.sqrt(float(best.area_filled) / math.pi)

    return step
