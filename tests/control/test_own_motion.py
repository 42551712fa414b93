import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from matchset.control.own_motion import GRAVITY, OwnMotion, OwnMotionParameters, OwnState, Sticks
from matchset.localization.pose import Pose

MODEL = OwnMotionParameters(delay=0.05, tilt_lag=0.1, drag_time=1e9)


def fly(sticks: Sticks, seconds: float) -> OwnMotion:
    own = OwnMotion(MODEL)
    for k in range(round(seconds * 30) + 1):
        own.sent(sticks, k / 30)
    return own


def test_tilt_is_a_delayed_first_order_answer() -> None:
    own = fly(Sticks(roll=0.2), 1.0)
    for time in (0.02, 0.2, 0.6):
        expected = 0.2 * (1.0 - math.exp(-max(time - 0.05, 0.0) / 0.1))
        assert own.at(time).roll == pytest.approx(expected, abs=0.01)


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
    assert end.x > 10.0 * abs(end.z)


def test_its_turn_is_yaw_then_pitch_then_roll() -> None:
    state = OwnState(0.0, roll=0.2, pitch=0.1, yaw=0.5)
    turn = Rotation.from_euler("YXZ", (0.5, -0.1, 0.2)).as_matrix()
    np.testing.assert_allclose(state.turn, turn, atol=1e-12)


def test_a_pose_seen_from_a_tilted_vehicle_is_leveled() -> None:
    state = OwnState(0.0, roll=0.2, pitch=0.1, yaw=0.5, x=1.0)
    there, attitude = np.array((0.3, -0.2, 1.5)), Rotation.from_euler("y", 2.0).as_matrix()
    spread = np.diag((1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    seen = Pose(
        position=state.turn.T @ (there - state.place),
        turn=state.turn.T @ attitude,
        covariance=spread,
        observed="full",
        time=0.0,
    )
    leveled = state.to_rest(seen)
    np.testing.assert_allclose(leveled.position, there, atol=1e-12)
    assert leveled.turn is not None
    np.testing.assert_allclose(leveled.turn, attitude, atol=1e-12)
    assert np.trace(leveled.covariance) == pytest.approx(21.0)


def test_it_can_be_asked_about_the_past_and_the_future() -> None:
    own = fly(Sticks(pitch=0.1), 1.0)
    assert own.at(-5.0).place.tolist() == [0.0, 0.0, 0.0]
    times = np.linspace(0.2, 1.3, 60)
    places = np.array([own.at(time).z for time in times])
    assert (np.diff(places) > 0.0).all()
    assert np.abs(np.diff(places, 2)).max() < 2e-3
    assert math.isfinite(own.at(1e9).z)
    own.sent(Sticks(), 1e6)
    assert own.at(1e6).z == 0.0
