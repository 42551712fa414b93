"""Gate, reach, prediction and correction of the motion, from their rules; plain Python, nothing compiles."""

import math
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest

from matchset.fitting.prior import FieldParameters, GateParameters, MotionParameters, WindowParameters
from matchset.numeric.jit import interpreted
from matchset.tracking import motion
from matchset.tracking.motion import Gate, ReachParameters
from matchset.tracking.parameters import IN_FLIGHT

REACH, LIMITS, WINDOW, FIELDS = ReachParameters(), MotionParameters(), WindowParameters(), FieldParameters()
GATE = GateParameters()
SLOW_FROM, PARAMETERS, STATES = 3, 3, 5  # three parameters and two modes, as a circle has
SIZE = "predict_size", "log_foreshortening", "size_error", "of_usual_size", "remember_size"


@pytest.fixture(autouse=True)
def _plain(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("extrapolate", "open_window", "expect_size", *SIZE):
        monkeypatch.setattr(motion, name, interpreted(getattr(motion, name)))


def work(**changes: Any) -> Any:
    """A record of the motion at rest at (100, 80, 20), seen at 1 s."""
    state = np.array([100.0, 80.0, 20.0, 0.0, 0.0])
    moving = SimpleNamespace(
        last_state=state.copy(),
        predicted=state.copy(),
        velocity=np.zeros(STATES),
        innovation_scale=np.full(PARAMETERS, 1.0),
        prior_sigma=np.zeros(PARAMETERS),
        time=1.0,
        speed=0.0,
        innovation=1.0,
        slow_from=SLOW_FROM,
        typical_half_width=0.0,
        offset_moment=0.0,
        speed_moment=0.0,
        size_log=0.0,
        size_trend=0.0,
        sized=1.0,
        size_variance=0.0,
        size_covariance=0.0,
        trend_variance=0.0,
        size_time=0.0,
    )
    for name, value in changes.items():
        setattr(moving, name, value)
    return SimpleNamespace(
        motion=moving,
        state=state.copy(),
        gate=GATE,
        motion_limits=LIMITS,
        window_limits=WINDOW,
        field_limits=FIELDS,
        fit_limits=SimpleNamespace(start_noise=0.7),
        window=SimpleNamespace(
            range_px=0.0, speed=0.0, initial_sigma=0.0, min_score=1.0, velocity_unknown=1, use_prior=0
        ),
        field_offset=SimpleNamespace(fitted=np.zeros(2)),
        fit=SimpleNamespace(msac_score=0.9, half_width=20.0),
        covariance=np.zeros((PARAMETERS, PARAMETERS)),
        state_count=STATES,
        parameter_count=PARAMETERS,
    )


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8)])
def test_the_gate_is_as_wide_as_it_says_in_every_direction(direction: tuple[float, float]) -> None:
    reach = GATE.center_share * 20.0 + GATE.center_innovations * 1.0
    for share, inside in ((0.999, True), (1.001, False)):
        record = work()
        record.state[:2] += share * reach * np.array(direction)
        assert interpreted(motion.in_gate)(record, 20.0, 20.0) is inside


def test_the_gate_grows_with_the_innovation_and_with_the_shape() -> None:
    record = work(innovation=4.0)
    record.state[0] += GATE.center_share * 20.0 + 3.9 * GATE.center_innovations
    assert interpreted(motion.in_gate)(record, 20.0, 20.0)
    record = work()
    record.state[0] += GATE.center_share * 30.0
    assert interpreted(motion.in_gate)(record, 30.0, 30.0)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_change_of_size_is_held_against_the_gate(sign: float) -> None:
    most = GATE.size_share * 20.0 + GATE.size_px
    assert interpreted(motion.in_gate)(work(), 20.0 + 0.999 * sign * most, 20.0)
    assert not interpreted(motion.in_gate)(work(), 20.0 + 1.001 * sign * most, 20.0)


def test_what_can_be_reached_grows_with_the_frames_missed() -> None:
    here = Gate(0.0, 0.0, 10.0)
    for missed in (1.0, 3.0):
        far = REACH.jump * 20.0 * missed + REACH.jump_px
        larger = 10.0 * REACH.growth**missed
        limits = ((far - 0.01, 0.0, 20.0, missed > 1.0), (0.0, far + 0.01, 20.0, False))
        for x, y, half_width, expected in limits:
            assert here.reachable(Gate(x, y, half_width), missed, REACH) is expected
        for half_width, expected in ((0.999 * larger, True), (1.001 * larger, False)):
            assert here.reachable(Gate(0.0, 0.0, half_width), missed, REACH) is expected
            assert Gate(0.0, 0.0, half_width).reachable(here, missed, REACH) is expected


