"""Kalman filter of the neighbor's motion: `NeighborFilter`.

It estimates the model of `neighbor_model.py` from poses. What the unmeasured tilt and yaw of the vehicle do to a pose
is added to its covariance: a degree of tilt at 1.5 m looks like 26 mm. The four axes are filtered by themselves; those
of the position are accepted or rejected together.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from matchset.control.ego_motion import STATE, STATE_SIZE, EgoState, write_rotation
from matchset.control.neighbor_model import (
    AXES,
    ORDER,
    YAW,
    AxisForecast,
    AxisGroup,
    Forecast,
    NeighborFilterParameters,
    forecast_axis,
    write_drift_transition,
    write_noise,
    write_oscillation_transition,
)
from matchset.localization.pose import Pose
from matchset.numeric.copies import Copied
from matchset.numeric.jit import helper, kernel
from matchset.numeric.kalman import add_prediction, correct_by_scalar
from matchset.numeric.record import Block, fields, new_block, record_dtype, store

Floats = npt.NDArray[np.float64]

SPEED = 1  # format: the second number of an axis
POSITION_ACCEPTED, YAW_ACCEPTED, OTHER_BALL = 1, 2, 4  # format: bits of an answer
VALUES = len(AxisForecast.__struct_fields__)


class _Work:
    parameters: NeighborFilterParameters
    position_axes: AxisGroup
    yaw_axis: AxisGroup
    estimate: Annotated[Floats, (AXES, ORDER), "f8"]
    covariance: Annotated[Floats, (AXES, ORDER, ORDER), "f8"]
    # the pose, and the vehicle's state at its time
    ball: Annotated[Floats, (3,), "f8"]
    pose_covariance: Annotated[Floats, (6, 6), "f8"]
    ball_rotation: Annotated[Floats, (3, 3), "f8"]
    ego: Annotated[Floats, (STATE_SIZE,), "f8"]
    distance: float  # from the camera to the ball in the last accepted pose, m
    refused: Annotated[Floats, (3,), "f8"]  # ball of the last rejected pose, camera frame
    # scratch
    rotation: Annotated[Floats, (3, 3), "f8"]
    away: Annotated[Floats, (3,), "f8"]  # from the vehicle to the ball, in the frame at rest
    measured: Annotated[Floats, (AXES,), "f8"]
    variance: Annotated[Floats, (AXES,), "f8"]
    innovation: Annotated[Floats, (AXES,), "f8"]
    innovation_variance: Annotated[Floats, (AXES,), "f8"]
    transition: Annotated[Floats, (ORDER, ORDER), "f8"]
    predicted: Annotated[Floats, (AXES, ORDER), "f8"]
    predicted_covariance: Annotated[Floats, (AXES, ORDER, ORDER), "f8"]
    cross: Annotated[Floats, (AXES, ORDER), "f8"]  # covariance of the prediction with its measurement
    forecast: Annotated[Floats, (AXES, VALUES), "f8"]


WORK = record_dtype(_Work)


class NeighborFilter(Copied):
    """Filters one neighbor in the frame at rest. The constructor compiles all kernels.

    Parameters
    ----------
    parameters : NeighborFilterParameters, optional

    Attributes
    ----------
    time : float
        Of the last pose whose position was accepted, s; -inf before the first.
    yaw_time : float
        The same for the direction of its marker.
    doubt : str
        Why the position of the last pose was not accepted, in words; empty if it was.
    """

    def __init__(self, parameters: NeighborFilterParameters | None = None) -> None:
        self.parameters = parameters or NeighborFilterParameters()
        self.time = self.yaw_time = -math.inf
        self.doubt = ""
        self._block = initial_block(self.parameters)
        self._make_derived()

    def _derive(self) -> None:
        self._work = fields(self._block, WORK)
        self._ball, self._pose_covariance = self._work.ball, self._work.pose_covariance
        self._ball_rotation, self._ego = self._work.ball_rotation, self._work.ego
        self._estimate: Floats = self._work.estimate
        precompile()

    def update(self, pose: Pose, ego: EgoState) -> bool:
        """Correct the estimate by a pose in the camera frame, seen from a state of the vehicle at the same time.

        Parameters
        ----------
        pose : Pose
        ego : EgoState

        Returns
        -------
        bool
            Whether its position was accepted.
        """
        # An error of camera or diameter is the same in every picture: it does not decide how two of them are weighed.
        self._ball[:], self._pose_covariance[:], self._ego[:] = pose.position, pose.random_covariance, ego.block
        if pose.rotation_matrix is not None:
            self._ball_rotation[:] = pose.rotation_matrix
        accepted = update(
            self._block, pose.time - self.time, pose.time - self.yaw_time, pose.rotation_matrix is not None
        )
        if accepted & POSITION_ACCEPTED:
            self.time = pose.time
        self.doubt = _doubt(accepted)
        if accepted & YAW_ACCEPTED:
            self.yaw_time = pose.time
        return bool(accepted & POSITION_ACCEPTED)

    def at(self, time: float, max_extrapolation: float) -> Forecast:
        """Predict for one time, see `at_times`."""
        return self.at_times((time,), max_extrapolation)[0]

    def at_times(self, times: Sequence[float], max_extrapolation: float) -> list[Forecast]:
        """Predict for several times.

        Parameters
        ----------
        times : sequence of float
            s.
        max_extrapolation : float
            How far past the last pose the drift is extrapolated, s; after that it stands still.
        """
        return named(self.numbers_at(np.array(times, dtype=np.float64), max_extrapolation))

    def numbers_at(self, times: Floats, max_extrapolation: float) -> Floats:
        """Predict for several times, for kernels: (n, 4, 4), the fields of `Forecast`; see `at_times`."""
        numbers = np.empty((len(times), AXES, VALUES))
        forecast_all(self._block, times, self.time, self.yaw_time, max_extrapolation, numbers)
        return numbers

    def yaw_sigma(self, time: float) -> float:
        """Tell how little is known of where its marker points at a time, s: the standard deviation, rad."""
        return math.sqrt(yaw_variance(self._block, max(time - self.yaw_time, 0.0)))

    @property
    def gains(self) -> Floats:
        """By what x, y and z were corrected last, per m of the innovation, (3, 5): the Kalman gains."""
        variance = np.maximum(self._work.innovation_variance[:YAW], np.finfo(np.float64).tiny)  # 0: not yet
        gains: Floats = self._work.cross[:YAW] / variance[:, np.newaxis]
        return gains

    @property
    def velocity(self) -> Floats:
        """Velocity of its drift in the frame at rest, (3,), m/s."""
        return self._estimate[:YAW, SPEED].copy()

    def add_velocity(self, velocity: Floats) -> None:
        """Add to the velocity of its drift, (3,), m/s: dead reckoning was found to be wrong by that."""
        self._estimate[:YAW, SPEED] += velocity


def named(numbers: Floats) -> list[Forecast]:
    """Name the numbers of forecasts, (n, 4, 4)."""
    return [
        Forecast(AxisForecast(*x), AxisForecast(*y), AxisForecast(*z), AxisForecast(*yaw))
        for x, y, z, yaw in numbers.tolist()
    ]


def _doubt(accepted: int) -> str:
    """Say why a position was not accepted; empty if it was."""
    if accepted & POSITION_ACCEPTED:
        return ""
    if accepted & OTHER_BALL:
        return "a ball is seen, but at the distance of another vehicle's"
    return "a ball is seen, but not where the neighbor should be"


def initial_block(parameters: NeighborFilterParameters) -> Block:
    """Return the block of a filter that has seen nothing."""
    block = new_block(WORK)
    work = fields(block, WORK)
    store(work.parameters, parameters)
    position, yaw = work.position_axes, work.yaw_axis
    position.end, yaw.first, yaw.end = YAW, YAW, AXES
    position.acceleration_sigma, yaw.acceleration_sigma = (
        parameters.acceleration_sigma,
        parameters.yaw_acceleration_sigma,
    )
    position.acceleration_time, yaw.acceleration_time = parameters.acceleration_time, parameters.yaw_acceleration_time
    position.oscillation_sigma, yaw.oscillation_sigma = parameters.oscillation_sigma, parameters.yaw_oscillation_sigma
    return block


@kernel(refcount=False)
def update(block: Block, since: float, yaw_since: float, marker_visible: bool) -> int:
    """Correct by the pose in the block, so many s after the last position and yaw; what of it was accepted."""
    work = block.view(WORK)[0]
    write_rotation(work.ego, work.rotation)
    position_to_world(work)
    accepted = 0
    visible = marker_visible and marker_yaw(work)
    if is_other_ball(work, since):
        accepted += OTHER_BALL
    elif correct_position(work, since):
        accepted += POSITION_ACCEPTED
    if visible and accepted & POSITION_ACCEPTED and correct_axes(work, work.yaw_axis, yaw_since):
        accepted += YAW_ACCEPTED
    return accepted


@kernel(refcount=False)
def forecast_all(
    block: Block, times: Floats, seen: float, yaw_seen: float, max_extrapolation: float, forecasts: Floats
) -> None:
    """Write the forecasts (n, 4, 4) for times; position and yaw were seen last at two others, s."""
    work = block.view(WORK)[0]
    for k in range(times.shape[0]):
        forecast(work, times[k] - seen, times[k] - yaw_seen, max_extrapolation)
        for axis in range(AXES):
            for value in range(VALUES):
                forecasts[k, axis, value] = work.forecast[axis, value]


@kernel(refcount=False)
def yaw_variance(block: Block, since: float) -> float:
    """Variance of the yaw so many s after it was seen last, rad^2."""
    work = block.view(WORK)[0]
    elapsed = min(since, work.parameters.max_prediction)
    write_drift_transition(work.yaw_axis.acceleration_time, elapsed, work.transition)
    write_oscillation_transition(work.parameters, elapsed, work.transition)
    predict(work, work.yaw_axis, YAW, elapsed)
    cross = work.cross[YAW]
    return float(cross[0] + cross[3])


@helper
def position_to_world(work: Any) -> None:
    """Write the ball's position in the frame at rest, and its variance with that of the vehicle's tilt and yaw."""
    parameters, turn, ball, away = work.parameters, work.rotation, work.ball, work.away
    position = work.ego.view(STATE)[0].position
    for j in range(3):
        away[j] = 0.0
        for k in range(3):
            away[j] += turn[j, k] * ball[k]
        work.measured[j] = position[j] + away[j]
    for j in range(3):
        total = parameters.systematic_sigma**2
        for k in range(3):
            for m in range(3):
                total += turn[j, k] * work.pose_covariance[k, m] * turn[j, m]
        work.variance[j] = total
    tilt, yaw = parameters.tilt_sigma**2, parameters.yaw_sigma**2
    work.variance[0] += yaw * away[2] ** 2 + tilt * away[1] ** 2
    work.variance[1] += tilt * (away[0] ** 2 + away[2] ** 2)
    work.variance[2] += yaw * away[0] ** 2 + tilt * away[1] ** 2


@helper
def marker_yaw(work: Any) -> bool:
    """Write the angle of the marker's direction to the right of z, and its variance; False if it is too steep."""
    parameters, turn, ball = work.parameters, work.rotation, work.ball_rotation
    x = turn[0, 0] * ball[0, 2] + turn[0, 1] * ball[1, 2] + turn[0, 2] * ball[2, 2]
    z = turn[2, 0] * ball[0, 2] + turn[2, 1] * ball[1, 2] + turn[2, 2] * ball[2, 2]
    if x * x + z * z < parameters.min_level_part**2:
        return False
    work.measured[YAW] = math.atan2(x, z)
    variance = parameters.yaw_sigma**2 + parameters.marker_sigma**2
    for k in range(3):  # rotation about the vertical
        for m in range(3):
            variance += turn[1, k] * work.pose_covariance[3 + k, 3 + m] * turn[1, m]
    work.variance[YAW] = variance
    return True


