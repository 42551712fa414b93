"""A patch on a ball, drawn slowly and obviously."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]


def picture_of_marker(
    ball: npt.NDArray[np.float64], middle: npt.NDArray[np.float64], size: float, depth: float, finer: int = 6
) -> npt.NDArray[np.uint8]:
    """Blue all over, redder inside the ellipse that a patch of a far sphere shows: every pixel the mean of many points.

    Parameters
    ----------
    ball : (3,)
        x, y, radius, px.
    middle : (2,)
        Middle of the patch's rim, px.
    size, depth : float
        Radius of the patch, and how far the middle of its rim is from the ball's center, in ball radii.
    finer : int
        Points along x and along y in every pixel.
    """
    offset = (middle - ball[:2]) / ball[2]
    # The patch is where the direction n from the ball's center has n.m > depth, m its own direction.
    x, y = offset / depth
    direction = np.array((x, y, math.sqrt(1.0 - x * x - y * y)))
    axis = (np.arange(120 * finer) + 0.5) / finer - 0.5
    columns, rows = np.meshgrid(axis, axis)
    nx, ny = (columns - ball[0]) / ball[2], (rows - ball[1]) / ball[2]
    nz = np.sqrt(np.maximum(1.0 - nx * nx - ny * ny, 0.0))
    inside = (nx * direction[0] + ny * direction[1] + nz * direction[2] > math.sqrt(1.0 - size * size)) & (nz > 0.0)
    share = inside.reshape(120, finer, 120, finer).mean(axis=(1, 3))
    image = np.full((120, 120, 3), (200, 60, 40), np.uint8)
    image[..., 2] = np.rint(40.0 + 120.0 * share)
    return image


class Sight(NamedTuple):
    """A marker as a fit sees it, in the picture, px."""

    ball: Floats
    middle: Floats
    other: Floats
    along: Floats
    ratio: float
    radius: float
    soft: float
    reach: float


class Scale(NamedTuple):
    """From colors to the scale from ball to marker, and the light: level, per px right and per px down."""

    axis: Floats
    ground: Floats
    shade: Floats


def weights_of(image: Bytes, sight: Sight, scale: Scale) -> tuple[Floats, Floats]:
    """What every pixel of a picture weighs, and the light there in that at the marker's middle."""
    rows, columns = np.indices(image.shape[:2])
    dx, dy = columns - sight.middle[0], rows - sight.middle[1]
    light = 1.0 + (scale.shade[1] * dx + scale.shade[2] * dy) / scale.shade[0]
    glint = image @ scale.ground / (scale.shade[0] * light)
    inside = sight.ball[2] - np.hypot(columns - sight.ball[0], rows - sight.ball[1])
    weight = np.clip((inside - 0.5) / 3.0, 0.0, 1.0) * np.clip((1.3 - glint) / 0.15, 0.0, 1.0)
    nearer = np.hypot(columns - sight.other[0], rows - sight.other[1]) < np.hypot(dx, dy)
    return np.where(nearer | (np.hypot(dx, dy) > sight.reach), 0.0, weight), light


def share_of(dx: float, dy: float, sight: Sight) -> tuple[float, float, float]:
    """Share of the marker at (dx, dy) from its middle, and how it grows as the marker moves right and down."""
    ux, uy = sight.along
    a, b = (dx * ux + dy * uy) / sight.ratio, dy * ux - dx * uy
    far = math.hypot(a, b)
    gx, gy = (a * ux / sight.ratio - b * uy) / far, (a * uy / sight.ratio + b * ux) / far
    soft = sight.soft * math.hypot(gx, gy)
    z = (sight.radius - far) / soft
    inside = 0.5 * (1.0 + math.tanh(0.5 * z)) if abs(z) < 6.0 else float(z > 0.0)
    slope = inside * (1.0 - inside) / soft
    return inside, slope * gx, slope * gy


def normal_equations(
    image: Bytes, sight: Sight, scale: Scale, height: float, level: float, tie: float
) -> tuple[Floats, float]:
    """Products of the columns x, y, height, level and what is left, (5, 5); what is left, squared."""
    weight, light = weights_of(image, sight, scale)
    total, rest = np.zeros((5, 5)), 0.0
    for row in range(image.shape[0]):
        before = None
        for column in range(image.shape[1]):
            w, lit = weight[row, column], light[row, column]
            if w == 0.0:
                before = None
                continue
            dx, dy = column - sight.middle[0], row - sight.middle[1]
            inside, right, under = share_of(dx, dy, sight)
            e = float(image[row, column] @ scale.axis[:3]) + scale.axis[3] - level - height * lit * inside
            here = np.array((height * lit * right, height * lit * under, lit * inside, 1.0, e))
            line = math.sqrt(1.0 - tie * tie) * here if before is None else here - tie * before
            total += w * np.outer(line, line)
            rest += w * e * e
            before = here
    return total, rest