def test_alone_is_what_is_far_or_of_another_size() -> None:
    here, far, larger = Gate(0.0, 0.0, 10.0), REACH.alone * 15.0, REACH.alone_growth * 10.0
    for there, expected in (
        (Gate(0.0, far - 0.01, 15.0), False),
        (Gate(0.0, far + 0.01, 15.0), True),
        (Gate(0.0, 0.0, larger - 0.01), False),
        (Gate(0.0, 0.0, larger + 0.01), True),
    ):
        assert here.alone(there, REACH) is expected
        assert there.alone(here, REACH) is expected


def test_near_is_near_in_place_and_in_size() -> None:
    here, near = Gate(0.0, 0.0, 10.0), REACH.near * 10.0
    assert here.near(Gate(0.0, 0.99 * near, 10.0), REACH)
    assert not here.near(Gate(0.0, 1.01 * near, 10.0), REACH)
    for half_width, expected in (
        (REACH.near_shrink * 10.0 + 0.01, True),
        (REACH.near_shrink * 10.0 - 0.01, False),
        (REACH.near_growth * 10.0 - 0.01, True),
        (REACH.near_growth * 10.0 + 0.01, False),
    ):
        assert here.near(Gate(0.0, 0.0, half_width), REACH) is expected


def test_the_prediction_goes_on_at_constant_velocity_and_fades_when_nothing_is_seen() -> None:
    velocity = np.array([30.0, -40.0, 6.0, 0.0, 0.0])
    for ahead in (0.04, LIMITS.fade_start, 0.06, 0.2, 1.0, 9.0):
        record = work(velocity=velocity, innovation_scale=np.array([2.0, 2.0, 0.5]))
        interpreted(motion.extrapolate)(record, 1.0 + ahead, 1.0)
        shown = ahead
        if 1.0 + ahead - 1.0 > LIMITS.fade_start:
            shown = LIMITS.fade_time * (1.0 - math.exp(-ahead / LIMITS.fade_time))
        np.testing.assert_allclose(record.motion.predicted, record.motion.last_state + shown * velocity)
        assert (record.motion.speed, record.motion.innovation) == (50.0, 2.0)


def test_the_prior_widens_with_innovation_and_frames_missed() -> None:
    for missed in (1.0, 3.0):
        record = work(innovation_scale=np.array([2.0, 2.0, 0.5]), slow_from=2)
        interpreted(motion.extrapolate)(record, 1.04, missed)
        wide = missed * (LIMITS.prior_sigmas * 2.0 + LIMITS.min_sigma)
        np.testing.assert_allclose(record.motion.prior_sigma, [wide, wide, missed * LIMITS.min_sigma])


def test_the_window_opens_with_the_innovations_up_to_a_limit() -> None:
    for innovation, missed in ((0.0, 1.0), (1.0, 1.0), (1.0, 3.0), (100.0, 1.0)):
        record = work(innovation=innovation, speed=50.0)
        record.motion.predicted[:] += 7.0
        interpreted(motion.open_window)(record, missed, 0.04)
        window, spread = record.window, innovation * missed
        assert window.range_px == min(WINDOW.min_range + WINDOW.innovations * spread, WINDOW.max_range)
        assert window.initial_sigma == max(spread, 0.7)
        assert (window.speed, window.min_score, window.velocity_unknown, window.use_prior) == (2.0, 0.0, 0, 1)
        np.testing.assert_array_equal(record.state, record.motion.predicted)


def test_predict_counts_the_frames_that_were_missed() -> None:
    for ahead, missed in ((0.02, 1.0), (0.04, 1.0), (0.12, 3.0)):
        record = work()
        interpreted(motion.predict)(record, 1.0 + ahead, 0.04)
        assert record.window.range_px == pytest.approx(WINDOW.min_range + WINDOW.innovations * missed)
    record = work(time=-math.inf, velocity=np.array([25.0, 0.0, 0.0, 0.0, 0.0]))
    interpreted(motion.predict)(record, 5.0, 0.04)
    assert record.motion.time == pytest.approx(4.96)
    assert record.motion.predicted[0] == pytest.approx(101.0)


