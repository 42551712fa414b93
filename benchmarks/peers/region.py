"""The same in a region around the last circle only; with BGR as it comes it is the strongest everyday rival."""

import msgspec

from benchmarks.common import contour
from benchmarks.common.contour import REGION_CHOICES, RegionParameters
from benchmarks.common.region import around_the_last
from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import bgr_mask, bgr_range, hsv_mask, hsv_range


class BgrParameters(msgspec.Struct, frozen=True):
    """The color's range, see `bgr_range`; side of the opening, px; half the region: reach * radius + margin, px."""

    low: float = 0.6
    slack: int = 60
    opening: int = 0
    reach: float = 1.45
    margin: float = 12.0


BGR_CHOICES: Choices = {
    "low": (0.2, 0.3, 0.4, 0.5, 0.6, 0.7),
    "slack": (20, 40, 60, 80, 100),
    "opening": (0, 3),
    "reach": (1.1, 1.25, 1.45),
    "margin": (8.0, 12.0, 20.0),
}


def follow_bgr(start: Start, parameters: BgrParameters) -> Step:
    """Look around the last circle; in the whole frame where nothing is there."""
    bounds = bgr_range(start, parameters.low, parameters.slack)

    def find(image: Image) -> Circle3 | None:
        return contour.moments(bgr_mask(image, bounds, parameters.opening))

    return around_the_last(find, start, parameters.reach, parameters.margin)


def follow_moments(start: Start, parameters: RegionParameters) -> Step:
    """Look around the last circle; in the whole frame where nothing is there."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def find(image: Image) -> Circle3 | None:
        return contour.moments(hsv_mask(image, bounds, parameters.opening))

    return around_the_last(find, start, parameters.reach, parameters.margin)


def follow_ellipse(start: Start, parameters: RegionParameters) -> Step:
    """Look around the last circle; in the whole frame where nothing is there."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)

    def find(image: Image) -> Circle3 | None:
        return contour.ellipse(hsv_mask(image, bounds, parameters.opening))

    return around_the_last(find, start, parameters.reach, parameters.margin)


PEERS = {
    "region_bgr": Method("region + BGR inRange, contour, moments", "circle", BgrParameters, BGR_CHOICES, follow_bgr),
    "region_moments": Method(
        "region + HSV mask, contour, moments", "circle", RegionParameters, REGION_CHOICES, follow_moments
    ),
    "region_ellipse": Method(
        "region + HSV mask, contour, fitEllipse", "circle", RegionParameters, REGION_CHOICES, follow_ellipse
    ),
}
