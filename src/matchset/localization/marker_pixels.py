"""Kernels that read the pixels around a marker: where they are on the scale from ball to marker, lit, and believed.

They are kept in single precision, each kind in a row of its own, so that all that is done with them is done to several
at a time.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.matrix3 import apply, invert
from matchset.shapes.jit import kernel, summing

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

VALUE, LIGHT, WEIGHT, X, Y, BRIGHT = range(6)  # rows of `pixels`: see `gather`
KINDS = 6
GLINT = 1.15  # brightness, in that of the ball around, from which a pixel is taken for a highlight
THIN = 10.0  # px of reach for each of which one pixel in a row more is left out of the shading
STILL = 20.0  # weight that holds the shading flat where few pixels tell, px^2
LIMB = 0.5  # px inside the ball's outline from which pixels count, fully from
FULL = 3.5
ZERO, ONE = np.float32(0.0), np.float32(1.0)
DARKER, DIM = np.float32((2.0 * GLINT - 1.0) / (GLINT - 1.0)), np.float32(1.0 / (GLINT - 1.0))


@kernel
def _around(image: Bytes, ball: Floats, window: Floats, reach: float, ground: Floats, points: Floats) -> int:
    """Write offsets and brightness of pixels of the ball around a marker, every few px; returns how many."""
    x0, y0, ux, uy, ratio, a = window[0], window[1], window[2], window[3], window[4], window[5]
    edge, inner, outer = (ball[2] - FULL) ** 2, (a + 3.0) ** 2, reach * reach
    height, width, channels = image.shape
    flat, thin, narrow, count = image.reshape(-1), 1 + int(reach / THIN), 1.0 / ratio, 0
    for row in range(max(int(y0 - reach), 0), min(int(y0 + reach) + 1, height), thin):
        for column in range(max(int(x0 - reach), 0), min(int(x0 + reach) + 1, width), thin):
            dx, dy = column - x0, row - y0
            along, across = (dx * ux + dy * uy) * narrow, dy * ux - dx * uy
            if along * along + across * across < inner or dx * dx + dy * dy > outer:
                continue
            if (column - ball[0]) ** 2 + (row - ball[1]) ** 2 > edge:
                continue
            value, at = 0.0, (row * width + column) * channels
            for c in range(channels):
                value += ground[c] * flat[np.uintp(at + c)]
            points[count, 0], points[count, 1], points[count, 2] = dx, dy, value
            count += 1
    return count


@kernel
def shading(image: Bytes, ball: Floats, window: Floats, reach: float, ground: Floats, shade: Floats) -> None:
    """Brightness of the ball around a marker, a plane without highlights: there, and per px right and down.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    ball, ground
        See `fit_marker`.
    window : (6,)
        Middle of the marker, px; direction and ratio of its axes (`ellipse`); its long semi-axis, px.
    reach : float
        How far around it is looked, px.
    shade : (3,), written
        Zeros where too little of the ball is seen.
    """
    shade[0], shade[1], shade[2] = 0.0, 0.0, 0.0
    across = int(2.0 * reach) + 2
    points, n, inverse, b = np.empty((across * across, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    found = _around(image, ball, window, reach, ground, points)
    for turn in range(2):
        count = sx = sy = sxx = sxy = syy = t = tx = ty = 0.0  # numbers, not arrays: they stay in registers
        for place in range(found):
            i = np.uintp(place)
            dx, dy, value = points[i, 0], points[i, 1], points[i, 2]
            if turn > 0 and value > GLINT * (shade[0] + shade[1] * dx + shade[2] * dy):
                continue
            count, sx, sy = count + 1.0, sx + dx, sy + dy
            sxx, sxy, syy = sxx + dx * dx, sxy + dx * dy, syy + dy * dy
            t, tx, ty = t + value, tx + value * dx, ty + value * dy
        if count < 20.0:
            return
        n[0, 0], n[0, 1], n[0, 2] = count, sx, sy
        n[1, 0], n[1, 1], n[1, 2] = sx, sxx + STILL, sxy
        n[2, 0], n[2, 1], n[2, 2] = sy, sxy, syy + STILL
        b[0], b[1], b[2] = t, tx, ty
        if not invert(n, inverse):
            return
        apply(inverse, b, shade)
    most = 0.5 * max(shade[0], 0.0) / reach
    shade[1], shade[2] = min(max(shade[1], -most), most), min(max(shade[2], -most), most)


@kernel
def _read(flat: Bytes, at: int, channels: int, axis: Floats, ground: Floats, values: Singles, bright: Singles) -> None:
    """Read the pixels of a row: their place from ball to marker, and how bright they are."""
    a0, a1, a2, a3 = np.float32(axis[0]), np.float32(axis[1]), np.float32(axis[2]), np.float32(axis[3])
    g0, g1, g2 = np.float32(ground[0]), np.float32(ground[1]), np.float32(ground[2])
    if channels == 3:
        for place in range(values.shape[0]):
            j, k = np.uintp(place), np.uintp(at + 3 * place)
            p, q, r = np.float32(flat[k]), np.float32(flat[k + np.uintp(1)]), np.float32(flat[k + np.uintp(2)])
            values[j] = a3 + a0 * p + a1 * q + a2 * r
            bright[j] = g0 * p + g1 * q + g2 * r
    else:
        for place in range(values.shape[0]):
            j, p = np.uintp(place), np.float32(flat[np.uintp(at + place)])
            values[j] = a3 + a0 * p
            bright[j] = g0 * p


@summing
def _weigh(
    dx: float,
    dy: float,
    bx: float,
    by: float,
    far: float,
    ball: Floats,
    shade: Floats,
    rows: tuple[Singles, Singles, Singles],
) -> None:
    """Write the light on the pixels of a row, and what they weigh inside the ball, outside highlights, and near by."""
    bright, lights, weights = rows
    lit = 1.0 / shade[0] if shade[0] > 0.0 else 0.0
    x0, x1, up, most = np.float32(dx), np.float32(bx), np.float32(by * by), np.float32(far - dy * dy)
    unit, right = np.float32(lit), np.float32(lit * shade[1])
    base = np.float32(1.0 + lit * shade[2] * dy)
    whole, share = np.float32((ball[2] - LIMB) / (FULL - LIMB)), np.float32(1.0 / (FULL - LIMB))
    for place in range(weights.shape[0]):
        j = np.uintp(place)
        column = np.float32(place)
        away, here = x1 + column, x0 + column
        light = base + right * here
        weight = whole - share * np.float32(math.sqrt(away * away + up))
        matt = DARKER - DIM * (bright[j] * unit / light)
        weight = weight if weight < ONE else ONE
        weight = weight if weight > ZERO else ZERO
        matt = matt if matt < ONE else ONE
        matt = matt if matt > ZERO else ZERO
        lights[j], weights[j] = light, weight * matt * np.float32(here * here <= most)


@summing
def _leave_out(dx: float, dy: float, ox: float, oy: float, weights: Singles) -> None:
    """Take the weight of those pixels of a row that are nearer to another marker."""
    x0, x1, lower = np.float32(dx), np.float32(ox), np.float32(oy * oy - dy * dy)
    for place in range(weights.shape[0]):
        j = np.uintp(place)
        here, there = x0 + np.float32(place), x1 + np.float32(place)
        weights[j] = weights[j] * np.float32(there * there + lower >= here * here)


@kernel
def lay_out(span: int, pixels: Singles) -> None:
    """Write where the pixels of a window lie in it: column and row.

    Parameters
    ----------
    span : int
        Rows and columns of the window.
    pixels : (KINDS, span * (span + 1)) float32, written
    """
    xs, ys, stride = pixels[X], pixels[Y], span + 1
    for i in range(span):
        for j in range(stride):
            xs[np.uintp(i * stride + j)], ys[np.uintp(i * stride + j)] = j - 1, i


@kernel
def gather(
    image: Bytes,
    ball: Floats,
    places: Floats,
    which: int,
    left: int,
    top: int,
    axis: Floats,
    ground: Floats,
    shade: Floats,
    pixels: Singles,
) -> None:
    """Read the pixels around a marker.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    ball, places, which, axis, ground
        See `fit_marker`.
    left, top : int
        Where the window begins in the picture, px.
    shade : (3,)
        See `shading`.
    pixels : (KINDS, span * (span + 1)) float32, written
        Rows of the window, each after a pixel of no weight: how much of a marker is in a pixel, the light there in that
        at the marker's middle, its weight, its column and row in the window (read), its brightness.
    """
    height, width, channels = image.shape
    span = int(math.sqrt(pixels.shape[1]))
    stride, flat, x0, y0 = span + 1, image.reshape(-1), places[which, 0], places[which, 1]
    begin, end = min(max(-left, 0), span), max(min(width - left, span), 0)
    farthest = (0.5 * span) ** 2
    for i in range(span):
        first, last, row = i * stride + 1, (i + 1) * stride, top + i
        weights = pixels[WEIGHT, first - 1 : last]
        for j in range(stride):
            weights[np.uintp(j)] = ZERO
        if row < 0 or row >= height or begin >= end:
            continue
        column, first, last = left + begin, first + begin, first + end
        weights, bright = pixels[WEIGHT, first:last], pixels[BRIGHT, first:last]
        _read(flat, (row * width + column) * channels, channels, axis, ground, pixels[VALUE, first:last], bright)
        rows = bright, pixels[LIGHT, first:last], weights
        _weigh(column - x0, row - y0, column - ball[0], row - ball[1], farthest, ball, shade, rows)
        for k in range(places.shape[0]):
            if k != which:
                _leave_out(column - x0, row - y0, column - places[k, 0], row - places[k, 1], weights)