def test_the_correction_follows_the_fit() -> None:
    record = work(velocity=np.array([10.0, 0.0, 0.0, 0.0, 0.0]), innovation_scale=np.array([1.0, 5.0, 0.2]))
    record.state[:3] = 102.0, 79.0, 20.1
    interpreted(motion.correct_motion)(record, 1.1)
    moved = record.motion
    missed = np.array([1.0, -1.0, 0.1])  # beside the constant velocity
    np.testing.assert_allclose(moved.velocity[:3], np.array([10.0, 0.0, 0.0]) + LIMITS.gain / 0.1 * missed)
    np.testing.assert_array_equal(moved.last_state, record.state)
    kept = LIMITS.innovation_memory
    center = kept * 5.0 + (1.0 - kept) * 1.0
    np.testing.assert_allclose(moved.innovation_scale, [center, center, max(0.1, kept * 0.2 + (1.0 - kept) * 0.1)])
    assert moved.time == 1.1


def test_a_large_innovation_counts_at_once() -> None:
    record = work()
    record.state[0] += 9.0
    interpreted(motion.correct_motion)(record, 1.1)
    assert record.motion.innovation_scale[0] == pytest.approx(9.0)


def test_the_velocity_of_what_the_edge_points_told_nothing_of_stops() -> None:
    for share, known in ((1.0, 0.0), (0.75, 0.5), (0.5, 1.0), (0.0, 1.0)):
        record = work(velocity=np.array([0.0, 0.0, 8.0, 0.0, 0.0]), prior_sigma=np.array([2.0, 2.0, 2.0]))
        record.covariance[:] = share * 4.0 * np.eye(PARAMETERS)
        record.state[2] += 0.8
        record.state[0] += 1.0
        interpreted(motion.correct_motion)(record, 1.1)
        assert record.motion.velocity[2] == pytest.approx(known * 8.0)
        assert record.motion.velocity[0] == pytest.approx(LIMITS.gain * 10.0)  # never that of the center


def test_two_fits_at_one_time_change_no_velocity() -> None:
    record = work(velocity=np.array([3.0, 0.0, 0.0, 0.0, 0.0]))
    record.state[0] += 5.0
    interpreted(motion.correct_motion)(record, 1.0)
    assert record.motion.velocity[0] == 3.0
    assert record.motion.last_state[0] == 105.0


def test_the_field_offset_of_a_fast_shape_that_is_seen_well_is_noted_for_its_speed() -> None:
    well, faintly, fast = FIELDS.min_score + 0.1, FIELDS.min_score - 0.1, 2.0 * FIELDS.min_speed
    for speed, score, noted in ((fast, well, True), (0.5 * FIELDS.min_speed, well, False), (fast, faintly, False)):
        record = work(velocity=np.array([30.0, 40.0, 0.0, 0.0, 0.0]), offset_moment=10.0, speed_moment=100.0)
        record.window.speed, record.fit.msac_score = speed, score
        record.field_offset.fitted[:] = 0.5, 0.25
        record.state[:2] = record.motion.last_state[:2] + 0.1 * np.array((60.0, 20.0))  # px, in 0.1 s
        interpreted(motion.correct_motion)(record, record.motion.time + 0.1)
        along = 60.0 * 30.0 + 20.0 * 40.0  # its way in this frame, along the speed that was expected
        expected = (FIELDS.memory * 10.0 + 25.0, FIELDS.memory * 100.0 + along) if noted else (10.0, 100.0)
        assert (record.motion.offset_moment, record.motion.speed_moment) == pytest.approx(expected)


def test_of_a_shape_that_turns_back_no_field_offset_is_noted() -> None:
    record = work(velocity=np.array([30.0, 40.0, 0.0, 0.0, 0.0]), offset_moment=10.0, speed_moment=100.0)
    record.window.speed, record.fit.msac_score = 2.0 * FIELDS.min_speed, FIELDS.min_score + 0.1
    record.field_offset.fitted[:] = 0.5, 0.25
    record.state[:2] = record.motion.last_state[:2] - 3.0
    interpreted(motion.correct_motion)(record, record.motion.time + 0.1)
    assert (record.motion.offset_moment, record.motion.speed_moment) == (10.0, 100.0)


