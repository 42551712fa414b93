"""A toy quadcopter as a rigid body: sticks command angles, a yaw rate and thrust; `advance`.

Frames as the camera's: x right, y down, z forward; the world's y is down too. R = Ry(yaw) Rx(-pitch) Rz(roll) turns
body vectors into the world. With m the mass and M the mass that accelerates (balloon air and added mass included),

    M dv/dt = m g - T R y - c (v - w) - k |v_b - w| (v_b - w),    J dW/dt = tau - W x J W + b x R^T F_b,

w the velocity of the air, b the center of the ball, v_b its velocity, F_b its drag; thrust T and torque tau follow
their commands with the motors' lag.
"""

import math
from typing import Annotated, Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, fields, new_block, record_dtype
from matchset.sim.vehicle import VehicleParameters

Floats = npt.NDArray[np.float64]

GRAVITY = 9.81  # theorem: m/s^2, the standard acceleration of free fall, 9.80665 m/s^2 (ISO 80000-3), rounded


class VehicleState:
    """Layout of a state: how a vehicle moves at a moment, 17 numbers."""

    position: Annotated[Floats, (3,), "f8"]  # of the center of mass, world frame, m
    velocity: Annotated[Floats, (3,), "f8"]  # world frame, m/s
    quaternion: Annotated[Floats, (4,), "f8"]  # w, x, y, z of the rotation from the body to the world
    angular_velocity: Annotated[Floats, (3,), "f8"]  # body frame, rad/s
    thrust: float  # N
    torque: Annotated[Floats, (3,), "f8"]  # body frame, N m


class Setpoint:
    """Layout of what the electronics of a vehicle aim at."""

    roll: float  # rad
    pitch: float  # rad
    yaw_rate: float  # rad/s
    thrust: float  # N


class VehicleConstants:
    """Layout of what the equations of motion need to know of a vehicle; units as in ``vehicle.toml``."""

    mass: float
    moved_mass: float
    inertia: Annotated[Floats, (3,), "f8"]  # about x, y and z, with the air in the balloon, kg m^2
    motor_lag: float
    torque_lag: float  # what the motors' lag is for torques: the electronics shorten it, s
    angle_gain: float
    rate_gain: float
    yaw_gain: float  # as rate_gain, about the vertical axis
    frame_drag: float
    ball_drag: float  # N s^2/m^2, per squared speed
    ball_height: float


class WakeParameters(msgspec.Struct, frozen=True, kw_only=True):
    """The air that a vehicle pushes down.

    Parameters
    ----------
    reach : float
        How far below a rotor disc its wake ends, m. Longer: more vehicles are pushed down. Chosen by hand: a chain is
        flown at one height, so vehicles are seldom below each other; `test_quadrotor` shows a change.
    spread : float
        How much the radius of the wake grows per meter below the disc. A round turbulent jet grows by about 0.1 (Pope,
        Turbulent Flows, section 5.1).
    """

    reach: float = 1.5
    spread: float = 0.1


class Wake:
    """Layout of what the kernel of the wakes needs."""

    disc_area: float  # of the rotors of a vehicle together, m^2
    air_density: float  # kg/m^3; 0 for no wakes
    reach: float
    spread: float


STATE, SETPOINT = record_dtype(VehicleState), record_dtype(Setpoint)
VEHICLE, WAKE = record_dtype(VehicleConstants), record_dtype(Wake)
STATE_SIZE = new_block(STATE).shape[0]


def vehicle_constants(vehicle: VehicleParameters) -> Block:
    """Make the block of `VehicleConstants` of a vehicle."""
    block = new_block(VEHICLE)
    constants = fields(block, VEHICLE)
    constants.mass, constants.moved_mass = vehicle.mass, vehicle.moved_mass
    pitch_inertia, roll_inertia = (
        vehicle.pitch_inertia + vehicle.ball_inertia,
        vehicle.roll_inertia + vehicle.ball_inertia,
    )
    constants.inertia[:] = pitch_inertia, vehicle.yaw_inertia, roll_inertia
    constants.motor_lag, constants.torque_lag = vehicle.motor_lag, vehicle.motor_lag / (1.0 + vehicle.motor_lead)
    constants.angle_gain, constants.rate_gain = vehicle.angle_gain, vehicle.rate_gain
    constants.yaw_gain = vehicle.rate_gain
    constants.frame_drag, constants.ball_drag = vehicle.frame_drag, vehicle.ball_area_drag
    constants.ball_height = vehicle.ball_height
    return block


