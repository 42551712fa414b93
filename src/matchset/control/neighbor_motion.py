"""How the neighbor moves, from poses seen by a vehicle that does not measure its own tilt: `NeighborMotion`.

In the frame at rest of dead reckoning each coordinate of the ball, and the way its marker points, is the sum of a drift
with an acceleration that lasts a while (Singer 1970), ``d'' = a, a' = -a/T + noise``, and a sway about the period of
what hangs on a rope, ``s'' = -w^2 s - 2 z w s' + noise``. A Kalman filter follows both. To the covariance of a pose
comes what the unmeasured tilt and turn of the vehicle do to it: a degree of tilt at 1.5 m looks like 26 mm.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.dead_reckoning import turn_of
from matchset.control.own_motion import OwnState
from matchset.localization.pose import Pose
from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]

BELIEVED, REFUSED, ANEW = 0, 1, 2
LASTING, PERIOD, DAMPING, SWAY, TILT, YAW, SHARED, GATE, PATIENCE = 2, 3, 4, 5, 7, 8, 9, 10, 11
FORGET = 1.5  # s without a pose after which all begins anew
UPRIGHT = 0.1  # share of the sway that is upright: what hangs on a rope sways level
LATEST = 10.0  # s past the last pose; later is the same
FIRST_SPEED = 0.5  # m/s or rad/s, of a speed that is not known yet
JERK = np.array(((20.0, 8.0, 6.0), (8.0, 3.0, 2.0), (6.0, 2.0, 1.0)))  # of the white-jerk model
STATES = 5  # numbers of a coordinate: drift, its speed and acceleration, sway, its speed


class NeighborMotionParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the neighbor's poses are filtered.

    Parameters
    ----------
    acceleration : float
        Standard deviation of the neighbor's acceleration and of what the dead reckoning misses, m/s^2. More follows
        sooner and smooths less.
    turning : float
        Standard deviation of its angular acceleration, rad/s^2.
    lasting : float
        For how long such an acceleration lasts, s.
    period : float
        Of the sway, s: 2.2 for a rope of 1.2 m. A neighbor that follows something that sways, sways with it.
    damping : float
        How far the sway is from a steady one, as a damping ratio: more forgives a wrong period, and predicts less.
    sway : float
        Standard deviation of the sway, m.
    turn_sway : float
        The same for the neighbor's turning, rad.
    tilt : float
        Standard deviation of the vehicle's own tilt about what its commands say, rad.
    yaw : float
        The same for its turning, rad.
    shared : float
        Least standard deviation of a place, m: what the shading and the lens do to all frames alike.
    gate : float
        Largest deviation from the prediction that is believed, standard deviations.
    patience : int
        How many poses in a row may be left out before the next one is believed and all begins anew.
    """

    acceleration: float = 0.7
    turning: float = 0.6
    lasting: float = 0.5
    period: float = 2.2
    damping: float = 0.03
    sway: float = 0.07
    turn_sway: float = 0.03
    tilt: float = 0.025
    yaw: float = 0.01
    shared: float = 0.005
    gate: float = 5.0
    patience: int = 5

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")


