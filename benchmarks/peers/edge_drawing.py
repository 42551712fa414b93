"""OpenCV's EdgeDrawing (the successor of EDCircles): on the gray whole frame, and on the mask in a region."""

from collections.abc import Callable

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
from cv2 import ximgproc  # type: ignore[attr-defined]

from benchmarks.common.contour import COLOR_CHOICES
from benchmarks.common.region import around_the_last
from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range, looks_right

Gray = npt.NDArray[np.uint8]


def ellipse_detector(gradient: int, anchor: int) -> Callable[[Gray], npt.NDArray[np.float64]]:
    """Set EdgeDrawing up, with its validation (NFA) on.

    Parameters
    ----------
    gradient, anchor : int
        Least gradient of an edge, and by how much an anchor must stand out, gray levels.

    Returns
    -------
    callable
        From a gray picture to ellipses, (k, 5): center, semi-axes, px, and angle of the first of them, degrees.
    """
    detector = ximgproc.createEdgeDrawing()
    settings = ximgproc.EdgeDrawing.Params()
    settings.EdgeDetectionOperator = ximgproc.EdgeDrawing_SOBEL
    settings.GradientThresholdValue, settings.AnchorThresholdValue = gradient, anchor
    settings.MinPathLength, settings.NFAValidation = 10, True
    detector.setParams(settings)

    def detect(gray: Gray) -> npt.NDArray[np.float64]:
        detector.detectEdges(gray)
        detector.detectLines()
        found = detector.detectEllipses()
        if found is None:
            return np.zeros((0, 5))
        e = np.asarray(found, np.float64).reshape(-1, 6)
        # Of the radius of a circle and the two semi-axes of an ellipse, one kind is 0.
        return np.column_stack((e[:, :2], e[:, 2:3] + e[:, 3:5], e[:, 5]))

    return detect


def edge_drawing(gradient: int, anchor: int) -> Callable[[Gray], list[Circle3]]:
    """Do the same, to circles: center and mean semi-axis of each ellipse, px."""
    detector = ellipse_detector(gradient, anchor)

    def detect(gray: Gray) -> list[Circle3]:
        return [(x, y, 0.5 * (a + b)) for x, y, a, b, _ in detector(gray).tolist()]

    return detect


class WholeParameters(msgspec.Struct, frozen=True):
    """EdgeDrawing's thresholds, gray levels; Gaussian blur before it, px; the color of the spot check; least radius."""

    gradient: int = 36
    anchor: int = 8
    blur: int = 0
    hue: int = 22
    saturation: float = 0.4
    least_radius: float = 4.0


WHOLE_CHOICES: Choices = {
    "gradient": (12, 20, 36),
    "blur": (0, 5, 9),
    "anchor": (2, 8),
    "least_radius": (3.0, 8.0),
    "hue": (16, 30),
}


def follow_whole(start: Start, parameters: WholeParameters) -> Step:
    """Detect in every frame; of the ellipses with the ball's color inside, the largest."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, 0.3)
    detect = edge_drawing(parameters.gradient, parameters.anchor)

    def step(image: Image) -> Circle3 | None:
        gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
        if parameters.blur:
            gray = cv2.GaussianBlur(gray, (parameters.blur, parameters.blur), 0)
        large = [c for c in detect(np.asarray(gray, np.uint8)) if c[2] >= parameters.least_radius]
        right = [c for c in large if looks_right(image, c, bounds)]
        return max(right, key=lambda circle: circle[2], default=None)

    return step


class RegionParameters(msgspec.Struct, frozen=True):
    """Gaussian blur of the mask, px; its opening, px; the color's range; half the region: reach * radius + margin."""

    blur: int = 5
    opening: int = 3
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    reach: float = 1.45
    margin: float = 12.0


REGION_CHOICES: Choices = {
    **COLOR_CHOICES,
    "blur": (3, 5, 9),
    "opening": (0, 3),
    "reach": (1.25, 1.45),
    "margin": (12.0, 20.0),
}


def follow_region(start: Start, parameters: RegionParameters) -> Step:
    """Look around the last circle; the largest ellipse is taken."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    size = (parameters.blur, parameters.blur)
    detect = edge_drawing(36, 8)

    def find(image: Image) -> Circle3 | None:
        mask = hsv_mask(image, bounds, parameters.opening)
        found = detect(cv2.GaussianBlur(mask, size, 0))  # type: ignore[arg-type]
        return max(found, key=lambda circle: circle[2], default=None)

    return around_the_last(find, start, parameters.reach, parameters.margin)


PEERS = {
    "edge_drawing": Method(
        "EdgeDrawing (EDCircles), gray whole frame", "color", WholeParameters, WHOLE_CHOICES, follow_whole
    ),
    "region_edge_drawing": Method(
        "region + HSV mask, EdgeDrawing", "circle", RegionParameters, REGION_CHOICES, follow_region
    ),
}
