"""Rotations inside kernels: matrices (3, 3) and rotation vectors (3,), an axis times an angle in rad."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.linalg import norm

Floats = npt.NDArray[np.float64]

TINY = 1e-12  # rad: a shorter rotation vector has no axis


@kernel(refcount=False)
def rotate(rotation: Floats, vector: Floats) -> None:
    """Rotate a rotation matrix R in place: ``R <- exp([vector]x) R`` (Rodrigues' formula).

    Parameters
    ----------
    rotation : (3, 3), written
    vector : (3,)
        Rotation vector, rad.
    """
    angle = norm(vector)
    if angle < TINY:
        return
    x, y, z = vector[0] / angle, vector[1] / angle, vector[2] / angle
    c, s = math.cos(angle), math.sin(angle)
    for k in range(3):
        a, b, d = rotation[0, k], rotation[1, k], rotation[2, k]
        dot = (1.0 - c) * (x * a + y * b + z * d)
        rotation[0, k] = c * a + s * (y * d - z * b) + dot * x
        rotation[1, k] = c * b + s * (z * a - x * d) + dot * y
        rotation[2, k] = c * d + s * (x * b - y * a) + dot * z


@kernel
def rotation_vector_between(one: Floats, other: Floats, vector: Floats) -> float:
    """Rotation vector v with ``other = exp([v]x) one``.

    Good to 1e-8 rad up to half a turn; of half a turn the axis may come out as its opposite.

    Parameters
    ----------
    one, other : (3, 3)
        Rotation matrices.
    vector : (3,), written
        v, rad.

    Returns
    -------
    float
        Its length, rad.
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
    scale = sign * angle / half if half > TINY else 0.0
    vector[0], vector[1], vector[2] = scale * w[0], scale * w[1], scale * w[2]
    return angle


def cross_matrix(v: Floats) -> Floats:
    """Return the matrix, (3, 3), whose product with a vector is the cross product of `v` and it; not for kernels."""
    x, y, z = v.tolist()
    return np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
