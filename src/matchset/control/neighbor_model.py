"""Motion model of a neighbor: each axis is a drift plus an oscillation.

In the frame at rest of dead reckoning each coordinate of the ball, and the direction of its marker, is the sum of a
drift with a correlated acceleration (Singer 1970), ``d'' = a, a' = -a / T + noise``, and an oscillation with the period
of what hangs on a rope, ``s'' = -w^2 s - 2 z w s' + noise``: five numbers for each of the four axes x, y, z and yaw.
Decision 050 has the reasons. `neighbor_filter.py` estimates them.
"""

import math
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import require_positive
from matchset.numeric.jit import helper

Floats = npt.NDArray[np.float64]

TINY = 1e-6  # least square of the damped frequency, as a share of the undamped one
AXES = 4  # format: x, y, z, and the angle of the marker's direction to the right of z
VERTICAL, YAW = 1, 3  # format: the second and the last of these
ORDER = 5  # format: numbers of an axis: drift, its speed and acceleration, oscillation, its speed
# theorem: white jerk, Bar-Shalom, Li & Kirubarajan 2001, section 6.2.3: Q[j, k] = q t^(5 - j - k) / WHITE_JERK[j, k]
WHITE_JERK = np.array(((20.0, 8.0, 6.0), (8.0, 3.0, 2.0), (6.0, 2.0, 1.0)))


class NeighborFilterParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of a `NeighborFilter`.

    Where it says "flights", the value was chosen on the simulated flights of seeds 0 to 9; `python -m
    benchmarks.flight.fly` shows a change.

    Parameters
    ----------
    acceleration_sigma : float
        Standard deviation of the neighbor's acceleration and of what dead reckoning misses, m/s^2. More follows sooner
        and smooths less. Chosen by: flights.
    yaw_acceleration_sigma : float
        The same for its yaw, rad/s^2. Chosen by: flights.
    acceleration_time, yaw_acceleration_time : float
        Correlation time T of these accelerations, s. More extrapolates farther. Chosen by: flights.
    oscillation_period : float
        Period 2 pi / w of the oscillation, s. Derived: 2 pi sqrt(L / g) of a rope of 1.2 m; a neighbor that follows
        something that swings, swings with it.
    oscillation_damping : float
        Damping ratio z of the oscillation: more forgives a wrong period, and predicts less. Chosen by: flights.
    oscillation_sigma : float
        Standard deviation of the oscillation, m. Chosen by: flights; about 0.1 m over root 2.
    yaw_oscillation_sigma : float
        The same for the yaw, rad. Estimate.
    tilt_sigma : float
        Standard deviation of the vehicle's tilt about its dead reckoning, rad. Less lets the height follow every tilt.
        Chosen by: flights.
    yaw_sigma : float
        The same for its yaw, rad. Chosen by: flights.
    systematic_sigma : float
        Standard deviation of the errors that frames share, m: shading and lens. Chosen by: the accuracy of positions at
        1.5 m.
    gate : float
        Largest innovation that is accepted, standard deviations. More accepts outliers, less rejects a neighbor that
        moves off. Usual value.
    max_jump : float
        Largest difference from the last accepted pose in the distance from the camera, m: half of the way from one ball
        to the next, which looks the same. It is not compared with the prediction, since dead reckoning drifts.
    max_rejected : int
        After so many rejected poses that agree with each other the next one initializes the filter anew. More waits
        longer for a neighbor that is in plain view; fewer believes something else of its size. Chosen by hand: a third
        of a second, a third of `SafetyParameters.hold_time`.
    agreement : float
        Largest distance between two rejected poses, one after the other, that agree, in the camera frame, m. More also
        believes poses that jump. Chosen by hand: 3 m/s for three pictures.
    widening : float
        By how much each rejected pose that agrees with the one before raises `acceleration_sigma`, as a share of it:
        the gate widens with what the prediction does not know. More accepts a pose sooner that is a little off. Chosen
        on the flights of seeds 100 to 103 with 133 ms of latency told as 67 ms.
    reset_time : float
        Time without a pose after which the next one initializes the filter anew, s. By then safety has landed a vehicle
        that lost its neighbor.
    vertical_oscillation_ratio : float
        Vertical oscillation as a share of the level one: what hangs on a rope swings level. Chosen by hand; flights.
    max_prediction : float
        A time farther than that after the last pose is treated as that, s. Chosen by hand: longer than `reset_time`.
    initial_speed_sigma : float
        Standard deviation of the speed before it is known, m/s and rad/s. Chosen by hand; flights.
    min_level_part : float
        Smallest level part of the marker's direction, a unit vector, from which its yaw is computed. Chosen by hand: 78
        degrees off the level.
    marker_sigma : float
        Least standard deviation of the marker's yaw, rad. Chosen by hand; flights.
    """

    acceleration_sigma: float = 0.52
    yaw_acceleration_sigma: float = 0.8
    acceleration_time: float = 0.68
    yaw_acceleration_time: float = 1.0
    oscillation_period: float = 2.2
    oscillation_damping: float = 0.021
    oscillation_sigma: float = 0.075
    yaw_oscillation_sigma: float = 0.03
    tilt_sigma: float = 0.04
    yaw_sigma: float = 0.01
    systematic_sigma: float = 0.005
    gate: float = 5.0
    max_jump: float = 0.7
    max_rejected: int = 10
    agreement: float = 0.3
    widening: float = 0.3
    reset_time: float = 3.0
    vertical_oscillation_ratio: float = 0.1
    max_prediction: float = 10.0
    initial_speed_sigma: float = 0.5
    min_level_part: float = 0.2
    marker_sigma: float = 0.01

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)


class AxisForecast(msgspec.Struct, frozen=True, gc=False):
    """One axis at a time: value (m or rad), speed, and the accelerations of oscillation and drift."""

    value: float
    speed: float
    oscillation_acceleration: float
    drift_acceleration: float


class Forecast(msgspec.Struct, frozen=True, gc=False):
    """The neighbor's ball in the frame at rest, and the angle of its marker's direction to the right of z."""

    x: AxisForecast
    y: AxisForecast
    z: AxisForecast
    yaw: AxisForecast

    def turned_to(self, x: float, z: float, beside: float) -> "Forecast":
        """Return it as if a place were in the direction of the set place, and the ball moved to and from that only.

        Across that line a ball that moves looks like a vehicle whose dead reckoning turns.

        Parameters
        ----------
        x, z : float
            The place, level, m.
        beside : float
            Angle of the set place from the marker's direction to the ball's +x, rad.
        """
        yaw = math.atan2(x - self.x.value, z - self.z.value)
        right, ahead = math.sin(yaw), math.cos(yaw)
        along = [right * one + ahead * other for one, other in zip(_motion(self.x), _motion(self.z), strict=True)]
        return Forecast(
            AxisForecast(self.x.value, *(right * each for each in along)),
            self.y,
            AxisForecast(self.z.value, *(ahead * each for each in along)),
            AxisForecast(yaw - beside, 0.0, 0.0, 0.0),
        )

    @property
    def place(self) -> Floats:
        """Where the ball is, (3,), m."""
        return np.array((self.x.value, self.y.value, self.z.value))


def _motion(axis: AxisForecast) -> tuple[float, float, float]:
    """Speed and both accelerations of an axis."""
    return axis.speed, axis.oscillation_acceleration, axis.drift_acceleration


class AxisGroup:
    """Layout of what axes share that are accepted or rejected together: position, or yaw."""

    first: int
    end: int  # behind the last one
    acceleration_sigma: float
    acceleration_time: float
    oscillation_sigma: float
    rejected: int  # poses that agree with each other


@helper
def write_drift_transition(time_constant: float, step: float, f: Floats) -> None:
    """Write the drift's part of the transition matrix: position, speed and acceleration (Singer 1970)."""
    fade = math.exp(-step / time_constant)
    f[0, 0] = f[1, 1] = 1.0
    f[0, 1], f[0, 2] = step, time_constant * (step - time_constant * (1.0 - fade))
    f[1, 2], f[2, 2] = time_constant * (1.0 - fade), fade


