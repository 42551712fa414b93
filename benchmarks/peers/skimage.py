"""scikit-image: a circle through the mask's contour by RANSAC, and the properties of the mask's largest region."""

import math

import msgspec
import numpy as np

from benchmarks.common.contour import COLOR_CHOICES, HALF_PIXEL, MASK_CHOICES, MaskParameters, largest
from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range


class RansacParameters(msgspec.Struct, frozen=True):
    """Residual of an inlier, px; trials; side of the opening, px; the color's range."""

    inlier: float = 1.5
    trials: int = 30
    opening: int = 3
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4


RANSAC_CHOICES: Choices = {
    **COLOR_CHOICES,
    "inlier": (1.0, 1.5, 2.5),
    "opening": (0, 3),
}


def follow_ransac(start: Start, parameters: RansacParameters) -> Step:
    """Detect in every frame anew."""
    from skimage.measure import CircleModel, ransac

    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    rng = np.random.default_rng(0)

    def step(image: Image) -> Circle3 | None:
        outline = largest(hsv_mask(image, bounds, parameters.opening))
        if outline is None or len(outline) < 8:
            return None
        points = outline[:, 0].astype(np.float64)
        model, _ = ransac(points, CircleModel, 3, parameters.inlier, max_trials=parameters.trials, rng=rng)
        if not model:
            return None
        x, y = model.center
        return float(x), float(y), float(model.radius) + HALF_PIXEL

    return step


LEAST_AREA = 12


def follow_regions(start: Start, parameters: MaskParameters) -> Step:
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


PEERS = {
    "skimage_ransac": Method(
        "scikit-image: RANSAC CircleModel on the contour", "color", RansacParameters, RANSAC_CHOICES, follow_ransac
    ),
    "skimage_regions": Method(
        "scikit-image: label, regionprops", "color", MaskParameters, MASK_CHOICES, follow_regions
    ),
}
