"""What a marker looks like: a patch of the sphere, an ellipse in the image.

At offset o from the middle of the ball (radius r, in the image) the rim of the patch is an ellipse with semi-axes
``a = r m`` across and ``a sqrt(1 - |o|^2 / (r k)^2)`` along o; m (`patch_radius`) and k (`rim_distance`) are the radius
of the patch and the distance of its rim's middle from the ball's center, in ball radii.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.localization.markers.marker_workspace import RIM_POINTS
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Number = float | np.float32

# theorem: tanh by Lambert's continued fraction, to 1e-6 where the argument is below 3; sums of single precision
TANH_LIMIT = np.float32(3.0)
ZERO, ONE, HALF, QUARTER, NO_DIVISION = (np.float32(v) for v in (0.0, 1.0, 0.5, 0.25, 1e-12))  # theorem: as above
T0, T1, T2, T3, T4, T5 = (np.float32(v) for v in (135135.0, 17325.0, 378.0, 62370.0, 3150.0, 28.0))  # theorem: as above
TINY = 1e-6  # px: nearer to the ball's middle an ellipse has no direction


class SoftEllipse(NamedTuple):
    """An ellipse with a soft rim; all numbers of one precision."""

    axis_x: Number  # direction of the short axis
    axis_y: Number
    ratio: Number  # of the axes
    semi_axis: Number  # the long one, px
    softness: Number  # of the rim, px


@kernel(refcount=False)
def ellipse_axes(dx: float, dy: float, limb: float, min_ratio: float) -> tuple[float, float, float]:
    """Direction of the short axis, and ratio of the axes, of a marker's ellipse.

    Parameters
    ----------
    dx, dy : float
        Its middle, from that of the ball, px.
    limb : float
        r k of the file's docstring: offset of a marker that is seen from its edge, px.
    min_ratio : float
        Least ratio.
    """
    far = math.sqrt(dx * dx + dy * dy)
    share = far / limb
    ratio = math.sqrt(max(1.0 - share * share, min_ratio * min_ratio))
    if far < TINY:
        return 1.0, 0.0, ratio
    return dx / far, dy / far, ratio


@kernel(refcount=False, reassociate=True)
def coverage(dx: Number, dy: Number, shape: SoftEllipse) -> tuple[Number, Number, Number]:
    """Softened ellipse at (dx, dy) px from its middle.

    Returns
    -------
    tuple of 3 floats
        Share of marker, ``1 / (1 + exp(-z))`` where z is the distance from the rim in units of the softness, and its
        derivatives as the ellipse moves to the right and down, per px.
    """
    ux, uy, narrow = shape.axis_x, shape.axis_y, ONE / shape.ratio
    along, across = (dx * ux + dy * uy) * narrow, dy * ux - dx * uy
    gx, gy = along * ux * narrow - across * uy, along * uy * narrow + across * ux
    far = math.sqrt(along * along + across * across + NO_DIVISION)
    flat = ONE / (shape.softness * math.sqrt(gx * gx + gy * gy + NO_DIVISION))
    half = HALF * (shape.semi_axis - far) * far * flat
    square = half * half  # tanh(z / 2)
    above = half * (T0 + square * (T1 + square * (T2 + square)))
    below = T0 + square * (T3 + square * (T4 + square * T5))
    turn = HALF * above / below
    steep = (QUARTER - turn * turn) * flat
    turn = turn if half < TANH_LIMIT else HALF
    turn = turn if half > -TANH_LIMIT else -HALF
    steep = steep if turn * turn < QUARTER else ZERO
    return HALF + turn, steep * gx, steep * gy


@kernel(refcount=False)
def describe_marker(work: Any, k: int, row: int) -> None:
    """Describe marker k as a circle of its ellipse's area, with its rim and covariance, in a row of what is found.

    Parameters
    ----------
    work : record of `MarkerWork`, written
    k, row : int
    """
    ball, fit = work.ball, work.limits.fit
    x, y, a = work.places[k, 0], work.places[k, 1], work.patch_radius * ball.radius
    ux, uy, ratio = ellipse_axes(x - ball.x, y - ball.y, ball.radius * work.rim_distance, fit.min_axis_ratio)
    for point in range(RIM_POINTS):
        turn = 2.0 * math.pi * point / RIM_POINTS
        along, across = a * ratio * math.cos(turn), a * math.sin(turn)
        work.rim[row, point, 0] = x + along * ux - across * uy
        work.rim[row, point, 1] = y + along * uy + across * ux
    radius = a * math.sqrt(ratio)
    floor = work.limits.min_sigma_px * work.limits.min_sigma_px
    for p in range(2):
        for q in range(2):
            own = work.limits.inflation * work.result.covariance[p, q]
            work.covariance[row, p, q] = own + (floor if p == q else 0.0)
        work.covariance[row, p, 2] = work.covariance[row, 2, p] = 0.0
    share = radius / ball.radius
    work.covariance[row, 2, 2] = share * share * ball.radius_variance + (fit.size_sigma * radius) ** 2
    work.middle[row, 0], work.middle[row, 1], work.radius[row], work.explained[row] = (
        x,
        y,
        radius,
        work.result.explained,
    )
