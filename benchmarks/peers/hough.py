"""OpenCV's two Hough transforms for circles on the gray whole frame: what the paper compares itself with."""

import cv2
import msgspec

from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import Bound, hsv_range, looks_right

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


class GradientParameters(msgspec.Struct, frozen=True):
    """Blur, px; the accumulator's cell, px; Canny's upper threshold; votes; least radius, px; the spot check's hue."""

    blur: int = 9
    dp: float = 1.5
    edge: float = 100.0
    votes: float = 30.0
    least_radius: int = 8
    hue: int = 22


GRADIENT_CHOICES: Choices = {
    "votes": (15.0, 22.0, 30.0, 45.0),
    "blur": (9, 13),
    "edge": (60.0, 100.0, 160.0),
    "dp": (1.0, 1.5, 2.0),
    "least_radius": (4, 10),
}


def follow_gradient(start: Start, parameters: GradientParameters) -> Step:
    """Detect in every frame; of the circles with the ball's color inside, the one with most votes."""
    bounds = hsv_range(start, parameters.hue, 0.4, 0.3)

    def step(image: Image) -> Circle3 | None:
        found = hough_circles(
            image,
            cv2.HOUGH_GRADIENT,
            bounds,
            parameters.blur,
            parameters.dp,
            parameters.edge,
            parameters.votes,
            parameters.least_radius,
        )
        return next(iter(found), None)

    return step


class AltParameters(msgspec.Struct, frozen=True):
    """Blur, px; accumulator, px; Scharr's upper threshold; perfection of the circle, 0 ... 1; least radius, px."""

    blur: int = 9
    dp: float = 1.5
    edge: float = 300.0
    perfection: float = 0.8
    least_radius: int = 8


ALT_CHOICES: Choices = {
    "blur": (5, 9, 13),
    "perfection": (0.5, 0.65, 0.8),
    "edge": (100.0, 200.0, 300.0),
    "dp": (1.5, 2.0),
    "least_radius": (4, 12),
}


def follow_alt(start: Start, parameters: AltParameters) -> Step:
    """Detect in every frame; of the circles with the ball's color inside, the largest."""
    bounds = hsv_range(start, 22, 0.4, 0.3)

    def step(image: Image) -> Circle3 | None:
        found = hough_circles(
            image,
            cv2.HOUGH_GRADIENT_ALT,
            bounds,
            parameters.blur,
            parameters.dp,
            parameters.edge,
            parameters.perfection,
            parameters.least_radius,
        )
        return max(found, key=lambda circle: circle[2], default=None)

    return step


PEERS = {
    "hough_gradient": Method(
        "HoughCircles (gradient), gray whole frame", "color", GradientParameters, GRADIENT_CHOICES, follow_gradient
    ),
    "hough_alt": Method("HoughCircles (ALT), gray whole frame", "color", AltParameters, ALT_CHOICES, follow_alt),
}
