"""How a vehicle answers to its sticks, from its parameters: `VehicleModel.predict`.

The equations are those of a follower's dead reckoning (`matchset.control.ego_motion`), with two lags of the yaw rate in
place of one, and trims: with s a stick after the delay, tilts t, yaw y, thrust u and time constants L, T, a, b, l,

    L db/dt = F s + t0 - b,    T^2 t'' = b - t - 2 z T t',    a (b y''' + y'') + y' = Y s + y0,    l du/dt = s - u,

    dv/dt = (g u / (m h)) up - g / m - v / D,    h' = S h,

and the yaw turns by (y' - t' sin r) / (cos r cos t), r the roll and t the pitch, since a gyroscope turns with its
vehicle. So a turn carries roll into pitch, and what is held at the level answers to that with 1 less its answer to the
stick. Up is the vehicle's axis in the level frame, h the throttle that hovers, m moved over carried mass. All but the
last are linear, so each is a digital filter of the sticks, which are averaged over each step after the delay.
"""

from typing import Generic, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.signal import cont2discrete, lfilter

from matchset.control.sticks.ego_parameters import GRAVITY
from matchset.flight.identify.flight_log import StickLog

T = TypeVar("T")
Floats = npt.NDArray[np.float64]
STEP = 1.0 / 240.0  # format: s, of the integration; the sticks are averaged over it


class VehicleResponse(NamedTuple):
    """A vehicle when the pictures were taken, in a level frame at rest: x right, y down, z forward, of its start.

    Attributes
    ----------
    rotation : (m, 3, 3)
        From the camera to the frame: Ry(yaw) Rx(-pitch) Rz(roll).
    position : (m, 3)
        Of the center of mass, m; it began at rest in 0.
    """

    rotation: Floats
    position: Floats


class VehicleValues(NamedTuple, Generic[T]):
    """Something of each parameter of a vehicle: its value (SI units, rad), its standard deviation, what is known of it.

    Attributes
    ----------
    delay : float
        From sending a command to its first effect, by the time stamps of the pictures, s.
    full_tilt, tilt_lag, tilt_time, tilt_damping : float
        F, L, T and z.
    roll_trim, pitch_trim : float
        t0: tilts with the sticks in the middle.
    full_yaw_rate, yaw_lag, yaw_motor_lag, yaw_trim : float
        Y, a, b and y0.
    hover_throttle : float
        h at the end of the log.
    sag : float
        S: how fast that grows, 1/s.
    lift_lag : float
        l.
    effective_mass_ratio : float
        m: moved over carried mass.
    drag_time : float
        D.
    ahead : float
        How far the camera is before the center of mass, m.
    speed_x, speed_y, speed_z : float
        Velocity at the first picture, m/s.
    """

    delay: T
    full_tilt: T
    tilt_lag: T
    tilt_time: T
    tilt_damping: T
    roll_trim: T
    pitch_trim: T
    full_yaw_rate: T
    yaw_lag: T
    yaw_motor_lag: T
    yaw_trim: T
    hover_throttle: T
    sag: T
    lift_lag: T
    effective_mass_ratio: T
    drag_time: T
    ahead: T
    speed_x: T
    speed_y: T
    speed_z: T


