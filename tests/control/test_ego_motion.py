import math

import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from matchset.control.dead_reckoning import PITCH, ROLL, SIZE, YAW
from matchset.control.ego_motion import GRAVITY, AttitudeCommand, EgoMotion, EgoMotionParameters, EgoState
from matchset.sim.quadrotor import SPEED, constants, resting, rotation, step_vehicle
from matchset.sim.vehicle import toy

MODEL = EgoMotionParameters(delay=0.05, tilt_lag=1e-6, tilt_time=0.05, tilt_damping=1.0, drag_time=1e9, heft=1.0)
TOY = toy()


def fly(sticks: AttitudeCommand, seconds: float) -> EgoMotion:
    own = EgoMotion(MODEL)
    for k in range(round(seconds * 30) + 1):
        own.sent(sticks, k / 30)
    return own


def test_tilt_swings_into_its_angle_after_a_delay() -> None:
    own = fly(AttitudeCommand(roll=0.2), 1.0)
    for time in (0.02, 0.2, 0.6):
        since = max(time - 0.05, 0.0) / 0.05
        expected = 0.2 * (1.0 - (1.0 + since) * math.exp(-since))
        assert own.at(time).roll == pytest.approx(expected, abs=0.015)


@pytest.mark.parametrize(
    ("sticks", "way"),
    [
        (AttitudeCommand(roll=0.1), (1.0, 0.0, 0.0)),
        (AttitudeCommand(pitch=0.1), (0.0, 0.0, 1.0)),
        (AttitudeCommand(lift=GRAVITY * math.tan(0.1)), (0.0, -1.0, 0.0)),
    ],
)
def test_tilt_and_lift_pull_along_their_axes(sticks: AttitudeCommand, way: tuple[float, ...]) -> None:
    state = fly(sticks, 1.0).at(1.05)
    pull = GRAVITY * math.tan(0.1)
    assert state.velocity @ np.array(way) == pytest.approx(pull * 1.0, rel=0.12)
    assert np.linalg.norm(np.cross(state.place, way)) < 1e-9


def test_what_is_moved_and_not_carried_slows_the_answer() -> None:
    fast, slow = EgoMotion(MODEL), EgoMotion(msgspec.structs.replace(MODEL, heft=1.25))
    for own in (fast, slow):
        for k in range(31):
            own.sent(AttitudeCommand(roll=0.1), k / 30)
    assert slow.at(1.0).velocity[0] == pytest.approx(0.8 * fast.at(1.0).velocity[0], rel=1e-6)


def test_the_defaults_answer_as_the_simulated_toy_does() -> None:
    rng = np.random.default_rng(3)
    tilts = np.repeat(rng.normal(0.0, 0.08, 40), 3)
    own, state, turn = EgoMotion(), resting((0.0, 0.0, 0.0), 0.0, TOY.mass * GRAVITY), np.empty((3, 3))
    goal, off, lag = np.array((0.0, 0.0, 0.0, TOY.mass * GRAVITY)), [], []
    for k, tilt in enumerate(tilts):
        own.sent(AttitudeCommand(roll=float(tilt)), k / 30)
        for step in range(16 * k, 16 * k + 16):
            arrived = math.floor((step / 480 - TOY.radio_delay) * 30 + 1e-9)
            goal[0] = tilts[arrived] if arrived >= 0 else 0.0
            step_vehicle(state, goal, np.zeros(3), constants(TOY), 1 / 480)
        there = own.at((k + 1) / 30)
        rotation(state, turn)
        off.append(there.roll - math.asin(turn[1, 0]))
        lag.append(there.velocity[0] - state[SPEED])
    assert np.std(off) < math.radians(0.7)  # of 3.5 degrees
    assert np.std(lag) < 0.01  # m/s, of 0.12


def test_after_a_right_turn_forward_is_to_the_right() -> None:
    own = EgoMotion(EgoMotionParameters(drag_time=1e9))
    for k in range(31):
        own.sent(AttitudeCommand(turning=math.pi / 2), k / 30)
    for k in range(31, 61):
        own.sent(AttitudeCommand(pitch=0.1), k / 30)
    end = own.at(2.0)
    assert end.yaw == pytest.approx(math.pi / 2, abs=0.06)
    assert end.place[0] > 10.0 * abs(end.place[2])


def test_its_turn_is_yaw_then_pitch_then_roll() -> None:
    numbers = np.zeros(SIZE)
    numbers[ROLL], numbers[PITCH], numbers[YAW] = 0.2, 0.1, 0.5
    turn = Rotation.from_euler("YXZ", (0.5, -0.1, 0.2)).as_matrix()
    np.testing.assert_allclose(EgoState(numbers).turn, turn, atol=1e-12)


def test_it_can_be_asked_about_the_past_and_the_future() -> None:
    own = fly(AttitudeCommand(pitch=0.1), 1.0)
    assert own.at(-5.0).place.tolist() == [0.0, 0.0, 0.0]
    times = np.linspace(0.2, 1.3, 60)
    places = np.array([own.at(time).place[2] for time in times])
    assert (np.diff(places) > 0.0).all()
    assert np.abs(np.diff(places, 2)).max() < 2e-3
    assert math.isfinite(own.at(1e9).place[2])
    own.sent(AttitudeCommand(), 1e6)
    assert own.at(1e6).place[2] == 0.0


def test_states_at_several_times_are_those_at_each() -> None:
    own, times = fly(AttitudeCommand(roll=0.1, pitch=-0.05, turning=0.4), 1.0), (0.3, 1.02, 1.2)
    for time, state in zip(times, own.at_times(times), strict=True):
        np.testing.assert_array_equal(state.numbers, own.at(time).numbers)
