"""Kernels that let time pass in a `matchset.sim.world.World`: many steps in one call, without Python's lock.

What moves besides the vehicles' states, and what they hear, is one block of floats whose fields `ChainState` names.
"""

import math
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, record_dtype
from matchset.sim.on_board.speed_control import LETS_GO, OnBoard, SpeedControl, aim_at_speeds
from matchset.sim.quadrotor import STATE, Setpoint, VehicleConstants, Wake, advance, rotation_matrix, write_downwash
from matchset.sim.rope import RopeState, hanging_rotation, rope_yaw, swing

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

MOST_VEHICLES = 20  # format: capacity of a block
ON_BOARD = record_dtype(OnBoard)
ON_BOARD_SIZE = ON_BOARD.itemsize // 8  # format: its numbers
# format: what happened to a vehicle; HIT_VEHICLE + k: it hit vehicle k
NOTHING, HIT_FLOOR, HIT_CEILING, HIT_WALL, HIT_VEHICLE = range(5)


class ElectronicsConstants:
    """Layout of what a vehicle's electronics, battery and level sensor are like."""

    full_tilt: float  # rad, at full stick
    full_yaw_rate: float  # rad/s
    full_thrust: float  # N, with a full battery
    battery_sag: float  # share of the thrust lost over a flight
    flight_time: float  # s
    failsafe: float  # s without a command after which the motors stop
    wander_decay: float  # share of the level's wander that is forgotten in a step
    wander_noise: float  # rad, standard deviation of what is added to it in a step
    release_thrust: float  # N at which the hand that holds a vehicle lets go
    battery_loss: float  # 1/s, share of the thrust lost besides battery_sag
    yaw_trim: float  # rad/s, with the stick in the middle
    thrust_exponent: float  # thrust goes with this power of the throttle
    hover_throttle: float  # at which thrust is what it is with an exponent of 1


class Wind:
    """Layout of how the air moves besides the wakes."""

    steady: Annotated[Floats, (3,), "f8"]  # m/s
    gust: Annotated[Floats, (MOST_VEHICLES, 3), "f8"]  # at each vehicle, now, m/s
    keep: float  # share of the gusts that is left after a step
    noise: float  # m/s, standard deviation of what is added to them in a step


class RoomConstants:
    """Layout of what a vehicle can hit."""

    half_width: float  # m from the middle to the walls at the sides
    near: float  # m, z of the wall behind the chain
    far: float  # m, z of the wall before it
    floor: float  # m below the origin; the ceiling is as far above
    clearance: float  # m above the floor at which a center of mass counts as on it
    frame_radius: float  # m
    ball_radius: float  # m
    ball_height: float  # m above the center of mass


class ChainState:
    """Layout of a chain: time, what is constant, what is heard and what moves besides the vehicles' states."""

    step: int  # steps since the beginning
    time_step: float  # s
    check_period: int  # steps from one test for crashes to the next
    vehicle: VehicleConstants
    electronics: ElectronicsConstants
    speed_control: SpeedControl
    wake: Wake
    air: Wind
    room: RoomConstants
    rope: RopeState
    setpoint: Setpoint  # of the vehicle that is advanced
    wind: Annotated[Floats, (3,), "f8"]  # at the vehicle that is advanced, m/s
    sticks: Annotated[Floats, (MOST_VEHICLES, 4), "f8"]  # roll, pitch, yaw, throttle as last heard
    heard: Annotated[Ints, (MOST_VEHICLES,), "i8"]  # step at which that was
    held: Annotated[Ints, (MOST_VEHICLES,), "i8"]  # 1 while a vehicle is in a hand
    crashed: Annotated[Ints, (MOST_VEHICLES,), "i8"]  # 1 after a crash
    hits: Annotated[Ints, (MOST_VEHICLES,), "i8"]  # what was hit in the last test
    level_bias: Annotated[Floats, (MOST_VEHICLES, 2), "f8"]  # of roll and pitch, rad
    level_wander: Annotated[Floats, (MOST_VEHICLES, 2), "f8"]  # rad
    battery_age: Annotated[Floats, (MOST_VEHICLES,), "f8"]  # in use at the beginning, s
    on_board: Annotated[Floats, (MOST_VEHICLES, ON_BOARD_SIZE), "f8"]  # `OnBoard` of those that are told speeds


