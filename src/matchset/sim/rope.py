"""The last vehicle of the chain hangs on a rope: `Rope`, a spherical pendulum that turns slowly about its rope."""

import math
from typing import Annotated, Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import require_positive
from matchset.numeric.copies import Copied
from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, fields, new_block, record_dtype
from matchset.sim.quadrotor import GRAVITY

Floats = npt.NDArray[np.float64]


class RopeParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The rope and how the vehicle on it moves.

    Parameters
    ----------
    length : float
        From the ceiling to the vehicle's center of mass, m.
    swing : float
        Amplitude of the swing, m.
    damping : float
        Decay of the swing, 1/s: 0.002 takes away 11 % in a minute.
    yaw_deg : float
        Amplitude of the yaw, degree; never more than that to either side.
    yaw_periods : tuple of 2 floats
        Periods of its two sine waves, s.
    yaw_shares : tuple of 2 floats
        Share of each wave in the amplitude; they add up to 1, so that the yaw never exceeds it. Chosen by hand: a slow
        wave with a faster one on it, so that the yaw does not repeat itself; `test_rope` shows a change.
    """

    length: float = 1.2
    swing: float = 0.1
    damping: float = 0.002
    yaw_deg: float = 20.0
    yaw_periods: tuple[float, float] = (16.0, 7.0)
    yaw_shares: tuple[float, float] = (0.8, 0.2)

    def __post_init__(self) -> None:
        require_positive(self, ("length",))
        if not 0.0 <= self.swing <= 0.9 * self.length:
            raise ValueError(f"swing must be 0 or more, and less than 0.9 of the rope's length, got {self.swing}")
        if not (0.0 <= self.damping < math.inf and 0.0 <= self.yaw_deg <= 180.0):
            raise ValueError(f"damping must be 0 or more and yaw_deg 0 ... 180, got {self.damping}, {self.yaw_deg}")
        if not all(0.0 < period < math.inf for period in self.yaw_periods):
            raise ValueError(f"yaw_periods must be positive, got {self.yaw_periods}")


class RopeState:
    """Layout of a rope and what hangs on it."""

    offset: Annotated[Floats, (3,), "f8"]  # from the anchor to the vehicle, m
    velocity: Annotated[Floats, (3,), "f8"]  # of the vehicle, m/s
    anchor: Annotated[Floats, (3,), "f8"]  # where the rope is fastened, m
    length: float  # m
    damping: float  # 1/s
    yaw_amplitude: float  # rad
    yaw_periods: Annotated[Floats, (2,), "f8"]  # s
    yaw_phases: Annotated[Floats, (2,), "f8"]  # rad
    yaw_shares: Annotated[Floats, (2,), "f8"]


ROPE = record_dtype(RopeState)


class Rope(Copied):
    """A pendulum, ``r'' = g - ((g r + v^2) / L^2) r - 2 c v`` with |r| = L, and a yaw of two sine waves.

    Parameters
    ----------
    parameters : RopeParameters
    anchor : (3,)
        Where it hangs from the ceiling, m.
    rng : numpy.random.Generator
        Decides the plane of the swing, its phase, and the phases of the yaw.
    block : (18,), optional
        Memory for its `RopeState`, for a world that lets many things move in one call; its own by default.

    Attributes
    ----------
    state : record
        `RopeState`, always that of now.
    """

    def __init__(
        self, parameters: RopeParameters, anchor: npt.ArrayLike, rng: np.random.Generator, block: Block | None = None
    ) -> None:
        self.parameters = parameters
        self._block = new_block(ROPE) if block is None else block
        self._make_derived()
        state = self.state
        plane, phase, *phases = rng.uniform(0.0, 2.0 * math.pi, 4)
        state.anchor[:], state.length, state.damping = anchor, parameters.length, parameters.damping
        state.yaw_amplitude = math.radians(parameters.yaw_deg)
        state.yaw_periods[:], state.yaw_phases[:] = parameters.yaw_periods, phases
        state.yaw_shares[:] = parameters.yaw_shares
        along = np.array((math.cos(plane), 0.0, math.sin(plane)))
        out = parameters.swing * math.cos(phase)
        state.offset[:] = out * along + np.array((0.0, math.sqrt(parameters.length**2 - out**2), 0.0))
        frequency = math.sqrt(GRAVITY / parameters.length)
        state.velocity[:] = -parameters.swing * frequency * math.sin(phase) * along
        state.velocity -= state.offset * (state.offset @ state.velocity) / parameters.length**2

    def _derive(self) -> None:
        self.state = fields(self._block, ROPE)

    def share(self, block: Block) -> None:
        """Let its `RopeState` lie in another block, which holds the same one."""
        self._block = block
        self._derive()

    @property
    def position(self) -> Floats:
        """Where the vehicle is, (3,), m."""
        position: Floats = self.state.anchor + self.state.offset
        return position

    def yaw(self, time: float) -> float:
        """Yaw of the vehicle at a time, rad."""
        return yaw_at(self._block, time)

    def rotation(self, time: float) -> Floats:
        """Rotation matrix of the vehicle: its down axis along the rope, turned by the yaw of a time."""
        matrix = np.empty((3, 3))
        hanging_rotation(self.state.offset, self.yaw(time), self.parameters.length, matrix)
        return matrix

    def step(self, step: float) -> None:
        """Let time pass, s: one step of the classical Runge-Kutta method."""
        step_rope(self._block, step)


@kernel(refcount=False)
def yaw_at(rope: Block, time: float) -> float:
    """Yaw at a time, s, of what hangs on a rope, rad: two sine waves."""
    return rope_yaw(rope.view(ROPE)[0], time)


@kernel(refcount=False)
def rope_yaw(rope: Any, time: float) -> float:
    """Yaw as `yaw_at` gives it, for kernels that hold `RopeState` as a record."""
    slow = rope.yaw_shares[0] * math.sin(2.0 * math.pi * time / rope.yaw_periods[0] + rope.yaw_phases[0])
    fast = rope.yaw_shares[1] * math.sin(2.0 * math.pi * time / rope.yaw_periods[1] + rope.yaw_phases[1])
    yaw: float = rope.yaw_amplitude * (slow + fast)
    return yaw


@kernel(refcount=False)
def hanging_rotation(offset: Floats, yaw: float, length: float, matrix: Floats) -> None:
    """Write the rotation of what hangs on a rope: y along the rope, z as near to the yaw's direction as that allows."""
    ahead = (math.sin(yaw), 0.0, math.cos(yaw))
    for k in range(3):
        matrix[k, 1] = offset[k] / length
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        matrix[k, 0] = matrix[a, 1] * ahead[b] - matrix[b, 1] * ahead[a]
    far = math.sqrt(matrix[0, 0] * matrix[0, 0] + matrix[1, 0] * matrix[1, 0] + matrix[2, 0] * matrix[2, 0])
    for k in range(3):
        matrix[k, 0] /= far
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        matrix[k, 2] = matrix[a, 0] * matrix[b, 1] - matrix[b, 0] * matrix[a, 1]


