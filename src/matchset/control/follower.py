"""Hold a place beside a neighbor, looking at its ball: `Follower`.

Everything happens in a level frame at rest, found by dead reckoning (`own_motion.py`), in which the neighbor's ball is
filtered (`neighbor_motion.py`) and predicted for the time at which a command acts. There the ball's marker points out
of the neighbor, and the set place is ``ball + side x + heading z + height up`` with level axes of the ball (Epstein &
Feldman, Eq. 6-8).
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.ego_motion import GRAVITY, AttitudeCommand, EgoMotion, EgoMotionParameters, EgoState
from matchset.control.feedforward import FeedforwardParameters, SpeedFeedforward
from matchset.control.neighbor_motion import NeighborFilter, NeighborFilterParameters
from matchset.control.pid import Pid, PidParameters, PidTerms
from matchset.control.safety import DesiredCommand
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]


class RelativeSetpoint(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where to be, in the level frame of the neighbor's ball: m.

    Parameters
    ----------
    side, height, heading : float
        To the side (+x of the ball frame), above, and before the marker.
    """

    side: float = 0.0
    height: float = 0.0
    heading: float = 1.5


class FollowerParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
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
    lead : float
        How long after a command first acts it acts in full, s: what is predicted for that time counts for the level
        axes. About the lags of the tilt; more is calmer, until the prediction fails.
    rise_lead : float
        The same for the height: about the lag of the thrust.
    ahead : float
        Share of the set place's swaying that is flown without waiting for an error, 0 ... 1. More follows a
        steady swing closer, and passes on what the next in the chain sees as shaking.
    drift : float
        The same for what is no sway: a turn of the neighbor that goes on for seconds.
    pace, rise_pace : FeedforwardParameters
        What of the neighbor's speed is flown along, level and upward.
    own : EgoMotionParameters
        How the vehicle answers to its sticks.
    motion : NeighborFilterParameters
        How the neighbor's poses are filtered.
    reach : float
        How far the neighbor's motion is extrapolated past its last sighting, s; after that it is taken to stand.
    memory : float
        How long after the last sighting there is an answer, s; longer than safety lets it be used.
    """

    level: PidParameters = PidParameters(
        proportional=4.0,
        integral=2.1,
        derivative=3.3,
        smoothing=0.033,
        stride=0.4,
        most=3.0,
        most_integral=1.2,
        within=0.3,
        foresight=0.4,
        learning=3.0,
        settled=0.09,
    )
    rise: PidParameters = PidParameters(
        proportional=5.5,
        integral=2.6,
        derivative=7.5,
        smoothing=0.023,
        most=4.0,
        most_integral=3.0,
        within=0.6,
        foresight=1.36,
        learning=5.5,
        settled=0.12,
    )
    yaw: PidParameters = PidParameters(proportional=0.3, most=1.0)
    hover: float = 0.59
    lead: float = 0.074
    rise_lead: float = 0.038
    ahead: float = 0.85
    drift: float = 0.45
    pace: FeedforwardParameters = FeedforwardParameters(share=0.7, calm=0.23)
    rise_pace: FeedforwardParameters = FeedforwardParameters(share=0.42, calm=0.75)
    own: EgoMotionParameters = EgoMotionParameters()
    motion: NeighborFilterParameters = NeighborFilterParameters()
    reach: float = 0.4
    memory: float = 1.2

    def __post_init__(self) -> None:
        if not 0.0 < self.hover < 1.0:
            raise ValueError(f"hover must be within 0 ... 1, got {self.hover}")
        for name in ("lead", "rise_lead", "ahead", "drift", "reach", "memory"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} must not be negative, got {getattr(self, name)}")


class ControlOutput(NamedTuple):
    """What a follower makes of a moment.

    Attributes
    ----------
    wish : DesiredCommand
    side, height, heading : float
        Where it is in the level frame of the neighbor's ball at the time of action, m.
    bearing : float
        Where the ball is to the right of straight ahead, rad.
    right, ahead, rise, turn : PidTerms
        Of the controllers.
    """

    wish: DesiredCommand
    side: float
    height: float
    heading: float
    bearing: float
    right: PidTerms
    ahead: PidTerms
    rise: PidTerms
    turn: PidTerms


class Follower:
    """Holds a place beside one neighbor.

    Parameters
    ----------
    place : RelativeSetpoint, optional
    parameters : FollowerParameters, optional
    """

    def __init__(self, place: RelativeSetpoint | None = None, parameters: FollowerParameters | None = None) -> None:
        self.place = place or RelativeSetpoint()
        self.parameters = parameters or FollowerParameters()
        self.own = EgoMotion(self.parameters.own)
        self.neighbor = NeighborFilter(self.parameters.motion)
        self._right, self._ahead = Pid(self.parameters.level), Pid(self.parameters.level)
        self._rise, self._yaw = Pid(self.parameters.rise), Pid(self.parameters.yaw)
        pace, rise_pace = self.parameters.pace, self.parameters.rise_pace
        self._paces = SpeedFeedforward(pace), SpeedFeedforward(rise_pace), SpeedFeedforward(pace)
        self._fed = self._time = -math.inf

    def update(self, pose: "Pose | Lost[Pose]", now: float) -> ControlOutput | None:
        """Decide what to do about a pose.

        Parameters
        ----------
        pose : Pose or Lost
            The neighbor's ball in the camera frame when the picture was taken.
        now : float
            When the command will be sent, s; it acts `own.delay` later, and that is the time that counts.

        Returns
        -------
        ControlOutput or None
            None while there is nothing to go by: no ball for long, or its marker never seen.
        """
        if isinstance(pose, Pose) and pose.time > self._fed:
            self._fed = pose.time
            self.neighbor.update(pose, self.own.at(pose.time))
        step, self._time = min(max(now - self._time, 1e-3), 0.1), now
        acts = now + self.parameters.own.delay
        if not acts - self.neighbor.time <= self.parameters.memory or self.neighbor.turn_time == -math.inf:
            return None
        return self._steer(acts, step)

    def sent(self, command: Command, now: float) -> None:
        """Note what really went out, after limits and quantization; without throttle nothing is learned."""
        if not command.throttle > 0.0:
            for pid in (self._right, self._ahead, self._rise, self._yaw):
                pid.reset()
        limits, hover = self.parameters.own, self.parameters.hover
        pull = GRAVITY / limits.heft
        trims = [pid.terms.integral for pid in (self._right, self._ahead, self._rise)]
        sticks = AttitudeCommand(
            limits.full_tilt * command.roll - math.atan(trims[0] / pull),
            limits.full_tilt * command.pitch - math.atan(trims[1] / pull),
            limits.full_yaw_rate * command.yaw,
            pull * (command.throttle / hover - 1.0) - trims[2],
        )
        self.own.sent(sticks if command.throttle > 0.0 else AttitudeCommand(), now)

    def expected(self, time: float) -> Floats | None:
        """Tell where the ball should be in the camera frame at a time, (3,), m; None if it was not seen for long."""
        if not time - self.neighbor.time <= self.parameters.memory:
            return None
        own = self.own.at(time)
        there: Floats = own.turn.T @ (self.neighbor.at(time, self.parameters.reach)[:3, 0] - own.place)
        return there

    def _steer(self, acts: float, step: float) -> ControlOutput:
        """Run the controllers for a command that begins to act at a time."""
        parameters, reach = self.parameters, self.parameters.reach
        times = acts, acts + parameters.lead, acts + parameters.rise_lead
        (own, later, there), (ball, level, risen) = self.own.at_times(times), self.neighbor.at_times(times, reach)
        for pace, speed in zip(self._paces, ball[:3, 1].tolist(), strict=True):
            pace.update(speed, step)
        roll, pitch = self._level(later, level, own.yaw, step)
        height = risen[1].tolist()
        low = there.place.item(1) - height[0] + self.place.height
        rise = self._rise.update(0.0, -low, step, self._paces[1].of(height[1]) - there.velocity.item(1))
        sight, out = (ball[:3, 0] - own.place).tolist(), (math.sin(ball[3, 0]), math.cos(ball[3, 0]))
        bearing = math.atan2(sight[0], sight[2]) - own.yaw
        bearing -= 2.0 * math.pi * math.floor(bearing / (2.0 * math.pi) + 0.5)
        turning = self._yaw.update(0.0, -bearing, step)
        model, pull = parameters.own, GRAVITY / parameters.own.heft
        tilt = 1.0 / max(math.cos(own.roll) * math.cos(own.pitch), 0.5)
        wish = DesiredCommand(
            math.atan(roll / pull) / model.full_tilt,
            math.atan(pitch / pull) / model.full_tilt,
            turning / model.full_yaw_rate,
            parameters.hover * (1.0 + rise / pull) * tilt,
        )
        side = sight[2] * out[0] - sight[0] * out[1]
        heading = -sight[0] * out[0] - sight[2] * out[1]
        terms = (self._right.terms, self._ahead.terms, self._rise.terms, self._yaw.terms)
        return ControlOutput(wish, side, sight[1], heading, bearing, *terms)

    def _level(self, own: EgoState, ball: Floats, yaw: float, step: float) -> tuple[float, float]:
        """Accelerations to the right and ahead, m/s^2, that lead to the set place."""
        goal, speed, push = self._goal(ball)
        cos, sin = math.cos(yaw), math.sin(yaw)
        place, velocity = own.place.tolist(), own.velocity.tolist()
        x, z = goal[0] - place[0], goal[1] - place[2]
        vx, vz = speed[0] - velocity[0], speed[1] - velocity[2]
        right, ahead = x * cos - z * sin, x * sin + z * cos
        speed_right, speed_ahead = vx * cos - vz * sin, vx * sin + vz * cos
        return (
            self._right.update(0.0, -right, step, -speed_right) + push[0] * cos - push[1] * sin,
            self._ahead.update(0.0, -ahead, step, -speed_ahead) + push[0] * sin + push[1] * cos,
        )

    def _goal(self, ball: Floats) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float]]:
        """Find the set place in the frame at rest, x and z, its speed, and what of its acceleration is flown.

        The level ball frame is z = out, y down, x = y cross z; it turns with the neighbor.
        """
        x, _, z, way = ball.tolist()  # of each the place, its speed, and the accelerations of sway and drift
        sin, cos, turning = math.sin(way[0]), math.cos(way[0]), way[1]
        side, heading = self.place.side, self.place.heading
        away = (side * cos + heading * sin, heading * cos - side * sin)
        sway, drift = self.parameters.ahead, self.parameters.drift
        right, forward, turned = (sway * each[2] + drift * each[3] for each in (x, z, way))
        return (
            (x[0] + away[0], z[0] + away[1]),
            (self._paces[0].of(x[1]) + turning * away[1], self._paces[2].of(z[1]) - turning * away[0]),
            (right + turned * away[1], forward - turned * away[0]),
        )