@helper
def distance_of_ball(work: Any) -> float:
    """Distance from the camera to the ball of the pose, m."""
    return math.sqrt(work.ball[0] ** 2 + work.ball[1] ** 2 + work.ball[2] ** 2)


@helper
def is_other_ball(work: Any, since: float) -> bool:
    """Whether the ball is so much nearer or farther than the neighbor's was that it must be another vehicle's."""
    if not since <= work.parameters.reset_time:
        return False
    return not abs(distance_of_ball(work) - work.distance) <= work.parameters.max_jump


@helper
def correct_position(work: Any, since: float) -> bool:
    """Predict and correct the position; of the poses that it rejects count those that agree with each other."""
    axes, square = work.position_axes, 0.0
    for k in range(3):
        square += (work.ball[k] - work.refused[k]) ** 2
    if axes.rejected > 0 and not square <= work.parameters.agreement**2:
        axes.rejected = 0
    accepted = correct_axes(work, axes, since)
    if accepted:
        work.distance = distance_of_ball(work)
    else:
        for k in range(3):
            work.refused[k] = work.ball[k]
    return bool(accepted)


@helper
def correct_axes(work: Any, axes: Any, since: float) -> bool:
    """Predict and correct the axes of a group; all are accepted, or none."""
    parameters = work.parameters
    if not since <= parameters.reset_time or axes.rejected >= parameters.max_rejected:
        for axis in range(axes.first, axes.end):
            initialize(work, axes, axis)
        axes.rejected = 0
        return True
    write_drift_transition(axes.acceleration_time, since, work.transition)
    write_oscillation_transition(parameters, since, work.transition)
    rejected = False
    for axis in range(axes.first, axes.end):
        innovation, variance = predict(work, axes, axis, since)
        rejected = rejected or not innovation * innovation <= parameters.gate**2 * variance
    if rejected:
        axes.rejected += 1
        return False
    for axis in range(axes.first, axes.end):
        correct(work, axis)
    axes.rejected = 0
    return True