class NeighborMotion:
    """Filters one neighbor in the frame at rest.

    Parameters
    ----------
    parameters : NeighborMotionParameters, optional

    Attributes
    ----------
    time : float
        Of the last pose that was believed, s; -inf before the first.
    turn_time : float
        The same for the way its marker points.
    """

    def __init__(self, parameters: NeighborMotionParameters | None = None) -> None:
        self.parameters = parameters or NeighborMotionParameters()
        self.time = self.turn_time = -math.inf
        self._state = np.zeros((4, STATES))  # x, y, z, and the angle of the marker's way to the right of z
        self._covariance = np.zeros((4, STATES, STATES))
        self._limits = np.array([float(getattr(self.parameters, name)) for name in self.parameters.__struct_fields__])
        self._refused = np.zeros(2, np.int64)

    def update(self, pose: Pose, own: OwnState) -> bool:
        """Take in a pose in the camera frame, seen from a state of the vehicle at the same time.

        Returns
        -------
        bool
            Whether its position was believed.
        """
        turn, seen, spread = np.empty((3, 3)), np.empty(4), np.empty(4)
        turn_of(own.numbers, turn)
        told = 3
        to_rest(pose.position, pose.covariance, turn, own.place, self._limits, seen, spread)
        if pose.turn is not None and marker_way(pose.turn, pose.covariance, turn, self._limits, seen, spread):
            told = 4
        since, turn_since = pose.time - self.time, pose.time - self.turn_time
        believed = take(self._state, self._covariance, seen, spread, 0, 3, since, self._limits, self._refused)
        if believed != REFUSED:
            self.time = pose.time
        if told == 4:
            believed_turn = take(
                self._state, self._covariance, seen, spread, 3, 4, turn_since, self._limits, self._refused
            )
            if believed_turn != REFUSED:
                self.turn_time = pose.time
        return believed != REFUSED

    def at(self, time: float, reach: float) -> Floats:
        """Predict for a time, extrapolating at most so far past what was seen last; after that it stands.

        Parameters
        ----------
        time : float
            s.
        reach : float
            s.

        Returns
        -------
        ndarray of shape (4, 3)
            x, y, z and the angle of the marker's way to the right of z, rad; each with its speed and the acceleration
            of its sway.
        """
        ahead = np.zeros((4, 3))
        since, turn_since = time - self.time, time - self.turn_time
        predict(self._state, since, turn_since, reach, self._limits, ahead)
        return ahead


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
def transition(ahead: float, limits: Floats, f: Floats) -> None:
    """Write the matrix that takes the five numbers of a coordinate so far ahead."""
    lasting, w = limits[LASTING], 2.0 * math.pi / limits[PERIOD]
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
    """Write x, y, z and the angle with their speeds and the accelerations of their sway, so long after the last."""
    f = np.empty((STATES, STATES))
    w = 2.0 * math.pi / limits[PERIOD]
    for axis in range(4):
        gone = min(max(since if axis < 3 else turn_since, 0.0), LATEST)
        transition(min(gone, reach), limits, f)
        for k in range(3):
            ahead[axis, 0] += f[0, k] * state[axis, k]
            if gone <= reach:
                ahead[axis, 1] += f[1, k] * state[axis, k]
        transition(gone, limits, f)
        sway = f[3, 3] * state[axis, 3] + f[3, 4] * state[axis, 4]
        speed = f[4, 3] * state[axis, 3] + f[4, 4] * state[axis, 4]
        ahead[axis, 0] += sway
        ahead[axis, 1] += speed
        ahead[axis, 2] = -w * w * sway - 2.0 * limits[DAMPING] * w * speed


@kernel
def spread_of(ahead: float, sigma: float, sway: float, limits: Floats, q: Floats) -> None:
    """Write the covariance that the noise adds in so long: of jerk in the drift, of acceleration in the sway."""
    density = 2.0 * sigma**2 / limits[LASTING]
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
    """Correct coordinates first ... last - 1 by what was seen; all are believed, or none."""
    which = 0 if first == 0 else 1
    sigma, sway = (limits[0], limits[SWAY]) if which == 0 else (limits[1], limits[SWAY + 1])
    if not since <= FORGET or refused[which] >= limits[PATIENCE]:
        for axis in range(first, last):
            begin(state[axis], covariance[axis], seen[axis], spread[axis], sigma, sway, 2.0 * math.pi / limits[PERIOD])
        refused[which] = 0
        return ANEW
    f, q = np.empty((STATES, STATES)), np.empty((STATES, STATES))
    transition(since, limits, f)
    spread_of(since, sigma, sway, limits, q)
    after, wide = np.zeros((last - first, STATES)), np.empty((last - first, STATES, STATES))
    far = False
    for i in range(last - first):
        axis = first + i
        if axis == 1:
            spread_of(since, sigma, UPRIGHT * sway, limits, q)
        elif axis == 2:
            spread_of(since, sigma, sway, limits, q)
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