CHAIN = record_dtype(ChainState)


@kernel
def fly(chain: Block, states: Floats, kicks: Floats, past: Floats, past_offsets: Floats, until: int) -> int:
    """Let steps pass until one, or until someone crashes.

    Parameters
    ----------
    chain : block, written
        `ChainState`.
    states : (n, 17), written
        `matchset.sim.quadrotor.VehicleState` of each; the last one hangs.
    kicks : (until - step, n, 2) or (until - step, n, 5)
        Normal deviates that drive the wander of the levels, and the gusts if there are any.
    past, past_offsets : (kept, n, 17), (kept, 3), written
        States, and the offset of the rope, at each of the last steps: step k at k mod kept.
    until : int

    Returns
    -------
    int
        Steps that have passed since the beginning.
    """
    now = chain.view(CHAIN)[0]
    last, kept, begin = states.shape[0] - 1, past.shape[0], now.step
    positions, rotations, balls = np.empty((last + 1, 3)), np.empty((last + 1, 3, 3)), np.empty((last + 1, 3))
    while now.step < until:
        swing(now.rope, now.time_step)
        _wander(now, kicks[now.step - begin])
        _gust(now.air, kicks[now.step - begin])
        now.step += 1
        time = now.step * now.time_step
        for who in range(last):
            _aim(now, who, time)
            if now.speed_control.used != 0:
                _hold_speeds(now, states[who], who)
            if now.held[who] != 0 and not now.setpoint.thrust < now.electronics.release_thrust:
                now.held[who] = 0
            if now.crashed[who] == 0 and now.held[who] == 0:
                write_downwash(states, who, now.wake, now.wind)
                for k in range(3):
                    now.wind[k] += now.air.steady[k] + now.air.gust[who, k]
                advance(states[who], now.setpoint, now.wind, now.vehicle, now.time_step)
        _hang(now, states[last], time)
        past[now.step % kept] = states
        past_offsets[now.step % kept] = now.rope.offset
        if now.step % now.check_period == 0:
            _write_poses(now, states, now.rope.offset, time, (positions, rotations, balls))
            if _find_hits(now, positions, balls):
                break
    return int(now.step)


@kernel
def write_poses(
    chain: Block, states: Floats, offset: Floats, time: float, poses: tuple[Floats, Floats, Floats]
) -> None:
    """Write positions and rotations of all vehicles at a time, s, from their states and the rope's offset then.

    `poses` are positions, rotations and centers of the balls, (n, 3), (n, 3, 3), (n, 3).
    """
    _write_poses(chain.view(CHAIN)[0], states, offset, time, poses)


@kernel
def _write_poses(now: Any, states: Floats, offset: Floats, time: float, poses: tuple[Floats, Floats, Floats]) -> None:
    positions, rotations, balls = poses
    last = states.shape[0] - 1
    for who in range(last + 1):
        if who < last:
            rotation_matrix(states[who], rotations[who])
        else:
            hanging_rotation(offset, rope_yaw(now.rope, time), now.rope.length, rotations[who])
        position = states[who].view(STATE)[0].position
        for k in range(3):
            positions[who, k] = position[k]
            balls[who, k] = positions[who, k] - rotations[who, k, 1] * now.room.ball_height


@kernel(refcount=False)
def _wander(now: Any, kick: Floats) -> None:
    """Let the levels of all vehicles wander by a step: a first-order Gauss-Markov process."""
    decay, noise = now.electronics.wander_decay, now.electronics.wander_noise
    for who in range(kick.shape[0]):
        for k in range(2):
            now.level_wander[who, k] += -decay * now.level_wander[who, k] + noise * kick[who, k]


@kernel(refcount=False)
def _gust(air: Any, kick: Floats) -> None:
    """Let the gusts change by a step: a first-order Gauss-Markov process along each axis."""
    for who in range(kick.shape[0]):
        for k in range(kick.shape[1] - 2):
            air.gust[who, k] = air.keep * air.gust[who, k] + air.noise * kick[who, 2 + k]


