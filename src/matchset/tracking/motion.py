"""Motion of the tracked shape: constant velocity, the innovations it lately had, and the gate around its prediction.

The parameters stand in `fitting.prior`, since the fit uses the prediction as its prior.
"""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.validation import Rejection, is_weak
from matchset.numeric.jit import helper, interpreted, kernel
from matchset.numeric.record import Block, Record

Floats = npt.NDArray[np.float64]


class ReachParameters(msgspec.Struct, frozen=True):
    """Where a shape that was lost may turn up again.

    All numbers chosen by hand; `python -m benchmarks --only reacquisition` would show a change.

    Parameters
    ----------
    jump, jump_px : float
        How far from its prediction a shape may be found again while coasting, in half-widths per missed frame plus px.
    growth : float
        Largest change of size per missed frame, as a factor.
    near : float
        Distance from the prediction within which a shape found again is the lost one, in half-widths, if its ...
    near_shrink, near_growth : float
        ... size changed by a factor between these.
    remembered_s, remembered, remembered_growth : float
        For how long after it was seen last, within how many half-widths of that place, and by which factor of size
        changed at most, a shape is taken for the one that was lost: it was in the picture there.
    alone, alone_growth : float
        Distance from the prediction, in half-widths, and factor of size, from which on nothing speaks for a detection
        but itself. The factor was 1.8 to 7 in five rendered false locks after a ball had left, where more was allowed;
        more finds again what was followed at a wrong size, and things that are not the target.
    """

    jump: float = 2.0
    jump_px: float = 10.0
    growth: float = 1.5
    near: float = 0.5
    near_shrink: float = 0.8
    near_growth: float = 1.25
    remembered_s: float = 3.0
    remembered: float = 1.5
    remembered_growth: float = 1.4
    alone: float = 3.0
    alone_growth: float = 1.7


class Gate(NamedTuple):
    """Center and half-width of a prediction, px, and what is near to it."""

    x: float
    y: float
    half_width: float

    def distance(self, other: "Gate") -> float:
        """Distance of the centers, px."""
        return math.hypot(other.x - self.x, other.y - self.y)

    def alone(self, other: "Gate", limits: ReachParameters) -> bool:
        """Whether nothing of this prediction speaks for a shape at `other`: too far, or of too different a size."""
        larger, smaller = max(self.half_width, other.half_width), min(self.half_width, other.half_width)
        return self.distance(other) > limits.alone * larger or larger > limits.alone_growth * smaller

    def near(self, other: "Gate", limits: ReachParameters) -> bool:
        """Whether a shape found again at `other` is about where this prediction has it."""
        size = self.half_width
        like = limits.near_shrink * size < other.half_width < limits.near_growth * size
        return like and self.distance(other) < limits.near * size

    def reachable(self, other: "Gate", missed: float, limits: ReachParameters) -> bool:
        """Whether a shape can have come from here to `other` in `missed` frames."""
        larger, smaller = max(self.half_width, other.half_width), min(self.half_width, other.half_width)
        near = self.distance(other) <= limits.jump * larger * missed + limits.jump_px
        return larger <= smaller * limits.growth**missed and near


def gate_of(family: type[Any], state: Floats) -> Gate:
    """Center and size of a state of a family of shapes."""
    return Gate(float(state[0]), float(state[1]), float(family.half_width(state)))


@helper
def in_gate(work: Record, half_width: float, predicted_half_width: float) -> bool:
    """Whether the fitted state is so near to its prediction that it needs no other proof."""
    gate, state, predicted = work.gate, work.state, work.motion.predicted
    far = math.hypot(state[0] - predicted[0], state[1] - predicted[1])
    change = abs(half_width - predicted_half_width)
    size_near = change <= gate.size_share * predicted_half_width + gate.size_px
    reach = gate.center_share * predicted_half_width + gate.center_innovations * work.motion.innovation
    return bool(size_near and far <= reach)


@helper
def predict_size(work: Record, time: float) -> tuple[float, float, float, float, float]:
    """Predict the size remembered to a time, s: ln(half-width), its rate, their variances and covariance.

    The rate fades. Between two sightings the acceleration along the line of sight is unknown.
    """
    motion, limits = work.motion, work.motion_limits
    passed = max(time - motion.size_time, 0.0)
    kept, push = math.exp(-passed / limits.size_fade_s), limits.size_acceleration * passed
    variance = motion.size_variance + passed * (2.0 * motion.size_covariance + passed * motion.trend_variance)
    variance += 0.25 * push * push * passed * passed
    covariance = kept * (motion.size_covariance + passed * motion.trend_variance) + 0.5 * push * push * passed
    of_rate = kept * kept * motion.trend_variance + push * push
    return motion.size_log + passed * motion.size_trend, kept * motion.size_trend, variance, covariance, of_rate


