"""Kernels of the filter of a neighbor: five numbers for each coordinate, see `neighbor_motion.py`.

`limits` holds the fields of `NeighborFilterParameters` in their order.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]

BELIEVED, REFUSED, ANEW = 0, 1, 2
LASTING, PERIOD, DAMPING, SWAY, TILT, YAW, SHARED, GATE, JUMP, PATIENCE = 2, 4, 5, 6, 8, 9, 10, 11, 12, 13
FORGET = 3.0  # s without a pose after which all begins anew: until then a vehicle that lost its neighbor has landed
STANDS = 0.4  # s, how far the drift is extrapolated to tell a jump
UPRIGHT = 0.1  # share of the sway that is upright: what hangs on a rope sways level
LATEST = 10.0  # s past the last pose; later is the same
FIRST_SPEED = 0.5  # m/s or rad/s, of a speed that is not known yet
JERK = np.array(((20.0, 8.0, 6.0), (8.0, 3.0, 2.0), (6.0, 2.0, 1.0)))  # of the white-jerk model
STATES = 5  # numbers of a coordinate: drift, its speed and acceleration, sway, its speed


@kernel
def to_rest(
    position: Floats, covariance: Floats, turn: Floats, place: Floats, limits: Floats, seen: Floats, spread: Floats
) -> None:
    """Write where a ball is in the frame at rest, and its variance, with what unmeasured tilt and turn add."""
    away = np.zeros(3)
    for j in range(3):
        for k in range(3):
            away[j] += turn[j, k] * position[k]
        seen[j] = place[j] + away[j]
    for j in range(3):
        total = limits[SHARED] ** 2
        for k in range(3):
            for m in range(3):
                total += turn[j, k] * covariance[k, m] * turn[j, m]
        spread[j] = total
    tilt, yaw = limits[TILT] ** 2, limits[YAW] ** 2
    spread[0] += yaw * away[2] ** 2 + tilt * away[1] ** 2
    spread[1] += tilt * (away[0] ** 2 + away[2] ** 2)
    spread[2] += yaw * away[0] ** 2 + tilt * away[1] ** 2


@kernel
def marker_way(
    attitude: Floats, covariance: Floats, turn: Floats, limits: Floats, seen: Floats, spread: Floats
) -> bool:
    """Write the angle of the marker's way to the right of z in the frame at rest, and its variance; False if steep."""
    x = turn[0, 0] * attitude[0, 2] + turn[0, 1] * attitude[1, 2] + turn[0, 2] * attitude[2, 2]
    z = turn[2, 0] * attitude[0, 2] + turn[2, 1] * attitude[1, 2] + turn[2, 2] * attitude[2, 2]
    if x * x + z * z < 0.04:
        return False
    seen[3] = math.atan2(x, z)
    spread[3] = limits[YAW] ** 2 + 1e-4
    for k in range(3):  # rotation about the vertical
        for m in range(3):
            spread[3] += turn[1, k] * covariance[3 + k, 3 + m] * turn[1, m]
    return True


@kernel
def transition(ahead: float, lasting: float, limits: Floats, f: Floats) -> None:
    """Write the matrix that takes the five numbers of a coordinate so far ahead."""
    w = 2.0 * math.pi / limits[PERIOD]
    fade = math.exp(-ahead / lasting)
    f[:] = 0.0
    f[0, 0] = f[1, 1] = 1.0
    f[0, 1], f[0, 2] = ahead, lasting * (ahead - lasting * (1.0 - fade))
    f[1, 2], f[2, 2] = lasting * (1.0 - fade), fade
    decay = limits[DAMPING] * w
    turn = w * math.sqrt(max(1.0 - limits[DAMPING] ** 2, 1e-6))
    envelope = math.exp(-decay * ahead)
    c, s = envelope * math.cos(turn * ahead), envelope * math.sin(turn * ahead) / turn
    f[3, 3], f[3, 4] = c + decay * s, s
    f[4, 3], f[4, 4] = -w * w * s, c - decay * s


@kernel
def predict(state: Floats, since: float, turn_since: float, reach: float, limits: Floats, ahead: Floats) -> None:
    """Write x, y, z and the angle with their speeds and the accelerations of sway and drift, so long after the last."""
    f = np.empty((STATES, STATES))
    w = 2.0 * math.pi / limits[PERIOD]
    for axis in range(4):
        gone = min(max(since if axis < 3 else turn_since, 0.0), LATEST)
        lasting = limits[LASTING if axis < 3 else LASTING + 1]
        transition(min(gone, reach), lasting, limits, f)
        for k in range(3):
            ahead[axis, 0] += f[0, k] * state[axis, k]
            if gone <= reach:
                ahead[axis, 1] += f[1, k] * state[axis, k]
        if gone <= reach:
            ahead[axis, 3] = f[2, 2] * state[axis, 2]
        transition(gone, lasting, limits, f)
        sway = f[3, 3] * state[axis, 3] + f[3, 4] * state[axis, 4]
        speed = f[4, 3] * state[axis, 3] + f[4, 4] * state[axis, 4]
        ahead[axis, 0] += sway
        ahead[axis, 1] += speed
        ahead[axis, 2] = -w * w * sway - 2.0 * limits[DAMPING] * w * speed


