"""One neighbor: its ball, its markers, its pose, and where it should be while it is hidden: `Neighbor`, `Member`."""

import math

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker
from matchset.tracking.voting import SearchParameters

FADE = 0.5  # s after which the velocity of a ball that is not seen has faded to 1/e
SLOW = 0.3  # share of the latest change that its usual size follows
GAIN = 0.4  # share of the latest change that its velocity follows


class Neighbor(msgspec.Struct, frozen=True):
    """A ball in view, or hidden for a while.

    Parameters
    ----------
    identity : int
        Its number, from 0 in the order of first sight; it keeps it.
    pose : Pose or Lost
        Where it is.
    ball : Track or Lost
        Its ball in this frame.
    markers : tuple of Track
        Its markers in this frame.
    marked : bool
        Whether a marker was seen on it lately: a neighbor; otherwise it is a ball of the right color without one.
    """

    identity: int
    pose: Pose | Lost[Pose]
    ball: Track[Circle] | Lost[Circle]
    markers: tuple[Track[Circle], ...]
    marked: bool


class Member:
    """What follows one ball: a tracker that never searches, its markers, its pose.

    Parameters
    ----------
    identity : int
    camera, target, ball_color, marker_color
        As for `Neighbors`.
    points : int
        Lines across the ball's outline.
    circle : Circle
        Where it was seen first, px.
    frame : Frame
        When.
    """

    def __init__(
        self,
        identity: int,
        camera: CameraModel,
        target: BallTarget,
        ball_color: ColorModel,
        marker_color: ColorModel,
        points: int,
        circle: Circle,
        frame: Frame,
    ) -> None:
        self.identity = identity
        self.tracker = Tracker(
            Circle, ball_color, points, parameters=TrackerParameters(search=SearchParameters(whole_frame=False))
        )
        self.markers = MarkerTracker(marker_color, target)
        self.localizer = Localizer(camera, target)
        self.circle, self.time, self.marked_at = circle, frame.time, -math.inf
        self.usual = circle.radius
        self._velocity = [0.0, 0.0, 0.0]
        self.tracker.start(circle)

    def expected(self, time: float) -> Circle:
        """Where the ball should be at a time, s: its velocity fades while it is not seen."""
        ahead = FADE * (1.0 - math.exp(-max(time - self.time, 0.0) / FADE))
        x, y, radius = (
            value + ahead * speed
            for value, speed in zip((self.circle.x, self.circle.y, self.circle.radius), self._velocity, strict=True)
        )
        return Circle(x, y, min(max(radius, 0.8 * self.usual), 1.25 * self.usual))

    def follow(self, frame: Frame, again: bool) -> Track[Circle] | Lost[Circle]:
        """Follow the ball into a frame; `again` from where it should be, since it was hidden."""
        if again:
            self.tracker.start(self.expected(frame.time))
        return self.tracker.update(frame)

    def meet(self, circle: Circle, time: float) -> None:
        """Go on from where a search saw the ball again."""
        self.tracker.start(circle)
        self.circle, self.time, self.usual = circle, time, circle.radius
        self._velocity = [0.0, 0.0, 0.0]

    def take_in(self, ball: Track[Circle], clear: bool) -> None:
        """Learn from a sighting where the ball is and how it moves; its usual size only from a clear one."""
        self.usual += SLOW * (ball.shape.radius - self.usual) if clear else 0.0
        passed = ball.time - self.time
        if passed > 0.0:
            new = (ball.shape.x, ball.shape.y, ball.shape.radius)
            old = (self.circle.x, self.circle.y, self.circle.radius)
            self._velocity = [
                speed + GAIN * ((b - a) / passed - speed) for speed, a, b in zip(self._velocity, old, new, strict=True)
            ]
        self.circle, self.time = ball.shape, ball.time

    def tell(self, frame: Frame, ball: Track[Circle] | Lost[Circle], memory: float) -> Neighbor:
        """Find the markers, place the ball, and answer."""
        markers = self.markers.update(frame, ball)
        if markers:
            self.marked_at = frame.time
        pose = self.localizer.update(ball, markers)
        return Neighbor(self.identity, pose, ball, markers, frame.time - self.marked_at <= memory)
