"""Kernels that read the pixels around a marker: where they are on the scale from ball to marker, lit, and believed.

They are kept in single precision, each kind in a row of its own, so that all that is done with them is done to several
at a time.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.linalg import apply, invert

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

VALUE, LIGHT, WEIGHT, X, Y, BRIGHT = range(6)  # rows of `pixels`: see `gather`
KINDS = 6
V, B, W, NEXT = np.uintp(VALUE), np.uintp(BRIGHT), np.uintp(WEIGHT), np.uintp(1)
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
def _read(
    flat: Bytes, at: int, channels: int, axis: Floats, ground: Floats, pixels: Singles, first: int, n: int
) -> None:
    """Read n pixels of a row: their place from ball to marker, and how bright they are; all count."""
    a0, a1, a2, a3 = np.float32(axis[0]), np.float32(axis[1]), np.float32(axis[2]), np.float32(axis[3])
    g0, g1, g2 = np.float32(ground[0]), np.float32(ground[1]), np.float32(ground[2])
    for place in range(n):
        j = np.uintp(first + place)
        if channels == 3:
            k = np.uintp(at + 3 * place)
            p, q, r = np.float32(flat[k]), np.float32(flat[k + NEXT]), np.float32(flat[k + NEXT + NEXT])
            pixels[V, j], pixels[B, j] = a3 + a0 * p + a1 * q + a2 * r, g0 * p + g1 * q + g2 * r
        else:
            p = np.float32(flat[np.uintp(at + place)])
            pixels[V, j], pixels[B, j] = a3 + a0 * p, g0 * p
        pixels[W, j] = ONE


@kernel(refcount=False, reassociate=True)
def _weigh(window: tuple[float, float, float, float, float], ball: Floats, shade: Floats, pixels: Singles) -> None:
    """Write the light on all pixels, and what they weigh inside the ball, outside highlights, and near by."""
    bright, lights, weights, xs, ys = pixels[BRIGHT], pixels[LIGHT], pixels[WEIGHT], pixels[X], pixels[Y]
    lit = 1.0 / shade[0] if shade[0] > 0.0 else 0.0
    x0, y0, most = np.float32(window[0]), np.float32(window[1]), np.float32(window[2])
    x1, y1 = np.float32(window[3]), np.float32(window[4])
    unit, right, under = np.float32(lit), np.float32(lit * shade[1]), np.float32(lit * shade[2])
    whole, share = np.float32((ball[2] - LIMB) / (FULL - LIMB)), np.float32(1.0 / (FULL - LIMB))
    for place in range(weights.shape[0]):
        j = np.uintp(place)
        dx, dy, ox, oy = xs[j] - x0, ys[j] - y0, xs[j] - x1, ys[j] - y1
        light = ONE + right * dx + under * dy
        weight = whole - share * np.float32(math.sqrt(ox * ox + oy * oy))
        matt = DARKER - DIM * (bright[j] * unit / light)
        weight = weight if weight < ONE else ONE
        weight = weight if weight > ZERO else ZERO
        matt = matt if matt < ONE else ONE
        matt = matt if matt > ZERO else ZERO
        lights[j] = light
        weights[j] = weights[j] * weight * matt * np.float32(dx * dx + dy * dy <= most)


@kernel(refcount=False, reassociate=True)
def _leave_out(x: float, y: float, ox: float, oy: float, pixels: Singles) -> None:
    """Take the weight of those pixels that are nearer to another marker."""
    weights, xs, ys = pixels[WEIGHT], pixels[X], pixels[Y]
    x0, y0, x1, y1 = np.float32(x), np.float32(y), np.float32(ox), np.float32(oy)
    for place in range(weights.shape[0]):
        j = np.uintp(place)
        dx, dy, rx, ry = xs[j] - x0, ys[j] - y0, xs[j] - x1, ys[j] - y1
        weights[j] = weights[j] * np.float32(rx * rx + ry * ry >= dx * dx + dy * dy)


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
        first, row = np.uintp(i * stride), np.float32(i)
        for j in range(stride):
            xs[first + np.uintp(j)], ys[first + np.uintp(j)] = np.float32(j) - ONE, row


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
    span, flat, weights = int(math.sqrt(pixels.shape[1])), image.reshape(-1), pixels[WEIGHT]
    begin, end = max(-left, 0), min(width - left, span)
    for place in range(weights.shape[0]):
        weights[np.uintp(place)] = ZERO
    for i in range(max(-top, 0), min(height - top, span)):
        at, first = ((top + i) * width + left + begin) * channels, i * (span + 1) + 1 + begin
        _read(flat, at, channels, axis, ground, pixels, first, end - begin)
    x, y = places[which, 0] - left, places[which, 1] - top
    _weigh((x, y, (0.5 * span) ** 2, ball[0] - left, ball[1] - top), ball, shade, pixels)
    for k in range(places.shape[0]):
        if k != which:
            _leave_out(x, y, places[k, 0] - left, places[k, 1] - top, pixels)
