"""A delay that nobody told shows in when the ball moves: poses made with the vehicle's own equations."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.ego_motion import EgoMotion
from matchset.control.learned.delay import DelayEstimator, DelayEstimatorParameters
from matchset.control.motion_consistency import MotionConsistency
from matchset.control.sticks.ego_parameters import AttitudeCommand
from matchset.localization.pose import Pose

FPS, LATENCY, STEP = 30, 0.067, 1 / 30
BALL = np.array((0.1, 0.0, 1.5))
DELAYS = np.arange(-1, 7) / 30.0


def watched(
    extra: float, amplitude: float = 0.08, seconds: float = 5.0, noise: float = 0.003, later: float = 0.0
) -> tuple[DelayEstimator, EgoMotion]:
    """Fly before a ball at rest with a pitch that changes, its pictures later than they say; what was estimated.

    After 3 s they are later still.
    """
    rng, true, model, consistency = np.random.default_rng(3), EgoMotion(), EgoMotion(), MotionConsistency()
    for step in range(round(seconds * FPS)):
        time = step / FPS
        there = true.at(time - extra - (later if time >= 3.0 else 0.0))
        away = there.rotation.T @ (BALL - there.position) + noise * rng.standard_normal(3)
        pose = Pose(position=away, rotation_matrix=None, covariance=np.eye(6), observed="position", time=time)
        consistency.update(pose, model)
        wave = amplitude * (math.sin(6.0 * time) + 0.5 * math.sin(11.0 * time + 1.0))
        for each in (true, model):
            each.update(AttitudeCommand(pitch=wave), time + LATENCY)
    return consistency.latency, model


@pytest.mark.parametrize("extra", [-0.02, 0.0, 0.04, 0.083, 0.133, 0.18])
def test_the_delay_is_found_within_eight_milliseconds_in_five_seconds(extra: float) -> None:
    latency, model = watched(extra)
    assert latency.extra == pytest.approx(extra, abs=0.008)
    assert model.delay == pytest.approx(model.parameters.delay + latency.extra)


def test_two_seconds_are_enough_to_fly() -> None:
    assert watched(0.133, seconds=2.0)[0].extra == pytest.approx(0.133, abs=0.02)


def test_without_motion_nothing_is_said() -> None:
    assert watched(0.133, amplitude=0.0)[0].extra == 0.0


def test_what_is_told_right_stays() -> None:
    assert watched(0.0, amplitude=0.02, noise=0.005, seconds=8.0)[0].extra == pytest.approx(0.0, abs=0.01)


def test_old_pictures_are_no_latency() -> None:
    assert abs(watched(0.0, later=0.5)[0].extra) < 0.08


def test_on_the_ground_nothing_is_noted_and_the_delay_is_kept() -> None:
    consistency, model = MotionConsistency(), EgoMotion()
    rng = np.random.default_rng(2)
    consistency.latency.extra = 0.1
    consistency.reset()
    for step in range(60):
        away = BALL + 0.05 * rng.standard_normal(3)
        pose = Pose(position=away, rotation_matrix=None, covariance=np.eye(6), observed="position", time=step / FPS)
        consistency.update(pose, model, flies=False)
        model.update(AttitudeCommand(pitch=0.1 * math.sin(0.3 * step)), step / FPS + LATENCY)
    assert (consistency.latency.extra, consistency.evidence) == (0.1, 0.0)
    assert model.delay == model.parameters.delay


def parabola(at: float) -> np.ndarray:
    return 1e-6 + 0.01 * (DELAYS - at) ** 2


def test_between_the_delays_lies_a_parabola() -> None:
    estimator = DelayEstimator(DELAYS, DelayEstimatorParameters(max_time=0.15))
    for _ in range(200):
        estimator.update(parabola(0.081), STEP)
    assert estimator.extra == pytest.approx(0.081, abs=1e-4)


def test_it_changes_no_faster_than_its_limit_and_less_and_less() -> None:
    estimator, ways = DelayEstimator(DELAYS), []
    for k in range(150):
        before = estimator.extra
        estimator.update(parabola(0.15 if k < 60 else 0.05), STEP)
        ways.append(abs(estimator.extra - before))
    assert max(ways) == pytest.approx(0.5 * STEP)
    assert ways[60] < 0.1 * STEP


@given(st.lists(st.lists(st.floats(0.0, 10.0), min_size=8, max_size=8), max_size=40), st.floats(1e-3, 3.0))
def test_whatever_is_left_the_delay_is_within_its_limits(left: list[list[float]], step: float) -> None:
    estimator = DelayEstimator(DELAYS)
    for each in left:
        estimator.update(np.array(each), step)
        assert DELAYS[0] - 1e-9 <= estimator.extra <= DELAYS[-1] + 1e-9


def test_bad_numbers_are_refused() -> None:
    for name in ("noise", "contrast", "min_time", "max_time", "max_rate"):
        with pytest.raises(ValueError, match=name):
            DelayEstimatorParameters(**{name: -1.0})


def test_a_parabola_whose_least_lies_far_outside_leads_to_the_last_delay_that_is_compared() -> None:
    rising = 1e-3 * np.array((0.0, 1.0, 2.1, 3.3, 4.6, 6.0, 7.5, 9.1))
    for left, expected in ((rising, DELAYS[0]), (rising[::-1].copy(), DELAYS[-1])):
        estimator = DelayEstimator(DELAYS)
        for _ in range(1200):
            estimator.update(left, STEP)
        assert estimator.extra == pytest.approx(expected, abs=1e-3)
