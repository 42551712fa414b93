"""The loop of one follower: capture, track, localize, control, guard, send. `Pilot.step` is all of it.

It knows nothing of where pictures come from and where commands go, so it flies a simulated vehicle and a real one alike
(Epstein & Feldman, section 4, steps 1-8).
"""

import itertools
import math
import time
from typing import NamedTuple, Protocol

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.control.follower import ControlOutput, Follower, FollowerParameters, RelativeSetpoint
from matchset.control.safety import SafetyInputs, SafetyParameters, SafetyState, safety_filter
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.links.link import Link
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.detect import detect
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker

DOUBTED = 3  # poses in a row that cannot be those of the neighbor, before it is looked for where it should be
STAGES = ("capture", "track", "markers", "localize", "control", "send")


class Camera(Protocol):
    """Where pictures come from.

    Attributes
    ----------
    model : CameraModel
    """

    model: CameraModel

    def read(self) -> Frame | None:
        """Return the newest picture; None if none came in the time of one."""

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""


class Colors(NamedTuple):
    """What the ball and its marker look like: the paper's filters a and b."""

    ball: ColorModel
    marker: ColorModel


class PilotStep(msgspec.Struct, frozen=True, kw_only=True):
    """All that happened in one turn of the loop; drawing, recording and reports read nothing else.

    Parameters
    ----------
    now : float
        When the command was sent, s, on the clock of the pictures.
    frame : Frame or None
        None if no picture came.
    ball : Track or Lost
    markers : tuple of Track
    pose : Pose or Lost
        In the camera frame, at the time of the frame.
    control : ControlOutput or None
        What the follower wants, and why.
    command : Command
        What was sent, as the link confirmed it.
    safety : SafetyState
        Of the safety: its phase and its words.
    age : float
        From capture to command, s; inf before the first picture.
    stage_times : tuple of float
        Computing time of each of `STAGES`, s.
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

    @property
    def processing(self) -> float:
        """Computing time from picture to command, s."""
        return sum(self.stage_times[1:])


class PilotParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Everything that a follower's loop can be told.

    Parameters
    ----------
    target : BallTarget
    place : RelativeSetpoint
    near : float
        How far off its place a follower may begin, m: of the balls that near to where the neighbor's would be the
        nearest is taken for it. Less than the way to the next but one, which looks the same.
    follower : FollowerParameters
    safety : SafetyParameters
    """

    target: BallTarget = BallTarget()
    place: RelativeSetpoint = RelativeSetpoint(height=-0.19)
    near: float = 1.0
    follower: FollowerParameters = FollowerParameters()
    safety: SafetyParameters = SafetyParameters()

    def __post_init__(self) -> None:
        if not 0.0 < self.near < math.inf:
            raise ValueError(f"near must be positive, got {self.near}")