@kernel(refcount=False)
def _acceleration(r: Floats, v: Floats, length: float, damping: float, rate: Floats) -> None:
    """Write the acceleration of a pendulum: gravity and centripetal force less what the rope takes, and damping."""
    tension = (GRAVITY * r[1] + v[0] ** 2 + v[1] ** 2 + v[2] ** 2) / length**2
    for k in range(3):
        rate[k] = -tension * r[k] - 2.0 * damping * v[k]
    rate[1] += GRAVITY


@kernel
def step_rope(rope: Block, step: float) -> None:
    """Advance offset and velocity of what hangs on a rope by a step, s, in place; the rope keeps its length."""
    swing(rope.view(ROPE)[0], step)


@kernel
def swing(rope: Any, step: float) -> None:
    """Advance as `step_rope` does, for kernels that hold `RopeState` as a record."""
    r, v, length = rope.offset, rope.velocity, rope.length
    rates = np.empty((4, 2, 3))
    at, speed = np.empty(3), np.empty(3)
    for stage in range(4):
        part = 0.0 if stage == 0 else step if stage == 3 else 0.5 * step
        for k in range(3):
            at[k], speed[k] = r[k], v[k]
            if stage > 0:
                at[k] = r[k] + part * rates[stage - 1, 0, k]
                speed[k] = v[k] + part * rates[stage - 1, 1, k]
        rates[stage, 0] = speed
        _acceleration(at, speed, length, rope.damping, rates[stage, 1])
    square = 0.0
    for k in range(3):
        r[k] += step / 6.0 * (rates[0, 0, k] + 2.0 * rates[1, 0, k] + 2.0 * rates[2, 0, k] + rates[3, 0, k])
        v[k] += step / 6.0 * (rates[0, 1, k] + 2.0 * rates[1, 1, k] + 2.0 * rates[2, 1, k] + rates[3, 1, k])
        square += r[k] ** 2
    for k in range(3):
        r[k] *= length / math.sqrt(square)