@helper
def initialize(work: Any, axes: Any, axis: int) -> None:
    """Begin an axis anew with the measurement."""
    sigma, frequency = axes.oscillation_sigma, 2.0 * math.pi / work.parameters.oscillation_period
    work.estimate[axis, :] = 0.0
    work.covariance[axis, :, :] = 0.0
    work.estimate[axis, 0] = work.measured[axis]
    work.covariance[axis, 0, 0] = work.variance[axis]
    work.covariance[axis, 1, 1] = work.parameters.initial_speed_sigma**2
    work.covariance[axis, 2, 2] = axes.acceleration_sigma**2
    work.covariance[axis, 3, 3] = sigma**2
    work.covariance[axis, 4, 4] = (frequency * sigma) ** 2


@helper
def predict(work: Any, axes: Any, axis: int, since: float) -> tuple[float, float]:
    """Predict an axis; the innovation of its measurement, the sum of drift and oscillation, and its variance."""
    predicted, spread, cross = work.predicted[axis], work.predicted_covariance[axis], work.cross[axis]
    write_noise(work.parameters, axes, axis, since, spread)
    add_prediction(work.estimate[axis], work.covariance[axis], work.transition, predicted, spread)
    innovation = work.measured[axis] - predicted[0] - predicted[3]
    if axis == YAW:
        innovation -= 2.0 * math.pi * math.floor(innovation / (2.0 * math.pi) + 0.5)
    for j in range(ORDER):
        cross[j] = spread[j, 0] + spread[j, 3]
    work.innovation[axis], work.innovation_variance[axis] = innovation, cross[0] + cross[3] + work.variance[axis]
    return innovation, work.innovation_variance[axis]


@helper
def correct(work: Any, axis: int) -> None:
    """Correct the prediction of an axis, and make it the estimate."""
    state, covariance = work.estimate[axis], work.covariance[axis]
    for j in range(ORDER):
        state[j] = work.predicted[axis, j]
        for k in range(ORDER):
            covariance[j, k] = work.predicted_covariance[axis, j, k]
    correct_by_scalar(state, covariance, work.cross[axis], work.innovation[axis], work.innovation_variance[axis])


@helper
def forecast(work: Any, since: float, yaw_since: float, max_extrapolation: float) -> None:
    """Write the forecast of all axes, (4, 4), so many s after the last position and yaw."""
    for axis in range(YAW):
        forecast_axis(work, work.position_axes, axis, since, max_extrapolation)
    forecast_axis(work, work.yaw_axis, YAW, yaw_since, max_extrapolation)


def precompile() -> None:
    """Compile the kernels that Python calls, with the types that `NeighborFilter` hands over."""
    block = initial_block(NeighborFilterParameters())
    update(block, math.inf, math.inf, True)
    yaw_variance(block, 0.0)
    forecast_all(block, np.zeros(1), 0.0, 0.0, 0.0, np.zeros((1, AXES, VALUES)))
