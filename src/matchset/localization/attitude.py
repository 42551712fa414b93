"""The rotation that fits the directions of markers: one marker and level vehicles, or two markers and more.

Two or more markers give the rotation R that minimizes ``sum (s - R b)^T W (s - R b)`` (Wahba's problem with full
weights): b is a marker's place in the ball frame, s its direction in the camera frame, W the inverse of its covariance
across s. One marker leaves the turn about it open; if both vehicles are level it follows.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.linalg import apply, cross, invert, rotate

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

ROUNDS = 5
UPRIGHT = 0.02  # least squared sine between a marker and the vertical from which "level" says something
BAD = 1e9


@kernel
def _triad(first: Floats, second: Floats, out: Floats) -> bool:
    """Rows of a right-handed frame: z along `first`, y as near to `second` as that allows, x = y cross z."""
    dot = first[0] * second[0] + first[1] * second[1] + first[2] * second[2]
    square = 0.0
    for k in range(3):
        out[2, k] = first[k]
        out[1, k] = second[k] - dot * first[k]
        square += out[1, k] ** 2
    if not square > UPRIGHT:
        return False
    unit = 1.0 / math.sqrt(square)
    for k in range(3):
        out[1, k] *= unit
    cross(out[1], out[2], out[0])
    return True


@kernel
def turn_between(b1: Floats, b2: Floats, s1: Floats, s2: Floats, turn: Floats) -> bool:
    """Rotation that takes b1 to s1 and b2 as near to s2 as that allows.

    Parameters
    ----------
    b1, b2, s1, s2 : (3,)
        Unit vectors.
    turn : (3, 3), written

    Returns
    -------
    bool
        False where two of them are nearly parallel.
    """
    body, seen = np.empty((3, 3)), np.empty((3, 3))
    if not _triad(b1, b2, body) or not _triad(s1, s2, seen):
        return False
    for j in range(3):
        for k in range(3):
            turn[j, k] = seen[0, j] * body[0, k] + seen[1, j] * body[1, k] + seen[2, j] * body[2, k]
    return True


@kernel
def fit_turn(bodies: Floats, seen: Floats, weights: Floats, who: Ints, turn: Floats, gains: Floats) -> float:
    """Gauss-Newton for the rotation that fits the markers best.

    Parameters
    ----------
    bodies : (m, 3)
        Places of the markers, ball frame.
    seen, weights : (n, 3), (n, 3, 3)
        Directions in the camera frame, and the inverse of their covariance across them.
    who : (n,)
        Which marker each is; -1 for none.
    turn : (3, 3), written
        The rotation; a rough one to begin with.
    gains : (n, 3, 3), written
        How its rotation vector answers to each direction.

    Returns
    -------
    float
        Sum of weighted squares; 1e9 where there is no unique answer.
    """
    normal, inverse, b, step = np.zeros((3, 3)), np.empty((3, 3)), np.zeros(3), np.empty(3)
    model, e, cost = np.empty(3), np.empty(3), 0.0
    lever = np.zeros((seen.shape[0], 3, 3))
    for _ in range(ROUNDS):
        normal[:], b[:], cost = 0.0, 0.0, 0.0
        for i in range(seen.shape[0]):
            if who[i] < 0:
                continue
            apply(turn, bodies[who[i]], model)
            for k in range(3):
                e[k] = seen[i, k] - model[k]
                # Row by row: model cross (the column k of the weights).
                lever[i, 0, k] = model[1] * weights[i, 2, k] - model[2] * weights[i, 1, k]
                lever[i, 1, k] = model[2] * weights[i, 0, k] - model[0] * weights[i, 2, k]
                lever[i, 2, k] = model[0] * weights[i, 1, k] - model[1] * weights[i, 0, k]
            for j in range(3):
                x, y, z = lever[i, j, 0], lever[i, j, 1], lever[i, j, 2]
                b[j] += x * e[0] + y * e[1] + z * e[2]
                normal[j, 0] += model[1] * z - model[2] * y
                normal[j, 1] += model[2] * x - model[0] * z
                normal[j, 2] += model[0] * y - model[1] * x
                for k in range(3):
                    cost += e[j] * weights[i, j, k] * e[k]
        if not invert(normal, inverse):
            return BAD
        apply(inverse, b, step)
        rotate(turn, step)
        if abs(step[0]) + abs(step[1]) + abs(step[2]) < 1e-6:
            break
    for i in range(seen.shape[0]):
        for j in range(3):
            for k in range(3):
                gains[i, j, k] = 0.0
                for m in range(3):
                    gains[i, j, k] += inverse[j, m] * lever[i, m, k]
    return cost


@kernel
def fit_level(body: Floats, seen: Floats, turn: Floats, gain: Floats, free: Floats) -> bool:
    """Rotation from one marker and two level vehicles: the marker exactly, down as near to down as that allows.

    Parameters
    ----------
    body, seen : (3,)
        The marker's place in the ball frame and its direction in the camera frame.
    turn : (3, 3), written
    gain : (3, 3), written
        How the rotation vector answers to the direction.
    free : (3,), written
        How it answers to a tilt of one vehicle against the other, per rad.

    Returns
    -------
    bool
        False for a marker straight above or below.
    """
    down, other, moved = np.array((0.0, 1.0, 0.0)), np.empty((3, 3)), np.empty(3)
    if not turn_between(body, down, seen, down, turn):
        return False
    across = math.sqrt(max(1.0 - seen[1] * seen[1], UPRIGHT))
    step = 1e-6
    for k in range(3):
        free[k] = seen[k] / across
        dot = seen[k]
        for m in range(3):
            moved[m] = seen[m] + step * ((m == k) - dot * seen[m])  # along the sphere
        unit = 1.0 / math.sqrt(moved[0] ** 2 + moved[1] ** 2 + moved[2] ** 2)
        for m in range(3):
            moved[m] *= unit
        if not turn_between(body, down, moved, down, other):
            return False
        for m in range(3):
            p, q = (m + 1) % 3, (m + 2) % 3
            rise = 0.0
            for c in range(3):
                rise += other[q, c] * turn[p, c] - other[p, c] * turn[q, c]
            gain[m, k] = 0.5 * rise / step
    return True