@kernel
def spread_of(ahead: float, sigma: float, lasting: float, sway: float, limits: Floats, q: Floats) -> None:
    """Write the covariance that the noise adds in so long: of jerk in the drift, of acceleration in the sway."""
    density = 2.0 * sigma**2 / lasting
    q[:] = 0.0
    for j in range(3):
        for k in range(3):
            q[j, k] = density * ahead ** (5 - j - k) / JERK[j, k]
    density = 4.0 * limits[DAMPING] * (2.0 * math.pi / limits[PERIOD]) ** 3 * sway**2
    q[3, 3], q[4, 4] = density * ahead**3 / 3.0, density * ahead
    q[3, 4] = q[4, 3] = density * ahead**2 / 2.0


@kernel
def begin(state: Floats, covariance: Floats, seen: float, spread: float, sigma: float, sway: float, w: float) -> None:
    """Begin a coordinate anew with what was seen."""
    state[:] = 0.0
    covariance[:] = 0.0
    state[0] = seen
    covariance[0, 0], covariance[1, 1], covariance[2, 2] = spread, FIRST_SPEED**2, sigma**2
    covariance[3, 3], covariance[4, 4] = sway**2, (w * sway) ** 2


@kernel
def take(
    state: Floats,
    covariance: Floats,
    seen: Floats,
    spread: Floats,
    first: int,
    last: int,
    since: float,
    limits: Floats,
    refused: npt.NDArray[np.int64],
) -> int:
    """Correct coordinates first ... last - 1 by what was seen; all are believed, or none.

    What is farther than a jump from where the neighbor should be is another one, however often it is seen.
    """
    which = 0 if first == 0 else 1
    sigma, lasting, sway = limits[which], limits[LASTING + which], limits[SWAY + which]
    apart = 0.0
    if which == 0 and since <= FORGET:
        ahead = np.zeros((4, 4))
        predict(state, since, since, STANDS, limits, ahead)
        for axis in range(3):
            apart += (seen[axis] - ahead[axis, 0]) ** 2
    if not apart <= limits[JUMP] ** 2:
        refused[which] += 1
        return REFUSED
    if not since <= FORGET or refused[which] >= limits[PATIENCE]:
        for axis in range(first, last):
            begin(state[axis], covariance[axis], seen[axis], spread[axis], sigma, sway, 2.0 * math.pi / limits[PERIOD])
        refused[which] = 0
        return ANEW
    f, q = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    transition(since, lasting, limits, f)
    spread_of(since, sigma, lasting, sway, limits, q)
    after, wide = np.zeros((last - first, STATES)), np.empty((last - first, STATES, STATES))
    far = False
    for i in range(last - first):
        axis = first + i
        if axis == 1:
            spread_of(since, sigma, lasting, UPRIGHT * sway, limits, q)
        elif axis == 2:
            spread_of(since, sigma, lasting, sway, limits, q)
        for j in range(STATES):
            for k in range(STATES):
                after[i, j] += f[j, k] * state[axis, k]
                total = q[j, k]
                for m in range(STATES):
                    for n in range(STATES):
                        total += f[j, m] * covariance[axis, m, n] * f[k, n]
                wide[i, j, k] = total
        off = seen[axis] - after[i, 0] - after[i, 3]
        if which == 1:
            off -= 2.0 * math.pi * math.floor(off / (2.0 * math.pi) + 0.5)
        variance = wide[i, 0, 0] + 2.0 * wide[i, 0, 3] + wide[i, 3, 3] + spread[axis]
        seen[axis], spread[axis] = off, variance  # from here on the innovation and its variance
        far = far or not off * off <= limits[GATE] ** 2 * variance
    if far:
        refused[which] += 1
        return REFUSED
    for i in range(last - first):
        axis = first + i
        for j in range(STATES):
            gain = (wide[i, j, 0] + wide[i, j, 3]) / spread[axis]
            state[axis, j] = after[i, j] + gain * seen[axis]
            for k in range(STATES):
                covariance[axis, j, k] = wide[i, j, k] - gain * (wide[i, 0, k] + wide[i, 3, k])
    refused[which] = 0
    return BELIEVED
