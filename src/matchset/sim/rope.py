"""The last of the chain hangs on a rope: a spherical pendulum whose yaw wanders; `Rope`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]

SHARES = 0.8, 0.2  # of the two waves of the yaw: together they never exceed the amplitude


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
        Periods of its two waves, s.
    """

    length: float = 1.2
    swing: float = 0.1
    damping: float = 0.002
    yaw_deg: float = 20.0
    yaw_periods: tuple[float, float] = (16.0, 7.0)

    def __post_init__(self) -> None:
        if not 0.0 < self.length < math.inf:
            raise ValueError(f"length must be positive, got {self.length}")
        if not 0.0 <= self.swing <= 0.9 * self.length:
            raise ValueError(f"swing must be 0 or more, and less than 0.9 of the rope's length, got {self.swing}")
        if not (0.0 <= self.damping < math.inf and 0.0 <= self.yaw_deg <= 180.0):
            raise ValueError(f"damping must be 0 or more and yaw_deg 0 ... 180, got {self.damping}, {self.yaw_deg}")
        if not all(0.0 < period < math.inf for period in self.yaw_periods):
            raise ValueError(f"yaw_periods must be positive, got {self.yaw_periods}")


class Rope:
    """A pendulum, ``r'' = g - ((g r + v^2) / L^2) r - c v`` with |r| = L, and a yaw of two sine waves.

    Parameters
    ----------
    parameters : RopeParameters
    anchor : (3,)
        Where it hangs from the ceiling, m.
    rng : numpy.random.Generator
        Decides the plane of the swing, its phase, and the phases of the yaw.

    Attributes
    ----------
    place, velocity : (3,)
        Of the vehicle, m and m/s.
    waves : (5,)
        See `yaw_of`.
    """

    def __init__(self, parameters: RopeParameters, anchor: npt.ArrayLike, rng: np.random.Generator) -> None:
        self.parameters = parameters
        self.anchor = np.array(anchor, np.float64)
        plane, phase, *phases = rng.uniform(0.0, 2.0 * math.pi, 4)
        self.waves = np.array((math.radians(parameters.yaw_deg), *parameters.yaw_periods, *phases))
        way = np.array((math.cos(plane), 0.0, math.sin(plane)))
        out = parameters.swing * math.cos(phase)
        self._arm = out * way + np.array((0.0, math.sqrt(parameters.length**2 - out**2), 0.0))
        pull = math.sqrt(9.81 / parameters.length)
        self.velocity = -parameters.swing * pull * math.sin(phase) * way
        self.velocity -= self._arm * (self._arm @ self.velocity) / parameters.length**2

    @property
    def arm(self) -> Floats:
        """From the anchor to the vehicle, (3,), m."""
        arm: Floats = self._arm
        return arm

    @property
    def place(self) -> Floats:
        """Where the vehicle is, (3,), m."""
        where: Floats = self.anchor + self._arm
        return where

    def yaw(self, time: float) -> float:
        """Yaw of the vehicle at a time, rad."""
        return yaw_of(self.waves, time)

    def turn(self, time: float, arm: Floats | None = None) -> Floats:
        """Rotation matrix of the vehicle: its down axis along the rope (or an earlier `arm`), turned by the yaw."""
        turn = np.empty((3, 3))
        hanging(self._arm if arm is None else arm, self.yaw(time), self.parameters.length, turn)
        return turn

    def step(self, step: float) -> None:
        """Let time pass, s: one step of the classical Runge-Kutta method."""
        swing(self._arm, self.velocity, self.parameters.length, self.parameters.damping, step)


@kernel
def yaw_of(waves: Floats, time: float) -> float:
    """Yaw at a time, rad; `waves` holds its amplitude (rad), the periods (s) of its two waves, and their phases."""
    slow = SHARES[0] * math.sin(2.0 * math.pi * time / waves[1] + waves[3])
    fast = SHARES[1] * math.sin(2.0 * math.pi * time / waves[2] + waves[4])
    yaw: float = waves[0] * (slow + fast)
    return yaw


@kernel
def hanging(arm: Floats, yaw: float, length: float, turn: Floats) -> None:
    """Write the rotation of what hangs on a rope's arm, turned by a yaw: (3, 3)."""
    ahead = (math.sin(yaw), 0.0, math.cos(yaw))
    for k in range(3):
        turn[k, 1] = arm[k] / length
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        turn[k, 0] = turn[a, 1] * ahead[b] - turn[b, 1] * ahead[a]
    far = math.sqrt(turn[0, 0] * turn[0, 0] + turn[1, 0] * turn[1, 0] + turn[2, 0] * turn[2, 0])
    for k in range(3):
        turn[k, 0] /= far
    for k in range(3):
        a, b = (k + 1) % 3, (k + 2) % 3
        turn[k, 2] = turn[a, 0] * turn[b, 1] - turn[b, 0] * turn[a, 1]


@kernel
def _pull(r: Floats, v: Floats, length: float, damping: float, slope: Floats) -> None:
    """Acceleration of a pendulum: gravity but for its part along the rope, the centripetal part, and damping."""
    pull = (9.81 * r[1] + v[0] ** 2 + v[1] ** 2 + v[2] ** 2) / length**2
    for k in range(3):
        slope[k] = -pull * r[k] - 2.0 * damping * v[k]
    slope[1] += 9.81


@kernel
def swing(r: Floats, v: Floats, length: float, damping: float, step: float) -> None:
    """Advance a pendulum's arm and velocity, (3,) each, m and m/s, in place; the arm keeps its length."""
    rates = np.empty((4, 2, 3))
    at, speed = r.copy(), v.copy()
    for stage in range(4):
        if stage > 0:
            part = step if stage == 3 else 0.5 * step
            for k in range(3):
                at[k] = r[k] + part * rates[stage - 1, 0, k]
                speed[k] = v[k] + part * rates[stage - 1, 1, k]
        rates[stage, 0] = speed
        _pull(at, speed, length, damping, rates[stage, 1])
    square = 0.0
    for k in range(3):
        r[k] += step / 6.0 * (rates[0, 0, k] + 2.0 * rates[1, 0, k] + 2.0 * rates[2, 0, k] + rates[3, 0, k])
        v[k] += step / 6.0 * (rates[0, 1, k] + 2.0 * rates[1, 1, k] + 2.0 * rates[2, 1, k] + rates[3, 1, k])
        square += r[k] ** 2
    for k in range(3):
        r[k] *= length / math.sqrt(square)
