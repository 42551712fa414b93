import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.learned.thrust_estimator import ThrustEstimator, ThrustEstimatorParameters

HOVER, GRAVITY, DELAY, LAG, STEP = 0.59, 8.1, 0.03, 0.05, 1.0 / 30.0


def flown(estimator: ThrustEstimator, gain: float, seconds: float, sag: float = 0.0) -> float:
    """Fly by what the estimator says, held at a height by a loop of its own; return the largest error of the height."""
    rng, delay, height, speed, thrust, worst = np.random.default_rng(5), [0.0] * 3, 0.0, 0.0, 0.0, 0.0
    for k in range(round(seconds / STEP)):
        now = k * STEP
        estimator.update(height + 0.01 * rng.standard_normal(), 1.0, now)
        wanted = -5.0 * height - 4.0 * speed
        throttle = min(max(HOVER / estimator.gain * (1.0 + wanted / GRAVITY), 0.2), 0.9)
        estimator.sent(throttle, now)
        delay.append(throttle)
        for _ in range(10):
            acting = delay[-2] if _ < 9 else delay[-1]
            thrust += (acting - thrust) * (STEP / 10) / LAG
            true = gain * (1.0 - sag * now)
            lift = GRAVITY * (true * thrust / HOVER - 1.0)
            if thrust * true / HOVER >= 0.5 or speed:
                speed += lift * STEP / 10
                height += speed * STEP / 10
        worst = max(worst, abs(height))
    return worst


@pytest.mark.parametrize("gain", [0.75, 0.8, 1.0, 1.2, 1.3])
def test_the_throttle_that_hovers_is_found_within_two_seconds(gain: float) -> None:
    estimator = ThrustEstimator(HOVER, GRAVITY, DELAY, LAG)
    flown(estimator, gain, 2.0)
    assert estimator.gain == pytest.approx(gain, rel=0.05)
    assert estimator.sigma < 0.15


def test_a_battery_that_loses_forty_percent_in_a_minute_is_followed() -> None:
    estimator = ThrustEstimator(HOVER, GRAVITY, DELAY, LAG)
    flown(estimator, 1.0, 50.0, 0.4 / 60.0)
    assert estimator.gain == pytest.approx(1.0 - 50.0 * 0.4 / 60.0, rel=0.05)


def test_in_the_hand_nothing_is_learned_and_on_the_ground_it_is_forgotten() -> None:
    estimator = ThrustEstimator(HOVER, GRAVITY, DELAY, LAG)
    for k in range(60):
        estimator.sent(0.3, k * STEP)
        estimator.update(0.5 * math.sin(k * STEP), 1.0, k * STEP)
    assert not estimator.airborne
    assert estimator.gain == 1.0
    flown(other := ThrustEstimator(HOVER, GRAVITY, DELAY, LAG), 0.8, 2.0)
    assert other.airborne
    other.reset()
    assert not other.airborne
    assert other.gain == 1.0


def test_a_tilted_vehicle_is_not_taken_for_a_weak_one() -> None:
    estimators = [ThrustEstimator(HOVER, GRAVITY, DELAY, LAG) for _ in range(2)]
    for k in range(120):
        for estimator, upright in zip(estimators, (1.0, 0.9), strict=True):
            estimator.sent(HOVER / upright, k * STEP)
            estimator.update(0.0, upright, k * STEP)
    assert estimators[1].gain == pytest.approx(1.0, abs=0.02)
    assert estimators[0].gain == pytest.approx(1.0, abs=0.02)


@given(
    st.lists(
        st.tuples(st.floats(-5.0, 5.0), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(-0.1, 2.0)), max_size=60
    )
)
def test_whatever_it_sees_the_gain_is_finite_and_within_its_limits(
    poses: list[tuple[float, float, float, float]],
) -> None:
    estimator, now = ThrustEstimator(HOVER, GRAVITY, DELAY, LAG), 0.0
    limits = ThrustEstimatorParameters()
    for height, upright, throttle, step in poses:
        now += step
        estimator.sent(throttle, now)
        estimator.update(height, upright, now)
        assert limits.min_gain <= estimator.gain <= limits.max_gain
        assert math.isfinite(estimator.sigma)


def test_limits_that_leave_out_what_was_told_are_refused() -> None:
    with pytest.raises(ValueError, match="min_gain"):
        ThrustEstimatorParameters(min_gain=1.1)
    with pytest.raises(ValueError, match="max_gain"):
        ThrustEstimatorParameters(max_gain=0.9)
    with pytest.raises(ValueError, match="acceleration_noise"):
        ThrustEstimatorParameters(acceleration_noise=0.0)
