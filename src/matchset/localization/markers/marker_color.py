"""Kernels that find patches of the marker's color on the ball, and learn how the two colors differ."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.localization.markers.marker_patch import field_shift
from matchset.localization.markers.marker_shape import ellipse_axes
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import invert_3x3, transform

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Index = np.uintp | int

TINY = 1e-9  # of color distances and brightness, whose inverse is taken


@kernel(refcount=False)
def _cell(image: Bytes, row: int, column: int) -> int:
    """Color cell of a pixel."""
    if image.shape[2] == 1:
        return int(image[row, column, 0])
    b, g, r = int(image[row, column, 0]), int(image[row, column, 1]), int(image[row, column, 2])
    return (b >> 3) << 10 | (g >> 3) << 5 | r >> 3


@kernel(refcount=False)
def mark_color(
    image: Bytes,
    table: npt.NDArray[np.int8],
    circle: tuple[float, float, float],
    fields: tuple[float, float],
    step: int,
    mask: Bytes,
) -> tuple[int, int]:
    """Mark the pixels of a color inside a circle, on a grid of every `step`-th pixel.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    table : (32768,) or (256,) int8
        See `ColorModel`.
    circle : tuple of 3 floats
        x, y, radius, px.
    fields : tuple of 2 floats
        From the odd rows' field to that of the even rows, px: each row is read where its field shows the circle.
    step : int
    mask : (n, n) uint8, written
        1 where the mean score over the cell's 3 x 3 pixels is positive.

    Returns
    -------
    tuple of int
        Column and row of the pixel at mask[0, 0].
    """
    x, y, radius = circle
    left, top = math.floor(x - radius), math.floor(y - radius)
    height, width = image.shape[0], image.shape[1]
    for i in range(mask.shape[0]):
        for j in range(mask.shape[1]):
            row, column = top + i * step, left + j * step
            mask[i, j] = 0
            if (column - x) ** 2 + (row - y) ** 2 > radius * radius:
                continue
            score = 0
            for a in range(row - 1, row + 2):
                right, under = field_shift(fields[0], fields[1], a)
                there, beside = a + 2 * round(0.5 * under), column + round(right)
                if there < 0 or beside < 1 or there >= height or beside >= width - 1:
                    score = 0
                    break
                for b in range(beside - 1, beside + 2):
                    score += table[_cell(image, there, b)]
            mask[i, j] = score > 0
    return left, top


@kernel(refcount=False)
def _add_color(color: tuple[float, float, float], first: Index, sums: Floats) -> None:
    """Add a color to the count, the sums and the products of a row of `sum_colors`, which begins at `first`."""
    b, g, r = color
    sums[first] += 1.0
    sums[first + np.uintp(1)] += b
    sums[first + np.uintp(2)] += g
    sums[first + np.uintp(3)] += r
    sums[first + np.uintp(4)] += b * b
    sums[first + np.uintp(5)] += g * b
    sums[first + np.uintp(6)] += g * g
    sums[first + np.uintp(7)] += r * b
    sums[first + np.uintp(8)] += r * g
    sums[first + np.uintp(9)] += r * r


@kernel
def _marker_axes(work: Any) -> Floats:
    """Of every marker that was seen: its middle, and the axes of its ellipse, scaled so that the rim is a circle."""
    axes, ball = np.empty((work.seen, 6)), work.ball
    for k in range(work.seen):
        x, y = work.places[k, 0], work.places[k, 1]
        limb, least = ball.radius * work.rim_distance, work.limits.fit.min_axis_ratio
        ux, uy, ratio = ellipse_axes(x - ball.x, y - ball.y, limb, least)
        axes[k, 0], axes[k, 1], axes[k, 2], axes[k, 3], axes[k, 4], axes[k, 5] = ux / ratio, uy / ratio, ux, uy, x, y
    return axes


@kernel(refcount=False)
def _distance_squared(axes: Floats, column: float, row: float) -> float:
    """Squared distance of a point from the nearest marker, foreshortening taken out, px^2."""
    nearest = math.inf
    for marker in range(axes.shape[0]):
        k = np.uintp(marker)
        dx, dy = column - axes[k, 4], row - axes[k, 5]
        along, across = dx * axes[k, 0] + dy * axes[k, 1], dy * axes[k, 2] - dx * axes[k, 3]
        nearest = min(nearest, along * along + across * across)
    return nearest


@kernel
def sum_colors(image: Bytes, work: Any, sums: Floats) -> None:
    """Sum up colors of the markers that were seen and of the ball between them.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    work : record of `MarkerWork`
    sums : (20,), written
        Of the markers, then of the ball: count, sums of b, g, r, of bb, gb, gg, rb, rg, rr.
    """
    ball, limits, axes = work.ball, work.limits.color, _marker_axes(work)
    for place in range(sums.size):
        sums[place] = 0.0
    a, reach, step = (
        work.patch_radius * ball.radius,
        limits.ball_inside * ball.radius,
        max(int(ball.radius / limits.rows), 1),
    )
    inside, outside = (limits.marker_inside * a) ** 2, (limits.marker_outside * a) ** 2
    height, width, channels = image.shape
    flat, left = image.reshape(-1), max(int(ball.x - reach), 0)
    for row in range(max(int(ball.y - reach), 0), min(int(ball.y + reach) + 1, height), step):
        right, under = field_shift(ball.field_x, ball.field_y, row)
        half, x = math.sqrt(max(reach * reach - (row - under - ball.y) ** 2, 0.0)), ball.x + right
        first = left + step * max(math.ceil((x - half - left) / step), 0)
        for column in range(first, min(math.floor(x + half) + 1, width), step):
            nearest = _distance_squared(axes, column - right, row - under)
            if nearest < inside or nearest > outside:
                at = np.uintp((row * width + column) * channels)
                b, g, r = float(flat[at]), 0.0, 0.0
                if channels == 3:
                    g, r = float(flat[at + np.uintp(1)]), float(flat[at + np.uintp(2)])
                _add_color((b, g, r), np.uintp(0 if nearest < inside else 10), sums)


@kernel(refcount=False)
def update_means(work: Any, sums: Floats) -> bool:
    """Update the means of the colors, of which the last frames count most.

    Parameters
    ----------
    work : record of `MarkerWork`
        Its `colors` are written, zeros at first.
    sums : (20,)
        See `sum_colors`.

    Returns
    -------
    bool
        False where too few pixels were seen; then nothing is written.
    """
    limits, known = work.limits.color, work.colors
    if sums[0] < limits.min_marker_pixels or sums[10] < limits.min_ball_pixels:
        return False
    kept = limits.memory if known[0, 0] > 0.0 else 0.0
    for row in range(2):
        for place in range(10):
            fresh = sums[10 * row + place] / sums[10 * row]
            known[row, place] = kept * known[row, place] + (1.0 - kept) * fresh
    return True


@kernel
def fisher_axis(work: Any) -> None:
    """Direction of color that separates marker from ball best (Fisher's linear discriminant), and the ball's color.

    Parameters
    ----------
    work : record of `MarkerWork`
        `colors` are read; `axis` and `brightness` are written, unless the two have the same color.
    """
    within, inverse, gap, direction = np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty(3)
    means, m, apart, square = work.colors, 4, 0.0, 0.0
    for c in range(3):
        gap[c] = means[0, 1 + c] - means[1, 1 + c]
        for d in range(c + 1):
            within[c, d] = within[d, c] = means[1, m] - means[1, 1 + c] * means[1, 1 + d]
            m += 1
        within[c, c] += work.limits.color.noise
    if not invert_3x3(within, inverse):
        return
    transform(inverse, gap, direction)
    for c in range(3):
        apart += direction[c] * gap[c]
        square += means[1, 1 + c] ** 2
    if not apart > TINY:
        return
    work.axis[3] = 0.0
    for c in range(3):
        work.axis[c] = direction[c] / apart
        work.axis[3] -= work.axis[c] * means[1, 1 + c]
        work.brightness[c] = means[1, 1 + c] / max(square, TINY)
