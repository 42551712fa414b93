"""Position control beside a neighbor, by its ball: `Follower`.

Everything is computed in a level frame at rest, found by dead reckoning (`ego_motion.py`), in which the neighbor's ball
is filtered (`neighbor_filter.py`) and predicted for the time at which a command acts. There the ball's marker points
out of the neighbor, and the setpoint is ``ball + side x + heading z + height up`` with the level axes of the ball
(Epstein & Feldman, Eq. 6-8).
"""

import math
from typing import Literal, Self

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.chain.gain_schedule import Gains, GainSchedule, GainScheduleParameters
from matchset.control.chain.next_but_one import NextButOne, NextButOneParameters
from matchset.control.command import Command
from matchset.control.control_output import ControlOutput
from matchset.control.ego_motion import EgoMotion, EgoState
from matchset.control.feedforward import FeedforwardParameters, SpeedFeedforward
from matchset.control.learned.common_motion import CommonMotionParameters, hand_over
from matchset.control.learned.thrust_estimator import ThrustEstimatorParameters
from matchset.control.motion_consistency import MotionConsistency, MotionConsistencyParameters
from matchset.control.mount.camera_mount import CameraMount, MountParameters
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.neighbor_model import Forecast, NeighborFilterParameters
from matchset.control.pid import Pid, PidParameters
from matchset.control.stability.follower_loops import LoopParameters
from matchset.control.stability.gain_limit import GainLimit, StabilityParameters
from matchset.control.sticks.angle_sticks import WantedMotion
from matchset.control.sticks.ego_parameters import EgoMotionParameters
from matchset.control.sticks.kinds import lift_off_of, sticks_for
from matchset.control.sticks.speed_parameters import SpeedParameters
from matchset.localization.pose import Pose
from matchset.numeric.arguments import require, require_not_negative, require_positive, require_share
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]
Pair = tuple[float, float]


