import math

import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from kernels import step_vehicle
from matchset.control.ego_motion import STATE, EgoMotion, EgoState
from matchset.control.sticks.ego_parameters import GRAVITY, AttitudeCommand, EgoMotionParameters
from matchset.numeric.record import fields, new_block
from matchset.sim import quadrotor
from matchset.sim.quadrotor import rotation_matrix, state_at_rest, vehicle_constants
from matchset.sim.vehicle import toy

MODEL = EgoMotionParameters(
    delay=0.05, tilt_lag=1e-6, tilt_time=0.05, tilt_damping=1.0, drag_time=1e9, effective_mass_ratio=1.0
)
TOY = toy()
Floats = npt.NDArray[np.float64]


def fly(sticks: AttitudeCommand, seconds: float) -> EgoMotion:
    own = EgoMotion(MODEL)
    for k in range(round(seconds * 30) + 1):
        own.update(sticks, k / 30)
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
    assert np.linalg.norm(np.cross(state.position, way)) < 1e-9


def test_a_delay_that_was_learned_counts_for_what_was_sent_before_too() -> None:
    own, late = fly(AttitudeCommand(roll=0.2), 1.0), fly(AttitudeCommand(roll=0.2), 1.0)
    late.delay += 0.1
    for time in (0.1, 0.2, 0.6):
        assert late.at(time + 0.1).roll == pytest.approx(own.at(time).roll)
    assert late.at(0.2).roll < own.at(0.2).roll - 0.01


def test_what_is_moved_and_not_carried_slows_the_answer() -> None:
    fast, slow = EgoMotion(MODEL), EgoMotion(msgspec.structs.replace(MODEL, effective_mass_ratio=1.25))
    for own in (fast, slow):
        for k in range(31):
            own.update(AttitudeCommand(roll=0.1), k / 30)
    assert slow.at(1.0).velocity[0] == pytest.approx(0.8 * fast.at(1.0).velocity[0], rel=1e-6)


def test_the_defaults_answer_as_the_simulated_toy_does() -> None:
    rng = np.random.default_rng(3)
    tilts = np.repeat(rng.normal(0.0, 0.08, 40), 3)
    own, state, turn = EgoMotion(), state_at_rest((0.0, 0.0, 0.0), 0.0, TOY.mass * GRAVITY), np.empty((3, 3))
    goal, off, lag = np.array((0.0, 0.0, 0.0, TOY.mass * GRAVITY)), [], []
    for k, tilt in enumerate(tilts):
        own.update(AttitudeCommand(roll=float(tilt)), k / 30)
        for step in range(16 * k, 16 * k + 16):
            arrived = math.floor((step / 480 - TOY.radio_delay) * 30 + 1e-9)
            goal[0] = tilts[arrived] if arrived >= 0 else 0.0
            step_vehicle(state, goal, np.zeros(3), vehicle_constants(TOY), 1 / 480)
        there = own.at((k + 1) / 30)
        rotation_matrix(state, turn)
        off.append(there.roll - math.asin(turn[1, 0]))
        lag.append(there.velocity[0] - fields(state, quadrotor.STATE).velocity[0])
    assert np.std(off) < math.radians(0.7)  # of 3.5 degrees
    assert np.std(lag) < 0.01  # m/s, of 0.12


def test_after_a_right_turn_forward_is_to_the_right() -> None:
    own = EgoMotion(EgoMotionParameters(drag_time=1e9))
    for k in range(31):
        own.update(AttitudeCommand(yaw_rate=math.pi / 2), k / 30)
    for k in range(31, 61):
        own.update(AttitudeCommand(pitch=0.1), k / 30)
    end = own.at(2.0)
    assert end.yaw == pytest.approx(math.pi / 2, abs=0.06)
    assert end.position[0] > 10.0 * abs(end.position[2])


def test_its_turn_is_yaw_then_pitch_then_roll() -> None:
    block = new_block(STATE)
    state = fields(block, STATE)
    state.tilt[:], state.yaw = (0.2, 0.1), 0.5
    turn = Rotation.from_euler("YXZ", (0.5, -0.1, 0.2)).as_matrix()
    np.testing.assert_allclose(EgoState(block).rotation, turn, atol=1e-12)


def test_a_gyroscope_turns_with_its_vehicle() -> None:
    """Without a yaw stick: rolled to the right, then tipped forward, the vehicle has turned; by SciPy's rotations."""
    own = EgoMotion(MODEL)
    for k in range(61):
        own.update(AttitudeCommand(roll=0.35, pitch=0.35 if k >= 20 else 0.0), k / 30)
    states = own.at_times(np.linspace(0.0, 2.0, 2001).tolist())
    turn = Rotation.from_matrix([state.rotation for state in states])
    about_own_axis = (turn[:-1].inv() * turn[1:]).as_rotvec()[:, 1]  # y is down: what a yaw gyroscope adds up
    assert abs(about_own_axis.sum()) < 2e-3
    expected = -math.degrees(math.tan(0.35) * math.asinh(math.tan(0.35)))  # the integral of 1 / cos is asinh(tan)
    assert math.degrees(states[-1].yaw) == pytest.approx(expected, abs=0.3)


