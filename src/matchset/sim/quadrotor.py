"""A toy quadcopter as a rigid body: sticks command angles, a yaw rate and thrust; `step_vehicles`.

Frames as the camera's: x right, y down, z forward; the world's y is down too. R = Ry(yaw) Rx(-pitch) Rz(roll) turns
body vectors into the world. With m the mass and M the mass that moves (balloon air and added mass included),

    M dv/dt = m g - T R y - c (v - w) - k |v_b - w| (v_b - w),    J dW/dt = tau - W x J W + b x R^T F_b,

w the air's speed, b the place of the ball, v_b its speed, F_b its drag; thrust T and torque tau follow their commands
with the motors' lag.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.sim.vehicle import VehicleParameters

Floats = npt.NDArray[np.float64]

GRAVITY = 9.81  # m/s^2
PLACE, SPEED, TURN, SPIN, THRUST, TORQUE = 0, 3, 6, 10, 13, 14  # columns of a state
SIZE = 17
REACH = 1.5  # m below a rotor disc where its wake ends, in this model

# places of what the kernel needs of the parameters
MASS, MOVED, J_X, J_Y, J_Z, LAG, LEAD, K_ANGLE, K_RATE, DRAG, BALL_DRAG, BALL_UP = range(12)


def constants(vehicle: VehicleParameters) -> Floats:
    """Pack the parameters that the kernel needs, (12,)."""
    return np.array(
        [
            vehicle.mass,
            vehicle.moved_mass,
            vehicle.pitch_inertia + vehicle.ball_inertia,
            vehicle.yaw_inertia,
            vehicle.roll_inertia + vehicle.ball_inertia,
            vehicle.motor_lag,
            vehicle.motor_lead,
            vehicle.angle_gain,
            vehicle.rate_gain,
            vehicle.frame_drag,
            vehicle.ball_area_drag,
            vehicle.ball_height,
        ]
    )


def resting(place: npt.ArrayLike, yaw: float, thrust: float) -> Floats:
    """State of a level vehicle that stands still, (17,)."""
    state = np.zeros(SIZE)
    state[PLACE : PLACE + 3] = place
    state[TURN], state[TURN + 2] = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    state[THRUST] = thrust
    return state


@kernel
def rotation(state: Floats, turn: Floats) -> None:
    """Write the rotation matrix of a state's quaternion w, x, y, z into `turn`, (3, 3)."""
    w, x, y, z = state[6], state[7], state[8], state[9]
    turn[0, 0], turn[0, 1], turn[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    turn[1, 0], turn[1, 1], turn[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    turn[2, 0], turn[2, 1], turn[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@kernel
def _slope(state: Floats, wanted: Floats, wind: Floats, c: Floats, turn: Floats, rate: Floats) -> None:
    """Time derivative of a state; `wanted` is roll, pitch (rad), yaw rate (rad/s) and thrust (N)."""
    rotation(state, turn)
    wx, wy, wz = state[10], state[11], state[12]
    up = -c[BALL_UP]
    # the ball is at body (0, up, 0): W x b = (-wz up, 0, wx up)
    force = np.empty(3)
    ball = np.empty(3)
    square = 0.0
    for k in range(3):
        air = state[3 + k] - wind[k]
        ball[k] = air + turn[k, 0] * (-wz * up) + turn[k, 2] * (wx * up)
        square += ball[k] ** 2
        force[k] = -c[DRAG] * air
    push = -c[BALL_DRAG] * math.sqrt(square)
    for k in range(3):
        rate[k] = state[3 + k]
        rate[3 + k] = (force[k] + push * ball[k] - turn[k, 1] * state[13]) / c[MOVED]
    rate[4] += c[MASS] * GRAVITY / c[MOVED]
    rate[6] = 0.5 * (-state[7] * wx - state[8] * wy - state[9] * wz)
    rate[7] = 0.5 * (state[6] * wx + state[8] * wz - state[9] * wy)
    rate[8] = 0.5 * (state[6] * wy + state[9] * wx - state[7] * wz)
    rate[9] = 0.5 * (state[6] * wz + state[7] * wy - state[8] * wx)
    along_x = push * (turn[0, 0] * ball[0] + turn[1, 0] * ball[1] + turn[2, 0] * ball[2])
    along_z = push * (turn[0, 2] * ball[0] + turn[1, 2] * ball[1] + turn[2, 2] * ball[2])
    rate[10] = (state[14] - (c[J_Z] - c[J_Y]) * wy * wz + up * along_z) / c[J_X]
    rate[11] = (state[15] - (c[J_X] - c[J_Z]) * wz * wx) / c[J_Y]
    rate[12] = (state[16] - (c[J_Y] - c[J_X]) * wx * wy - up * along_x) / c[J_Z]
    pitch = math.asin(min(max(turn[1, 2], -1.0), 1.0))
    roll = math.atan2(turn[1, 0], turn[1, 1])
    goal_x, goal_z = -c[K_ANGLE] * (wanted[1] - pitch), c[K_ANGLE] * (wanted[0] - roll)
    lag = c[LAG] / (1.0 + c[LEAD])
    flying = 1.0 if wanted[3] > 0.0 else 0.0
    rate[13] = (wanted[3] - state[13]) / c[LAG]
    rate[14] = (flying * c[J_X] * c[K_RATE] * (goal_x - wx) - state[14]) / lag
    rate[15] = (flying * c[J_Y] * c[K_RATE] * (wanted[2] - wy) - state[15]) / lag
    rate[16] = (flying * c[J_Z] * c[K_RATE] * (goal_z - wz) - state[16]) / lag


@kernel
def step_vehicle(state: Floats, wanted: Floats, wind: Floats, c: Floats, step: float) -> None:
    """Advance one vehicle by one step of the classical Runge-Kutta method, in place.

    Parameters
    ----------
    state : (17,), written
        Place, speed (world), quaternion w x y z, spin (body), thrust (N), torque (body, N m).
    wanted : (4,)
        Roll and pitch, rad; yaw rate, rad/s; thrust, N.
    wind : (3,)
        Speed of the air, m/s.
    c : (12,)
        `constants`.
    step : float
        s.
    """
    turn = np.empty((3, 3))
    slopes = np.empty((4, SIZE))
    probe = np.empty(SIZE)
    _slope(state, wanted, wind, c, turn, slopes[0])
    for stage in range(1, 4):
        part = step if stage == 3 else 0.5 * step
        for k in range(SIZE):
            probe[k] = state[k] + part * slopes[stage - 1, k]
        _slope(probe, wanted, wind, c, turn, slopes[stage])
    for k in range(SIZE):
        state[k] += step / 6.0 * (slopes[0, k] + 2.0 * slopes[1, k] + 2.0 * slopes[2, k] + slopes[3, k])
    length = math.sqrt(state[6] ** 2 + state[7] ** 2 + state[8] ** 2 + state[9] ** 2)
    for k in range(6, 10):
        state[k] /= length


@kernel
def downwash(states: Floats, who: int, disc: float, density: float, wind: Floats) -> None:
    """Speed of the air at a vehicle from the wakes of those above it.

    Momentum theory: v = sqrt(T / (2 rho A)) in the disc; below it the wake is a Gaussian jet that widens by 0.1 a meter
    and meter and keeps its momentum.

    Parameters
    ----------
    states : (n, 17)
    who : int
        The vehicle.
    disc : float
        Area of its rotors together, m^2.
    density : float
        Of the air, kg/m^3; 0 for no wakes.
    wind : (3,), written
        m/s.
    """
    wind[:] = 0.0
    if density <= 0.0:
        return
    radius = math.sqrt(disc / math.pi)
    for other in range(states.shape[0]):
        below = states[who, 1] - states[other, 1]
        if other == who or not 0.0 < below < REACH:
            continue
        width = radius + 0.1 * below
        apart = (states[who, 0] - states[other, 0]) ** 2 + (states[who, 2] - states[other, 2]) ** 2
        speed = math.sqrt(max(states[other, 13], 0.0) / (2.0 * density * disc))
        wind[1] += 2.0 * speed * radius / width * math.exp(-apart / (width * width)) * min(below / radius, 1.0)
