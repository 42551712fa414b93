"""3 x 3 matrices inside kernels, written out: calls of LAPACK cost more than the arithmetic."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]


@kernel
def invert(a: Floats, inverse: Floats) -> bool:
    """Inverse of a symmetric positive matrix by cofactors; False if it has none.

    Parameters
    ----------
    a : (3, 3)
    inverse : (3, 3), written
    """
    c00, c01 = a[1, 1] * a[2, 2] - a[1, 2] * a[1, 2], a[0, 2] * a[1, 2] - a[0, 1] * a[2, 2]
    c02 = a[0, 1] * a[1, 2] - a[0, 2] * a[1, 1]
    det = a[0, 0] * c00 + a[0, 1] * c01 + a[0, 2] * c02
    if not det > 1e-13 * a[0, 0] * a[1, 1] * a[2, 2] or not det > 0.0:
        return False
    unit = 1.0 / det
    inverse[0, 0], inverse[0, 1], inverse[0, 2] = c00 * unit, c01 * unit, c02 * unit
    inverse[1, 1] = (a[0, 0] * a[2, 2] - a[0, 2] * a[0, 2]) * unit
    inverse[1, 2] = (a[0, 1] * a[0, 2] - a[0, 0] * a[1, 2]) * unit
    inverse[2, 2] = (a[0, 0] * a[1, 1] - a[0, 1] * a[0, 1]) * unit
    inverse[1, 0], inverse[2, 0], inverse[2, 1] = inverse[0, 1], inverse[0, 2], inverse[1, 2]
    return True


@kernel
def multiply(a: Floats, b: Floats, out: Floats) -> None:
    """Write a b."""
    for j in range(3):
        for k in range(3):
            out[j, k] = a[j, 0] * b[0, k] + a[j, 1] * b[1, k] + a[j, 2] * b[2, k]


@kernel
def apply(a: Floats, v: Floats, out: Floats) -> None:
    """Write a v."""
    for j in range(3):
        out[j] = a[j, 0] * v[0] + a[j, 1] * v[1] + a[j, 2] * v[2]


@kernel
def cross(a: Floats, b: Floats, out: Floats) -> None:
    """Write a cross b."""
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@kernel
def add_spread(response: Floats, spread: Floats, total: Floats) -> None:
    """Add ``response spread response^T``: the spread (n, n) of n numbers as three others, (3, n), answer to them."""
    n = spread.shape[0]
    for a in range(3):
        for k in range(n):
            part = 0.0
            for m in range(n):
                part += response[a, m] * spread[m, k]
            if part != 0.0:
                for b in range(3):
                    total[a, b] += part * response[b, k]


@kernel
def length(v: Floats) -> float:
    """Length of a vector."""
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def rotate(turn: Floats, step: Floats) -> None:
    """Turn a rotation matrix by a rotation vector, in place: ``exp(step) turn`` (Rodrigues).

    Parameters
    ----------
    turn : (3, 3), written
    step : (3,)
        rad.
    """
    angle = length(step)
    if angle < 1e-12:
        return
    x, y, z = step[0] / angle, step[1] / angle, step[2] / angle
    c, s = math.cos(angle), math.sin(angle)
    for k in range(3):
        a, b, d = turn[0, k], turn[1, k], turn[2, k]
        dot = (1.0 - c) * (x * a + y * b + z * d)
        turn[0, k] = c * a + s * (y * d - z * b) + dot * x
        turn[1, k] = c * b + s * (z * a - x * d) + dot * y
        turn[2, k] = c * d + s * (x * b - y * a) + dot * z


@kernel
def turn_from(one: Floats, other: Floats, vector: Floats) -> float:
    """Write the rotation vector that turns one rotation matrix into another; returns its length, rad.

    Good to 1e-8 rad up to half a turn; of half a turn the axis may come out as its opposite.
    """
    m, w = np.empty((3, 3)), np.empty(4)
    for j in range(3):
        for k in range(3):
            m[j, k] = other[j, 0] * one[k, 0] + other[j, 1] * one[k, 1] + other[j, 2] * one[k, 2]
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    # Quaternion by its largest part, which keeps half turns exact (Shepperd).
    largest = 3
    for k in range(3):
        if m[k, k] > (trace if largest == 3 else m[largest, largest]):
            largest = k
    if largest == 3:
        w[3] = 1.0 + trace
        w[0], w[1], w[2] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        w[i] = 1.0 + 2.0 * m[i, i] - trace
        w[j], w[k], w[3] = m[j, i] + m[i, j], m[k, i] + m[i, k], m[k, j] - m[j, k]
    sign = 1.0 if w[3] >= 0.0 else -1.0
    half = math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    angle = 2.0 * math.atan2(half, sign * w[3])
    scale = sign * angle / half if half > 1e-14 else 0.0
    vector[0], vector[1], vector[2] = scale * w[0], scale * w[1], scale * w[2]
    return angle
