"""What the vehicle made of its commands: `EgoMotion`, dead reckoning for a vehicle that measures nothing.

The commanded tilt goes through a delay, a lag of the motors and a damped swing of the electronics; it pulls the vehicle
along, ``dv/dt = g tan(theta) / heft - v/T_drag``. What constant offset of the sticks holds the vehicle still, its
trim, is no tilt and is taken off before. The place that follows drifts; it serves to compare moments less than a second
apart.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.dead_reckoning import (
    GRAVITY,
    PITCH,
    PLACE,
    ROLL,
    SIZE,
    TIME,
    VELOCITY,
    YAW,
    catch_up,
    precompile,
    recall,
    recall_all,
    turn_of,
)

Floats = npt.NDArray[np.float64]

KEPT = 128  # steps of 1/120 s
__all__ = ["GRAVITY", "AttitudeCommand", "EgoMotion", "EgoMotionParameters", "EgoState"]


class EgoMotionParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the vehicle answers to its sticks.

    Parameters
    ----------
    full_tilt : float
        Tilt at full stick, rad.
    full_yaw_rate : float
        Turning at full stick, rad/s.
    delay : float
        From sending a command to its first effect, s: the radio.
    tilt_lag : float
        Time constant of the motors before the tilt begins, s.
    tilt_time : float
        Of the tilt's swing into its angle, s: its period without damping over 2 pi.
    tilt_damping : float
        Damping ratio of that swing: below 1 it overshoots.
    yaw_lag, lift_lag : float
        Time constants of turning and thrust, s.
    drag_time : float
        Time in which drag takes away 63 % of a slow speed, s. Keeps the dead reckoning from running away.
    heft : float
        What must be accelerated, as a multiple of what the motors carry: a balloon's air weighs nothing in air and
        has to be moved all the same, with half as much around it.
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
    heft: float = 1.2

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")


class AttitudeCommand(NamedTuple):
    """What a command asks for beyond the trim: tilt to the right and forward, rad; turning, rad/s; lift, m/s^2."""

    roll: float = 0.0
    pitch: float = 0.0
    turning: float = 0.0
    lift: float = 0.0


class EgoState:
    """The vehicle by dead reckoning, in a level frame at rest: x right, y down, z forward of where it began.

    Parameters
    ----------
    numbers : ndarray of shape (16,)
        See `matchset.control.dead_reckoning`.
    """

    def __init__(self, numbers: Floats) -> None:
        self.numbers = numbers

    @property
    def roll(self) -> float:
        """Tilt to the right, rad."""
        return self.numbers.item(ROLL)

    @property
    def pitch(self) -> float:
        """Tilt forward, rad."""
        return self.numbers.item(PITCH)

    @property
    def yaw(self) -> float:
        """Turn to the right since the beginning, rad."""
        return self.numbers.item(YAW)

    @property
    def velocity(self) -> Floats:
        """How fast it moves, (3,), m/s."""
        return self.numbers[VELOCITY : VELOCITY + 3]

    @property
    def place(self) -> Floats:
        """Where it is, (3,), m."""
        return self.numbers[PLACE : PLACE + 3]

    @property
    def turn(self) -> Floats:
        """Matrix from its body, and its camera, to the frame at rest: Ry(yaw) Rx(-pitch) Rz(roll), (3, 3)."""
        turn = np.empty((3, 3))
        turn_of(self.numbers, turn)
        return turn


class EgoMotion:
    """Follows the vehicle through the commands that were sent to it; all kernels are compiled here.

    Parameters
    ----------
    parameters : EgoMotionParameters, optional
    """

    def __init__(self, parameters: EgoMotionParameters | None = None) -> None:
        self.parameters = parameters or EgoMotionParameters()
        self._model = np.array([getattr(self.parameters, name) for name in self.parameters.__struct_fields__])
        self._sticks = np.zeros(4)
        self._ring, self._count = np.zeros((KEPT, SIZE)), 0
        precompile()

    def sent(self, sticks: AttitudeCommand, now: float) -> None:
        """Note what was sent.

        Parameters
        ----------
        sticks : AttitudeCommand
        now : float
            When, s; later than before.
        """
        self._count = catch_up(self._ring, self._count, self._sticks, now + self.parameters.delay, self._model)
        self._sticks[:] = sticks

    def at(self, time: float) -> EgoState:
        """State at a time, from a second back to `delay` from now; later: the sticks stay as they are.

        Parameters
        ----------
        time : float
            s.
        """
        numbers = np.empty(SIZE)
        recall(self._ring, self._count, self._sticks, time, self._model, numbers)
        return EgoState(numbers)

    def at_times(self, times: Sequence[float]) -> list[EgoState]:
        """States at several times, see `at`.

        Parameters
        ----------
        times : sequence of float
            s.
        """
        states = np.empty((len(times), SIZE))
        states[:, TIME] = times
        recall_all(self._ring, self._count, self._sticks, self._model, states)
        return [EgoState(numbers) for numbers in states]