class Pilot:
    """Flies one follower by its own camera.

    Parameters
    ----------
    camera : Camera
    link : Link
    colors : Colors
    parameters : PilotParameters, optional
    """

    def __init__(self, camera: Camera, link: Link, colors: Colors, parameters: PilotParameters | None = None) -> None:
        self.parameters = parameters or PilotParameters()
        self.camera, self.link = camera, link
        self.armed = False
        target = self.parameters.target
        self._colors, self._rejected_poses = colors, 0
        self._tracker = Tracker(Circle, colors.ball)
        self._markers = MarkerTracker(colors.marker, target)
        self._localizer = Localizer(camera.model, target)
        self._follower = Follower(self.parameters.place, self.parameters.follower)
        self._memory = SafetyState()
        self._frame_time = self._seen = -math.inf

    def arm(self) -> None:
        """Fly from the next step on, as soon as the ball is seen."""
        self.link.arm()
        self.armed = True

    def step(self) -> PilotStep:
        """Wait for the newest picture and answer it with a command.

        Raises
        ------
        LinkError
            If the camera or the link is gone.
        """
        stamps = [time.perf_counter()]
        frame = self.camera.read()
        stamps.append(time.perf_counter())
        now = self.camera.now()
        ball, markers, pose = self._perceive(frame, now, stamps)
        control = self._follower.update(pose, now)
        self._update_gate(pose)
        facts = SafetyInputs(now, self._frame_time, self._seen, self.armed)
        wanted, self._memory = safety_filter(control and control.desired, facts, self._memory, self.parameters.safety)
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
            safety=self._memory,
            age=now - self._frame_time,
            stage_times=tuple(b - a for a, b in itertools.pairwise(stamps)),
        )

    def _perceive(
        self, frame: Frame | None, now: float, stamps: list[float]
    ) -> tuple[Track[Circle] | Lost[Circle], tuple[Track[Circle], ...], Pose | Lost[Pose]]:
        """Track and localize, with a time stamp after each stage."""
        if frame is None:
            stamps.extend([stamps[-1]] * 3)
            return Lost("no picture came", now), (), Lost("no picture came", now)
        if self._initialized(frame):
            ball: Track[Circle] | Lost[Circle] = self._tracker.update(frame)
        else:
            ball = Lost("no ball is near the place where the neighbor should be", frame.time)
        stamps.append(time.perf_counter())
        markers = self._markers.update(frame, ball)
        stamps.append(time.perf_counter())
        pose = self._localizer.update(ball, markers)
        stamps.append(time.perf_counter())
        self._frame_time = frame.time
        return ball, markers, pose

    def _initialized(self, frame: Frame) -> bool:
        """Whether there is a ball to follow: before one was believed the nearest that may be it."""
        if self._follower.neighbor.time > -math.inf:
            return True
        place, near = self.parameters.place, self.parameters.near
        there = np.array([place.side, place.height, place.heading])  # level, at the set place, its marker toward us
        ball = find_neighbor_ball(frame, self._colors.ball, self._localizer, there, near)
        if ball is not None:
            self._tracker.start(ball)
        return ball is not None

    def _update_gate(self, pose: Pose | Lost[Pose]) -> None:
        """Note when the ball was seen where it can be; look for it anew when another one is followed."""
        if not isinstance(pose, Pose):
            return
        if self._follower.neighbor.time == pose.time:
            self._seen, self._rejected_poses = pose.time, 0
            return
        self._rejected_poses += 1
        there = self._follower.expected(pose.time)
        if (
            self._rejected_poses % DOUBTED == 0
            and there is not None
            and self.camera.model.visible(there[np.newaxis])[0]
        ):
            x, y = self.camera.model.project(there[np.newaxis])[0]
            self._tracker = Tracker(Circle, self._colors.ball, start=(float(x), float(y)))


def learn_colors(sample: Frame) -> Colors:
    """Learn the colors from a picture of the ball in the middle, its marker toward the camera.

    Parameters
    ----------
    sample : Frame
        The ball at about 1 m: its marker holds the middle, and a point 3 marker radii to the left shows the ball.
    """
    height, width = sample.image.shape[:2]
    x, y = (width - 1) / 2.0, (height - 1) / 2.0
    marker = ColorModel.pick(sample.image, x, y)
    ball = ColorModel.pick(sample.image, x - 0.0625 * width, y)
    return Colors(ball | marker, marker)


MOST = 6  # balls that are looked at


def find_neighbor_ball(
    frame: Frame, color: ColorModel, localizer: Localizer, there: npt.NDArray[np.float64], reach: float
) -> Circle | None:
    """Of the balls that may be the neighbor's the nearest to the camera: the next but one looks the same, farther off.

    Parameters
    ----------
    frame : Frame
    color : ColorModel
        Of the ball with its marker.
    localizer : Localizer
        Tells where a ball is; without markers it remembers nothing of it.
    there : ndarray of shape (3,)
        Where the neighbor should be, in the camera frame, m.
    reach : float
        How far from there a ball may be to be the neighbor's, m.

    Returns
    -------
    Circle or None
        None if no ball may be it.
    """
    best: Circle | None = None
    nearest = math.inf
    for track in detect(frame, Circle, color, limit=MOST):
        pose = localizer.update(track)
        if isinstance(pose, Pose) and np.linalg.norm(pose.position - there) < reach and pose.distance < nearest:
            best, nearest = track.shape, pose.distance
    return best
