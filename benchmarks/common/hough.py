"""OpenCV's Hough transforms for circles on the gray whole frame, and which of their circles have the ball's color."""

import cv2

from benchmarks.common.start import Circle3, Image
from benchmarks.common.target_color import Bound, looks_right

MOST = 40  # candidates that are checked for color


def hough_circles(
    image: Image, method: int, bounds: tuple[Bound, Bound], blur: int, dp: float, edge: float, least: float, radius: int
) -> list[Circle3]:
    """Circles with the ball's color inside, in OpenCV's order.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
    method : int
        ``cv2.HOUGH_GRADIENT`` or ``cv2.HOUGH_GRADIENT_ALT``.
    bounds : tuple
        The color's range, see `looks_right`.
    blur : int
        Size of the Gaussian kernel, px.
    dp, edge, least : float
        The accumulator's cell, px; OpenCV's param1 and param2.
    radius : int
        Least radius, px.
    """
    gray = cv2.GaussianBlur(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), (blur, blur), 0)
    circles = cv2.HoughCircles(
        gray, method, dp=dp, minDist=20, param1=edge, param2=least, minRadius=radius, maxRadius=135
    )
    if circles is None:
        return []
    found = [(float(c[0]), float(c[1]), float(c[2])) for c in circles.reshape(-1, circles.shape[-1])[:MOST]]
    return [circle for circle in found if looks_right(image, circle, bounds)]
