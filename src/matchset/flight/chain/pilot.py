"""The loop of one follower: capture, track, localize, control, filter for safety, send. `Pilot.step` is all of it.

It does not know where pictures come from and where commands go, so it flies a simulated vehicle and a real one alike
(Epstein & Feldman, section 4, steps 1-8).
"""

import itertools
import math
import time

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.control.control_output import ControlOutput
from matchset.control.follower import Follower, FollowerParameters, RelativeSetpoint
from matchset.control.repeated_picture import PicturesSeen, RepeatedPictureParameters, note_picture
from matchset.control.safety import SafetyInputs, SafetyParameters, SafetyState, safety_filter
from matchset.flight.chain.excitation import Excitation, ExcitationParameters
from matchset.flight.real_time.rehearsal import RehearsalCamera, RehearsalLink
from matchset.image.frame import Frame
from matchset.links.camera import Camera
from matchset.links.link import Link
from matchset.localization.ball_target import NeighborBall
from matchset.localization.localizer import Localizer
from matchset.localization.markers.ball_colors import BallColors
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.neighbor_ball import AssociationParameters, distance_seen, find_neighbor_ball, in_lights
from matchset.localization.next_ball.next_ball_tracker import NextBallParameters, NextBallTracker
from matchset.localization.pose import Pose
from matchset.numeric.arguments import require_positive
from matchset.shapes.circle import Circle
from matchset.tracking.parameters import in_flight
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker

STAGES = ("capture", "track", "markers", "localize", "control", "send")
"""Of a step, in their order; `PilotStep.stage_times` has their computing times."""
Outlines = tuple[Track[Circle] | Lost[Circle], tuple[Track[Circle], ...]]
"""What was seen in a picture: the ball, and its markers."""


class PilotStep(msgspec.Struct, frozen=True, kw_only=True):
    """All that happened in one step of the loop; drawing, recording and reports read nothing else.

    Parameters
    ----------
    now : float
        When the command was sent, s, on the clock of the pictures.
    frame : Frame or None
        None if no picture came.
    ball : Track or Lost
    markers : tuple of Track
    pose : Pose or Lost
        Of the ball in the camera frame, at the time of the frame.
    control : ControlOutput or None
        The follower's desired command, and the controllers' terms; None while the neighbor is not known.
    command : Command
        What was sent, as the link confirmed it.
    safety : SafetyState
        State of the safety filter: its phase, and why.
    age : float
        From capture to command, s; inf before the first picture.
    stage_times : tuple of float
        Computing time of each of `STAGES`, s.
    stopped : str
        Why the motors were stopped in this step although the safety filter saw no reason: by `Pilot.cut`, or since the
        link refused. Empty if they were not.
    landing : str
        Why it descends by `Pilot.land`; empty if it does not.
    """

    now: float
    frame: Frame | None
    ball: Track[Circle] | Lost[Circle]
    markers: tuple[Track[Circle], ...]
    pose: Pose | Lost[Pose]
    control: ControlOutput | None
    command: Command
    safety: SafetyState
    age: float
    stage_times: tuple[float, ...]
    stopped: str = ""
    landing: str = ""

    @property
    def processing(self) -> float:
        """Computing time from picture to command, s."""
        return sum(self.stage_times[1:])


class PilotParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of a follower's loop, as `flight.toml` has them.

    Parameters
    ----------
    target : NeighborBall
    place : RelativeSetpoint
    near : float
        Largest distance from the expected position at which a ball is taken for the neighbor's at first, m. Less than
        the distance to the next ball but one, which looks the same; more lets a follower begin farther off its place.
        Chosen by: `python -m benchmarks.flight.fly --only start`, see docs/log/control.md#how-well.
    association : AssociationParameters
    next_ball : NextBallParameters
    follower : FollowerParameters
    repeated : RepeatedPictureParameters
    safety : SafetyParameters
    excitation : ExcitationParameters or None
        Known motions that are added to the sticks, to identify the vehicle by; None for none.
    """

    target: NeighborBall = NeighborBall()
    place: RelativeSetpoint = RelativeSetpoint(height=-0.19)
    near: float = 1.0
    association: AssociationParameters = AssociationParameters()
    next_ball: NextBallParameters = NextBallParameters()
    follower: FollowerParameters = FollowerParameters()
    repeated: RepeatedPictureParameters = RepeatedPictureParameters()
    safety: SafetyParameters = SafetyParameters()
    excitation: ExcitationParameters | None = None

    def __post_init__(self) -> None:
        require_positive(self, ("near",))
        away, least = math.hypot(*msgspec.structs.astuple(self.place)), self.safety.min_distance
        if not away > least:
            raise ValueError(f"a follower goes back from less than {least:g} m, but its place is {away:.2f} m away")


class Pilot:
    """Flies one follower by its own camera. Its constructor compiles everything that `step` calls, and rehearses it.

    Parameters
    ----------
    camera : Camera
    link : Link
    colors : BallColors
    parameters : PilotParameters, optional

    Attributes
    ----------
    parameters : PilotParameters
    camera : Camera
    link : Link
    armed : bool
        Whether it was told to fly.
    killed : str
        Why its motors were stopped by `cut`; empty if they were not.
    landing : str
        Why it descends by `land`; empty if it does not.
    """

    def __init__(
        self, camera: Camera, link: Link, colors: BallColors, parameters: PilotParameters | None = None
    ) -> None:
        self.parameters = parameters or PilotParameters()
        self.camera, self.link, self._colors = camera, link, colors
        self._begin()
        self._pixel(np.array((0.0, 0.0, 1.0)))  # compiles what it calls
        self._rehearse()

    def _begin(self) -> None:
        """Know nothing, and be disarmed."""
        target = self.parameters.target
        self.armed, self.killed, self.landing, self._rejected_poses = False, "", "", 0
        self._link_is_armed = False
        self._begin_tracking()
        self._localizer = Localizer(self.camera.model, target)
        self._follower = Follower(self.parameters.place, self.parameters.follower)
        self._safety, shaken = SafetyState(), self.parameters.excitation
        self._excitation = None if shaken is None else Excitation(self.parameters.place, shaken)
        self._pictures, self._fault = PicturesSeen(), ""
        self._frame_time = self._seen_time = -math.inf
        self._distances = (math.inf, math.inf)

    def _begin_tracking(self) -> None:
        """Make what finds balls and markers in pictures."""
        ball, target = self._colors.ball, self.parameters.target
        self._lights = in_lights(ball, self.parameters.association.shade)
        camera = self.camera.model
        parameters = in_flight(math.sqrt(camera.fx * camera.fy), (camera.cx, camera.cy))
        self._tracker = Tracker(Circle, ball, parameters=parameters)
        self._markers = MarkerTracker(self._colors.marker, target)
        self._next_ball = NextBallTracker(self.camera.model, target, ball, self.parameters.next_ball)

    def _rehearse(self) -> None:
        """Take some steps with painted pictures and nobody at the other end, then forget them."""
        camera, link, place = self.camera, self.link, self.parameters.place
        where = place.side, place.height, place.heading
        painted = RehearsalCamera(camera.model, *self._colors, self.parameters.target, where)
        self.camera, self.link = painted, RehearsalLink()
        try:
            self.arm()
            for _ in range(len(painted) + 1):
                self.step()
        finally:
            self.camera, self.link = camera, link
            self._begin()

    def arm_link(self) -> None:
        """Arm the link alone, which may take a moment: the motors stay off until `arm`, which then takes none."""
        self.link.arm()
        self._link_is_armed = True

    def arm(self) -> None:
        """Fly from the next step on, as soon as the ball is seen; also after the motors were stopped."""
        self._safety, self.killed, self.landing, self._fault = SafetyState(), "", "", ""
        self._pictures = self._pictures._replace(went_back=False)
        if not self._link_is_armed or self.link.status().refusal:
            self.link.arm()
        self.armed, self._link_is_armed = True, False

    def cut(self, reason: str) -> None:
        """Stop the motors at once, until `arm`: the vehicle falls. May be called by another thread or a signal handler.

        Parameters
        ----------
        reason : str
            Why, in words.
        """
        self.killed = reason
        self.link.cut()

    def land(self, reason: str) -> None:
        """Descend from the next step on, until `arm`: level, with less and less throttle, then the motors stop.

        One that does not fly yet never will. May be called by another thread or a signal handler.

        Parameters
        ----------
        reason : str
            Why, in words.
        """
        self.landing = reason

    def is_losing_sight(self, ahead: float, margin: float) -> bool:
        """Whether the ball that it watches will come near the border of the picture; False if that is not known.

        Parameters
        ----------
        ahead : float
            How long from now, s.
        margin : float
            How near the middle of the ball comes to the border, radii of the ball.
        """
        expected = self._follower.expected(self.camera.now() + ahead, reach=math.inf)
        if expected is None:
            return False
        radius = self.parameters.target.radius
        outward = expected * (1.0, 1.0, 0.0) / max(float(np.hypot(*expected[:2])), radius)
        return self._pixel(expected + margin * radius * outward) is None

    def step(self) -> PilotStep:
        """Wait for the newest picture and answer it with a command.

        After `cut`, or when the link refuses to fly, the phase is ``cut`` until the pilot is armed again.

        Raises
        ------
        LinkError
            If the camera or the link is gone.
        """
        stamps = [time.perf_counter()]
        frame = self.camera.read()
        stamps.append(time.perf_counter())
        now = self.camera.now()
        ball, markers, pose = self._locate(frame, now, stamps)
        control = self._follower.update(pose, now)
        self._check_association(pose)
        fault = self._picture_fault()
        doubt = self._follower.neighbor.doubt if isinstance(pose, Pose) else ""
        hover, landing, distance = self._follower.hover_throttle, self.landing or fault, max(self._distances)
        seen, holds = self._seen_time, self._follower.sticks.hold_throttle
        inputs = SafetyInputs(now, self._frame_time, seen, self.armed, landing, doubt, hover, distance, holds)
        desired = control and (self._excitation(control, self._safety, now) if self._excitation else control.desired)
        wanted, self._safety = safety_filter(desired, inputs, self._safety, self.parameters.safety)
        stopped = self._stop_reason()
        if stopped:
            wanted, self._safety = Command(), SafetyState("cut", stopped, now)
        stamps.append(time.perf_counter())
        command = self.link.send(wanted)
        self._follower.sent(command, now)
        stamps.append(time.perf_counter())
        return PilotStep(
            now=now,
            frame=frame,
            ball=ball,
            markers=markers,
            pose=pose,
            control=control,
            command=command,
            safety=self._safety,
            age=now - self._frame_time,
            stage_times=tuple(b - a for a, b in itertools.pairwise(stamps)),
            stopped=stopped,
            landing=self.landing,
        )

    def _stop_reason(self) -> str:
        """Say why the motors have stopped although the safety filter would fly on; empty if they have not."""
        why = self.killed or (self.link.status().refusal if self.armed else "")
        return "" if self._safety.phase == "cut" else why

    def _picture_fault(self) -> str:
        """Say why the pictures must not be flown by; those of another time are not to be trusted again until `arm`."""
        again = self._pictures.repeats >= self.parameters.repeated.max_repeats
        if again and self._pictures.went_back:
            self._fault = "pictures come that came before"
        elif self._safety.phase == "descending" and self._pictures.repeats >= self.parameters.repeated.final_repeats:
            self._fault = "the picture stood still for so long that those that come next may be old"
        elif not self._follower.consistency.is_current and not self._fault:  # what is known exactly stays said
            self._fault = "the motion seen does not answer to the commands: old pictures, or commands that got lost"
        return self._fault or ("the picture stands still" if again else "")

    def _locate(self, frame: Frame | None, now: float, stamps: list[float]) -> tuple[*Outlines, Pose | Lost[Pose]]:
        """Track and localize, with a time stamp after each stage."""
        if frame is not None:
            self._pictures = note_picture(frame.image, self._pictures, self.parameters.repeated)
        if frame is None or self._pictures.repeats:
            why = "no picture came" if frame is None else "a picture came again"
            stamps.extend([stamps[-1]] * 3)
            return Lost(why, now), (), Lost(why, now)
        ball, markers = self._outlines(frame, stamps)
        pose = self._localizer.update(ball, markers)
        self._distances = (self._distances[1], distance_seen(pose, self._distances[1]))
        if self.parameters.follower.next_but_one.share and frame.index % self.parameters.next_ball.every == 0:
            self._look_beyond(frame, ball)
        stamps.append(time.perf_counter())
        self._frame_time = frame.time
        return ball, markers, pose

    def _outlines(self, frame: Frame, stamps: list[float]) -> Outlines:
        """Track the ball and its markers, with a time stamp after each."""
        ball: Track[Circle] | Lost[Circle]
        if self._is_initialized(frame):
            ball = self._tracker.update(frame)
        else:
            ball = Lost("no ball is near the place where the neighbor should be", frame.time)
        stamps.append(time.perf_counter())
        markers = self._markers.update(frame, ball)
        stamps.append(time.perf_counter())
        return ball, markers

    def _look_beyond(self, frame: Frame, ball: Track[Circle] | Lost[Circle]) -> None:
        """Locate the next-but-one ball, and tell the follower."""
        beyond, follower = self._see_beyond(frame, ball), self._follower
        if isinstance(beyond, Pose):
            follower.next_but_one.update(follower.mount.turn(beyond), follower.ego_motion.at(beyond.time))

    def _see_beyond(self, frame: Frame, ball: Track[Circle] | Lost[Circle]) -> Pose | Lost[Pose]:
        """Locate the next-but-one ball, beside the neighbor's in the same picture."""
        expected = self._follower.expected(frame.time, beyond=True)
        followed = self._follower.next_but_one.is_followed(frame.time)
        if expected is None or isinstance(ball, Lost):
            return Lost("where the neighbor is, is not known", frame.time)
        return self._next_ball.update(frame, self._tracker.color, ball.shape, expected, followed)

    def _is_initialized(self, frame: Frame) -> bool:
        """Whether there is a ball to track; before the follower has accepted one, start with the nearest candidate."""
        if self._follower.neighbor.time > -math.inf:
            return True
        place, near, candidates = self.parameters.place, self.parameters.near, self.parameters.association.candidates
        expected = np.array([place.side, place.height, place.heading])  # level, at the set place, its marker toward us
        ball = find_neighbor_ball(frame, self._lights, self._localizer, expected, near, candidates)
        if ball is not None:
            self._tracker.start(ball)
        return ball is not None

    def _check_association(self, pose: Pose | Lost[Pose]) -> None:
        """Note when the follower accepted a pose; restart the tracker when its gate rejects one after the other."""
        if not isinstance(pose, Pose):
            return
        if self._follower.neighbor.time == pose.time:
            self._seen_time, self._rejected_poses = pose.time, 0
            return
        self._rejected_poses += 1
        expected = self._follower.expected(pose.time)
        if self._rejected_poses % self.parameters.association.rejected_poses or expected is None:
            return
        if (pixel := self._pixel(expected)) is not None:
            self._restart_tracking(pixel)

    def _restart_tracking(self, pixel: tuple[float, float]) -> None:
        """Look for the ball where it is expected, px, and forget which outline was followed."""
        self._tracker.restart(pixel, same_camera=True)

    def _pixel(self, position: npt.NDArray[np.float64]) -> tuple[float, float] | None:
        """Project a position in the camera frame, (3,), m, to the picture, px; None if it is not visible there."""
        if not self.camera.model.visible(position[np.newaxis])[0]:
            return None
        x, y = self.camera.model.project(position[np.newaxis])[0]
        return float(x), float(y)
