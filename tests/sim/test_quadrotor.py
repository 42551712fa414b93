"""The vehicle against closed-form cases."""

import math

import msgspec
import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from kernels import downwash, step_vehicle
from matchset.numeric.record import fields
from matchset.sim.quadrotor import (
    GRAVITY,
    STATE,
    VEHICLE,
    WakeParameters,
    rotation_matrix,
    state_at_rest,
    vehicle_constants,
    wake_constants,
)
from matchset.sim.vehicle import VehicleParameters, toy

TOY = toy()
STEP = 1.0 / 480.0
STILL = np.zeros(3)
HOVER = np.array((0.0, 0.0, 0.0, TOY.mass * GRAVITY))


def flown(wanted: np.ndarray, seconds: float, vehicle: VehicleParameters = TOY, step: float = STEP) -> np.ndarray:
    state = state_at_rest((0.0, 0.0, 0.0), 0.3, TOY.mass * GRAVITY)
    for _ in range(round(seconds / step)):
        step_vehicle(state, wanted, STILL, vehicle_constants(vehicle), step)
    return state


def turn_of(state: np.ndarray) -> np.ndarray:
    turn = np.empty((3, 3))
    rotation_matrix(state, turn)
    return turn


def test_it_hovers_where_it_is() -> None:
    state = flown(HOVER, 5.0)
    np.testing.assert_allclose(state, state_at_rest((0.0, 0.0, 0.0), 0.3, TOY.mass * GRAVITY), atol=1e-9)


def test_without_thrust_it_falls_and_drags_its_air_along() -> None:
    state = state_at_rest((0.0, 0.0, 0.0), 0.0, 0.0)
    step_vehicle(state, np.zeros(4), STILL, vehicle_constants(TOY), STEP)
    assert fields(state, STATE).velocity[1] == pytest.approx(TOY.mass * GRAVITY / TOY.moved_mass * STEP, rel=1e-3)
    air = 1.2 * 4.0 / 3.0 * math.pi * 0.14**3
    assert TOY.moved_mass == pytest.approx(0.1 + air + 0.5 * air)


def test_it_falls_at_last_as_fast_as_drag_allows() -> None:
    state = state_at_rest((0.0, 0.0, 0.0), 0.0, 0.0)
    for _ in range(480 * 20):
        step_vehicle(state, np.zeros(4), STILL, vehicle_constants(TOY), STEP)

    def surplus(v: float) -> float:
        return TOY.frame_drag * v + TOY.ball_area_drag * v * v - TOY.mass * GRAVITY

    assert fields(state, STATE).velocity[1] == pytest.approx(brentq(surplus, 0.1, 100.0), rel=1e-3)


@pytest.mark.parametrize(("axis", "value"), [("roll", 0.1), ("pitch", 0.1), ("roll", -0.2), ("pitch", -0.2)])
def test_a_stick_tilts_it_that_way_and_drag_limits_its_speed(axis: str, value: float) -> None:
    wanted = HOVER.copy()
    wanted[0 if axis == "roll" else 1] = value
    wanted[3] /= math.cos(value)
    light = msgspec.structs.replace(TOY, ball_height=0.0)  # no torque of the drag: the tilt is as commanded
    state = flown(wanted, 30.0, light)
    turn = turn_of(state)
    tilt = math.atan2(turn[1, 0], turn[1, 1]) if axis == "roll" else math.asin(turn[1, 2])
    assert tilt == pytest.approx(value, abs=1e-3)

    def surplus(v: float) -> float:
        return light.frame_drag * v + light.ball_area_drag * v * v - light.mass * GRAVITY * math.tan(abs(value))

    level = Rotation.from_euler("y", 0.3).as_matrix()
    way = level @ np.array((np.sign(value), 0.0, 0.0) if axis == "roll" else (0.0, 0.0, np.sign(value)))
    np.testing.assert_allclose(fields(state, STATE).velocity, brentq(surplus, 0.01, 50.0) * way, atol=0.02)


def test_tilt_settles_in_half_a_second_without_swinging_over() -> None:
    wanted = HOVER + np.array((0.2, 0.0, 0.0, 0.0))
    state = state_at_rest((0.0, 0.0, 0.0), 0.0, TOY.mass * GRAVITY)
    tilts = []
    for _ in range(480):
        step_vehicle(state, wanted, STILL, vehicle_constants(TOY), STEP)
        turn = turn_of(state)
        tilts.append(math.atan2(turn[1, 0], turn[1, 1]))
    assert max(tilts) < 0.2 * 1.1
    assert min(tilts[240:]) > 0.2 * 0.8  # the drag of the balloon above tilts it back


