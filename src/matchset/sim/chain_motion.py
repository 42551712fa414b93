"""Kernels that let time pass in a `matchset.sim.world.World`: many steps in one call, without Python's lock."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel
from matchset.sim.quadrotor import PLACE, SPEED, TURN, downwash, rotation, step_vehicle
from matchset.sim.rope import hanging, swing, yaw_of

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

# places of what the kernels need of a chain beside `matchset.sim.quadrotor.constants`
STEP, TILT, YAW_RATE, MOST, SAG, ENDURANCE, FAILSAFE, FADE, KICK, DISC, DENSITY, WEIGHT = range(12)
LENGTH, DAMPING, BALL_HEIGHT, BALL_RADIUS, WIDE, NEAR, FAR, FLOOR, FRAME = range(12, 21)
NOTHING, HIT_FLOOR, HIT_CEILING, HIT_WALL, HIT_VEHICLE = range(5)
"""What happened; HIT_VEHICLE + k: hit vehicle k."""


@kernel
def fly(
    states: Floats,
    arm: Floats,
    velocity: Floats,
    anchor: Floats,
    wander: Floats,
    kicks: Floats,
    sticks: Floats,
    heard: Ints,
    held: Flags,
    ended: Flags,
    bias: Floats,
    age: Floats,
    c: Floats,
    e: Floats,
    waves: Floats,
    past: Floats,
    past_arms: Floats,
    step: int,
    until: int,
    look: int,
    hits: Ints,
) -> int:
    """Let steps pass until one, or until someone crashes; returns how many have passed in all.

    Parameters
    ----------
    states : (n, 17), written
        The last one hangs.
    arm, velocity, anchor : (3,)
        Of the rope; the first two are written.
    wander : (n, 2), written
        How far the levels are off, beside their bias, rad.
    kicks : (until - step, n, 2)
        Normal deviates.
    sticks : (n, 4)
        Roll, pitch, yaw and throttle as last heard, at steps `heard`, (n,).
    held, ended : (n,)
        Who is in a hand, written, and who crashed.
    bias, age : (n, 2), (n,)
        Of the levels, rad, and of the batteries, s.
    c : (12,)
        `matchset.sim.quadrotor.constants`.
    e : (21,)
        Of the chain, see above.
    waves : (5,)
        See `matchset.sim.rope.yaw_of`.
    past, past_arms : (kept, n, 17), (kept, 3), written
        States and the rope's arm at each of the last steps, step k at k mod kept.
    step, until : int
    look : int
        Steps from one look for crashes to the next.
    hits : (n,), written
        What happened to whom in the last step.
    """
    last, kept, begin = states.shape[0] - 1, past.shape[0], step
    goal, wind = np.zeros(4), np.zeros(3)
    places, turns, balls = np.empty((last + 1, 3)), np.empty((last + 1, 3, 3)), np.empty((last + 1, 3))
    while step < until:
        swing(arm, velocity, e[LENGTH], e[DAMPING], e[STEP])
        kick = kicks[step - begin]
        step += 1
        time = step * e[STEP]
        for who in range(last + 1):
            for k in range(2):
                wander[who, k] += -e[FADE] * wander[who, k] + e[KICK] * kick[who, k]
        for who in range(last):
            wanted(sticks[who], (step - heard[who]) * e[STEP], age[who] + time, bias[who], wander[who], e, goal)
            held[who] = held[who] and goal[3] < 0.5 * e[WEIGHT]
            if not (ended[who] or held[who]):
                downwash(states, who, e[DISC], e[DENSITY], wind)
                step_vehicle(states[who], goal, wind, c, e[STEP])
        yaw = yaw_of(waves, time)
        hung = states[last]
        for k in range(3):
            hung[PLACE + k], hung[SPEED + k] = anchor[k] + arm[k], velocity[k]
        hung[TURN], hung[TURN + 2] = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
        past[step % kept] = states
        past_arms[step % kept] = arm
        if step % look == 0:
            seen(states, arm, yaw, e[LENGTH], e[BALL_HEIGHT], places, turns, balls)
            if find_hits(places, balls, ended, e, hits):
                break
    return step


@kernel
def wanted(sticks: Floats, silent: float, used: float, bias: Floats, wander: Floats, e: Floats, goal: Floats) -> None:
    """Write what a vehicle's electronics make of sticks heard `silent` s ago, the battery in use for `used` s.

    `goal` is roll and pitch (rad), yaw rate (rad/s) and thrust (N).
    """
    heard = 0.0 if silent > e[FAILSAFE] else 1.0
    most = e[MOST] * (1.0 - e[SAG] * min(used / e[ENDURANCE], 1.0))
    goal[0] = e[TILT] * (heard * sticks[0]) + bias[0] + wander[0]
    goal[1] = e[TILT] * (heard * sticks[1]) + bias[1] + wander[1]
    goal[2] = e[YAW_RATE] * (heard * sticks[2])
    goal[3] = most * (heard * sticks[3])


@kernel
def seen(
    states: Floats,
    arm: Floats,
    yaw: float,
    length: float,
    ball_height: float,
    places: Floats,
    turns: Floats,
    balls: Floats,
) -> None:
    """Write where everyone is, how they are turned and where their balls are: (n, 3), (n, 3, 3), (n, 3)."""
    last = states.shape[0] - 1
    for who in range(last + 1):
        if who < last:
            rotation(states[who], turns[who])
        else:
            hanging(arm, yaw, length, turns[who])
        for k in range(3):
            places[who, k] = states[who, PLACE + k]
            balls[who, k] = places[who, k] - turns[who, k, 1] * ball_height


@kernel
def find_hits(places: Floats, balls: Floats, ended: Flags, e: Floats, hits: Ints) -> bool:
    """Write what each vehicle but the last hits; whether any does that has not crashed."""
    ball, found = e[BALL_RADIUS], False
    for who in range(places.shape[0] - 1):
        x, y, z = places[who, 0], places[who, 1], places[who, 2]
        hits[who] = NOTHING
        if ended[who]:
            continue
        if y > e[FLOOR] - 0.03:
            hits[who] = HIT_FLOOR
        elif balls[who, 1] < -e[FLOOR] + ball:
            hits[who] = HIT_CEILING
        elif abs(x) > e[WIDE] - ball or not e[NEAR] + ball < z < e[FAR] - ball:
            hits[who] = HIT_WALL
        for other in range(places.shape[0]):
            if other != who and _touch(places, balls, who, other, ball, e[FRAME]):
                hits[who] = HIT_VEHICLE + other
        found = found or hits[who] != NOTHING
    return found


@kernel
def _touch(places: Floats, balls: Floats, one: int, two: int, ball: float, frame: float) -> bool:
    """Whether two vehicles touch: their balls, or a frame, which fills a sphere around its place, anything."""
    return (
        _apart(balls[one], balls[two]) < ball + ball
        or _apart(balls[one], places[two]) < ball + frame
        or _apart(places[one], balls[two]) < frame + ball
        or _apart(places[one], places[two]) < frame + frame
    )


@kernel
def _apart(a: Floats, b: Floats) -> float:
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)