def wake_constants(vehicle: VehicleParameters, parameters: WakeParameters) -> Block:
    """Make the block of `Wake` of a vehicle with four rotors."""
    block = new_block(WAKE)
    wake = fields(block, WAKE)
    wake.disc_area, wake.air_density = 4.0 * math.pi * vehicle.rotor_radius**2, vehicle.air_density
    wake.reach, wake.spread = parameters.reach, parameters.spread
    return block


def state_at_rest(position: npt.ArrayLike, yaw: float, thrust: float) -> Floats:
    """State of a level vehicle that stands still, (17,)."""
    block = new_block(STATE)
    state = fields(block, STATE)
    state.position[:] = position
    state.quaternion[:] = math.cos(0.5 * yaw), 0.0, math.sin(0.5 * yaw), 0.0
    state.thrust = thrust
    return block


@kernel
def rotation_matrix(state: Block, matrix: Floats) -> None:
    """Write the rotation matrix of a state's quaternion into `matrix`, (3, 3)."""
    _to_matrix(state.view(STATE)[0].quaternion, matrix)


@kernel(refcount=False)
def _to_matrix(quaternion: Floats, matrix: Floats) -> None:
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@kernel(refcount=False)
def _turn_rates(state: Any, rate: Any) -> None:
    """Write the time derivative of the quaternion: half of q (0, W)."""
    w, x, y, z = state.quaternion[0], state.quaternion[1], state.quaternion[2], state.quaternion[3]
    wx, wy, wz = state.angular_velocity[0], state.angular_velocity[1], state.angular_velocity[2]
    rate.quaternion[0] = 0.5 * (-x * wx - y * wy - z * wz)
    rate.quaternion[1] = 0.5 * (w * wx + y * wz - z * wy)
    rate.quaternion[2] = 0.5 * (w * wy + z * wx - x * wz)
    rate.quaternion[3] = 0.5 * (w * wz + x * wy - y * wx)


@kernel(refcount=False)
def _accelerations(state: Any, wind: Floats, constants: Any, turn: Floats, rate: Any) -> None:
    """Write the accelerations by gravity, thrust and drag, and the angular ones by torques and the ball's drag."""
    wx, wy, wz = state.angular_velocity[0], state.angular_velocity[1], state.angular_velocity[2]
    up = -constants.ball_height  # the ball is at body (0, up, 0): W x b = (-wz up, 0, wx up)
    square = 0.0
    ball, force, inertia = rate.velocity, rate.position, constants.inertia  # the first two are written over below
    for k in range(3):
        air = state.velocity[k] - wind[k]
        ball[k] = air + turn[k, 0] * (-wz * up) + turn[k, 2] * (wx * up)
        square += ball[k] ** 2
        force[k] = -constants.frame_drag * air
    push = -constants.ball_drag * math.sqrt(square)
    along_x = push * (turn[0, 0] * ball[0] + turn[1, 0] * ball[1] + turn[2, 0] * ball[2])
    along_z = push * (turn[0, 2] * ball[0] + turn[1, 2] * ball[1] + turn[2, 2] * ball[2])
    for k in range(3):
        rate.velocity[k] = (force[k] + push * ball[k] - turn[k, 1] * state.thrust) / constants.moved_mass
        rate.position[k] = state.velocity[k]
    rate.velocity[1] += constants.mass * GRAVITY / constants.moved_mass
    spin, torque = rate.angular_velocity, state.torque
    spin[0] = (torque[0] - (inertia[2] - inertia[1]) * wy * wz + up * along_z) / inertia[0]
    spin[1] = (torque[1] - (inertia[0] - inertia[2]) * wz * wx) / inertia[1]
    spin[2] = (torque[2] - (inertia[1] - inertia[0]) * wx * wy - up * along_x) / inertia[2]