@pytest.mark.parametrize("same_camera", [False, True])
def test_what_is_known_of_the_fields_remains_with_the_camera(same_camera: bool) -> None:
    record = work(offset_moment=10.0, speed_moment=100.0)
    record.motion.typical_half_width, record.motion.size_variance = 20.0, 5.0
    motion.forget_motion(record, same_camera)
    kept = (10.0, 100.0) if same_camera else (0.0, 0.0)
    assert (record.motion.offset_moment, record.motion.speed_moment) == kept
    assert (record.motion.typical_half_width, record.motion.size_variance) == (0.0, 0.0)


def test_the_typical_size_follows_well_confirmed_fits_only() -> None:
    for typical, score, expected in (
        (0.0, 0.9, 20.0),
        (10.0, 0.9, 10.0 + LIMITS.typical_gain * 10.0),
        (10.0, 0.7, 10.0),
    ):
        record = work(typical_half_width=typical)
        record.fit.msac_score = score
        interpreted(motion.correct_size)(record, 1.0)
        assert record.motion.typical_half_width == pytest.approx(expected)


def sizes_seen(record: Any, sizes: list[float], score: float = 0.8, begin: float = 1.0) -> list[float]:
    """Sizes that are remembered after each of some sightings, a thirtieth of a second apart, px."""
    remembered = []
    for k, size in enumerate(sizes):
        record.fit.half_width, record.fit.msac_score = size, score
        interpreted(motion.remember_size)(record, begin + k / 30.0)
        remembered.append(math.exp(record.motion.size_log))
    return remembered


def test_a_wrong_size_of_which_little_agrees_is_hardly_remembered() -> None:
    record = work()
    record.motion_limits = IN_FLIGHT.motion
    sizes_seen(record, [20.0] * 15, 0.9)
    assert sizes_seen(record, [26.0] * 5, 0.4, begin=1.5)[-1] < 20.8


def test_a_ball_that_grows_by_fifteen_percent_a_picture_is_followed() -> None:
    for growth, within in ((1.01, 0.005), (1.15, 0.02)):
        sizes = [20.0 * growth**k for k in range(15)]
        assert sizes_seen(work(), sizes, 0.9)[-1] == pytest.approx(sizes[-1], rel=within)


def test_what_is_not_known_of_the_size_grows_with_the_time_not_seen() -> None:
    record = work()
    assert motion.usual_size(record, 1.0, (0.0, 0.0)) is None
    sizes_seen(record, [20.0] * 20, 0.9)
    last, sigmas = 1.0 + 19.0 / 30.0, []
    for passed in (1.0 / 30.0, 0.1, 0.3):
        found = motion.usual_size(record, last + passed, (0.0, 0.0))
        assert found is not None
        assert found[0] == pytest.approx(math.log(20.0), abs=1e-6)
        sigmas.append(found[1])
    assert sigmas[0] < 0.03 < sigmas[1] < sigmas[2]
    assert motion.usual_size(record, last + LIMITS.size_kept_s, (0.0, 0.0)) is None
    assert sizes_seen(record, [30.0], begin=last + LIMITS.size_kept_s)[-1] == pytest.approx(30.0)


def test_an_outline_a_third_larger_than_the_one_before_needs_other_proof() -> None:
    for size, is_usual in ((20.0, True), (20.5, True), (27.0, False), (14.0, False)):
        record = work()
        sizes_seen(record, [20.0] * 20, 0.9)
        record.fit.half_width = size
        assert interpreted(motion.of_usual_size)(record, 1.0 + 20.0 / 30.0) is is_usual


def test_off_the_axis_the_same_ball_looks_larger() -> None:
    record = work()
    record.motion_limits = msgspec.structs.replace(LIMITS, focal_px=300.0, center_x_px=100.0, center_y_px=80.0)
    sizes_seen(record, [20.0] * 20, 0.9)
    found = motion.usual_size(record, 1.0 + 20.0 / 30.0, (400.0, 80.0))
    assert found is not None
    assert math.exp(found[0]) == pytest.approx(20.0 * 2.0**0.75, rel=1e-6)  # cos 45 degrees to the power of -1.5