@helper
def write_oscillation_transition(parameters: Any, step: float, f: Floats) -> None:
    """Write the oscillation's part of the transition matrix: value and speed of a damped oscillator."""
    damping, w = parameters.oscillation_damping, 2.0 * math.pi / parameters.oscillation_period
    decay = damping * w
    damped = w * math.sqrt(max(1.0 - damping**2, TINY))
    envelope = math.exp(-decay * step)
    c, s = envelope * math.cos(damped * step), envelope * math.sin(damped * step) / damped
    f[3, 3], f[3, 4] = c + decay * s, s
    f[4, 3], f[4, 4] = -w * w * s, c - decay * s


@helper
def write_noise(parameters: Any, axes: Any, axis: int, step: float, q: Floats) -> None:
    """Write the covariance that the noise adds in a time: of jerk to the drift, of acceleration to the oscillation."""
    sigma = axes.acceleration_sigma * (1.0 + parameters.widening * axes.rejected)
    density = 2.0 * sigma**2 / axes.acceleration_time
    q[:, :] = 0.0
    for j in range(3):
        for k in range(3):
            q[j, k] = density * step ** (5 - j - k) / WHITE_JERK[j, k]
    sigma = axes.oscillation_sigma
    if axis == VERTICAL:
        sigma = parameters.vertical_oscillation_ratio * sigma
    density = 4.0 * parameters.oscillation_damping * (2.0 * math.pi / parameters.oscillation_period) ** 3 * sigma**2
    q[3, 3], q[4, 4] = density * step**3 / 3.0, density * step
    q[3, 4] = q[4, 3] = density * step**2 / 2.0


@helper
def forecast_axis(work: Any, axes: Any, axis: int, since: float, max_extrapolation: float) -> None:
    """Write value, speed, and the accelerations of oscillation and drift of one axis, so long after it was seen, s."""
    f, state, parameters, ahead = work.transition, work.estimate[axis], work.parameters, work.forecast[axis]
    elapsed = min(max(since, 0.0), parameters.max_prediction)
    write_drift_transition(axes.acceleration_time, min(elapsed, max_extrapolation), f)
    write_oscillation_transition(parameters, elapsed, f)
    drift = f[0, 0] * state[0] + f[0, 1] * state[1] + f[0, 2] * state[2]
    speed = f[1, 1] * state[1] + f[1, 2] * state[2] if elapsed <= max_extrapolation else 0.0
    swing = f[3, 3] * state[3] + f[3, 4] * state[4]
    swing_speed = f[4, 3] * state[3] + f[4, 4] * state[4]
    w = 2.0 * math.pi / parameters.oscillation_period
    ahead[0], ahead[1] = drift + swing, speed + swing_speed
    ahead[2] = -w * w * swing - 2.0 * parameters.oscillation_damping * w * swing_speed
    ahead[3] = f[2, 2] * state[2] if elapsed <= max_extrapolation else 0.0