@helper
def extrapolate(work: Record, time: float, missed: float) -> None:
    """Predict the state at a time, `missed` frames after the last sighting; the velocity fades while nothing is seen.

    Writes `predicted`, `prior_sigma`, the speed and the innovation.
    """
    motion, limits = work.motion, work.motion_limits
    ahead = time - motion.time
    if ahead > limits.fade_start:
        ahead = limits.fade_time * (1.0 - math.exp(-ahead / limits.fade_time))
    for k in range(work.state_count):
        motion.predicted[k] = motion.last_state[k] + ahead * motion.velocity[k]
    for k in range(work.parameter_count):
        scale, least = motion.innovation_scale[k], limits.min_sigma
        sigma = least if k >= motion.slow_from else limits.prior_sigmas * scale + least
        motion.prior_sigma[k] = missed * sigma
    motion.speed, motion.innovation = math.hypot(motion.velocity[0], motion.velocity[1]), motion.innovation_scale[0]


@helper
def open_window(work: Record, missed: float, interval: float) -> None:
    """Open the search window around the prediction: it grows with the innovations; the fit begins there."""
    window, limits, motion = work.window, work.window_limits, work.motion
    innovation = motion.innovation * missed
    window.range_px = min(limits.min_range + limits.innovations * innovation, limits.max_range)
    window.speed, window.initial_sigma = interval * motion.speed, max(innovation, work.fit_limits.start_noise)
    window.min_score, window.velocity_unknown, window.use_prior = 0.0, 0, 1
    for k in range(work.state_count):
        work.state[k] = motion.predicted[k]


@helper
def correct_motion(work: Record, time: float) -> None:
    """Correct state, velocity and innovation scale with the state that was fitted at a time, s.

    The field offset that was fitted is noted for the speed that the shape has in this frame, where most edge points
    agree: those of a hand, or of a blurred rim, look like a second field. The velocity of a
    parameter that the edge points told nothing of stops: its variance is that of the prior.
    """
    motion, limits, fields, fitted = work.motion, work.motion_limits, work.field_limits, work.state
    velocity, scale, offset, memory = motion.velocity, motion.innovation_scale, work.field_offset.fitted, fields.memory
    x, y, passed, kept = velocity[0], velocity[1], time - motion.time, limits.innovation_memory
    if work.window.speed > fields.min_speed and work.fit.msac_score > fields.min_score and passed > 0.0:
        moved = ((fitted[0] - motion.last_state[0]) * x + (fitted[1] - motion.last_state[1]) * y) / passed
        if moved > 0.0:
            motion.offset_moment = memory * motion.offset_moment + offset[0] * x + offset[1] * y
            motion.speed_moment = memory * motion.speed_moment + moved
    for k in range(work.state_count):
        if passed > 0.0:
            missed = fitted[k] - motion.last_state[k] - velocity[k] * passed
            if k < work.parameter_count:
                prior, known = motion.prior_sigma[k] * motion.prior_sigma[k], 1.0
                if prior > 0.0 and k > 1:
                    known = min(max(2.0 * (1.0 - work.covariance[k, k] / prior), 0.0), 1.0)
                velocity[k] = (velocity[k] + limits.gain / passed * missed) * known
                scale[k] = max(abs(missed), kept * scale[k] + (1.0 - kept) * abs(missed))
        motion.last_state[k] = fitted[k]
    scale[0] = scale[1] = max(scale[0], scale[1])
    motion.time = time


@helper
def log_foreshortening(work: Record, x: float, y: float) -> float:
    """By how much ln(half-width) is larger at a place in the picture than in its middle, of the same ball as far off.

    Off the axis a pinhole camera shows a ball longer by 1 / cos^2 of the angle, and wider by 1 / cos.
    """
    limits = work.motion_limits
    away = math.hypot(x - limits.center_x_px, y - limits.center_y_px) / limits.focal_px
    return float(0.75 * math.log1p(away * away))


@helper
def size_error(work: Record) -> float:
    """Variance of ln(half-width) of the last fit: much where little of the outline agrees."""
    limits = work.motion_limits
    doubt = limits.size_clutter * (1.0 - min(max(work.fit.msac_score, 0.0), 1.0)) ** 3
    return float(limits.size_sigma * limits.size_sigma + doubt * doubt)


@helper
def expect_size(work: Record, time: float) -> None:
    """Expect the size remembered in a frame at a time, s, as well as it is known."""
    motion = work.motion
    if motion.sized == 1.0 and motion.size_variance > 0.0 and time - motion.size_time < work.motion_limits.size_kept_s:
        size, _, variance, _, _ = predict_size(work, time)
        radius = math.exp(size + log_foreshortening(work, motion.predicted[0], motion.predicted[1]))
        motion.predicted[2], motion.prior_sigma[2] = radius, radius * math.sqrt(variance)


@helper
def of_usual_size(work: Record, time: float) -> bool:
    """Whether the last fit is as large as a ball can be that was as large as remembered, at a time, s."""
    motion, limits = work.motion, work.motion_limits
    if motion.size_variance == 0.0 or not time - motion.size_time < limits.size_kept_s:
        return True
    size, _, variance, _, _ = predict_size(work, time)
    size += log_foreshortening(work, work.state[0], work.state[1])
    innovation, sigma = math.log(max(work.fit.half_width, 1.0)) - size, limits.size_sigma
    return bool(innovation * innovation < limits.size_sigmas * limits.size_sigmas * (variance + sigma * sigma))


