"""scikit-image: label the mask, properties of its largest region."""

import math

import msgspec

from benchmarks.peers.parts.start import Choices, Circle3, Image, Start, Step
from benchmarks.peers.parts.target_color import hsv_mask, hsv_range

NAME = "scikit-image: label, regionprops"
NEEDS = "color"
LEAST_AREA = 12


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
