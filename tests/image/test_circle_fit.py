"""The fit of a circle to an outline, against the same with NumPy's least squares."""

import math

import cv2
import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st

from matchset.image.candidates import FitLimits, fit_circle_kernel

Floats = npt.NDArray[np.float64]
LIMITS = FitLimits(rounds=4, tolerance=0.12, tolerance_px=1.5, min_points=12, min_inliers=0.5)


def slow(points: Floats, limits: FitLimits) -> Floats | None:
    """Fit x^2 + y^2 = 2 a x + 2 b y + c, again and again without the points far from the circle."""
    counted = points
    for _ in range(limits.rounds):
        if len(counted) < limits.min_points:
            return None
        rows = np.column_stack((2.0 * counted, np.ones(len(counted))))
        (x, y, c), _, rank, _ = np.linalg.lstsq(rows, (counted**2).sum(axis=1), rcond=None)
        if rank < 3:
            return None
        radius = math.sqrt(max(c + x * x + y * y, 1e-9))
        residual = np.abs(np.hypot(*(points - (x, y)).T) - radius)
        counted = points[residual < max(limits.tolerance * radius, limits.tolerance_px)]
    return np.array((x, y, radius)) if len(counted) >= limits.min_inliers * len(points) else None


def outline(radius: float, x: float, y: float, bite: float) -> npt.NDArray[np.int32]:
    """Outline of a disc in a picture of 200 x 200 px, of which a square is missing at one side."""
    image = np.zeros((200, 200), np.uint8)
    cv2.circle(image, (round(16.0 * x), round(16.0 * y)), round(16.0 * radius), 1, -1, shift=4)
    image[:, : round(max(x - radius + bite * radius, 0.0))] = 0
    contours, _ = cv2.findContours(image, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    return np.asarray(max(contours, key=len)[:, 0], np.int32)


@given(st.floats(8.0, 60.0), st.floats(80.0, 120.0), st.floats(80.0, 120.0), st.floats(0.0, 1.2))
def test_it_is_the_fit_of_least_squares(radius: float, x: float, y: float, bite: float) -> None:
    points, circle = outline(radius, x, y, bite), np.zeros(3)
    found, wanted = fit_circle_kernel(points, LIMITS, circle), slow(points.astype(np.float64), LIMITS)
    assert found == (wanted is not None)
    if wanted is not None:
        np.testing.assert_allclose(circle, wanted, atol=1e-6)


def test_points_on_a_line_or_too_few_are_no_circle() -> None:
    line = np.column_stack((np.arange(40), np.full(40, 7))).astype(np.int32)
    assert not fit_circle_kernel(line, LIMITS, np.zeros(3))
    assert not fit_circle_kernel(outline(20.0, 100.0, 100.0, 0.0)[:11], LIMITS, np.zeros(3))
