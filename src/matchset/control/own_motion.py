"""What the vehicle made of its commands: `OwnMotion`, dead reckoning for a vehicle that measures nothing.

The commanded tilt goes through a delay and a first-order lag, ``T dtheta/dt = theta_commanded - theta``; it pulls the
vehicle along, ``dv/dt = g tan(theta) - v/T_drag``. What constant offset of the sticks holds the vehicle still, its
trim, is no tilt and is taken off before. The place that follows drifts; it serves to compare moments less than a second
apart.
"""

import math
from bisect import bisect_right
from collections import deque
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.localization.pose import Pose

Floats = npt.NDArray[np.float64]

GRAVITY = 9.81  # m/s^2
STEP = 1.0 / 120.0  # s
KEPT = 128  # steps


class OwnMotionParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How the vehicle answers to its sticks.

    Parameters
    ----------
    full_tilt : float
        Tilt at full stick, rad.
    full_yaw_rate : float
        Turning at full stick, rad/s.
    delay : float
        From sending a command to its first effect, s: the radio.
    tilt_lag, yaw_lag, lift_lag : float
        Time constants of tilt, turning and thrust, s.
    drag_time : float
        Time in which drag takes away 63 % of a slow speed, s. Keeps the dead reckoning from running away.
    """

    full_tilt: float = 0.35
    full_yaw_rate: float = 2.0
    delay: float = 0.035
    tilt_lag: float = 0.12
    yaw_lag: float = 0.08
    lift_lag: float = 0.05
    drag_time: float = 4.0

    def __post_init__(self) -> None:
        for name in self.__struct_fields__:
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")


class Sticks(NamedTuple):
    """What a command asks for beyond the trim: tilt to the right and forward, rad; turning, rad/s; lift, m/s^2."""

    roll: float = 0.0
    pitch: float = 0.0
    turning: float = 0.0
    lift: float = 0.0


class OwnState(NamedTuple):
    """The vehicle by dead reckoning, in a level frame at rest: x right, y down, z forward of where it began."""

    time: float
    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0
    turning: float = 0.0
    lift: float = 0.0
    vx: float = 0.0
    vy: float = 0.0
    vz: float = 0.0
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0

    @property
    def place(self) -> Floats:
        """Where it is, (3,), m."""
        return np.array((self.x, self.y, self.z))

    @property
    def velocity(self) -> Floats:
        """How fast it moves, (3,), m/s."""
        return np.array((self.vx, self.vy, self.vz))

    @property
    def turn(self) -> Floats:
        """Matrix from its body, and its camera, to the frame at rest: Ry(yaw) Rx(-pitch) Rz(roll), (3, 3)."""
        cy, sy = math.cos(self.yaw), math.sin(self.yaw)
        cp, sp = math.cos(self.pitch), math.sin(self.pitch)
        cr, sr = math.cos(self.roll), math.sin(self.roll)
        return np.array(
            (
                (cy * cr - sy * sp * sr, -cy * sr - sy * sp * cr, sy * cp),
                (cp * sr, cp * cr, sp),
                (-sy * cr - cy * sp * sr, sy * sr - cy * sp * cr, cy * cp),
            )
        )

    def to_rest(self, pose: Pose) -> Pose:
        """Express a pose in the frame at rest, as seen from here."""
        turn = self.turn
        both = np.zeros((6, 6))
        both[:3, :3] = both[3:, 3:] = turn
        return Pose(
            position=self.place + turn @ pose.position,
            turn=None if pose.turn is None else turn @ pose.turn,
            covariance=both @ pose.covariance @ both.T,
            observed=pose.observed,
            time=pose.time,
        )

    def moved(self, sticks: Sticks, step: float, model: OwnMotionParameters) -> "OwnState":
        """State one step later under these sticks."""
        roll = self.roll + (sticks.roll - self.roll) * step / (model.tilt_lag + step)
        pitch = self.pitch + (sticks.pitch - self.pitch) * step / (model.tilt_lag + step)
        turning = self.turning + (sticks.turning - self.turning) * step / (model.yaw_lag + step)
        lift = self.lift + (sticks.lift - self.lift) * step / (model.lift_lag + step)
        yaw = self.yaw + turning * step
        right, ahead = GRAVITY * math.tan(roll), GRAVITY * math.tan(pitch)
        c, s, fade = math.cos(yaw), math.sin(yaw), 1.0 - step / model.drag_time
        vx = fade * self.vx + (right * c + ahead * s) * step
        vy = fade * self.vy - lift * step
        vz = fade * self.vz + (ahead * c - right * s) * step
        x, y, z = self.x + vx * step, self.y + vy * step, self.z + vz * step
        return OwnState(self.time + step, roll, pitch, yaw, turning, lift, vx, vy, vz, x, y, z)


class OwnMotion:
    """Follows the vehicle through the commands that were sent to it.

    Parameters
    ----------
    parameters : OwnMotionParameters, optional
    """

    def __init__(self, parameters: OwnMotionParameters | None = None) -> None:
        self.parameters = parameters or OwnMotionParameters()
        self._sticks = Sticks()
        self._states: deque[OwnState] = deque(maxlen=KEPT)

    def sent(self, sticks: Sticks, now: float) -> None:
        """Note what was sent.

        Parameters
        ----------
        sticks : Sticks
        now : float
            When, s; later than before.
        """
        self._advance(now + self.parameters.delay)
        self._sticks = sticks

    def at(self, time: float) -> OwnState:
        """State at a time, from a second back to `delay` from now; later: the sticks stay as they are.

        Parameters
        ----------
        time : float
            s.
        """
        states = self._states
        if not states or time <= states[0].time:
            return states[0]._replace(time=time) if states else OwnState(time)
        if time >= states[-1].time:
            state = states[-1]
            time = min(time, state.time + KEPT * STEP)
            while state.time + STEP < time:
                state = state.moved(self._sticks, STEP, self.parameters)
            return state.moved(self._sticks, time - state.time, self.parameters) if time > state.time else state
        after = bisect_right(states, time, key=lambda state: state.time)
        one, two = states[after - 1], states[after]
        share = (time - one.time) / (two.time - one.time)
        return OwnState(*(a + share * (b - a) for a, b in zip(one, two, strict=True)))

    def _advance(self, time: float) -> None:
        if self._states and not abs(time - self._states[-1].time) <= KEPT * STEP:
            self._states.clear()  # nothing was sent for long: begin anew
        if not self._states:
            self._states.append(OwnState(time))
        while self._states[-1].time + STEP <= time:
            self._states.append(self._states[-1].moved(self._sticks, STEP, self.parameters))
