"""OpenCV's SimpleBlobDetector on the HSV mask: the blob detector that the paper compares itself with."""

import cv2
import msgspec

from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range


class Parameters(msgspec.Struct, frozen=True):
    """Filters of the detector (shares, 0 ... 1); the color's range; side of the opening, px."""

    circularity: float = 0.5
    convexity: float = 0.7
    inertia: float = 0.4
    hue: int = 30
    saturation: float = 0.4
    value: float = 0.4
    opening: int = 3


CHOICES: Choices = {
    "hue": (8, 12, 16, 22, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6),
    "value": (0.1, 0.2, 0.35, 0.5),
    "circularity": (0.2, 0.5, 0.7),
    "convexity": (0.5, 0.7, 0.85),
    "inertia": (0.2, 0.4),
    "opening": (0, 3, 5),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame anew; the largest blob is taken."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    settings = cv2.SimpleBlobDetector.Params()
    # By color it would look at the blob's middle only, where the marker is.
    settings.filterByColor = False
    settings.minThreshold, settings.maxThreshold, settings.thresholdStep = 100, 200, 50
    settings.minRepeatability = 1
    settings.filterByArea, settings.minArea, settings.maxArea = True, 40, 70_000
    settings.filterByCircularity, settings.minCircularity = True, parameters.circularity
    settings.filterByConvexity, settings.minConvexity = True, parameters.convexity
    settings.filterByInertia, settings.minInertiaRatio = True, parameters.inertia
    detector = cv2.SimpleBlobDetector.create(settings)

    def step(image: Image) -> Circle3 | None:
        blobs = detector.detect(hsv_mask(image, bounds, parameters.opening))
        best = max(blobs, key=lambda blob: blob.size, default=None)
        return None if best is None else (float(best.pt[0]), float(best.pt[1]), float(best.size) / 2.0)

    return step


PEERS = {
    "simple_blob": Method("SimpleBlobDetector on the HSV mask", "color", Parameters, CHOICES, follow),
}