@helper
def remember_size(work: Record, time: float) -> None:
    """Correct the size remembered with a fit that was accepted at a time, s: a Kalman filter.

    The size of a rigid ball is smooth, while a hand or another thing of its color takes in a wrong outline for a few
    frames.
    """
    motion, limits = work.motion, work.motion_limits
    size, error = math.log(max(work.fit.half_width, 1.0)), size_error(work)
    size -= log_foreshortening(work, work.state[0], work.state[1])
    if motion.size_variance == 0.0 or not time - motion.size_time < limits.size_kept_s:
        motion.size_log, motion.size_trend, motion.size_covariance = size, 0.0, 0.0
        motion.size_variance, motion.trend_variance = error, limits.size_rate * limits.size_rate
    elif time > motion.size_time:
        expected, rate, variance, covariance, of_rate = predict_size(work, time)
        gain, innovation = 1.0 / (variance + error), size - expected
        motion.size_log = expected + variance * gain * innovation
        motion.size_trend = rate + covariance * gain * innovation
        motion.size_variance = variance * error * gain
        motion.size_covariance = covariance * error * gain
        motion.trend_variance = of_rate - covariance * covariance * gain
    motion.size_time = time


def usual_size(work: Record, time: float, place: Sequence[float] | Floats) -> tuple[float, float] | None:
    """Size that is remembered, at a place (x, y, ...) in a frame at a time, s; None where none is.

    Returns ln(half-width / px) and its standard deviation.
    """
    motion = work.motion
    if motion.size_variance == 0.0 or not time - float(motion.size_time) < float(work.motion_limits.size_kept_s):
        return None
    size, _, variance, _, _ = interpreted(predict_size)(work, time)
    longer = interpreted(log_foreshortening)(work, float(place[0]), float(place[1]))
    return float(size) + longer, math.sqrt(variance)


@helper
def correct_size(work: Record, time: float) -> None:
    """Correct the size remembered, and the typical half-width with a well-confirmed fit, at a time, s."""
    motion, limits = work.motion, work.motion_limits
    remember_size(work, time)
    if work.fit.msac_score > limits.typical_min_score:
        typical = motion.typical_half_width
        new = typical + limits.typical_gain * (work.fit.half_width - typical)
        motion.typical_half_width = new if typical > 0.0 else work.fit.half_width


@helper
def predict(work: Record, time: float, interval: float) -> None:
    """Predict the state at a time, s, an interval after the last frame, and open the search window around it."""
    if work.motion.time == -math.inf:
        work.motion.time = time - interval
    missed = max((time - work.motion.time) / interval, 1.0)
    extrapolate(work, time, missed)
    expect_size(work, time)
    open_window(work, missed, interval)


@helper
def correct(work: Record, time: float) -> int:
    """Correct the motion with a fit that began at the prediction and was validated.

    Returns `Rejection.NONE`; or `Rejection.AMBIGUOUS`, and nothing is corrected, if it is weak or outside the gate.
    """
    near = in_gate(work, work.fit.half_width, work.start_half_width)
    if not near or not of_usual_size(work, time) or is_weak(work.fit, work.validation):
        return Rejection.AMBIGUOUS.value
    correct_motion(work, time)
    correct_size(work, time)
    return Rejection.NONE.value


@functools.cache
def make_accept(layout: "np.dtype[np.void]") -> Callable[[Block, float], None]:
    """Compile ``accept(block, time)``: correct the motion with a fit that was accepted in another way."""

    @kernel(refcount=False)
    def accept(block: Block, time: float) -> None:
        work = block.view(layout)[0]
        correct_motion(work, time)
        correct_size(work, time)

    return accept


def predict_state(work: Record, time: float) -> Floats:
    """State expected at a time, s, by plain Python; the prior is that of one missed frame."""
    interpreted(extrapolate)(work, time, 1.0)
    predicted: Floats = work.motion.predicted[: work.state_count].copy()
    return predicted


def initialize(work: Record, state: Floats, time: float, sigma: float) -> None:
    """Begin at a state, at rest.

    Parameters
    ----------
    work : record
    state : ndarray of shape (s,), float64
        State at the first sighting.
    time : float
        When that was, s; -inf for one frame before the next.
    sigma : float
        How far from it the next sighting may be, px.
    """
    motion, s = work.motion, len(state)
    motion.last_state[:s] = motion.predicted[:s] = state
    motion.velocity[:], motion.innovation_scale[:], motion.prior_sigma[:] = 0.0, sigma, 0.0
    motion.time, motion.speed, motion.innovation = time, 0.0, sigma


def forget_motion(work: Record, same_camera: bool) -> None:
    """Forget how large a shape was, and how far the fields of an interlaced picture lie apart in time.

    Parameters
    ----------
    work : record
    same_camera : bool
        Whether what is known of the fields remains.
    """
    motion = work.motion
    motion.typical_half_width = motion.size_variance = 0.0
    if not same_camera:
        motion.offset_moment = motion.speed_moment = 0.0