def test_it_can_be_asked_about_the_past_and_the_future() -> None:
    own = fly(AttitudeCommand(pitch=0.1), 1.0)
    assert own.at(-5.0).position.tolist() == [0.0, 0.0, 0.0]
    times = np.linspace(0.2, 1.3, 60)
    places = np.array([own.at(time).position[2] for time in times])
    assert (np.diff(places) > 0.0).all()
    assert np.abs(np.diff(places, 2)).max() < 2e-3
    assert math.isfinite(own.at(1e9).position[2])
    own.update(AttitudeCommand(), 1e6)
    assert own.at(1e6).position[2] == 0.0


def test_states_at_several_times_are_those_at_each() -> None:
    own, times = fly(AttitudeCommand(roll=0.1, pitch=-0.05, yaw_rate=0.4), 1.0), (0.3, 1.02, 1.2)
    own.delay = 0.08  # not that of the parameters
    for time, state in zip(times, own.at_times(times), strict=True):
        np.testing.assert_array_equal(state.block, own.at(time).block)


def exact(model: EgoMotionParameters, commands: list[AttitudeCommand], end: float) -> Floats:
    """Tilt, yaw, velocity and position of the model's equations by SciPy; a command every 1/30 s, the first at 0."""

    def rates(_: float, state: Floats, command: AttitudeCommand) -> Floats:
        begun, tilt, tilt_rate, velocity = state[:2], state[2:4], state[4:6], state[9:12]
        yaw, yaw_rate, lift = state[6:9]
        t, z = model.tilt_time, model.tilt_damping
        pull = GRAVITY / model.effective_mass_ratio * np.tan(tilt) / (math.cos(tilt[1]), 1.0)
        turned = (yaw_rate - tilt_rate[1] * math.sin(tilt[0])) / (math.cos(tilt[0]) * math.cos(tilt[1]))
        push = Rotation.from_euler("y", yaw).apply((pull[0], -lift, pull[1])) - (velocity / model.drag_time)
        return np.concatenate(
            (
                (np.array(command[:2]) - begun) / model.tilt_lag,
                tilt_rate,
                ((begun - tilt) / t - 2.0 * z * tilt_rate) / t,
                (turned, (command.yaw_rate - yaw_rate) / model.yaw_lag, (command.lift - lift) / model.lift_lag),
                push,
                velocity,
            )
        )

    state = np.zeros(15)
    for k, command in enumerate(commands):
        begin = k / 30 + model.delay
        stop = min(begin + 1 / 30, end) if k + 1 < len(commands) else end
        state = solve_ivp(rates, (begin, stop), state, args=(command,), rtol=1e-9, atol=1e-12).y[:, -1]
    return np.concatenate((state[2:4], state[6:7], state[9:15]))


def test_dead_reckoning_converges_to_the_equations_of_its_model() -> None:
    rng = np.random.default_rng(5)
    commands = [AttitudeCommand(*(rng.normal(0.0, 1.0, 4) * (0.1, 0.1, 0.5, 1.0))) for _ in range(30)]
    off = []
    for step in (1 / 120, 1 / 1200):
        model = EgoMotionParameters(integration_step=step)
        own = EgoMotion(model)
        for k, command in enumerate(commands):
            own.update(command, k / 30)
        state, truth = own.at(1.05), exact(model, commands, 1.05)
        found = np.concatenate(((state.roll, state.pitch, state.yaw), state.velocity, state.position))
        off.append(np.abs(found - truth).max())
    assert off[0] < 0.02
    assert off[1] < 0.2 * off[0]


@given(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2), st.floats(-4.0, 4.0))
def test_every_rotation_is_that_of_scipy(roll: float, pitch: float, yaw: float) -> None:
    block = new_block(STATE)
    state = fields(block, STATE)
    state.tilt[:], state.yaw = (roll, pitch), yaw
    expected = Rotation.from_euler("YXZ", (yaw, -pitch, roll)).as_matrix()
    np.testing.assert_allclose(EgoState(block).rotation, expected, atol=1e-12)


@pytest.mark.parametrize("quick", ["tilt_lag", "tilt_time", "yaw_lag", "lift_lag"])
def test_a_vehicle_quicker_than_a_step_answers_at_once_and_does_not_swing_up(quick: str) -> None:
    """Each lag in turn a thousandth of the step of the integration."""
    step = EgoMotionParameters().integration_step
    model = msgspec.structs.replace(EgoMotionParameters(tilt_damping=0.1), **{quick: 1e-3 * step})
    own = EgoMotion(model)
    for k in range(31):
        own.update(AttitudeCommand(roll=0.2, pitch=-0.1, yaw_rate=0.5, lift=1.0), k / 30)
    states = own.at_times(np.linspace(0.0, 1.0, 200).tolist())
    assert max(abs(state.roll) for state in states) < 0.2 * 1.8  # a damping of 0.1 alone overshoots by 73 %
    carried = 0.2 * 1.8 * 0.1 * 1.8  # by tipping forward while it is rolled
    assert max(state.yaw for state in states) < 0.5 + carried
    assert abs(states[-1].velocity[1]) < 1.0
    assert states[-1].yaw > 0.4
