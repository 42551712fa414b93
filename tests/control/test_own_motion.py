import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from matchset.control.dead_reckoning import PITCH, ROLL, SIZE, YAW
from matchset.control.own_motion import GRAVITY, OwnMotion, OwnMotionParameters, OwnState, Sticks

MODEL = OwnMotionParameters(delay=0.05, tilt_lag=0.1, drag_time=1e9)


def fly(sticks: Sticks, seconds: float) -> OwnMotion:
    own = OwnMotion(MODEL)
    for k in range(round(seconds * 30) + 1):
        own.sent(sticks, k / 30)
    return own


def test_tilt_follows_after_a_delay_through_two_equal_lags() -> None:
    own = fly(Sticks(roll=0.2), 1.0)
    for time in (0.02, 0.2, 0.6):
        since = max(time - 0.05, 0.0) / 0.05
        expected = 0.2 * (1.0 - (1.0 + since) * math.exp(-since))
        assert own.at(time).roll == pytest.approx(expected, abs=0.015)


@pytest.mark.parametrize(
    ("sticks", "way"),
    [
        (Sticks(roll=0.1), (1.0, 0.0, 0.0)),
        (Sticks(pitch=0.1), (0.0, 0.0, 1.0)),
        (Sticks(lift=GRAVITY * math.tan(0.1)), (0.0, -1.0, 0.0)),
    ],
)
def test_tilt_and_lift_pull_along_their_axes(sticks: Sticks, way: tuple[float, ...]) -> None:
    state = fly(sticks, 1.0).at(1.05)
    pull = GRAVITY * math.tan(0.1)
    assert state.velocity @ np.array(way) == pytest.approx(pull * 1.0, rel=0.12)
    assert np.linalg.norm(np.cross(state.place, way)) < 1e-9


def test_after_a_right_turn_forward_is_to_the_right() -> None:
    own = OwnMotion(OwnMotionParameters(drag_time=1e9))
    for k in range(31):
        own.sent(Sticks(turning=math.pi / 2), k / 30)
    for k in range(31, 61):
        own.sent(Sticks(pitch=0.1), k / 30)
    end = own.at(2.0)
    assert end.yaw == pytest.approx(math.pi / 2, abs=0.06)
    assert end.place[0] > 10.0 * abs(end.place[2])


def test_its_turn_is_yaw_then_pitch_then_roll() -> None:
    numbers = np.zeros(SIZE)
    numbers[ROLL], numbers[PITCH], numbers[YAW] = 0.2, 0.1, 0.5
    turn = Rotation.from_euler("YXZ", (0.5, -0.1, 0.2)).as_matrix()
    np.testing.assert_allclose(OwnState(numbers).turn, turn, atol=1e-12)


def test_it_can_be_asked_about_the_past_and_the_future() -> None:
    own = fly(Sticks(pitch=0.1), 1.0)
    assert own.at(-5.0).place.tolist() == [0.0, 0.0, 0.0]
    times = np.linspace(0.2, 1.3, 60)
    places = np.array([own.at(time).place[2] for time in times])
    assert (np.diff(places) > 0.0).all()
    assert np.abs(np.diff(places, 2)).max() < 2e-3
    assert math.isfinite(own.at(1e9).place[2])
    own.sent(Sticks(), 1e6)
    assert own.at(1e6).place[2] == 0.0
