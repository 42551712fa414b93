"""Kernels that read the pixels around a marker: where they are on the scale from ball to marker, lit, and weighed.

They are kept in single precision, each kind of number in a row of its own, so that several pixels are worked on at a
time.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.linalg import invert_3x3, transform

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

ZERO, ONE, NEXT = np.float32(0.0), np.float32(1.0), np.uintp(1)  # theorem: neutral elements, in single precision


class Patch(NamedTuple):
    """The pixels of a window, (span * (span + 1),) float32 each: its rows, each after one pixel of no weight."""

    value: Singles  # how much of a marker is in a pixel: 0 on the ball, 1 on a marker
    light: Singles  # the light there in that at the marker's middle
    weight: Singles
    x: Singles  # column in the window
    y: Singles  # row in the window
    brightness: Singles  # in that of the ball


@kernel
def new_patch(span: int) -> Patch:
    """Make a window of `span` rows and columns; of its pixels only the places are known."""
    stride = span + 1
    table = np.zeros((6, span * stride), np.float32)
    xs, ys = table[3], table[4]
    for i in range(span):
        first, row = np.uintp(i * stride), np.float32(i)
        for j in range(stride):
            xs[first + np.uintp(j)], ys[first + np.uintp(j)] = np.float32(j) - ONE, row
    return Patch(table[0], table[1], table[2], xs, ys, table[5])


@kernel(refcount=False)
def field_shift(right: float, under: float, row: int) -> tuple[float, float]:
    """From where a thing is to where a row shows it, px: half of the way from the odd rows' field to the even rows'."""
    half = 0.5 - (row & 1)
    return half * right, half * under


@kernel(refcount=False)
def _ball_around(image: Bytes, work: Any, middle: tuple[float, float], reach: float, points: Floats) -> int:
    """Write offsets and brightness of pixels of the ball around a marker, every few px; returns how many."""
    ball, window, limits, ground = work.ball, work.window, work.limits.fit, work.brightness
    x0, y0 = middle
    ux, uy, narrow = window.axis_x, window.axis_y, 1.0 / window.ratio
    edge, inner = (ball.radius - limits.rim_inner_px) ** 2, (window.semi_axis + limits.shading_gap_px) ** 2
    height, width, channels = image.shape
    spacing, count = 1 + int(reach / limits.shading_spacing_px), 0
    for row in range(max(int(y0 - reach), 0), min(int(y0 + reach) + 1, height), spacing):
        right, under = field_shift(ball.field_x, ball.field_y, row)
        for column in range(max(int(x0 - reach), 0), min(int(x0 + reach) + 1, width), spacing):
            dx, dy = column - right - x0, row - under - y0
            along, across = (dx * ux + dy * uy) * narrow, dy * ux - dx * uy
            if along * along + across * across < inner or dx * dx + dy * dy > reach * reach:
                continue
            if (x0 + dx - ball.x) ** 2 + (y0 + dy - ball.y) ** 2 > edge:
                continue
            value = 0.0
            for c in range(channels):
                value += ground[c] * image[np.uintp(row), np.uintp(column), np.uintp(c)]
            points[count, 0], points[count, 1], points[count, 2] = dx, dy, value
            count += 1
    return count


@kernel
def _fit_plane(points: Floats, shade: Floats, limits: Any, robust: bool) -> bool:
    """Plane through brightness, without highlights above the last plane if `robust`; False if there is none."""
    n, inverse, b = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    count = sx = sy = sxx = sxy = syy = t = tx = ty = 0.0  # numbers, not arrays: they stay in registers
    for place in range(points.shape[0]):
        i = np.uintp(place)
        dx, dy, value = points[i, 0], points[i, 1], points[i, 2]
        if robust and value > limits.highlight_ratio * (shade[0] + shade[1] * dx + shade[2] * dy):
            continue
        count, sx, sy = count + 1.0, sx + dx, sy + dy
        sxx, sxy, syy = sxx + dx * dx, sxy + dx * dy, syy + dy * dy
        t, tx, ty = t + value, tx + value * dx, ty + value * dy
    if count < limits.min_shading_pixels:
        return False
    n[0, 0], n[0, 1], n[0, 2] = count, sx, sy
    n[1, 0], n[1, 1], n[1, 2] = sx, sxx + limits.shading_weight, sxy
    n[2, 0], n[2, 1], n[2, 2] = sy, sxy, syy + limits.shading_weight
    b[0], b[1], b[2] = t, tx, ty
    if not invert_3x3(n, inverse):
        return False
    transform(inverse, b, shade)
    return True


@kernel
def measure_shading(image: Bytes, work: Any, which: int) -> None:
    """Brightness of the ball around a marker, a plane without highlights; zeros where too little of the ball is seen.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    work : record of `MarkerWork`
        `window.shading` is written.
    which : int
        The marker.
    """
    window, limits, shade = work.window, work.limits.fit, work.window.shading[:]
    reach = window.reach + limits.shading_around * window.semi_axis
    shade[:] = 0.0
    across = int(2.0 * reach) + 2
    points = np.empty((across * across, 3))
    middle = work.places[which, 0], work.places[which, 1]
    found = _ball_around(image, work, middle, reach, points)
    for turn in range(2):
        if not _fit_plane(points[:found], shade, limits, turn > 0):
            return
    most = limits.max_shading_change * max(shade[0], 0.0) / reach
    shade[1], shade[2] = min(max(shade[1], -most), most), min(max(shade[2], -most), most)


@kernel(refcount=False)
def _read_row(flat: Bytes, channels: int, work: Any, patch: Patch, run: tuple[int, int, int]) -> None:
    """Read pixels of a row; `run`: where they begin in the image and in the patch, and how many. All have weight."""
    begin, first, n = run
    axis, ground, value, bright, weight = work.axis, work.brightness, patch.value, patch.brightness, patch.weight
    a0, a1, a2, a3 = np.float32(axis[0]), np.float32(axis[1]), np.float32(axis[2]), np.float32(axis[3])
    g0, g1, g2 = np.float32(ground[0]), np.float32(ground[1]), np.float32(ground[2])
    for place in range(n):
        j = np.uintp(first + place)
        if channels == 3:
            k = np.uintp(begin + 3 * place)
            p, q, r = np.float32(flat[k]), np.float32(flat[k + NEXT]), np.float32(flat[k + NEXT + NEXT])
            value[j], bright[j] = a3 + a0 * p + a1 * q + a2 * r, g0 * p + g1 * q + g2 * r
        else:
            p = np.float32(flat[np.uintp(begin + place)])
            value[j], bright[j] = a3 + a0 * p, g0 * p
        weight[j] = ONE


@kernel(refcount=False, reassociate=True)
def _weigh(work: Any, patch: Patch, x: float, y: float) -> None:
    """Write the light on all pixels, and their weights: inside the ball, outside highlights, near (x, y)."""
    bright, lights, weights, xs, ys = patch.brightness, patch.light, patch.weight, patch.x, patch.y
    ball, window, limits = work.ball, work.window, work.limits.fit
    shade, far = window.shading, 0.5 * window.span
    lit = 1.0 / shade[0] if shade[0] > 0.0 else 0.0
    x0, y0, most = np.float32(x), np.float32(y), np.float32(far**2)
    x1, y1 = np.float32(ball.x - window.left), np.float32(ball.y - window.top)
    unit, right, under = np.float32(lit), np.float32(lit * shade[1]), np.float32(lit * shade[2])
    depth, glint = limits.rim_inner_px - limits.rim_outer_px, limits.highlight_ratio
    whole, share = np.float32((ball.radius - limits.rim_outer_px) / depth), np.float32(1.0 / depth)
    darker, dim = np.float32((2.0 * glint - 1.0) / (glint - 1.0)), np.float32(1.0 / (glint - 1.0))
    for place in range(weights.shape[0]):
        j = np.uintp(place)
        dx, dy, ox, oy = xs[j] - x0, ys[j] - y0, xs[j] - x1, ys[j] - y1
        light = ONE + right * dx + under * dy
        weight = whole - share * np.float32(math.sqrt(ox * ox + oy * oy))
        matt = darker - dim * (bright[j] * unit / light)
        weight = weight if weight < ONE else ONE
        weight = weight if weight > ZERO else ZERO
        matt = matt if matt < ONE else ONE
        matt = matt if matt > ZERO else ZERO
        lights[j] = light
        weights[j] = weights[j] * weight * matt * np.float32(dx * dx + dy * dy <= most)


@kernel(refcount=False, reassociate=True)
def _leave_out(x: float, y: float, ox: float, oy: float, patch: Patch) -> None:
    """Take the weight of those pixels that are nearer to another marker."""
    weights, xs, ys = patch.weight, patch.x, patch.y
    x0, y0, x1, y1 = np.float32(x), np.float32(y), np.float32(ox), np.float32(oy)
    for place in range(weights.shape[0]):
        j = np.uintp(place)
        dx, dy, rx, ry = xs[j] - x0, ys[j] - y0, xs[j] - x1, ys[j] - y1
        weights[j] = weights[j] * np.float32(rx * rx + ry * ry >= dx * dx + dy * dy)


@kernel(refcount=False)
def _place_pixels(work: Any, patch: Patch) -> None:
    """Write where the pixels would be if both fields were taken at one time."""
    ball, top, stride, xs, ys = work.ball, work.window.top, work.window.span + 1, patch.x, patch.y
    for i in range(work.window.span):
        right, under = field_shift(ball.field_x, ball.field_y, top + i)
        first, begin, row = np.uintp(i * stride), np.float32(-1.0 - right), np.float32(i - under)
        for j in range(stride):
            xs[first + np.uintp(j)], ys[first + np.uintp(j)] = np.float32(j) + begin, row


@kernel
def read_patch(image: Bytes, work: Any, which: int, patch: Patch) -> None:
    """Read and weigh the pixels around a marker.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    work : record of `MarkerWork`
        `axis`, `brightness`, `ball`, `places` and the window's place and shading are read.
    which : int
        The marker; the others are kept out of the way.
    patch : Patch, written
    """
    height, width, channels = image.shape
    left, top, span = work.window.left, work.window.top, work.window.span
    flat, weights = image.reshape(-1), patch.weight
    if work.ball.field_x != 0.0 or work.ball.field_y != 0.0:
        _place_pixels(work, patch)
    begin, end = max(-left, 0), min(width - left, span)
    for place in range(weights.shape[0]):
        weights[np.uintp(place)] = ZERO
    for i in range(max(-top, 0), min(height - top, span)):
        at, first = ((top + i) * width + left + begin) * channels, i * (span + 1) + 1 + begin
        _read_row(flat, channels, work, patch, (at, first, end - begin))
    x, y = work.places[which, 0] - left, work.places[which, 1] - top
    _weigh(work, patch, x, y)
    for k in range(work.count):
        if k != which:
            _leave_out(x, y, work.places[k, 0] - left, work.places[k, 1] - top, patch)
