"""Hold a place beside a neighbor, looking at its ball: `Follower`.

Everything happens in a level frame at rest, found by dead reckoning (`own_motion.py`), in which the neighbor's ball is
filtered and predicted for the time at which a command acts. There the ball's marker points out of the neighbor, and
the set place is ``ball + side x + heading z + height up`` with level axes of the ball (Epstein & Feldman, Eq. 6-8).
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.own_motion import GRAVITY, OwnMotion, OwnMotionParameters, OwnState, Sticks
from matchset.control.pid import Pid, PidParameters, Terms
from matchset.control.safety import Wish
from matchset.localization.filter import FilterParameters, PoseFilter
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]
AHEAD = 0.02  # s over which the set place's speed is taken


class SetPlace(msgspec.Struct, frozen=True, kw_only=True):
    """Where to be, in the level frame of the neighbor's ball: m.

    Parameters
    ----------
    side, height, heading : float
        To the side (+x of the ball frame), above, and before the marker.
    """

    side: float = 0.0
    height: float = 0.0
    heading: float = 1.5


class FollowerParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a place is held.

    Parameters
    ----------
    level : PidParameters
        From m to m/s^2, for both level axes.
    rise : PidParameters
        From m to m/s^2, upward.
    yaw : PidParameters
        From rad to rad/s. Kept slow: a vehicle that turns its own ball fast shakes the one that watches it.
    hover : float
        Throttle at which it hovers, roughly; the integral finds the rest.
    own : OwnMotionParameters
        How the vehicle answers to its sticks.
    filter : FilterParameters
        How the neighbor's poses are filtered.
    reach : float
        How far the neighbor's motion is extrapolated past its last sighting, s; after that it is taken to stand.
    """

    level: PidParameters = PidParameters(
        proportional=5.0, integral=1.5, derivative=4.0, smoothing=0.02, most=3.0, most_integral=1.2
    )
    rise: PidParameters = PidParameters(
        proportional=7.0, integral=3.0, derivative=5.0, smoothing=0.02, most=4.0, most_integral=3.0
    )
    yaw: PidParameters = PidParameters(proportional=1.0, most=1.0)
    hover: float = 0.55
    own: OwnMotionParameters = OwnMotionParameters()
    filter: FilterParameters = FilterParameters(acceleration=0.9, turning=1.0, memory=1.2)
    reach: float = 0.4

    def __post_init__(self) -> None:
        if not 0.0 < self.hover < 1.0:
            raise ValueError(f"hover must be within 0 ... 1, got {self.hover}")
        if not 0.0 <= self.reach < math.inf:
            raise ValueError(f"reach must not be negative, got {self.reach}")


class Answer(NamedTuple):
    """What a follower makes of a moment.

    Attributes
    ----------
    wish : Wish
    side, height, heading : float
        Where it is in the level frame of the neighbor's ball at the time of action, m.
    bearing : float
        Where the ball is to the right of straight ahead, rad.
    right, ahead, rise, turn : Terms
        Of the controllers.
    """

    wish: Wish
    side: float
    height: float
    heading: float
    bearing: float
    right: Terms
    ahead: Terms
    rise: Terms
    turn: Terms


