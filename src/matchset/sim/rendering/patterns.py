"""Patterns of balls: the share of a second color at a point of the unit sphere."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

GOLDEN = 0.5 * (1.0 + math.sqrt(5.0))  # theorem: golden ratio, of the vertices of an icosahedron
PENTAGON, HEXAGON = 2.3274, 2.2673  # theorem: distances of the faces of a truncated icosahedron from its center, edges


class PatternParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How patterns look. All chosen by hand, after photographs.

    Parameters
    ----------
    seam : float
        Width of a seam, rad as seen from the center of the ball.
    loop : float
        Angle of a basketball's two loops from their axis, rad.
    logo : float
        Angle of the logo's ring from its middle, rad.
    points : tuple of 2 floats
        Angles from the logo's middle to the inner and the outer corners of its star, rad.
    """

    seam: float = 0.05
    loop: float = 0.85
    logo: float = 0.55
    points: tuple[float, float] = (0.18, 0.42)


PATTERNS = PatternParameters()


def pattern_share(name: str, points: Array, soft: float) -> Array:
    """Share of a pattern's color.

    Parameters
    ----------
    name : str
        "plain", "soccer", "basketball" or "logo".
    points : ndarray of shape (..., 3)
        Unit vectors of the ball's own frame; a logo is around -z, which faces the camera where the ball is not turned.
    soft : float
        Width of a border between the colors, rad as seen from the center of the ball: what a pixel spans.

    Returns
    -------
    ndarray of shape (...)
        0 ... 1.
    """
    if name == "soccer":
        return _soccer(points, soft)
    if name == "basketball":
        return _basketball(points, soft)
    return _logo(points, soft) if name == "logo" else np.zeros(points.shape[:-1])


def _step(distance: Array, soft: float) -> Array:
    """0 where the distance is negative, 1 where it is positive, with a border of some width; rad."""
    return np.clip(distance / max(soft, 1e-6) + 0.5, 0.0, 1.0)


def _line(distance: Array, soft: float) -> Array:
    """Share of a seam at a distance from its middle, rad."""
    half = 0.5 * PATTERNS.seam
    return _step(half - np.abs(distance), soft) * min(1.0, 2.0 * half / max(soft, 1e-6))


def _soccer(points: Array, soft: float) -> Array:
    """Black pentagons, and seams between the hexagons of a truncated icosahedron.

    A ray from the center meets the face with the largest ``n.f / distance``, n its direction, f the face's normal.
    """
    five, six = _icosahedron()
    pentagons = (points @ five.T).max(axis=-1) / PENTAGON
    hexagons = np.partition(points @ six.T / HEXAGON, -2, axis=-1)[..., -2:]
    # Gradients per rad: the difference of two normals, over their distance.
    black = _step((pentagons - hexagons[..., 1]) * HEXAGON / 0.65, soft)
    seam = _line((hexagons[..., 1] - hexagons[..., 0]) * HEXAGON / 0.71, soft)
    return np.maximum(black, 0.7 * seam)


def _icosahedron() -> tuple[Array, Array]:
    """Return unit vectors to the twelve vertices and to the middles of the twenty faces of an icosahedron."""
    corners = np.array([(0.0, a, b * GOLDEN) for a in (-1.0, 1.0) for b in (-1.0, 1.0)])
    five = np.concatenate([np.roll(corners, shift, axis=1) for shift in range(3)]) / math.hypot(1.0, GOLDEN)
    near = five @ five.T > 0.4
    middles = [
        five[i] + five[j] + five[k]
        for i in range(12)
        for j in range(i)
        for k in range(j)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    six = np.array(middles)
    return five, six / np.linalg.norm(six, axis=1, keepdims=True)


def _basketball(points: Array, soft: float) -> Array:
    """Two great circles, and a loop around either end of the x axis."""
    x, y, z = np.moveaxis(points, -1, 0)
    circles = np.maximum(_line(np.arcsin(np.clip(y, -1.0, 1.0)), soft), _line(np.arcsin(np.clip(z, -1.0, 1.0)), soft))
    return np.maximum(circles, _line(np.arccos(np.clip(np.abs(x), 0.0, 1.0)) - PATTERNS.loop, soft))


def _logo(points: Array, soft: float) -> Array:
    """Draw a star of five points in a ring, around -z; rho is the angle from there."""
    x, y, z = np.moveaxis(points, -1, 0)
    rho, turn = np.arccos(np.clip(-z, -1.0, 1.0)), np.arctan2(y, x)
    inner, outer = PATTERNS.points
    from_tip = np.abs((turn + 0.5 * math.pi) % (0.4 * math.pi) - 0.2 * math.pi) / (0.2 * math.pi)
    star = _step(inner + (outer - inner) * from_tip**1.5 - rho, soft)
    ring = _step(1.5 * PATTERNS.seam - np.abs(rho - PATTERNS.logo), soft)
    return np.maximum(star, ring)