class RelativeSetpoint(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where to be, in the level frame of the neighbor's ball, m.

    Parameters
    ----------
    side, height, heading : float
        To the side (+x of the ball frame), above, and before the marker.
    """

    side: float = 0.0
    height: float = 0.0
    heading: float = 1.5


class FollowerParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of a `Follower`.

    All gains were searched for (decision 074, seeds 0 to 9), then changed by hand for robustness to thrust, tilt and
    motors that differ. `python -m benchmarks.flight.fly` shows a change.

    Parameters
    ----------
    commands : str
        What the sticks of the vehicle are: "angles", and thrust; or "speeds", which it holds by itself. The link of a
        real flight and the world of a simulated one decide it, so a file need not name it.
    horizontal : PidParameters
        From m to m/s^2, for both level axes.
    vertical : PidParameters
        From m to m/s^2, upward.
    yaw : PidParameters
        From the bearing of the ball, rad, to a yaw rate, rad/s. Slow: a ball that turns fast disturbs who watches it.
        Its integral learns a trim; its lead is the lag of this loop and more: an answered turn is no trim.
    hover_throttle : float
        Throttle that hovers, roughly; `thrust_estimator` finds the rest. Estimate.
    horizontal_lead, vertical_lead : float
        Time from the first to the full effect of a command, s, for which level axes and height are predicted. More is
        calmer, until the prediction fails. Decision 074; about tilt_lag + tilt_time, and lift_lag.
    oscillation_feedforward, drift_feedforward : float
        Shares of the setpoint's oscillating acceleration, and of its other one, that are flown at once, 0 ... 1. More
        follows closer, and passes it on to the next of the chain. Chosen by: decision 074.
    horizontal_feedforward, vertical_feedforward : FeedforwardParameters
        Feedforward of the neighbor's speed, level and upward.
    ego_motion : EgoMotionParameters
        The vehicle's answer to its sticks.
    neighbor_filter : NeighborFilterParameters
        Filter of the neighbor's poses.
    motion_consistency : MotionConsistencyParameters
        When the motion of the ball does not answer to the commands.
    thrust_estimator : ThrustEstimatorParameters
        Estimate of the throttle that hovers.
    common_motion, mount, next_but_one : CommonMotionParameters, MountParameters, NextButOneParameters
        Whose velocity the pictures show; how camera and marker are mounted; how the next-but-one ball counts.
    gain_schedule : GainScheduleParameters
        The gains that hold where chain and delay are short; those above hold where one of them is long.
    stability : StabilityParameters
        When gains are lowered.
    speeds : SpeedParameters
        What is otherwise where the vehicle is told speeds.
    max_stick : float
        Largest roll and pitch stick of the low gains, 0 ... 1; with all of it long chains fall in their start.
    max_extrapolation : float
        How long the neighbor's drift goes on after its last pose, s; then it stands still. Estimate.
    pose_timeout : float
        How long after the last pose there is an output, s; longer than `SafetyParameters.hold_time`.
    max_yaw_sigma : float
        Standard deviation of the direction of the neighbor's marker from which that is not known, and the place is held
        by the ball alone, rad. Less keeps to the ball sooner, and drifts around it; more flies to where the marker may
        long have turned away from. Chosen by hand: half a meter at 1.5 m.
    min_step, max_step, min_tilt_cosine : float
        Limits of the time between updates, s, for a clock that jumps, and of the cosine of the tilt over which the
        throttle is divided. Chosen by hand: 60 degrees.
    """

    commands: Literal["angles", "speeds"] = "angles"
    horizontal: PidParameters = PidParameters(
        proportional=4.0,
        integral=2.1,
        derivative=3.3,
        derivative_filter_time=0.033,
        max_error=0.4,
        output_limit=3.0,
        integral_limit=1.2,
        integral_zone=0.3,
        integral_lead=0.4,
        integral_decay_time=3.0,
        integral_floor=0.09,
    )
    vertical: PidParameters = PidParameters(
        proportional=5.5,
        derivative=7.5,
        derivative_filter_time=0.023,
        output_limit=4.0,
    )
    yaw: PidParameters = PidParameters(
        proportional=0.3, integral=0.03, output_limit=1.0, integral_limit=0.4, integral_lead=3.8
    )
    hover_throttle: float = 0.59
    horizontal_lead: float = 0.074
    vertical_lead: float = 0.038
    oscillation_feedforward: float = 0.85
    drift_feedforward: float = 0.45
    horizontal_feedforward: FeedforwardParameters = FeedforwardParameters(high_frequency_gain=0.7, crossover_time=0.23)
    vertical_feedforward: FeedforwardParameters = FeedforwardParameters(high_frequency_gain=0.42, crossover_time=0.75)
    ego_motion: EgoMotionParameters = EgoMotionParameters()
    neighbor_filter: NeighborFilterParameters = NeighborFilterParameters()
    motion_consistency: MotionConsistencyParameters = MotionConsistencyParameters()
    thrust_estimator: ThrustEstimatorParameters = ThrustEstimatorParameters()
    common_motion: CommonMotionParameters = CommonMotionParameters()
    mount: MountParameters = MountParameters()
    next_but_one: NextButOneParameters = NextButOneParameters()
    gain_schedule: GainScheduleParameters = GainScheduleParameters()
    stability: StabilityParameters = StabilityParameters()
    speeds: SpeedParameters = SpeedParameters()
    max_stick: float = 0.8
    max_extrapolation: float = 0.4
    pose_timeout: float = 1.2
    max_yaw_sigma: float = 0.3
    min_step: float = 1e-3
    max_step: float = 0.1
    min_tilt_cosine: float = 0.5

    def __post_init__(self) -> None:
        require(self, ("hover_throttle",), lambda value: 0.0 < value < 1.0, "within 0 ... 1")
        require_share(self, ("max_stick",))
        require_not_negative(self, ("oscillation_feedforward", "drift_feedforward", "horizontal_lead"))
        require_not_negative(self, ("vertical_lead", "max_extrapolation", "pose_timeout"))
        require_positive(self, ("min_step", "max_step", "min_tilt_cosine", "max_yaw_sigma"))

    @property
    def in_use(self) -> Self:
        """As it flies: for a vehicle that is told speeds with those of `speeds` in their places."""
        return msgspec.structs.replace(self, **self.speeds.changes(self)) if self.commands == "speeds" else self


class Follower:
    """Holds a setpoint beside one neighbor. The constructor compiles all kernels.

    Parameters
    ----------
    setpoint : RelativeSetpoint, optional
    parameters : FollowerParameters, optional

    Attributes
    ----------
    ego_motion : EgoMotion
    neighbor : NeighborFilter
    consistency : MotionConsistency
        Whether the ball moves in the pictures as the commands say.
    mount : CameraMount
    beyond : NextButOne
    limit : GainLimit
        Whether its gains are lowered, and why.
    thrust : ThrustEstimator or TakeOff
        What is known of the throttle that hovers, and of lift-off.
    sticks : Sticks
    """

    def __init__(self, setpoint: RelativeSetpoint | None = None, parameters: FollowerParameters | None = None) -> None:
        self.setpoint = setpoint or RelativeSetpoint()
        self.parameters = known = (parameters or FollowerParameters()).in_use
        self.ego_motion, self.consistency = EgoMotion(known.ego_motion), MotionConsistency(known.motion_consistency)
        self.neighbor, self.next_but_one = (
            NeighborFilter(known.neighbor_filter),
            NextButOne(known.next_but_one, known.neighbor_filter),
        )
        self.sticks, takeoff = sticks_for(known.ego_motion, known.min_tilt_cosine), known.speeds.takeoff_duration
        self.thrust = lift_off_of(known.ego_motion, known.hover_throttle, takeoff, known.thrust_estimator)
        self._right, self._forward = Pid(known.horizontal), Pid(known.horizontal)
        self._up, self._yaw = Pid(known.vertical), Pid(known.yaw)
        level, vertical = known.horizontal_feedforward, known.vertical_feedforward
        self._speed_x, self._speed_y, self._speed_z = map(SpeedFeedforward, (level, vertical, level))
        low = Gains(known.horizontal, level, vertical, max_stick=known.max_stick)
        self.mount, self._schedule = CameraMount(known.mount), GainSchedule(low, known.gain_schedule)
        loops = LoopParameters(*(getattr(known, name) for name in LoopParameters._fields))
        self.limit = GainLimit(loops, known.stability)
        self._pose_time = self._time = -math.inf

    def update(self, pose: "Pose | Lost[Pose]", now: float) -> ControlOutput | None:
        """Compute the command for a pose.

        Parameters
        ----------
        pose : Pose or Lost
            The neighbor's ball in the camera frame when the picture was taken.
        now : float
            When the command will be sent, s; it acts `EgoMotion.delay` later, and that is the time that counts.

        Returns
        -------
        ControlOutput or None
            None without a pose for `FollowerParameters.pose_timeout`, or before the first with a marker.
        """
        parameters = self.parameters
        if isinstance(pose, Pose) and pose.time > self._pose_time:
            since, self._pose_time = pose.time - self._pose_time, pose.time
            own, seen, pose = self.ego_motion.at(pose.time), pose, self.mount.turn(pose)
            if self.neighbor.update(pose, own):
                self.limit.note_filter(self.neighbor.gains, now - pose.time, since)
                airborne_time = pose.time - self.thrust.lift_time
                if not parameters.ego_motion.speed_commands:  # which know their speed better than a picture
                    hand_over(
                        self.ego_motion,
                        (self.neighbor, self.next_but_one.ball),
                        airborne_time,
                        since,
                        parameters.common_motion,
                    )
                self.consistency.update(pose, self.ego_motion, self.thrust.airborne)
                self.thrust.delay = self.ego_motion.delay
                upright = math.cos(own.roll) * math.cos(own.pitch)
                self.thrust.update(float(own.rotation[1] @ pose.position), upright, pose.time)
                if self.thrust.airborne:
                    self.mount.learn(seen, own)
        step, self._time = min(max(now - self._time, parameters.min_step), parameters.max_step), now
        acts = now + self.ego_motion.delay
        if not acts - self.neighbor.time <= parameters.pose_timeout or self.neighbor.yaw_time == -math.inf:
            return None
        return self._control(acts, step)

    def sent(self, command: Command, now: float) -> None:
        """Note the command that was sent, after limits and quantization; without lift the controllers are reset.

        Parameters
        ----------
        command : Command
        now : float
            When, s.
        """
        if not command.throttle > 0.0:
            self._up.reset()
            self.consistency.reset()
            self.thrust.reset()
        self.thrust.sent(command.throttle, now)
        if now + self.ego_motion.delay < self.thrust.lift_time:  # what they integrate in a hand is no trim
            for pid in (self._right, self._forward, self._yaw):
                pid.reset()
        trim = WantedMotion(*(pid.terms.integral for pid in (self._right, self._forward, self._up, self._yaw)))
        self.ego_motion.update(self.sticks.modeled_command(command, trim, self.hover_throttle), now)

    @property
    def hover_throttle(self) -> float:
        """Throttle that hovers, as far as it is known now."""
        return self.parameters.hover_throttle / self.thrust.gain

    def expected(self, time: float, beyond: bool = False, reach: float | None = None) -> Floats | None:
        """Predict the ball in the camera frame at a time, s.

        Parameters
        ----------
        time : float
        beyond : bool
            The next-but-one ball, not the neighbor's.
        reach : float, optional
            In place of `FollowerParameters.max_extrapolation`, s.

        Returns
        -------
        ndarray of shape (3,) or None
            m; None without a pose for `FollowerParameters.pose_timeout`.
        """
        if not time - self.neighbor.time <= self.parameters.pose_timeout:
            return None
        own, reach = self.ego_motion.at(time), self.parameters.max_extrapolation if reach is None else reach
        ball = (
            self.next_but_one.expected(self.neighbor, own, time, reach)
            if beyond
            else self.neighbor.at(time, reach).place
        )
        position: Floats = (own.rotation @ self.mount.from_camera).T @ (ball - own.position)
        return position

    def _control(self, acts: float, step: float) -> ControlOutput:
        """Run the controllers for a command that begins to act at a time."""
        parameters = self.parameters
        gains = self._schedule.update(acts - self.neighbor.time, step, acts - self.thrust.lift_time)
        self._right.parameters = self._forward.parameters = self.limit.horizontal(gains.horizontal)
        self._up.parameters, self._yaw.parameters = (
            self.limit.vertical(parameters.vertical),
            self.limit.yaw(parameters.yaw),
        )
        self._speed_x.parameters = self._speed_z.parameters = gains.horizontal_feedforward
        self._speed_y.parameters = gains.vertical_feedforward
        times = acts, acts + parameters.horizontal_lead, acts + parameters.vertical_lead
        own, own_level, own_vertical = self.ego_motion.at_times(times)
        ball, ball_level, ball_vertical = self.next_but_one.at_times(self.neighbor, times, parameters.max_extrapolation)
        doubt = self._yaw_doubt(acts)
        if doubt:
            ball, ball_level = self._turned(ball, own), self._turned(ball_level, own_level)
        for feedforward, axis in ((self._speed_x, ball.x), (self._speed_y, ball.y), (self._speed_z, ball.z)):
            feedforward.update(axis.speed, step)
        right, forward = self._go_level(own_level, ball_level, own.yaw, step)
        up = self._go_up(own_vertical, ball_vertical, step)
        x, y, z = (ball.place - own.position).tolist()  # from the vehicle to the ball
        bearing = math.remainder(math.atan2(x, z) - own.yaw, 2.0 * math.pi)
        most = gains.max_stick if acts >= self.thrust.lift_time else 0.0  # in a hand integrals wind up
        wanted = WantedMotion(right, forward, up, self._yaw.update(0.0, -bearing, step))
        desired = self.sticks.command(wanted, self.hover_throttle, most, (own.roll, own.pitch))
        self.limit.note_sticks(desired, most, acts, step, acts - self.thrust.lift_time)
        self.limit.check(gains, self.ego_motion.delay, self.thrust.sigma, step)
        sin, cos = math.sin(ball.yaw.value), math.cos(ball.yaw.value)
        terms = self._right.terms, self._forward.terms, self._up.terms, self._yaw.terms
        place = z * sin - x * cos, y, -x * sin - z * cos
        return ControlOutput(desired, *place, bearing, *terms, self.limit.state, doubt)

    def _yaw_doubt(self, acts: float) -> str:
        """Say that where the neighbor's marker points is not known when a command acts; empty if it is."""
        unknown = self.neighbor.yaw_sigma(acts) > self.parameters.max_yaw_sigma
        return f"no marker for {acts - self.neighbor.yaw_time:.0f} s, held by the ball alone" if unknown else ""

    def _turned(self, ball: Forecast, own: EgoState) -> Forecast:
        """Forecast as if the vehicle were in the direction of the setpoint."""
        x, _, z = own.position.tolist()
        return ball.turned_to(x, z, math.atan2(self.setpoint.side, self.setpoint.heading))

    def _go_up(self, own: EgoState, ball: Forecast, step: float) -> float:
        """Acceleration or speed upward that leads to the setpoint."""
        error = own.position.item(1) - ball.y.value + self.setpoint.height
        speed = self._speed_y.output(ball.y.speed)
        drift = -self._schedule.gains.vertical_drift_feedforward * ball.y.drift_acceleration
        ahead = self.sticks.feedforward(-speed, drift, upward=True)
        return ahead + self._up.update(0.0, -error, step, speed - own.velocity.item(1))

    def _go_level(self, own: EgoState, ball: Forecast, yaw: float, step: float) -> tuple[float, float]:
        """Accelerations or speeds to the right and forward that lead to the setpoint."""
        place, speed, (ax, az) = self._level_target(ball)
        cos, sin = math.cos(yaw), math.sin(yaw)
        position, velocity = own.position.tolist(), own.velocity.tolist()
        x, z = place[0] - position[0], place[1] - position[2]
        vx, vz = speed[0] - velocity[0], speed[1] - velocity[2]
        ax, az = self.sticks.feedforward(speed[0], ax), self.sticks.feedforward(speed[1], az)
        right, forward = x * cos - z * sin, x * sin + z * cos
        right_speed, forward_speed = vx * cos - vz * sin, vx * sin + vz * cos
        right = self._right.update(0.0, -right, step, -right_speed) + ax * cos - az * sin
        return right, self._forward.update(0.0, -forward, step, -forward_speed) + ax * sin + az * cos

    def _level_target(self, ball: Forecast) -> tuple[Pair, Pair, Pair]:
        """Find place, velocity and acceleration of the setpoint along x and z of the frame at rest.

        The level ball frame, z out, y down, x = y cross z, turns with the ball.
        """
        sin, cos, yaw_rate = math.sin(ball.yaw.value), math.cos(ball.yaw.value), ball.yaw.speed
        side, heading = self.setpoint.side, self.setpoint.heading
        x, z = side * cos + heading * sin, heading * cos - side * sin  # from the ball to the setpoint
        swing, drift = self.parameters.oscillation_feedforward, self.parameters.drift_feedforward
        ax, az, yaw_acceleration = (
            swing * axis.oscillation_acceleration + drift * axis.drift_acceleration
            for axis in (ball.x, ball.z, ball.yaw)
        )
        speed = self._speed_x.output(ball.x.speed) + yaw_rate * z, self._speed_z.output(ball.z.speed) - yaw_rate * x
        return (ball.x.value + x, ball.z.value + z), speed, (ax + yaw_acceleration * z, az - yaw_acceleration * x)