class Follower:
    """Holds a place beside one neighbor.

    Parameters
    ----------
    place : SetPlace, optional
    parameters : FollowerParameters, optional
    """

    def __init__(self, place: SetPlace | None = None, parameters: FollowerParameters | None = None) -> None:
        self.place = place or SetPlace()
        self.parameters = parameters or FollowerParameters()
        self.own = OwnMotion(self.parameters.own)
        self.filter = PoseFilter(self.parameters.filter)
        self._right, self._ahead = Pid(self.parameters.level), Pid(self.parameters.level)
        self._rise, self._yaw = Pid(self.parameters.rise), Pid(self.parameters.yaw)
        self._out: Floats | None = None  # where the marker points, level, in the frame at rest
        self._seen, self._time = -math.inf, -math.inf

    def update(self, pose: "Pose | Lost[Pose]", now: float) -> Answer | None:
        """Decide what to do about a pose.

        Parameters
        ----------
        pose : Pose or Lost
            The neighbor's ball in the camera frame when the picture was taken.
        now : float
            When the command will be sent, s; it acts `own.delay` later, and that is the time that counts.

        Returns
        -------
        Answer or None
            None while there is nothing to go by: no ball for long, or its marker never seen.
        """
        if isinstance(pose, Pose) and self.filter.update(self.own.at(pose.time).to_rest(pose)):
            self._seen = pose.time
        time = now + self.parameters.own.delay
        step, self._time = min(max(now - self._time, 1e-3), 0.1), now
        ball = self._ball(time)
        if ball is None or self._out is None:
            return None
        own = self.own.at(time)
        out, later = self._out, self._ball(time + AHEAD) or ball
        goal = self._goal(ball.position, out)
        speed = (self._goal(later.position, _level(later, out)) - goal) / AHEAD
        return self._steer(own, ball.position, goal - own.place, speed - own.velocity, step)

    def sent(self, command: Command, now: float) -> None:
        """Note what really went out, after limits and quantization."""
        limits, hover = self.parameters.own, self.parameters.hover
        trims = [pid.terms.integral for pid in (self._right, self._ahead, self._rise)]
        sticks = Sticks(
            limits.full_tilt * command.roll - math.atan(trims[0] / GRAVITY),
            limits.full_tilt * command.pitch - math.atan(trims[1] / GRAVITY),
            limits.full_yaw_rate * command.yaw,
            GRAVITY * (command.throttle / hover - 1.0) - trims[2],
        )
        self.own.sent(sticks if command.throttle > 0.0 else Sticks(), now)

    def _ball(self, time: float) -> Pose | None:
        """Predict the ball in the frame at rest for a time, and note where its marker points."""
        until = min(time, self._seen + self.parameters.reach)
        if not time - self._seen <= self.parameters.filter.memory:
            return None
        ball = self.filter.predict(until)
        if not isinstance(ball, Pose):
            return None
        if ball.turn is not None:
            self._out = _level(ball, self._out)
        return ball

    def _goal(self, ball: Floats, out: Floats) -> Floats:
        """Find the set place in the frame at rest; the level ball frame is z = out, y down, x = y cross z."""
        across = np.array((out[2], 0.0, -out[0]))
        goal: Floats = ball + self.place.side * across + self.place.heading * out
        goal[1] -= self.place.height
        return goal

    def _steer(self, own: OwnState, ball: Floats, off: Floats, speed: Floats, step: float) -> Answer:
        """Run the controllers: `off` leads to the set place, `speed` is its own; both in the frame at rest."""
        assert self._out is not None
        c, s = math.cos(own.yaw), math.sin(own.yaw)
        right, ahead = off[0] * c - off[2] * s, off[0] * s + off[2] * c
        speed_right, speed_ahead = speed[0] * c - speed[2] * s, speed[0] * s + speed[2] * c
        roll = self._right.update(0.0, -float(right), step, -float(speed_right))
        pitch = self._ahead.update(0.0, -float(ahead), step, -float(speed_ahead))
        rise = self._rise.update(0.0, float(off[1]), step, float(speed[1]))
        sight = ball - own.place
        bearing = math.atan2(sight[0] * c - sight[2] * s, sight[0] * s + sight[2] * c)
        turning = self._yaw.update(0.0, -bearing, step)
        model = self.parameters.own
        tilt = 1.0 / max(math.cos(own.roll) * math.cos(own.pitch), 0.5)
        wish = Wish(
            math.atan(roll / GRAVITY) / model.full_tilt,
            math.atan(pitch / GRAVITY) / model.full_tilt,
            turning / model.full_yaw_rate,
            self.parameters.hover * (1.0 + rise / GRAVITY) * tilt,
        )
        across = (self._out[2], -self._out[0])
        side = -float(sight[0] * across[0] + sight[2] * across[1])
        heading = -float(sight[0] * self._out[0] + sight[2] * self._out[2])
        terms = (self._right.terms, self._ahead.terms, self._rise.terms, self._yaw.terms)
        return Answer(wish, side, float(sight[1]), heading, bearing, *terms)


def _level(ball: Pose, last: Floats | None) -> Floats:
    """Level unit vector along which the marker points; the last one where that is not observed."""
    if ball.turn is not None:
        x, z = float(ball.turn[0, 2]), float(ball.turn[2, 2])
        length = math.hypot(x, z)
        if length > 0.2:
            return np.array((x / length, 0.0, z / length))
    return np.zeros(3) if last is None else last
