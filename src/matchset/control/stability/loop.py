"""The loops of a follower as frequency responses: `level_loop`, `rise_loop` and `yaw_loop` make a `Loop`.

A follower predicts: it subtracts from each picture what dead reckoning says that its own commands did, and controls the
vehicle as it will be when the next command acts (`follower.py`). With the vehicle G, its model G' in dead reckoning,
the delay t from a command to the first picture of its effect and t' as it is believed,

    picture, in the frame of dead reckoning:   z = b - G e^(-st) u + G' e^(-st') u,
    command:                                   u = N z - M u,

where M is what the controllers make of the predicted own motion, and N what they make of the neighbor as the filter
predicts it. That is a Smith predictor (Smith 1957): with a right model the delay is not in the loop of its poles. Two
loops have margins, and both count:

- *gains*: cut behind the controllers, model and vehicle together, ``M + N (G e^(-st) - G' e^(-st'))``. By so much all
  gains may be raised. With a right model it is M alone, whatever the delay.
- *vehicle*: cut at the vehicle alone, ``N G e^(-st) / (1 + M - N G' e^(-st'))``. By so much its thrust may differ from
  what dead reckoning believes, and so much later may it answer. Here delay and filter count, also with a right model.

Both close the same loop, ``1 + gains = 0`` where ``1 + vehicle = 0``. Commands are held from picture to picture, and
sampling is exact, z = e^(sT), but for a delay that is no whole number of pictures, which is e^(-st). Left out: limits
of the sticks and of their rates, pictures that are missing, the tilt's coupling into the height, and what is learned
slowly (thrust, delay, mount).
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.linalg import expm

from matchset.control.feedforward import FeedforwardParameters
from matchset.control.neighbor_model import (
    ORDER,
    NeighborFilterParameters,
    write_drift_transition,
    write_oscillation_transition,
)
from matchset.control.pid import PidParameters
from matchset.control.sticks.ego_parameters import EgoMotionParameters
from matchset.numeric.jit import interpreted

Floats = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

# format: of a sweep: from slower than any integral to beyond the bandwidth of every vehicle that is flown, rad/s
FREQUENCIES = np.geomspace(0.2, 80.0, 160)


class Timing(NamedTuple):
    """Times of a loop, s, as this flight shows them.

    Attributes
    ----------
    step : float
        From one picture to the next.
    age : float
        Of a picture by its stamp when its command is sent.
    delay : float
        From sending a command to its first effect, as it is believed: `EgoMotion.delay`.
    error : float
        By how much later than that, or than the stamp says, the effect is seen.
    reach : float
        `FollowerParameters.max_extrapolation`.
    """

    step: float
    age: float
    delay: float
    error: float = 0.0
    reach: float = 0.4


class AxisControl(NamedTuple):
    """The controllers of one axis.

    Attributes
    ----------
    pid : PidParameters
        From m to m/s^2; of the yaw from rad to rad/s.
    lead : float
        For how much later than the command acts it is computed, s.
    speed : FeedforwardParameters or None
        Of the neighbor's speed.
    swing, drift : float
        Shares of the neighbor's oscillating acceleration, and of its other one, that are flown at once; where speeds
        are told, times the time in which the vehicle goes over to one.
    along : float
        Share of the neighbor's speed that is told besides: 1 where speeds are told.
    """

    pid: PidParameters
    lead: float = 0.0
    speed: FeedforwardParameters | None = None
    swing: float = 0.0
    drift: float = 0.0
    along: float = 0.0


class Vehicle(NamedTuple):
    """How one axis of a vehicle answers: ``x' = A x + B u``, its position the last number, its speed the one before.

    Attributes
    ----------
    system : ndarray of shape (n, n)
    input : ndarray of shape (n,)
    gain : float
        What it does over what it is believed to do.
    """

    system: Floats
    input: Floats
    gain: float = 1.0


class FilterGains(NamedTuple):
    """The Kalman filter of the neighbor on one axis, in use.

    Attributes
    ----------
    gains : ndarray of shape (5,)
        By which it corrects its five numbers, see `neighbor_model.py`: they follow the noise of this flight's poses.
    parameters : NeighborFilterParameters
    acceleration_time : float
        Of the axis, s.
    """

    gains: Floats
    parameters: NeighborFilterParameters
    acceleration_time: float


class Loop(NamedTuple):
    """A loop cut open, at `frequencies`.

    Attributes
    ----------
    frequencies : ndarray of shape (n,)
        rad/s.
    own, seen : ndarray of shape (n,), complex
        M and N.
    vehicle, model : ndarray of shape (n,), complex
        G e^(-st) and G' e^(-st').
    """

    frequencies: Floats
    own: Complex
    seen: Complex
    vehicle: Complex
    model: Complex

    @property
    def at_gains(self) -> Complex:
        """Cut behind the controllers."""
        return self.own + self.seen * (self.vehicle - self.model)

    @property
    def at_vehicle(self) -> Complex:
        """Cut at the vehicle."""
        return self.seen * self.vehicle / (1.0 + self.own - self.seen * self.model)


def horizontal_vehicle(model: EgoMotionParameters, gain: float = 1.0) -> Vehicle:
    """Motors, tilt, its rate, speed and place, from the acceleration that is asked for."""
    w, damping = 1.0 / model.tilt_time, model.tilt_damping
    system = np.zeros((5, 5))
    system[0, 0] = -1.0 / model.tilt_lag
    system[1, 2] = 1.0
    system[2, :3] = w * w, -w * w, -2.0 * damping * w
    system[3, 1], system[3, 3] = 1.0, -1.0 / model.drag_time
    system[4, 3] = 1.0
    return Vehicle(system, np.array((1.0 / model.tilt_lag, 0.0, 0.0, 0.0, 0.0)), gain)


def vertical_vehicle(model: EgoMotionParameters, gain: float = 1.0) -> Vehicle:
    """Lift, speed and height, from the acceleration that is asked for."""
    system = np.zeros((3, 3))
    system[0, 0] = -1.0 / model.lift_lag
    system[1, 0], system[1, 1] = 1.0, -1.0 / model.drag_time
    system[2, 1] = 1.0
    return Vehicle(system, np.array((1.0 / model.lift_lag, 0.0, 0.0)), gain)


def horizontal_speed_vehicle(model: EgoMotionParameters, gain: float = 1.0) -> Vehicle:
    """Return the same of one that is told a level speed, and asks itself for the acceleration to it."""
    vehicle = horizontal_vehicle(model, gain)
    vehicle.system[3, 3] = 0.0
    return _held(vehicle, model.speed_time)


def vertical_speed_vehicle(model: EgoMotionParameters, gain: float = 1.0) -> Vehicle:
    """Return lift, speed and height of one that is told a rise."""
    vehicle = vertical_vehicle(model, gain)
    vehicle.system[1, 1] = 0.0
    return _held(vehicle, model.rise_time)


def _held(vehicle: Vehicle, time: float) -> Vehicle:
    """Let a vehicle hold its speed by itself, going over to another one in a time, s."""
    vehicle.system[:, -2] -= vehicle.input / time
    return vehicle._replace(input=vehicle.input / time)


def yaw_vehicle(model: EgoMotionParameters, gain: float = 1.0) -> Vehicle:
    """Yaw rate and yaw, from the rate that is asked for."""
    system = np.array(((-1.0 / model.yaw_lag, 0.0), (1.0, 0.0)))
    return Vehicle(system, np.array((1.0 / model.yaw_lag, 0.0)), gain)


def open_loop(
    control: AxisControl, vehicle: Vehicle, neighbor: FilterGains, timing: Timing, frequencies: Floats = FREQUENCIES
) -> Loop:
    """Cut a loop open.

    Parameters
    ----------
    control : AxisControl
    vehicle : Vehicle
        As dead reckoning believes it, but for its `gain`.
    neighbor : FilterGains
    timing : Timing
    frequencies : ndarray of shape (n,)
        rad/s.
    """
    s = 1j * frequencies
    z = np.exp(s * timing.step)
    states = _states(vehicle, timing.step, z)
    place = states[:, -1]
    shape, ahead = _going_on(vehicle, control.lead)
    led = states @ shape.T + np.outer(1.0 / z, ahead)  # the last command goes on
    seen = _seen(control, neighbor, timing, z)
    on_place, on_speed = _controllers(control, timing.step, z)
    own = on_place * led[:, -1] + on_speed * led[:, -2]
    shown = timing.age + timing.delay
    actual = vehicle.gain * place * np.exp(-s * (shown + timing.error))
    return Loop(frequencies, own, seen, actual, place * np.exp(-s * shown))


def _states(vehicle: Vehicle, step: float, z: Complex) -> Complex:
    """Responses of all numbers of a vehicle to a command that is held from picture to picture, (n, order)."""
    moved, added = _going_on(vehicle, step)
    systems = z[:, np.newaxis, np.newaxis] * np.eye(len(added)) - moved
    return np.asarray(np.linalg.solve(systems, added[:, np.newaxis]), np.complex128)[..., 0]


def _going_on(vehicle: Vehicle, time: float) -> tuple[Floats, Floats]:
    """Return what a state becomes in a time, and what the command that is held adds."""
    order = len(vehicle.input)
    block = np.zeros((order + 1, order + 1))
    block[:order, :order], block[:order, order] = vehicle.system, vehicle.input
    whole = expm(block * time)
    return whole[:order, :order], whole[:order, order]


def _controllers(control: AxisControl, step: float, z: Complex) -> tuple[Complex, Complex]:
    """Return what a place and a speed are multiplied by, filter of the derivative and integral included."""
    pid = control.pid
    share = step / (pid.derivative_filter_time + step)
    rate = share / (1.0 - (1.0 - share) / z)
    kept = pid.integral_floor if math.isfinite(pid.integral_decay_time) else 1.0
    integral = kept * pid.integral * step / (1.0 - 1.0 / z)
    return pid.proportional + integral, (pid.derivative + integral * pid.integral_lead) * rate


def _seen(control: AxisControl, neighbor: FilterGains, timing: Timing, z: Complex) -> Complex:
    """N: what the controllers make of a picture, through the neighbor's filter and its prediction."""
    transition = _transition(neighbor, timing.step, timing.step)
    correcting = np.eye(len(transition)) - np.outer(neighbor.gains, (1.0, 0.0, 0.0, 1.0, 0.0))
    systems = np.eye(len(transition)) - (correcting @ transition) / z[:, np.newaxis, np.newaxis]
    state = np.linalg.solve(systems, neighbor.gains[:, np.newaxis].astype(np.complex128))[..., 0]
    acts = timing.age + timing.delay
    now, led = (_forecast(neighbor, time, timing.reach) for time in (acts, acts + control.lead))
    place, speed, swinging, drifting = (state @ row for row in led)
    if control.speed is not None:
        share = timing.step / (control.speed.crossover_time + timing.step)
        low = share / (1.0 - (1.0 - share) / z) * (state @ now[1])
        speed = low + control.speed.high_frequency_gain * (speed - low)
    on_place, on_speed = _controllers(control, timing.step, z)
    seen: Complex = on_place * place + on_speed * speed + control.swing * swinging + control.drift * drifting
    seen += control.along * speed
    return seen


def _transition(neighbor: FilterGains, drifting: float, swinging: float) -> Floats:
    """Transition of the five numbers: the drift over one time, the oscillation over another (`neighbor_model.py`)."""
    transition = np.zeros((ORDER, ORDER))
    interpreted(write_drift_transition)(neighbor.acceleration_time, drifting, transition)
    interpreted(write_oscillation_transition)(neighbor.parameters, swinging, transition)
    return transition


def _forecast(neighbor: FilterGains, elapsed: float, reach: float) -> Floats:
    """Rows for place, speed, and the accelerations of oscillation and drift, so long after a picture."""
    moved = _transition(neighbor, min(elapsed, reach), elapsed)
    w, damping = 2.0 * np.pi / neighbor.parameters.oscillation_period, neighbor.parameters.oscillation_damping
    goes_on = float(elapsed <= reach)
    return np.array(
        (
            moved[0] + moved[3],
            goes_on * moved[1] + moved[4],
            -w * w * moved[3] - 2.0 * damping * w * moved[4],
            goes_on * moved[2],
        )
    )