class VehicleModel:
    """Predicts the motion during a log, for any parameters.

    Parameters
    ----------
    log : StickLog
    """

    def __init__(self, log: StickLog) -> None:
        self._log, end = log, float(log.taken[-1])
        self._start = float(log.sent[0])
        self._edges = np.arange(self._start, end + 2.0 * STEP, STEP)  # of the steps
        self._first = max(int((log.taken[0] - self._start) / STEP) - 1, 0)  # the vehicle flies from here on
        held = np.diff(log.sent, append=end + 1.0)
        self._since = np.concatenate((log.sent, [end + 1.0]))
        self._added = np.vstack((np.zeros(log.sticks.shape[1]), np.cumsum(log.sticks * held[:, np.newaxis], axis=0)))

    def predict(self, values: VehicleValues[float]) -> VehicleResponse:
        """Compute attitude and way at the times of the pictures."""
        roll, pitch, yaw, throttle = self._sticks(values.delay)
        roll, pitch, turned = _turned(values, roll, pitch, yaw)
        times = self._edges[1:]
        hover = values.hover_throttle * np.exp(values.sag * (times - times[-1]))
        thrust = lfilter(*_lag_filter(values.lift_lag), throttle) / hover
        rotations = _rotations(roll, pitch, turned)
        push = -rotations[:, :, 1] * thrust[:, np.newaxis]
        push[:, 1] += 1.0
        push[1:] = 0.5 * (push[1:] + push[:-1])
        push *= GRAVITY / values.effective_mass_ratio * STEP
        push[: self._first] = 0.0
        push[self._first] = values.speed_x, values.speed_y, values.speed_z
        fade = np.exp(-STEP / values.drag_time)
        speed = lfilter([1.0], [1.0, -fade], push, axis=0)
        way = _integral(speed)
        return self._at_pictures(roll, pitch, turned, way)

    def _sticks(self, delay: float) -> Floats:
        """Sticks as they act, each averaged over each step, (4, steps)."""
        at = self._edges - delay
        return np.stack([np.diff(np.interp(at, self._since, added)) / STEP for added in self._added.T])

    def _at_pictures(self, roll: Floats, pitch: Floats, yaw: Floats, way: Floats) -> VehicleResponse:
        """Interpolate, tilts at the ends of the steps."""
        at, times = self._log.taken, self._edges[1:]
        tilts = [np.interp(at, times, each) for each in (roll, pitch, yaw)]
        places = np.stack([np.interp(at, times, each) for each in way.T], axis=1)
        return VehicleResponse(_rotations(*tilts), places)


def _turned(values: VehicleValues[float], roll: Floats, pitch: Floats, yaw: Floats) -> tuple[Floats, Floats, Floats]:
    """Compute roll, pitch and yaw from their sticks."""
    tilt = _tilt_filter(values)
    roll = lfilter(*tilt, values.full_tilt * roll) + values.roll_trim
    pitch = lfilter(*tilt, values.full_tilt * pitch) + values.pitch_trim
    rate = lfilter(*_yaw_filter(values), values.full_yaw_rate * yaw) + values.yaw_trim
    tipping = np.diff(pitch, prepend=pitch[0]) / STEP
    turning = (rate - tipping * np.sin(roll)) / (np.cos(roll) * np.cos(pitch))
    carried = _integral(np.stack((-turning * np.sin(pitch), turning * np.sin(roll)), axis=1))
    left = carried - lfilter(*tilt, carried, axis=0)
    return roll + left[:, 0], pitch + left[:, 1], _integral(turning)


def _integral(rates: Floats) -> Floats:
    """Integrate over time by the trapezoidal rule, from 0 half a step before the first."""
    integral: Floats = STEP * (np.cumsum(rates, axis=0) - 0.5 * rates)
    return integral


def _tilt_filter(values: VehicleValues[float]) -> tuple[Floats, Floats]:
    """Coefficients of the tilt's answer."""
    pair = (values.tilt_time**2, 2.0 * values.tilt_damping * values.tilt_time, 1.0)
    return _discrete(np.asarray(np.polymul((values.tilt_lag, 1.0), pair), np.float64))


def _yaw_filter(values: VehicleValues[float]) -> tuple[Floats, Floats]:
    """Coefficients of the yaw rate's answer."""
    return _discrete(np.array((values.yaw_lag * values.yaw_motor_lag, values.yaw_lag, 1.0)))


def _lag_filter(lag: float) -> tuple[Floats, Floats]:
    """Coefficients of a first-order lag."""
    return _discrete(np.array((lag, 1.0)))


def _discrete(denominator: Floats) -> tuple[Floats, Floats]:
    """Coefficients of a filter of gain 1 for inputs that are constant over each step: its value at the step's end."""
    numerator, discrete, _ = cont2discrete(([1.0], denominator), STEP, "zoh")
    numerator = numerator.ravel()
    return numerator[1:] if len(numerator) > 1 else numerator, discrete


def _rotations(roll: Floats, pitch: Floats, yaw: Floats) -> Floats:
    """Matrices Ry(yaw) Rx(-pitch) Rz(roll), (n, 3, 3)."""
    # SciPy's Rotation takes twenty times as long, and a fit asks for this thousands of times
    cr, sr, cp, sp, cy, sy = (f(each) for each in (roll, pitch, yaw) for f in (np.cos, np.sin))
    rows = (
        (cy * cr - sy * sp * sr, -cy * sr - sy * sp * cr, sy * cp),
        (cp * sr, cp * cr, sp),
        (-sy * cr - cy * sp * sr, sy * sr - cy * sp * cr, cy * cp),
    )
    return np.moveaxis(np.array(rows), 2, 0)
