"""A simulated vehicle that is told speeds, and holds them by a controller of its own; `aim_at_speeds`.

The rigid body is that of the toy. Each step its electronics compare its true speed v, in the level frame that turns
with its yaw, with the speed u that the sticks tell, and ask for the acceleration

    a = (u - v) / T + i,    i' = (r - v) / (T T_i),    r' = (u - r) / T,

so that v goes over to u with the time constant T, and what pushes it aside, wind or a level that is off, is made up for
within T_i. Tilt and thrust follow from a. Sticks of a throttle of zero, or none for too long, land it: it stands level
and sinks.
"""

import math
from typing import Annotated, Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import HOLD
from matchset.numeric.arguments import require_not_negative, require_positive
from matchset.numeric.jit import kernel
from matchset.sim.quadrotor import GRAVITY
from matchset.sim.vehicle import VehicleParameters

Floats = npt.NDArray[np.float64]

LETS_GO = 0.45  # format: throttle at which the hand that holds it lets go


class SpeedControlParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The controller on board of a vehicle that is told speeds.

    Parameters
    ----------
    used : bool
        Whether the vehicles are told speeds; otherwise angles and thrust.
    full_speed, full_rise : float
        Level speed and rise at full stick, m/s. Estimate: a Tello in its slow mode.
    speed_time, rise_time : float
        Time constants T, s. More is a slower vehicle. Estimate: such vehicles take half a second.
    hold_time : float
        T_i, in which a push is made up for, s. Less holds better in wind, and overshoots. Chosen by hand.
    most_push : float
        Largest acceleration i, m/s^2. Chosen by hand: a level that is 15 degrees off.
    landing_speed : float
        At which it sinks when it lands, m/s. Estimate.
    """

    used: bool = False
    full_speed: float = 1.0
    full_rise: float = 1.0
    speed_time: float = 0.4
    rise_time: float = 0.4
    hold_time: float = 1.0
    most_push: float = 2.5
    landing_speed: float = 0.4

    def __post_init__(self) -> None:
        names = [name for name in self.__struct_fields__ if name not in ("used", "landing_speed")]
        require_positive(self, names)
        require_not_negative(self, ("landing_speed",))


class SpeedControl:
    """Layout of that, and of what it needs to know of its vehicle."""

    used: bool
    full_speed: float
    full_rise: float
    speed_time: float
    rise_time: float
    hold_time: float
    most_push: float
    landing_speed: float
    pull: float  # m/s^2 level that a tilt of 45 degrees gives: g over moved to carried mass
    weight: float  # N
    moved_mass: float  # kg
    time_step: float  # s


class OnBoard:
    """Layout of the state of a controller: right, forward, up."""

    speed: Annotated[Floats, (3,), "f8"]  # r: what it should have by now, m/s
    push: Annotated[Floats, (3,), "f8"]  # i, m/s^2


def store_speed_control(
    record: Any, parameters: SpeedControlParameters, vehicle: VehicleParameters, time_step: float
) -> None:
    """Write `SpeedControl` of a vehicle.

    Parameters
    ----------
    record : record of `SpeedControl`, written
    parameters : SpeedControlParameters
    vehicle : VehicleParameters
        As it is.
    time_step : float
        s.
    """
    record.time_step = time_step
    for name in parameters.__struct_fields__:
        setattr(record, name, getattr(parameters, name))
    record.weight, record.moved_mass = vehicle.mass * GRAVITY, vehicle.moved_mass
    record.pull = vehicle.mass * GRAVITY / vehicle.moved_mass


@kernel(refcount=False)
def aim_at_speeds(like: Any, own: Any, state: Any, sticks: Floats, landing: bool, aim: Any) -> None:
    """Write the tilt and the thrust that hold the speeds of the sticks, and go on by a step.

    Parameters
    ----------
    like : record of `SpeedControl`
    own : record of `OnBoard`, written
    state : record of `VehicleState`
    sticks : (4,)
        Roll, pitch, yaw, throttle.
    landing : bool
        Whether it lands instead.
    aim : record of `Setpoint`, written
        Its roll and pitch are limited to what they were before: the largest tilt, rad; and its thrust, N.
    """
    w, x, y, z = state.quaternion[0], state.quaternion[1], state.quaternion[2], state.quaternion[3]
    yaw = math.atan2(2.0 * (x * z + w * y), 1.0 - 2.0 * (x * x + y * y))
    c, s = math.cos(yaw), math.sin(yaw)
    speeds = (
        state.velocity[0] * c - state.velocity[2] * s,
        state.velocity[0] * s + state.velocity[2] * c,
        -state.velocity[1],
    )
    told = (like.full_speed * sticks[0], like.full_speed * sticks[1], like.full_rise * (sticks[3] - HOLD) / HOLD)
    if landing:
        told = (0.0, 0.0, -like.landing_speed)
    times = (like.speed_time, like.speed_time, like.rise_time)
    right = hold(like, own, 0, (told[0], speeds[0], times[0]))
    forward = hold(like, own, 1, (told[1], speeds[1], times[1]))
    up = hold(like, own, 2, (told[2], speeds[2], times[2]))
    aim.roll = min(max(math.atan(right / like.pull), -aim.roll), aim.roll)
    aim.pitch = min(max(math.atan(forward / like.pull), -aim.pitch), aim.pitch)
    thrust = (like.weight + like.moved_mass * up) / (math.cos(aim.roll) * math.cos(aim.pitch))
    aim.thrust = min(max(thrust, 0.2 * like.weight), aim.thrust)


@kernel(refcount=False)
def hold(like: Any, own: Any, axis: int, of: tuple[float, float, float]) -> float:
    """Return the acceleration of an axis, m/s^2, from what it is told, its speed and its time; go on by a step."""
    told, speed, time = of
    step = like.time_step
    asked: float = (told - speed) / time + own.push[axis]
    push = own.push[axis] + (own.speed[axis] - speed) * step / (time * like.hold_time)
    own.push[axis] = min(max(push, -like.most_push), like.most_push)
    own.speed[axis] += (told - own.speed[axis]) * step / time
    return asked
