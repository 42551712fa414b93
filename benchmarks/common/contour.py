"""From a mask to a circle: the largest outer contour, and what is made of it."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.common.start import Choices, Circle3

Mask = npt.NDArray[np.uint8]
LEAST_AREA = 12.0  # px^2: smaller things are noise
HALF_PIXEL = 0.5  # a contour runs through the middles of the outermost pixels


def largest(mask: Mask) -> npt.NDArray[np.int32] | None:
    """Return the outer contour with the largest area, or None."""
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    if not contours:
        return None
    best = max(contours, key=cv2.contourArea)
    return np.asarray(best, np.int32) if cv2.contourArea(best) >= LEAST_AREA else None


def moments(mask: Mask) -> Circle3 | None:
    """Center of gravity, and the radius of a disc of equal area."""
    contour = largest(mask)
    if contour is None:
        return None
    m = cv2.moments(contour)
    return m["m10"] / m["m00"], m["m01"] / m["m00"], math.sqrt(m["m00"] / math.pi) + HALF_PIXEL


def ellipse(mask: Mask) -> Circle3 | None:
    """Center of the least-squares ellipse, and the mean of its semi-axes."""
    contour = largest(mask)
    if contour is None or len(contour) < 5:
        return None
    (x, y), (a, b), _ = cv2.fitEllipse(contour)
    found = float(x), float(y), (a + b) / 4.0 + HALF_PIXEL
    return found if all(map(math.isfinite, found)) else None


def enclosing(mask: Mask) -> Circle3 | None:
    """Smallest circle around it."""
    contour = largest(mask)
    if contour is None:
        return None
    (x, y), radius = cv2.minEnclosingCircle(contour)
    return float(x), float(y), float(radius) + HALF_PIXEL


COLOR_CHOICES: Choices = {
    "hue": (8, 12, 16, 22, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6, 0.75),
    "value": (0.1, 0.2, 0.35, 0.5),
}


class MaskParameters(msgspec.Struct, frozen=True):
    """The color's range, see `hsv_range`; side of the opening, px."""

    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 3


MASK_CHOICES: Choices = {**COLOR_CHOICES, "opening": (0, 3, 5)}


class RegionParameters(msgspec.Struct, frozen=True):
    """The color's range; side of the opening, px; half the region's side: reach * radius + margin, px."""

    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 3
    reach: float = 1.45
    margin: float = 12.0


REGION_CHOICES: Choices = {**MASK_CHOICES, "reach": (1.1, 1.25, 1.45), "margin": (8.0, 12.0, 20.0)}
