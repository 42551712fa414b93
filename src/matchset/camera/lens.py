"""OpenCV's five-coefficient lens: from pixels to rays and back, for single points.

A point (X, Y, Z) of the camera frame has x = X / Z, y = Y / Z, s = x^2 + y^2. The lens moves it to

    x' = x (1 + k1 s + k2 s^2 + k3 s^3) + 2 p1 x y + p2 (s + 2 x^2)
    y' = y (1 + k1 s + k2 s^2 + k3 s^3) + p1 (s + 2 y^2) + 2 p2 x y

and the picture shows it at (fx x' + cx, fy y' + cy) px. `intrinsics` is always fx, fy, cx, cy, k1, k2, p1, p2, k3. The
polynomial is no lens where it folds back on itself: there the kernels report a miss (a row of zeros), never a guess.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]

INTRINSICS = "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"
"""What the nine numbers are, in their order."""

MIN_SLOPE = 0.01  # geometry: below this d r' / d r the lens counts as folded: 1 px of noise is 100 px of direction
_WIDEST = 1.0e6  # geometry: largest s = x^2 + y^2, 89.9 degrees off the axis
_ITERATIONS = 60  # theorem: as many halvings leave nothing of an interval in double precision
_NEAR = 1.0e-6  # theorem: Newton's step squares an error: from this one to below 1e-10
_ROUGH = 1.0e-2  # theorem: the same where two unknowns are solved for afterwards


@kernel
def _slope(s: float, k1: float, k2: float, k3: float) -> float:
    """Radial slope d r' / d r = 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3, less what counts as folded."""
    return 1.0 - MIN_SLOPE + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3))


@kernel
def fold(k1: float, k2: float, k3: float) -> float:
    """Find where the radial polynomial stops to grow.

    Parameters
    ----------
    k1, k2, k3 : float
        Radial coefficients.

    Returns
    -------
    float
        s = x^2 + y^2 of the last point that has an image of its own; 1e6 if the polynomial never folds.
    """
    # The slope is monotone between its own turning points, the roots of 3 k1 + 10 k2 s + 21 k3 s^2.
    first, second = _WIDEST, _WIDEST
    square = 25.0 * k2 * k2 - 63.0 * k1 * k3
    if square >= 0.0:
        half_sum = -5.0 * k2 - math.copysign(math.sqrt(square), k2)
        one = half_sum / (21.0 * k3) if k3 != 0.0 else _WIDEST
        other = 3.0 * k1 / half_sum if half_sum != 0.0 else _WIDEST
        first, second = min(one, other), max(one, other)
    low = 0.0
    for end in (first, second, _WIDEST):
        high = min(end, _WIDEST)
        if high <= low:
            continue
        if _slope(high, k1, k2, k3) < 0.0:
            for _ in range(_ITERATIONS):
                half = 0.5 * (low + high)
                if _slope(half, k1, k2, k3) < 0.0:
                    high = half
                else:
                    low = half
            return low
        low = high
    return _WIDEST


@kernel
def _radial(target: float, widest: float, near: float, k1: float, k2: float, k3: float) -> float:
    """Find r with r (1 + k1 s + k2 s^2 + k3 s^3) = target: Newton, kept between two bounds; -1 beyond the fold.

    Once the error is below `near` one more step is the last: it squares the error.
    """
    low, high = 0.0, widest
    s = widest * widest
    if not target <= widest * (1.0 + s * (k1 + s * (k2 + s * k3))):
        return -1.0
    t = target * target  # the first terms of the inverse series
    r = max(0.0, min(target * (1.0 + t * (t * (3.0 * k1 * k1 - k2) - k1)), 0.98 * widest))
    for _ in range(_ITERATIONS):
        s = r * r
        error = r * (1.0 + s * (k1 + s * (k2 + s * k3))) - target
        slope = 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3))
        if error > 0.0:
            high = r
        else:
            low = r
        r -= error / slope
        if not low <= r <= high:
            r = 0.5 * (low + high)
        elif abs(error) < near * min(1.0, slope * slope):
            break
    return r


@kernel
def bend(intrinsics: Floats, x: float, y: float) -> tuple[float, float, float]:
    """How the lens bends around a direction: d x' / d x, d x' / d y = d y' / d x, d y' / d y.

    Parameters
    ----------
    intrinsics : ndarray of shape (9,), float64
    x, y : float
        X / Z and Y / Z of the direction.
    """
    k1, k2, p1, p2, k3 = intrinsics[4], intrinsics[5], intrinsics[6], intrinsics[7], intrinsics[8]
    s = x * x + y * y
    gain = 1.0 + s * (k1 + s * (k2 + s * k3))
    turn = 2.0 * (k1 + s * (2.0 * k2 + s * 3.0 * k3))
    across = turn * x * y + 2.0 * p1 * x + 2.0 * p2 * y
    return gain + turn * x * x + 2.0 * p1 * y + 6.0 * p2 * x, across, gain + turn * y * y + 6.0 * p1 * y + 2.0 * p2 * x


