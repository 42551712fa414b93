"""What a marker looks like: a patch of the sphere, an ellipse in the picture.

At offset o from the middle of the ball (radius r, in the picture) the rim of the patch is an ellipse with semi-axes
``a = r m`` across and ``a sqrt(1 - |o|^2 / (r k)^2)`` along o; m and k are the radius of the patch and the distance of
its rim's middle from the ball's center, in ball radii.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import inlined, kernel

Floats = npt.NDArray[np.float64]
Number = float | np.float32

EDGE_ON = 0.25  # least ratio of the ellipse's axes that is drawn
WIDEST = np.float32(3.0)  # half the softnesses from the rim beyond which all is marker, or nothing
ZERO, ONE, HALF, QUARTER, TINY = np.float32(0.0), np.float32(1.0), np.float32(0.5), np.float32(0.25), np.float32(1e-12)
T0, T1, T2, T3, T4, T5 = (np.float32(term) for term in (135135.0, 17325.0, 378.0, 62370.0, 3150.0, 28.0))
VAGUE = 0.05  # standard deviation of a marker's radius, as a share of it


@kernel
def ellipse(place: Floats, ball: Floats, depth: float) -> tuple[float, float, float]:
    """Find the direction of the short axis and the ratio of the axes for a marker.

    Parameters
    ----------
    place : (2,)
        Its middle, px.
    ball : (3,)
        x, y, radius, px.
    depth : float
        k of the file's docstring.
    """
    ox, oy = place[0] - ball[0], place[1] - ball[1]
    far = math.sqrt(ox * ox + oy * oy)
    share = far / (ball[2] * depth)
    ratio = math.sqrt(max(1.0 - share * share, EDGE_ON * EDGE_ON))
    if far < 1e-6:
        return 1.0, 0.0, ratio
    return ox / far, oy / far, ratio


@inlined
def coverage(
    dx: Number, dy: Number, ux: Number, uy: Number, a: Number, ratio: Number, soft: Number
) -> tuple[Number, Number, Number]:
    """Softened ellipse at (dx, dy) from its middle; all numbers of one precision.

    Parameters
    ----------
    dx, dy : float
        px.
    ux, uy, ratio : float
        See `ellipse`.
    a : float
        Long semi-axis, px.
    soft : float
        Softness of the rim, px.

    Returns
    -------
    tuple of 3 floats
        Share of marker, ``1 / (1 + exp(-z))`` where z is the distance from the rim in units of `soft`, and how that
        grows as the ellipse moves to the right and down, per px.
    """
    narrow = ONE / ratio
    along, across = (dx * ux + dy * uy) * narrow, dy * ux - dx * uy
    gx, gy = along * ux * narrow - across * uy, along * uy * narrow + across * ux
    far = math.sqrt(along * along + across * across + TINY)
    flat = ONE / (soft * math.sqrt(gx * gx + gy * gy + TINY))
    half = HALF * (a - far) * far * flat
    square = half * half  # tanh(z / 2), by Lambert's continued fraction: to 1e-6
    above = half * (T0 + square * (T1 + square * (T2 + square)))
    below = T0 + square * (T3 + square * (T4 + square * T5))
    turn = HALF * above / below
    steep = (QUARTER - turn * turn) * flat
    turn = turn if half < WIDEST else HALF
    turn = turn if half > -WIDEST else -HALF
    steep = steep if turn * turn < QUARTER else ZERO
    return HALF + turn, steep * gx, steep * gy


@kernel
def describe(
    place: Floats, ball: Floats, size: float, depth: float, covariance: Floats, spread: float, rim: Floats, wide: Floats
) -> float:
    """Describe a marker as a circle: the radius of its ellipse's area, px.

    Parameters
    ----------
    place, ball, depth
        See `ellipse`.
    size : float
        m of the file's docstring.
    covariance : (2, 2)
        Of its place, px^2.
    spread : float
        Variance of the ball's radius, px^2.
    rim : (k, 2), written
        Points of the ellipse, px.
    wide : (3, 3), written
        Covariance of x, y and the radius, px^2.
    """
    ux, uy, ratio = ellipse(place, ball, depth)
    a = size * ball[2]
    for k in range(rim.shape[0]):
        turn = 2.0 * math.pi * k / rim.shape[0]
        along, across = a * ratio * math.cos(turn), a * math.sin(turn)
        rim[k, 0] = place[0] + along * ux - across * uy
        rim[k, 1] = place[1] + along * uy + across * ux
    radius = a * math.sqrt(ratio)
    wide[:] = 0.0
    wide[:2, :2] = covariance
    wide[2, 2] = (radius / ball[2]) ** 2 * spread + (VAGUE * radius) ** 2
    return float(radius)
