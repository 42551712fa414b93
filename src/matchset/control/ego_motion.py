"""Dead reckoning: the vehicle's own motion from the commands that were sent to it, `EgoMotion`.

The vehicle measures neither its tilt nor its speed. Its model (decision 050): a command acts after a delay. The tilt t
follows its stick s through a first-order lag of the motors and a damped second-order answer of the flight controller,

    L db/dt = s - b,    T^2 t'' = b - t - 2 z T t',

and accelerates the vehicle level, ``dv/dt = g tan(t) / m - v / D``, with the ratio m of moved mass to carried mass and
the drag time D (to the right that is over the cosine of the pitch). The yaw rate y' that is commanded is that of a
gyroscope, which turns with its vehicle: with the roll r and the pitch p the yaw turns by ``(y' - p' sin r) / (cos r cos
p)``, ten degrees in a third of a second where both change at once. The constant stick offset that holds the vehicle
still, its trim, is no tilt and is subtracted before. The position drifts; it serves to compare moments less than a
second apart.

A vehicle that is told speeds u (`EgoMotionParameters.speed_commands`) holds them by a controller of its own, which
tilts: its stick s is that of the acceleration ``(u - v) / T_v`` in the level frame that turns with its yaw, within its
largest tilt, and its lift ``(u - v) / T_r``; it makes up for drag by itself. Its speed does not drift away.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt

from matchset.control.sticks.ego_parameters import GRAVITY, AttitudeCommand, EgoMotionParameters, SpeedCommand
from matchset.numeric.copies import Copied
from matchset.numeric.jit import helper, kernel
from matchset.numeric.record import Block, fields, new_block, record_dtype, store

Floats = npt.NDArray[np.float64]

TINY = 1e-9  # s, shortest step: a loop over time ends
CAPACITY = 160  # format: states that are kept


class _Command:
    tilt: Annotated[Floats, (2,), "f8"]  # roll to the right, pitch forward, rad; or speeds along them, m/s
    yaw_rate: float
    lift: float  # m/s^2; or a rise, m/s


class _State:
    """A state in the level frame at rest: x right, y down, z forward of where it began."""

    time: float
    tilt: Annotated[Floats, (2,), "f8"]  # roll to the right, pitch forward, rad
    yaw: float  # to the right
    yaw_rate: float
    lift: float  # upward, m/s^2
    velocity: Annotated[Floats, (3,), "f8"]
    position: Annotated[Floats, (3,), "f8"]
    motor_tilt: Annotated[Floats, (2,), "f8"]  # b: the tilt that the motors have begun
    tilt_rate: Annotated[Floats, (2,), "f8"]


STATE = record_dtype(_State)
STATE_SIZE = STATE.itemsize // 8  # format: numbers of a state
TIME = 0  # format: a state begins with its time
# format: index of the first number of each field of a state
_INDEX = {name: field[1] // 8 for name, field in (STATE.fields or {}).items()}
_VELOCITY = slice(_INDEX["velocity"], _INDEX["velocity"] + 3)
_POSITION = slice(_INDEX["position"], _INDEX["position"] + 3)


class _Work:
    parameters: EgoMotionParameters
    command: _Command
    count: int  # states that were ever written to the ring
    ring: Annotated[Floats, (CAPACITY, STATE_SIZE), "f8"]
    scratch: Annotated[Floats, (STATE_SIZE,), "f8"]


WORK = record_dtype(_Work)


class EgoState:
    """The vehicle by dead reckoning, in a level frame at rest: x right, y down, z forward of where it began.

    Parameters
    ----------
    block : ndarray of float64
        The fields of `STATE`, for kernels; Python reads them by position, which is faster than by name.
    """

    def __init__(self, block: Block) -> None:
        self.block = block

    @property
    def roll(self) -> float:
        """Tilt to the right, rad."""
        return self.block.item(_INDEX["tilt"])

    @property
    def pitch(self) -> float:
        """Tilt forward, rad."""
        return self.block.item(_INDEX["tilt"] + 1)

    @property
    def yaw(self) -> float:
        """Rotation to the right since the beginning, rad."""
        return self.block.item(_INDEX["yaw"])

    @property
    def velocity(self) -> Floats:
        """Velocity, (3,), m/s."""
        return self.block[_VELOCITY]

    @property
    def position(self) -> Floats:
        """Position, (3,), m."""
        return self.block[_POSITION]

    @cached_property
    def rotation(self) -> Floats:
        """Matrix from the body, and its camera, to the frame at rest: Ry(yaw) Rx(-pitch) Rz(roll), (3, 3)."""
        rotation = np.empty((3, 3))
        write_rotation(self.block, rotation)
        return rotation


class EgoMotion(Copied):
    """Dead reckoning of one vehicle. The constructor compiles all kernels.

    Parameters
    ----------
    parameters : EgoMotionParameters, optional

    Attributes
    ----------
    delay : float
        Time from sending a command to its first effect, s: that of the parameters, until somebody knows better.
    """

    def __init__(self, parameters: EgoMotionParameters | None = None) -> None:
        self.parameters = parameters or EgoMotionParameters()
        self.delay = self.parameters.delay
        self._block = new_block(WORK)
        store(fields(self._block, WORK).parameters, self.parameters)
        self._make_derived()

    def _derive(self) -> None:
        start = WORK.fields["command"][1] // 8 if WORK.fields else 0
        self._command = self._block[start : start + len(AttitudeCommand._fields)]
        precompile()

    def update(self, command: AttitudeCommand | SpeedCommand, now: float) -> None:
        """Note a command that was sent, and when, s; later than before."""
        extend(self._block, now)
        self._command[:] = command

    def at(self, time: float) -> EgoState:
        """State at a time, from 1.2 s back to `delay` from now; later: the last command goes on.

        Parameters
        ----------
        time : float
            s.
        """
        state = np.empty(STATE_SIZE)
        interpolate_one(self._block, time - self.delay, state)
        return EgoState(state)

    def at_times(self, times: Sequence[float]) -> list[EgoState]:
        """States at several times, s; see `at`."""
        states = np.empty((len(times), STATE_SIZE))
        self.write_states(np.array(times, dtype=np.float64), states)
        return [EgoState(block) for block in states]

    def write_states(self, times: Floats, states: Floats) -> None:
        """Write the states at several times as rows of one array, for kernels; see `at`.

        Parameters
        ----------
        times : ndarray of shape (n,), float64
            s.
        states : ndarray of shape (n, STATE_SIZE), float64, written
            The fields of `STATE` in each row.
        """
        interpolate_all(self._block, times, self.delay, states)

    def add_velocity(self, velocity: Floats, time: float) -> None:
        """Change the velocity from a time on; where the vehicle was then stays the same.

        Parameters
        ----------
        velocity : ndarray of shape (3,), float64
            In the frame at rest, m/s.
        time : float
            s, as in `at`.
        """
        change_velocity(self._block, velocity, time - self.delay)


@helper
def tilts_of_speeds(work: Any, state: Any) -> tuple[float, float]:
    """Return roll and pitch by which a vehicle that is told speeds goes over to them, rad."""
    model, told, c, s = work.parameters, work.command.tilt, math.cos(state.yaw), math.sin(state.yaw)
    right, forward = state.velocity[0] * c - state.velocity[2] * s, state.velocity[0] * s + state.velocity[2] * c
    gain, most = model.effective_mass_ratio / (GRAVITY * model.speed_time), model.full_tilt
    roll, pitch = math.atan(gain * (told[0] - right)), math.atan(gain * (told[1] - forward))
    return min(max(roll, -most), most), min(max(pitch, -most), most)


@helper
def propagate(work: Any, before: Block, step: float, after: Block) -> None:
    """Write the state one step later under the last command.

    The tilt's equation is integrated implicitly: stable for all parameters.
    """
    old, new = before.view(STATE)[0], after.view(STATE)[0]
    model, command = work.parameters, work.command
    new.time = old.time + step
    begin, frequency = step / (model.tilt_lag + step), 1.0 / model.tilt_time
    told, lift, drag = (command.tilt[0], command.tilt[1]), command.lift, max(1.0 - step / model.drag_time, 0.0)
    if model.speed_commands != 0:
        told, lift, drag = tilts_of_speeds(work, old), (command.lift + old.velocity[1]) / model.rise_time, 1.0
    for k in range(2):  # roll, pitch
        new.motor_tilt[k] = old.motor_tilt[k] + (told[k] - old.motor_tilt[k]) * begin
        error = new.motor_tilt[k] - old.tilt[k] - step * old.tilt_rate[k]
        acceleration = frequency * (frequency * error - 2.0 * model.tilt_damping * old.tilt_rate[k])
        implicit = 1.0 + step * frequency * (2.0 * model.tilt_damping + step * frequency)
        new.tilt_rate[k] = old.tilt_rate[k] + step * acceleration / implicit
        new.tilt[k] = old.tilt[k] + step * new.tilt_rate[k]
    new.yaw_rate = old.yaw_rate + (command.yaw_rate - old.yaw_rate) * step / (model.yaw_lag + step)
    new.lift = old.lift + (lift - old.lift) * step / (model.lift_lag + step)
    turned = new.yaw_rate - math.sin(new.tilt[0]) * new.tilt_rate[1]
    new.yaw = old.yaw + step * turned / (math.cos(new.tilt[0]) * math.cos(new.tilt[1]))
    gravity = GRAVITY / model.effective_mass_ratio
    right, forward = gravity * math.tan(new.tilt[0]) / math.cos(new.tilt[1]), gravity * math.tan(new.tilt[1])
    c, s = math.cos(new.yaw), math.sin(new.yaw)
    new.velocity[0] = drag * old.velocity[0] + (right * c + forward * s) * step
    new.velocity[1] = drag * old.velocity[1] - new.lift * step
    new.velocity[2] = drag * old.velocity[2] + (forward * c - right * s) * step
    for k in range(3):
        new.position[k] = old.position[k] + new.velocity[k] * step


@kernel(refcount=False)
def extend(block: Block, until: float) -> None:
    """Append states up to a time to the ring; after a long pause begin anew."""
    work = block.view(WORK)[0]
    step = work.parameters.integration_step
    if work.count > 0 and not abs(until - work.ring[(work.count - 1) % CAPACITY, TIME]) <= CAPACITY * step:
        work.count = 0
    if work.count == 0:
        work.ring[0, :] = 0.0
        work.ring[0, TIME] = until
        work.count = 1
        return
    while work.ring[(work.count - 1) % CAPACITY, TIME] + step <= until:
        propagate(work, work.ring[(work.count - 1) % CAPACITY], step, work.ring[work.count % CAPACITY])
        work.count += 1


@helper
def copy_state(source: Block, destination: Block) -> None:
    """Copy a state."""
    for k in range(STATE_SIZE):
        destination[k] = source[k]


@helper
def extrapolate(work: Any, state: Block, time: float) -> None:
    """Take a state forward to a time under the last command, by at most the length of the ring."""
    step = work.parameters.integration_step
    time = min(time, state[TIME] + CAPACITY * step)
    while state[TIME] < time:
        propagate(work, state, min(step, max(time - state[TIME], TINY)), work.scratch)
        copy_state(work.scratch, state)


@helper
def interpolate(work: Any, time: float, state: Block) -> None:
    """Write the state at a time: between two of the ring, or extrapolated from the last."""
    state[:] = 0.0
    state[TIME] = time
    if work.count == 0:
        return
    first, last = max(work.count - CAPACITY, 0), work.count - 1
    if time <= work.ring[first % CAPACITY, TIME]:
        copy_state(work.ring[first % CAPACITY], state)
        state[TIME] = time
        return
    if time >= work.ring[last % CAPACITY, TIME]:
        copy_state(work.ring[last % CAPACITY], state)
        extrapolate(work, state, time)
        return
    behind = work.ring[last % CAPACITY, TIME] - time
    k = max(last - int(behind / work.parameters.integration_step) + 1, first + 1) if behind > 0.0 else last
    k = min(k, last)
    while work.ring[(k - 1) % CAPACITY, TIME] > time:
        k -= 1
    before, after = work.ring[(k - 1) % CAPACITY], work.ring[k % CAPACITY]
    share = (time - before[TIME]) / (after[TIME] - before[TIME])
    for i in range(STATE_SIZE):
        state[i] = before[i] + share * (after[i] - before[i])


@kernel(refcount=False)
def interpolate_one(block: Block, time: float, state: Block) -> None:
    """Write the state at a time."""
    interpolate(block.view(WORK)[0], time, state)


@kernel(refcount=False)
def interpolate_all(block: Block, times: Floats, delay: float, states: Floats) -> None:
    """Write the states at several times, less a delay."""
    work = block.view(WORK)[0]
    for k in range(times.shape[0]):
        interpolate(work, times[k] - delay, states[k])


@kernel(refcount=False)
def change_velocity(block: Block, velocity: Floats, time: float) -> None:
    """Add a velocity to the states after a time, and to the last one, from which others are extrapolated."""
    work = block.view(WORK)[0]
    for k in range(max(work.count - CAPACITY, 0), work.count):
        state = work.ring[k % CAPACITY].view(STATE)[0]
        if state.time > time or k == work.count - 1:
            for axis in range(3):
                state.velocity[axis] += velocity[axis]
                state.position[axis] += velocity[axis] * (state.time - time)


@kernel(refcount=False)
def write_rotation(block: Block, rotation: Floats) -> None:
    """Write the matrix from the body, and the camera, to the frame at rest: Ry(yaw) Rx(-pitch) Rz(roll), (3, 3)."""
    state = block.view(STATE)[0]
    cy, sy = math.cos(state.yaw), math.sin(state.yaw)
    cp, sp = math.cos(state.tilt[1]), math.sin(state.tilt[1])
    cr, sr = math.cos(state.tilt[0]), math.sin(state.tilt[0])
    rotation[0, 0], rotation[0, 1], rotation[0, 2] = cy * cr - sy * sp * sr, -cy * sr - sy * sp * cr, sy * cp
    rotation[1, 0], rotation[1, 1], rotation[1, 2] = cp * sr, cp * cr, sp
    rotation[2, 0], rotation[2, 1], rotation[2, 2] = -sy * cr - cy * sp * sr, sy * sr - cy * sp * cr, cy * cp


def precompile() -> None:
    """Compile the kernels that Python calls."""
    block, states = new_block(WORK), np.zeros((1, STATE_SIZE))
    extend(block, 0.0)
    interpolate_one(block, 0.0, states[0])
    interpolate_all(block, np.zeros(1), 0.0, states)
    change_velocity(block, np.zeros(3), 0.0)
    write_rotation(states[0], np.empty((3, 3)))