@kernel(refcount=False)
def _aim(now: Any, who: int, time: float) -> None:
    """Write the setpoint that a vehicle's electronics make of the sticks last heard, at a time, s."""
    like, sticks, setpoint = now.electronics, now.sticks[who], now.setpoint
    silent, used = (now.step - now.heard[who]) * now.time_step, now.battery_age[who] + time
    heard = 0.0 if silent > like.failsafe else 1.0
    left = 1.0 - like.battery_sag * min(used / like.flight_time, 1.0) - like.battery_loss * time
    most, throttle = like.full_thrust * max(left, 0.0), heard * sticks[3]
    if like.thrust_exponent != 1.0:
        throttle = like.hover_throttle * (throttle / like.hover_throttle) ** like.thrust_exponent
    bias, wander = now.level_bias[who], now.level_wander[who]
    setpoint.roll = like.full_tilt * (heard * sticks[0]) + bias[0] + wander[0]
    setpoint.pitch = like.full_tilt * (heard * sticks[1]) + bias[1] + wander[1]
    setpoint.yaw_rate = like.full_yaw_rate * (heard * sticks[2]) + like.yaw_trim
    setpoint.thrust = most * throttle


@kernel(refcount=False)
def _hold_speeds(now: Any, state: Block, who: int) -> None:
    """Write the setpoint of a vehicle that holds the speeds of its sticks, after that of the yaw: see `_aim`."""
    like, sticks, aim = now.electronics, now.sticks[who], now.setpoint
    silent = (now.step - now.heard[who]) * now.time_step > like.failsafe
    if now.held[who] != 0 and (silent or sticks[3] < LETS_GO):
        aim.thrust = 0.0
        return
    time = now.step * now.time_step
    left = (
        1.0 - like.battery_sag * min((now.battery_age[who] + time) / like.flight_time, 1.0) - like.battery_loss * time
    )
    aim.roll, aim.pitch, aim.thrust = like.full_tilt, like.full_tilt, like.full_thrust * max(left, 0.0)
    landing = silent or not sticks[3] > 0.0
    own = now.on_board[who].view(ON_BOARD)[0]
    aim_at_speeds(now.speed_control, own, state.view(STATE)[0], sticks, landing, aim)
    aim.roll += now.level_bias[who, 0] + now.level_wander[who, 0]
    aim.pitch += now.level_bias[who, 1] + now.level_wander[who, 1]


@kernel(refcount=False)
def _hang(now: Any, state: Block, time: float) -> None:
    """Write the state of the vehicle on the rope."""
    hung, yaw = state.view(STATE)[0], rope_yaw(now.rope, time)
    for k in range(3):
        hung.position[k], hung.velocity[k] = now.rope.anchor[k] + now.rope.offset[k], now.rope.velocity[k]
    hung.quaternion[0], hung.quaternion[2] = math.cos(0.5 * yaw), math.sin(0.5 * yaw)


@kernel(refcount=False)
def _find_hits(now: Any, positions: Floats, balls: Floats) -> bool:
    """Write what each vehicle but the last hits; whether any does that has not crashed."""
    found = False
    for who in range(positions.shape[0] - 1):
        now.hits[who] = NOTHING
        if now.crashed[who] != 0:
            continue
        now.hits[who] = _hit_room(now.room, positions[who], balls[who])
        for other in range(positions.shape[0]):
            if other != who and _touch(now.room, positions, balls, who, other):
                now.hits[who] = HIT_VEHICLE + other
        found = found or bool(now.hits[who] != NOTHING)
    return found


@kernel(refcount=False)
def _hit_room(room: Any, position: Floats, ball: Floats) -> int:
    """Floor, ceiling, wall or nothing."""
    radius = room.ball_radius
    if position[1] > room.floor - room.clearance:
        return HIT_FLOOR
    if ball[1] < -room.floor + radius:
        return HIT_CEILING
    if abs(position[0]) > room.half_width - radius or not room.near + radius < position[2] < room.far - radius:
        return HIT_WALL
    return NOTHING


@kernel(refcount=False)
def _touch(room: Any, positions: Floats, balls: Floats, one: int, two: int) -> bool:
    """Whether two vehicles touch: their balls, or a frame, which fills a sphere around its position, anything."""
    ball, frame = room.ball_radius, room.frame_radius
    touch: bool = (
        _distance(balls[one], balls[two]) < ball + ball
        or _distance(balls[one], positions[two]) < ball + frame
        or _distance(positions[one], balls[two]) < frame + ball
        or _distance(positions[one], positions[two]) < frame + frame
    )
    return touch


@kernel(refcount=False)
def _distance(a: Floats, b: Floats) -> float:
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)