def test_it_turns_clockwise_seen_from_above_at_the_rate_commanded() -> None:
    state = flown(HOVER + np.array((0.0, 0.0, 1.0, 0.0)), 2.0)
    assert fields(state, STATE).angular_velocity[1] == pytest.approx(1.0, abs=1e-3)
    ahead = turn_of(state)[:, 2]
    assert math.atan2(ahead[0], ahead[2]) == pytest.approx(0.3 + 2.0, abs=0.1)


def test_a_spinning_body_without_torque_keeps_energy_and_angular_momentum() -> None:
    free = msgspec.structs.replace(TOY, frame_drag=0.0, ball_drag=0.0)
    c = vehicle_constants(free)
    inertia = fields(c, VEHICLE).inertia
    inertia[0] *= 1.3
    state = state_at_rest((0.0, 0.0, 0.0), 0.0, 0.0)
    fields(state, STATE).angular_velocity = (3.0, 0.2, 1.0)
    before = turn_of(state) @ (inertia * fields(state, STATE).angular_velocity)
    energy = inertia @ fields(state, STATE).angular_velocity ** 2
    for _ in range(480 * 3):
        step_vehicle(state, np.zeros(4), STILL, c, STEP)
    np.testing.assert_allclose(
        turn_of(state) @ (inertia * fields(state, STATE).angular_velocity), before, rtol=1e-6, atol=1e-9
    )
    assert inertia @ fields(state, STATE).angular_velocity ** 2 == pytest.approx(energy, rel=1e-6)


def test_thrust_follows_with_the_motors_lag() -> None:
    state = flown(2.0 * HOVER, TOY.motor_lag)
    assert fields(state, STATE).thrust / HOVER[3] == pytest.approx(2.0 - math.exp(-1.0), rel=1e-2)


def test_the_integration_is_of_fourth_order() -> None:
    wanted = HOVER + np.array((0.1, -0.2, 1.0, 0.2))
    exact = flown(wanted, 0.5, step=1.0 / 15360.0)
    errors = [float(np.linalg.norm(flown(wanted, 0.5, step=1.0 / rate) - exact)) for rate in (240, 480)]
    assert 10.0 < errors[0] / errors[1] < 24.0


def test_a_wake_pushes_down_what_hangs_below_and_nothing_else() -> None:
    disc, wake = 4.0 * math.pi * TOY.rotor_radius**2, wake_constants(TOY, WakeParameters())
    states = np.array([state_at_rest((0.0, 0.0, 0.0), 0.0, HOVER[3]), state_at_rest((0.0, 0.6, 0.0), 0.0, HOVER[3])])
    wind = np.empty(3)
    downwash(states, 1, wake, wind)
    assert 1.0 < wind[1] < 2.0 * math.sqrt(HOVER[3] / (2.0 * TOY.air_density * disc))
    downwash(states, 0, wake, wind)
    assert wind.tolist() == [0.0, 0.0, 0.0]
    states[1, 0] = 1.0
    downwash(states, 1, wake, wind)
    assert wind[1] < 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_a_quaternion_turns_as_scipy_says(seed: int) -> None:
    expected = Rotation.random(random_state=seed)
    state = state_at_rest((0.0, 0.0, 0.0), 0.0, 0.0)
    x, y, z, w = expected.as_quat()
    fields(state, STATE).quaternion = w, x, y, z
    np.testing.assert_allclose(turn_of(state), expected.as_matrix(), atol=1e-14)


def test_spinning_integrates_to_the_rotation_of_scipy() -> None:
    free = msgspec.structs.replace(TOY, frame_drag=0.0, ball_drag=0.0)
    c = vehicle_constants(free)
    fields(c, VEHICLE).inertia[:] = 1e-4  # a sphere: its axis of rotation stays
    state, spin = state_at_rest((0.0, 0.0, 0.0), 0.4, 0.0), np.array((1.0, -0.5, 2.0))
    fields(state, STATE).angular_velocity = spin
    for _ in range(480):
        step_vehicle(state, np.zeros(4), STILL, c, STEP)
    expected = Rotation.from_euler("y", 0.4) * Rotation.from_rotvec(spin)
    np.testing.assert_allclose(turn_of(state), expected.as_matrix(), atol=1e-9)
