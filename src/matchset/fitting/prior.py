"""What is known before a fit: the motion's prediction, the search range, and the field offset of interlaced pictures.

An interlaced picture shows a moving shape at two places: its even rows (one field) were taken half a frame before or
after its odd rows. The *field offset* is the distance between the two, px.
"""

import math

import msgspec

from matchset.numeric.jit import helper
from matchset.numeric.record import Record


class MotionParameters(msgspec.Struct, frozen=True):
    """Constant-velocity motion of the shape's state, and how far its predictions are trusted.

    Parameters
    ----------
    gain : float
        Share of the latest innovation that the velocity follows: 1 is quick and noisy, 0 never learns.
        Chosen by hand; `python -m benchmarks --only reacquisition` would show a change.
    innovation_memory : float
        Share of the innovation scale that a frame as predicted leaves.
        Chosen by hand; `python -m benchmarks --only reacquisition` would show a change.
    fade_time : float
        Time after which a velocity without a sighting has faded to 1/e, s.
        Chosen by hand; `python -m benchmarks --only reacquisition` would show a change.
    fade_start : float
        Time without a sighting from which the velocity fades, s: one frame at 25 Hz is predicted in full.
    prior_sigmas : float
        How far a parameter may be from its prediction, in innovation scales: less is steadier where edges are few, more
        follows sudden motion sooner. Chosen by hand; `tests/tracking/test_accuracy.py` would show a change.
    min_sigma : float
        No prediction is trusted to be better than this, px.
        Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    typical_gain, typical_min_score : float
        Share of its change that the typical half-width follows, and the MSAC score from which a fit may change it.
        Chosen by hand; `python -m benchmarks --only false_locks` would show a change.
    size_acceleration : float
        Standard deviation of the second derivative of ln(half-width), 1/s^2: acceleration along the line of sight as a
        share of the distance. Less holds on to a size, more follows sudden motion sooner. It and the next ones: chosen
        on flights of seeds 901 and 907; `python -m benchmarks --only real` would show a change.
    size_rate, size_fade_s : float
        Standard deviation of its rate of change at the first sighting, 1/s, and the time in which the rate fades to
        1/e where nothing is seen of it, s.
    size_sigma, size_clutter : float
        Standard deviation of ln(half-width) of a fit with whose outline everything agrees, and what is added to it
        where nothing does: things beside the target err alike for many frames.
    size_sigmas : float
        Standard deviations of an innovation of ln(half-width) from which a fit needs other proof.
    size_worth : float
        By how much the MSAC score may be less where the size is held: more follows edge points less.
    size_reach : float
        How far the place may move where the size is held, in changes of the half-width.
    size_kept_s : float
        After so long without a sighting the size is not remembered, s.
    focal_px, center_x_px, center_y_px : float
        Focal length and center of the camera, where they are known: away from there the same ball looks larger.
    """

    gain: float = 0.7
    innovation_memory: float = 0.8
    fade_time: float = 0.25
    fade_start: float = 0.05
    prior_sigmas: float = 0.5
    min_sigma: float = 0.3
    typical_gain: float = 0.1
    typical_min_score: float = 0.75
    size_acceleration: float = 20.0
    size_rate: float = 1.0
    size_fade_s: float = 0.6
    size_sigma: float = 0.01
    size_clutter: float = 1.0
    size_sigmas: float = 2.0
    size_worth: float = 0.2
    size_reach: float = 2.0
    size_kept_s: float = 1.0
    focal_px: float = math.inf
    center_x_px: float = 0.0
    center_y_px: float = 0.0


class WindowParameters(msgspec.Struct, frozen=True):
    """Search range on each side of the predicted outline while a shape is tracked.

    Parameters
    ----------
    min_range, max_range : float
        Shortest and longest search range, px: longer finds faster shapes, costs time and shows more foreign edges.
        Chosen by hand; `python -m benchmarks --only reacquisition` would show a change.
    innovations : float
        By how much the range grows, in innovations.
        Chosen by hand; `python -m benchmarks --only reacquisition` would show a change.
    """

    min_range: float = 3.0
    max_range: float = 24.0
    innovations: float = 2.0


