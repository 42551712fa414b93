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
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.parameter_checks import require_positive
from matchset.numeric.copies import Copied
from matchset.numeric.jit import helper, kernel
from matchset.numeric.record import Block, fields, new_block, record_dtype, store

Floats = npt.NDArray[np.float64]

GRAVITY = 9.81  # theorem: standard gravity, m/s^2 (ISO 80000-3: 9.80665), rounded
TINY = 1e-9  # s, shortest step: a loop over time ends
CAPACITY = 160  # format: states that are kept


class EgoMotionParameters(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    rename={"effective_mass_ratio": "heft"},
):
    """Model of the vehicle's answer to its sticks.

    Defaults describe the simulated toy (`matchset/sim/vehicle.toml`); a test compares the two. Measure those of another
    vehicle from its answer to a step of the stick.

    Parameters
    ----------
    full_tilt : float
        Tilt at full stick, rad. Estimate: toys tilt 15 to 25 degrees.
    full_yaw_rate : float
        Yaw rate at full stick, rad/s. Estimate: toys turn 60 to 180 degrees a second.
    delay : float
        Time from sending a command to its first effect, s. Estimate: a radio takes 20 to 40 ms.
    tilt_lag : float
        Time constant L of the motors before the tilt begins, s. Fitted to the toy's step answer.
    tilt_time : float
        Time constant T of the tilt, s: the period of the undamped oscillation over 2 pi. Fitted, as `tilt_lag`.
    tilt_damping : float
        Damping ratio z of the tilt; below 1 it overshoots. Fitted, as `tilt_lag`.
    yaw_lag : float
        Time constant of the yaw rate, s. Fitted to the toy's step answer.
    lift_lag : float
        Time constant of the thrust, s. Estimate: brushed motors have 0.05 to 0.10 s.
    drag_time : float
        Time constant D in which drag slows the vehicle down, s. It keeps the dead reckoning from running away. Chosen
        on the simulated flights of seeds 0 to 9.
    effective_mass_ratio : float
        Moved mass over carried mass (``heft`` in a file): the air in a balloon weighs nothing in air and is moved all
        the same, with half as much around it (added mass). Derived for 100 g and a balloon of 28 cm.
    integration_step : float
        Step of the integration, s. Shorter is more exact and slower: the time of a call is proportional to the number
        of steps. Chosen by hand: a quarter of a picture's period; tests/control/test_ego_motion.py compares with SciPy.
    """

    full_tilt: float = 0.35
    full_yaw_rate: float = 2.0
    delay: float = 0.03
    tilt_lag: float = 0.03
    tilt_time: float = 0.054
    tilt_damping: float = 0.6
    yaw_lag: float = 0.055
    lift_lag: float = 0.05
    drag_time: float = 3.5
    effective_mass_ratio: float = 1.2
    integration_step: float = 1.0 / 120.0

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)


class AttitudeCommand(NamedTuple):
    """A command without the trim: tilt to the right and forward, rad; yaw rate, rad/s; lift (upward), m/s^2."""

    roll: float = 0.0
    pitch: float = 0.0
    yaw_rate: float = 0.0
    lift: float = 0.0


class _Command:
    tilt: Annotated[Floats, (2,), "f8"]  # roll to the right, pitch forward, rad
    yaw_rate: float
    lift: float


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

    def update(self, command: AttitudeCommand, now: float) -> None:
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
def propagate(work: Any, before: Block, step: float, after: Block) -> None:
    """Write the state one step later under the last command.

    The tilt's equation is integrated implicitly: stable for all parameters.
    """
    old, new = before.view(STATE)[0], after.view(STATE)[0]
    model, command = work.parameters, work.command
    new.time = old.time + step
    begin, frequency = step / (model.tilt_lag + step), 1.0 / model.tilt_time
    for k in range(2):  # roll, pitch
        new.motor_tilt[k] = old.motor_tilt[k] + (command.tilt[k] - old.motor_tilt[k]) * begin
        error = new.motor_tilt[k] - old.tilt[k] - step * old.tilt_rate[k]
        acceleration = frequency * (frequency * error - 2.0 * model.tilt_damping * old.tilt_rate[k])
        implicit = 1.0 + step * frequency * (2.0 * model.tilt_damping + step * frequency)
        new.tilt_rate[k] = old.tilt_rate[k] + step * acceleration / implicit
        new.tilt[k] = old.tilt[k] + step * new.tilt_rate[k]
    new.yaw_rate = old.yaw_rate + (command.yaw_rate - old.yaw_rate) * step / (model.yaw_lag + step)
    new.lift = old.lift + (command.lift - old.lift) * step / (model.lift_lag + step)
    turned = new.yaw_rate - math.sin(new.tilt[0]) * new.tilt_rate[1]
    new.yaw = old.yaw + step * turned / (math.cos(new.tilt[0]) * math.cos(new.tilt[1]))
    gravity = GRAVITY / model.effective_mass_ratio
    right, forward = gravity * math.tan(new.tilt[0]) / math.cos(new.tilt[1]), gravity * math.tan(new.tilt[1])
    c, s = math.cos(new.yaw), math.sin(new.yaw)
    drag = max(1.0 - step / model.drag_time, 0.0)
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