@kernel
def undistort(intrinsics: Floats, widest: float, u: float, v: float) -> tuple[float, float, bool]:
    """Take the lens out of one point of the picture.

    Parameters
    ----------
    intrinsics : ndarray of shape (9,), float64
    widest : float
        ``fold(k1, k2, k3)``.
    u, v : float
        The point, px.

    Returns
    -------
    tuple of float, float, bool
        x = X / Z, y = Y / Z and True; or zeros and False if no direction is seen there.
    """
    k1, k2, p1, p2, k3 = intrinsics[4], intrinsics[5], intrinsics[6], intrinsics[7], intrinsics[8]
    seen_x, seen_y = (u - intrinsics[2]) / intrinsics[0], (v - intrinsics[3]) / intrinsics[1]
    target = math.sqrt(seen_x * seen_x + seen_y * seen_y)
    if not target < 1.0e150:  # neither NaN nor infinite, and its square neither
        return 0.0, 0.0, False
    x, y = seen_x, seen_y
    if k1 != 0.0 or k2 != 0.0 or k3 != 0.0:
        near = _NEAR if p1 == 0.0 and p2 == 0.0 else _ROUGH
        r = _radial(target, math.sqrt(widest), near, k1, k2, k3)
        if r < 0.0:
            return 0.0, 0.0, False
        if target > 0.0:
            x, y = seen_x * (r / target), seen_y * (r / target)
    if p1 == 0.0 and p2 == 0.0:
        return x, y, True
    for _ in range(_ITERATIONS):
        s = x * x + y * y
        if not s <= widest:
            break
        gain = 1.0 + s * (k1 + s * (k2 + s * k3))
        error_x = x * gain + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x) - seen_x
        error_y = y * gain + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y - seen_y
        xx, xy, yy = bend(intrinsics, x, y)
        area = xx * yy - xy * xy
        if not area > MIN_SLOPE * MIN_SLOPE:
            break
        x -= (yy * error_x - xy * error_y) / area
        y -= (xx * error_y - xy * error_x) / area
        if abs(error_x) + abs(error_y) < _NEAR * min(1.0, area * area):
            if x * x + y * y <= widest:
                return x, y, True
            break
    return 0.0, 0.0, False


@kernel
def unproject(intrinsics: Floats, points: Floats, rays: Floats) -> int:
    """Turn points of the picture into rays.

    Parameters
    ----------
    intrinsics : ndarray of shape (9,), float64
        fx, fy, cx, cy (px), k1, k2, p1, p2, k3.
    points : ndarray of shape (n, 2), float64
        px.
    rays : ndarray of shape (n, 3), float64
        Filled with unit vectors of the camera frame; zeros where no direction is seen.

    Returns
    -------
    int
        How many points have no ray.
    """
    widest = fold(intrinsics[4], intrinsics[5], intrinsics[8])
    missed = 0
    for i in range(len(points)):
        x, y, seen = undistort(intrinsics, widest, points[i, 0], points[i, 1])
        if seen:
            scale = 1.0 / math.sqrt(x * x + y * y + 1.0)
            rays[i, 0], rays[i, 1], rays[i, 2] = x * scale, y * scale, scale
        else:
            rays[i, 0], rays[i, 1], rays[i, 2] = 0.0, 0.0, 0.0
            missed += 1
    return missed


@kernel
def project(intrinsics: Floats, points: Floats, pixels: Floats, seen: npt.NDArray[np.bool_]) -> int:
    """Turn points of the camera frame into points of the picture.

    Parameters
    ----------
    intrinsics : ndarray of shape (9,), float64
        fx, fy, cx, cy (px), k1, k2, p1, p2, k3.
    points : ndarray of shape (n, 3), float64
        m; directions will do.
    pixels : ndarray of shape (n, 2), float64
        Filled with px; zeros where there is no image.
    seen : ndarray of shape (n,), bool
        Filled: whether the point lies before the camera and the lens does not fold there.

    Returns
    -------
    int
        How many points have no image.
    """
    k1, k2, p1, p2, k3 = intrinsics[4], intrinsics[5], intrinsics[6], intrinsics[7], intrinsics[8]
    widest = fold(k1, k2, k3)
    missed = 0
    for i in range(len(points)):
        depth = points[i, 2]
        x = points[i, 0] / depth if depth > 0.0 else math.inf
        y = points[i, 1] / depth if depth > 0.0 else math.inf
        s = x * x + y * y
        seen[i] = s <= widest
        if not seen[i]:
            pixels[i, 0], pixels[i, 1] = 0.0, 0.0
            missed += 1
            continue
        gain = 1.0 + s * (k1 + s * (k2 + s * k3))
        lens_x = x * gain + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x)
        lens_y = y * gain + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y
        pixels[i, 0] = intrinsics[0] * lens_x + intrinsics[2]
        pixels[i, 1] = intrinsics[1] * lens_y + intrinsics[3]
    return missed