class GateParameters(msgspec.Struct, frozen=True):
    """How far from its prediction a fitted shape needs no other proof.

    All numbers chosen by hand; `python -m benchmarks --only false_locks` would show a change.

    Parameters
    ----------
    size_share, size_px : float
        Largest change of the half-width: a share of the predicted one plus px.
    center_share : float
        Largest distance of the center from its prediction, in half-widths, ...
    center_innovations : float
        ... plus this, in innovations.
    """

    size_share: float = 0.1
    size_px: float = 1.0
    center_share: float = 0.3
    center_innovations: float = 2.0


class FieldParameters(msgspec.Struct, frozen=True):
    """What is expected of the field offset, see docs/decisions/072-fields-expected-apart.md.

    Parameters
    ----------
    min_speed : float
        Speed from which the field offset is fitted, px per frame.
    min_score : float
        MSAC score from which a fit tells how far the fields are apart. Less learns a noisy link's fields sooner, more
        takes fewer hands and blurred rims for a second field. Chosen on a real clip and on rendered ones
        (docs/log/network.md#disc-as-prior).
    memory : float
        Share of what is known about the fields that one frame leaves.
    still_speed : float
        px/s: below such speeds in the frames remembered, little is known about the fields.
    frame_share : float
        Time between the fields, as a share of the time between two frames: an interlaced picture's is a half.
    tolerance : float
        How near to that share the learned one must be to be taken for it.
    unknown_sigma, known_sigma : float
        Standard deviation of the field offset while it is not known and once it is, as a share of the way per frame.
    min_sigma : float
        What is added to that, px.
    comb_sigmas, comb_min_sigma : float
        From an offset of so many standard deviations of an edge point, but at least so many px each, a line along a
        column reads one field only, see docs/decisions/075-each-line-in-one-field.md.
    """

    min_speed: float = 0.5
    min_score: float = 0.5
    memory: float = 0.9
    still_speed: float = 120.0
    frame_share: float = 0.5
    tolerance: float = 0.15
    unknown_sigma: float = 0.5
    known_sigma: float = 0.08
    min_sigma: float = 0.1
    comb_sigmas: float = 2.0
    comb_min_sigma: float = 0.7


@helper
def time_between_fields(work: Record) -> tuple[float, float]:
    """Time between the even rows and the odd ones, s, and how well it is known, 0 ... 1; zeros if not half a frame."""
    limits, motion, way = work.field_limits, work.motion, work.window.speed
    speed = math.hypot(motion.velocity[0], motion.velocity[1])
    if not (speed > 0.0 and way > 0.0 and work.window.velocity_unknown == 0):
        return 0.0, 0.0
    frame, noted = way / speed, motion.speed_moment + limits.still_speed * limits.still_speed
    between = motion.offset_moment / noted
    if abs(abs(between) - limits.frame_share * frame) < limits.tolerance * frame:
        return math.copysign(limits.frame_share * frame, between), motion.speed_moment / noted
    return 0.0, 0.0


@helper
def predict_field_offset(work: Record) -> None:
    """Expect the field offset that the speed, and the time that lately lay between the fields, give.

    An interlaced picture's fields are half a frame apart, unless frames were left out; those of any other picture are
    one. While it is not known which, none is expected, with a standard deviation of half the way per frame.
    """
    limits, velocity, offset = work.field_limits, work.motion.velocity, work.field_offset
    between, known = time_between_fields(work)
    offset.fitted[0] = offset.expected[0] = between * velocity[0]
    offset.fitted[1] = offset.expected[1] = between * velocity[1]
    share = limits.unknown_sigma + known * (limits.known_sigma - limits.unknown_sigma)
    offset.sigma = limits.min_sigma + share * work.window.speed


@helper
def correct_field_offset(work: Record) -> None:
    """Expect the field offset that the way in this frame gives, as far as it was fitted, in place of the predicted one.

    Where the speed changes within a frame, as in pictures whose camera pitches, the fields lie farther apart than
    predicted, and one of them would be taken for both.
    """
    motion, offset = work.motion, work.field_offset
    between, _ = time_between_fields(work)
    way = math.hypot(motion.predicted[0] - motion.last_state[0], motion.predicted[1] - motion.last_state[1])
    if between == 0.0 or way == 0.0 or work.window.use_prior == 0:
        return
    rate = motion.speed / way  # 1 / s: of the time since the last sighting
    for k in range(2):
        velocity = motion.velocity[k] + rate * (work.state[k] - motion.predicted[k])
        offset.fitted[k] = offset.expected[k] = between * velocity