@kernel(refcount=False)
def _motor_rates(state: Any, setpoint: Any, constants: Any, turn: Floats, rate: Any) -> None:
    """Write how thrust and torque change: angles are held by rates, rates by torques, both with the motors' lag."""
    spin, inertia = state.angular_velocity, constants.inertia
    pitch = math.asin(min(max(turn[1, 2], -1.0), 1.0))
    roll = math.atan2(turn[1, 0], turn[1, 1])
    rate_x, rate_z = -constants.angle_gain * (setpoint.pitch - pitch), constants.angle_gain * (setpoint.roll - roll)
    flying, gain, lag = 1.0 if setpoint.thrust > 0.0 else 0.0, constants.rate_gain, constants.torque_lag
    rate.thrust = (setpoint.thrust - state.thrust) / constants.motor_lag
    rate.torque[0] = (flying * inertia[0] * gain * (rate_x - spin[0]) - state.torque[0]) / lag
    rate.torque[1] = (flying * inertia[1] * constants.yaw_gain * (setpoint.yaw_rate - spin[1]) - state.torque[1]) / lag
    rate.torque[2] = (flying * inertia[2] * gain * (rate_z - spin[2]) - state.torque[2]) / lag


@kernel(refcount=False)
def _slope(state: Block, setpoint: Any, wind: Floats, constants: Any, turn: Floats, rate: Block) -> None:
    """Write the time derivative of a state into `rate`, (17,)."""
    now, change = state.view(STATE)[0], rate.view(STATE)[0]
    _to_matrix(now.quaternion, turn)
    _accelerations(now, wind, constants, turn, change)
    _turn_rates(now, change)
    _motor_rates(now, setpoint, constants, turn, change)


@kernel
def advance(state: Block, setpoint: Any, wind: Floats, constants: Any, step: float) -> None:
    """Advance one vehicle by one step of the classical Runge-Kutta method, in place.

    Parameters
    ----------
    state : (17,), written
        `VehicleState`.
    setpoint : Record
        `Setpoint`.
    wind : (3,)
        Velocity of the air, m/s.
    constants : Record
        `vehicle_constants`.
    step : float
        s.
    """
    turn = np.empty((3, 3))
    slopes = np.empty((4, STATE_SIZE))
    probe = np.empty(STATE_SIZE)
    _slope(state, setpoint, wind, constants, turn, slopes[0])
    for stage in range(1, 4):
        part = step if stage == 3 else 0.5 * step
        for k in range(STATE_SIZE):
            probe[k] = state[k] + part * slopes[stage - 1, k]
        _slope(probe, setpoint, wind, constants, turn, slopes[stage])
    for k in range(STATE_SIZE):
        state[k] += step / 6.0 * (slopes[0, k] + 2.0 * slopes[1, k] + 2.0 * slopes[2, k] + slopes[3, k])
    quaternion = state.view(STATE)[0].quaternion
    length = math.sqrt(quaternion[0] ** 2 + quaternion[1] ** 2 + quaternion[2] ** 2 + quaternion[3] ** 2)
    for k in range(4):
        quaternion[k] /= length


@kernel(refcount=False)
def write_downwash(states: Floats, who: int, wake: Any, wind: Floats) -> None:
    """Write the velocity of the air at a vehicle in the wakes of those above it.

    Momentum theory: v = sqrt(T / (2 rho A)) in the disc; below it the wake is a Gaussian jet that widens and keeps its
    momentum.

    Parameters
    ----------
    states : (n, 17)
        `VehicleState` of each.
    who : int
        The vehicle.
    wake : Record
        `wake_constants`.
    wind : (3,), written
        m/s.
    """
    wind[:] = 0.0
    if wake.air_density <= 0.0:
        return
    radius, me = math.sqrt(wake.disc_area / math.pi), states[who].view(STATE)[0].position
    for other in range(states.shape[0]):
        above = states[other].view(STATE)[0]
        below = me[1] - above.position[1]
        if other == who or not 0.0 < below < wake.reach:
            continue
        width = radius + wake.spread * below
        apart = (me[0] - above.position[0]) ** 2 + (me[2] - above.position[2]) ** 2
        speed = math.sqrt(max(above.thrust, 0.0) / (2.0 * wake.air_density * wake.disc_area))
        wind[1] += 2.0 * speed * radius / width * math.exp(-apart / (width * width)) * min(below / radius, 1.0)
