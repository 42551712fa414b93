"""The color of the ball as a range, learned from the disc in the first frame: HSV and BGR, masks, a spot check."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.common.start import Circle3, Image, Start

Bound = tuple[int, int, int]
Mask = npt.NDArray[np.uint8]
SPOTS = 8  # pixels that are looked at inside a candidate
SPOTS_SHARE = 0.6  # of the radius: where they lie
SPOTS_NEEDED = 6


def disc_pixels(start: Start) -> Image:
    """Return the pixels between 0.35 and 0.85 radii from the center: without rim and marker, (n, 3) BGR."""
    x, y, radius = start.circle
    height, width = start.image.shape[:2]
    distance = np.hypot(np.arange(width) - x, np.arange(height)[:, np.newaxis] - y)
    pixels: Image = start.image[(distance > 0.35 * radius) & (distance < 0.85 * radius)]
    return pixels


def hsv_range(start: Start, hue: int, saturation: float, value: float) -> tuple[Bound, Bound]:
    """Range of HSV around the median of the disc.

    Parameters
    ----------
    start : Start
    hue : int
        Half its width in hue, OpenCV's units of 2 degrees. Hues around 0 are not wrapped: no ball here is red.
    saturation, value : float
        Least saturation and value, shares of the median.

    Returns
    -------
    low, high : tuple of 3 int
        For `cv2.inRange`.
    """
    pixels = cv2.cvtColor(disc_pixels(start)[np.newaxis], cv2.COLOR_BGR2HSV)[0]
    h, s, v = np.median(pixels, axis=0).tolist()
    return (max(int(h) - hue, 0), int(saturation * s), int(value * v)), (min(int(h) + hue, 179), 255, 255)


def bgr_range(start: Start, low: float, slack: int) -> tuple[Bound, Bound]:
    """Range of BGR: much of the strongest channel, not more of the others than the disc has.

    Parameters
    ----------
    start : Start
    low : float
        Least value of the strongest channel, a share of its median.
    slack : int
        By how much the other channels may lie above their medians.

    Returns
    -------
    low, high : tuple of 3 int
        For `cv2.inRange`.
    """
    middle = np.median(disc_pixels(start), axis=0)
    strongest = int(middle.argmax())
    least, most = [0, 0, 0], [min(int(m) + slack, 255) for m in middle.tolist()]
    least[strongest], most[strongest] = int(low * middle[strongest]), 255
    return (least[0], least[1], least[2]), (most[0], most[1], most[2])


def hsv_mask(image: Image, bounds: tuple[Bound, Bound], opening: int) -> Mask:
    """Convert, select, and open by a square of that many pixels (0: not at all), as everybody does it."""
    mask = cv2.inRange(cv2.cvtColor(image, cv2.COLOR_BGR2HSV), bounds[0], bounds[1])
    return opened(np.asarray(mask, np.uint8), opening)


def bgr_mask(image: Image, bounds: tuple[Bound, Bound], opening: int) -> Mask:
    """Select without converting, and open."""
    return opened(np.asarray(cv2.inRange(image, bounds[0], bounds[1]), np.uint8), opening)


def opened(mask: Mask, opening: int) -> Mask:
    """Open a mask by a square of that many pixels; 0: leave it."""
    if not opening:
        return mask
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((opening, opening), np.uint8)), np.uint8)


def looks_right(image: Image, circle: Circle3, bounds: tuple[Bound, Bound]) -> bool:
    """Check a candidate of a detector that sees no color: most of eight pixels inside must have the ball's color."""
    x, y, radius = circle
    height, width = image.shape[:2]
    angles = [2.0 * math.pi * k / SPOTS for k in range(SPOTS)]
    places = [(x + SPOTS_SHARE * radius * math.cos(a), y + SPOTS_SHARE * radius * math.sin(a)) for a in angles]
    inside = [(round(v), round(u)) for u, v in places if 0 <= round(u) < width and 0 <= round(v) < height]
    if len(inside) < SPOTS_NEEDED:
        return False
    rows, columns = zip(*inside, strict=True)
    hsv = cv2.cvtColor(image[list(rows), list(columns)][np.newaxis], cv2.COLOR_BGR2HSV)
    return int(np.count_nonzero(cv2.inRange(hsv, bounds[0], bounds[1]))) >= SPOTS_NEEDED
