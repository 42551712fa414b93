"""What a marker looks like: a patch of the sphere, an ellipse in the picture.

At offset o from the middle of the ball (radius r, in the picture) the rim of the patch is an ellipse with semi-axes
``a = r m`` across and ``a sqrt(1 - |o|^2 / (r k)^2)`` along o; m and k are the radius of the patch and the distance of
its rim's middle from the ball's center, in ball radii.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]

EDGE_ON = 0.25  # least ratio of the ellipse's axes that is drawn


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


@kernel
def coverage(
    dx: float, dy: float, ux: float, uy: float, a: float, ratio: float, soft: float
) -> tuple[float, float, float]:
    """Softened ellipse at (dx, dy) from its middle.

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
        Share of marker, and how that grows as the ellipse moves to the right and down, per px.
    """
    narrow = 1.0 / ratio
    along, across = (dx * ux + dy * uy) * narrow, dy * ux - dx * uy
    square = along * along + across * across
    if square < 1e-18:
        return 1.0, 0.0, 0.0
    near = 1.0 / math.sqrt(square)
    nx, ny = (along * ux * narrow - across * uy) * near, (along * uy * narrow + across * ux) * near
    flat = 1.0 / (soft * math.sqrt(nx * nx + ny * ny))
    z = (a - square * near) * flat
    if z * z > 36.0:
        return (1.0 if z > 0.0 else 0.0), 0.0, 0.0
    share = 1.0 / (1.0 + math.exp(-z))
    steep = share * (1.0 - share) * flat
    return share, steep * nx, steep * ny


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
