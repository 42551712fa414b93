"""Kernels of dead reckoning: a vehicle's state, advanced under its sticks, kept for a second, and asked for.

A state is 16 numbers: time, roll, pitch, yaw, turning, lift, velocity (3), place (3), roll and pitch as far as the
motors have begun them, and their speeds: tilt follows its stick through a lag and a swing, ``L db/dt = stick - b``,
``T^2 theta'' = b - theta - 2 z T theta'``, and pulls with ``g tan(theta) / heft``. A model has the fields of
`EgoMotionParameters` in their order.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]

GRAVITY = 9.81  # m/s^2
STEP = 1.0 / 120.0  # s
SIZE = 16
TIME, ROLL, PITCH, YAW, TURNING, LIFT, VELOCITY, PLACE, BEGUN, SPEED = 0, 1, 2, 3, 4, 5, 6, 9, 12, 14
TILT_LAG, TILT_TIME, TILT_DAMPING, YAW_LAG, LIFT_LAG, DRAG_TIME, HEFT = 3, 4, 5, 6, 7, 8, 9


@kernel
def move(state: Floats, sticks: Floats, step: float, model: Floats, after: Floats) -> None:
    """Write the state one step later under sticks: roll, pitch (rad), turning (rad/s), lift (m/s^2)."""
    after[TIME] = state[TIME] + step
    begin, quick = step / (model[TILT_LAG] + step), 1.0 / model[TILT_TIME]
    for k in range(2):  # roll, pitch
        after[BEGUN + k] = state[BEGUN + k] + (sticks[k] - state[BEGUN + k]) * begin
        off = after[BEGUN + k] - state[ROLL + k] - step * state[SPEED + k]
        push = quick * (quick * off - 2.0 * model[TILT_DAMPING] * state[SPEED + k])
        slow = 1.0 + step * quick * (2.0 * model[TILT_DAMPING] + step * quick)  # implicit: stable for every model
        after[SPEED + k] = state[SPEED + k] + step * push / slow
        after[ROLL + k] = state[ROLL + k] + step * after[SPEED + k]
    after[TURNING] = state[TURNING] + (sticks[2] - state[TURNING]) * step / (model[YAW_LAG] + step)
    after[LIFT] = state[LIFT] + (sticks[3] - state[LIFT]) * step / (model[LIFT_LAG] + step)
    after[YAW] = state[YAW] + after[TURNING] * step
    pull = GRAVITY / model[HEFT]
    right, ahead = pull * math.tan(after[ROLL]), pull * math.tan(after[PITCH])
    c, s = math.cos(after[YAW]), math.sin(after[YAW])
    fade = max(1.0 - step / model[DRAG_TIME], 0.0)
    after[VELOCITY] = fade * state[VELOCITY] + (right * c + ahead * s) * step
    after[VELOCITY + 1] = fade * state[VELOCITY + 1] - after[LIFT] * step
    after[VELOCITY + 2] = fade * state[VELOCITY + 2] + (ahead * c - right * s) * step
    for k in range(3):
        after[PLACE + k] = state[PLACE + k] + after[VELOCITY + k] * step


@kernel
def catch_up(ring: Floats, count: int, sticks: Floats, until: float, model: Floats) -> int:
    """Append states up to a time to a ring of which `count` were ever written; returns how many now."""
    kept = ring.shape[0]
    if count > 0 and not abs(until - ring[(count - 1) % kept, TIME]) <= kept * STEP:
        count = 0  # nothing was sent for long: begin anew
    if count == 0:
        ring[0] = 0.0
        ring[0, TIME] = until
        return 1
    while ring[(count - 1) % kept, TIME] + STEP <= until:
        move(ring[(count - 1) % kept], sticks, STEP, model, ring[count % kept])
        count += 1
    return count


@kernel
def recall(ring: Floats, count: int, sticks: Floats, time: float, model: Floats, out: Floats) -> None:
    """Write the state at a time: between two of the ring, or after the last with the sticks as they are."""
    kept = ring.shape[0]
    out[:] = 0.0
    out[TIME] = time
    if count == 0:
        return
    first, last = max(count - kept, 0), count - 1
    if time <= ring[first % kept, TIME]:
        out[:] = ring[first % kept]
        out[TIME] = time
        return
    end = ring[last % kept, TIME]
    if time >= end:
        out[:] = ring[last % kept]
        time = min(time, end + kept * STEP)
        after = np.empty(SIZE)
        while out[TIME] < time:
            move(out, sticks, min(STEP, max(time - out[TIME], 1e-9)), model, after)
            out[:] = after
        return
    k = last
    while ring[(k - 1) % kept, TIME] > time:
        k -= 1
    one, two = ring[(k - 1) % kept], ring[k % kept]
    share = (time - one[TIME]) / (two[TIME] - one[TIME])
    for i in range(SIZE):
        out[i] = one[i] + share * (two[i] - one[i])


@kernel
def recall_all(ring: Floats, count: int, sticks: Floats, model: Floats, states: Floats) -> None:
    """Write the states at several times: each row of `states` begins with its time."""
    for k in range(states.shape[0]):
        recall(ring, count, sticks, states[k, TIME], model, states[k])


@kernel
def turn_of(state: Floats, turn: Floats) -> None:
    """Write the matrix from the body, and the camera, to the frame at rest: Ry(yaw) Rx(-pitch) Rz(roll), (3, 3)."""
    cy, sy = math.cos(state[YAW]), math.sin(state[YAW])
    cp, sp = math.cos(state[PITCH]), math.sin(state[PITCH])
    cr, sr = math.cos(state[ROLL]), math.sin(state[ROLL])
    turn[0, 0], turn[0, 1], turn[0, 2] = cy * cr - sy * sp * sr, -cy * sr - sy * sp * cr, sy * cp
    turn[1, 0], turn[1, 1], turn[1, 2] = cp * sr, cp * cr, sp
    turn[2, 0], turn[2, 1], turn[2, 2] = -sy * cr - cy * sp * sr, sy * sr - cy * sp * cr, cy * cp


def precompile() -> None:
    """Compile the kernels that Python calls, with the types that `EgoMotion` hands over."""
    ring, sticks, model = np.zeros((2, SIZE)), np.zeros(4), np.ones(HEFT + 1)
    states, turn = np.zeros((1, SIZE)), np.eye(3)
    catch_up(ring, 0, sticks, 0.0, model)
    recall(ring, 1, sticks, 0.0, model, states[0])
    recall_all(ring, 1, sticks, model, states)
    turn_of(states[0], turn)
