"""What people use today: a mask by color, its largest contour, and what OpenCV makes of that."""

import math
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

import matchset as ms

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Method = Callable[[Image], Any]

HUE, SATURATION, VALUE = 12, 0.55, 0.5  # half the range of hue; least shares of the medians: the best on seeds 0-3
OPENING = 3  # px: side of the square that the mask is opened by
LEAST_AREA = 12.0  # px^2: smaller things are noise
AROUND = np.array([(0.5, 0.5), (-0.5, 0.5), (0.5, -0.5), (-0.5, -0.5)])  # a contour runs through pixels' middles


def contour_method(case: str, image: Image, outline: Floats) -> Method:
    """Learn the range of colors inside the true outline of the first frame; what finds the shape in a frame.

    Parameters
    ----------
    case : str
        Name of one of the cases.
    image : ndarray of shape (h, w, 3), uint8
    outline : ndarray of shape (k, 2)
        px.
    """
    low, high = color_range(image, outline)
    make = {"ellipse": _ellipse, "rectangle": _rectangle, "square": _rectangle}.get(case, _hull)
    sides = {"quadrilateral": 4, "triangle": 3, "stop sign": 8, "affine hexagon": 6}.get(case, 0)

    def find(picture: Image) -> Any:
        mask = cv2.inRange(cv2.cvtColor(picture, cv2.COLOR_BGR2HSV), low, high)
        contour = _largest(cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((OPENING, OPENING), np.uint8)))
        if contour is None:
            return None
        return _polygon(contour, sides) if sides else make(contour)

    return find


def color_range(image: Image, outline: Floats) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """Range of HSV around the median of what is inside an outline."""
    inside = np.zeros(image.shape[:2], np.uint8)
    middle = outline.mean(axis=0)
    cv2.fillConvexPoly(inside, np.rint(middle + 0.85 * (outline - middle)).astype(np.int32), 255)
    h, s, v = np.median(cv2.cvtColor(image, cv2.COLOR_BGR2HSV)[inside > 0], axis=0).tolist()
    return (max(int(h) - HUE, 0), int(SATURATION * s), int(VALUE * v)), (min(int(h) + HUE, 179), 255, 255)


def _largest(mask: Any) -> Any:
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    best = max(contours, key=cv2.contourArea, default=None)
    return best if best is not None and cv2.contourArea(best) >= LEAST_AREA else None


def _ellipse(contour: Any) -> ms.Ellipse | None:
    if len(contour) < 5:
        return None
    (x, y), (width, height), degrees = cv2.fitEllipse(contour)
    if not all(map(math.isfinite, (x, y, width, height))):
        return None
    return ms.Ellipse(x, y, 0.5 * (width + 1.0), 0.5 * (height + 1.0), math.radians(degrees))


def _rectangle(contour: Any) -> Floats:
    (x, y), (width, height), degrees = cv2.minAreaRect(contour)
    return np.asarray(cv2.boxPoints(((x, y), (width + 1.0, height + 1.0), degrees)), np.float64)


def _hull(contour: Any) -> Floats:
    """Return the hull of the pixels, not of their middles."""
    points = (contour[:, 0, np.newaxis].astype(np.float32) + AROUND.astype(np.float32)).reshape(-1, 1, 2)
    return np.asarray(cv2.convexHull(points)[:, 0], np.float64)


def _polygon(contour: Any, sides: int) -> Floats | None:
    """Approximate the hull by as many sides, with the finest tolerance that leaves no more."""
    hull = _hull(contour).astype(np.float32).reshape(-1, 1, 2)
    around = cv2.arcLength(hull, True)
    for tolerance in np.geomspace(0.005, 0.2, 24).tolist():
        found = cv2.approxPolyDP(hull, tolerance * around, True)
        if len(found) <= sides:
            return np.asarray(found[:, 0], np.float64) if len(found) == sides else None
    return None
