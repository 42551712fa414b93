"""One neighbor: its ball, its markers, its pose, and its prediction while it is hidden: `Neighbor`, `BallTrack`."""

import math
from typing import NamedTuple

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer, LocalizerParameters
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.markers.marker_workspace import MarkerParameters
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.voting import SearchParameters
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker

WITHOUT_SEARCH = TrackerParameters(search=SearchParameters(whole_frame=False))


class Neighbor(msgspec.Struct, frozen=True):
    """A ball in view, or hidden for a while.

    Parameters
    ----------
    identity : int
        Its number, from 0 in the order of first sight; it keeps it.
    pose : Pose or Lost
        Position and rotation.
    ball : Track or Lost
        Its ball in this frame.
    markers : tuple of Track
        Its markers in this frame.
    marked : bool
        Whether a marker was seen on it recently: then it is a neighbor, otherwise a ball of the right color without
        markers.
    """

    identity: int
    pose: Pose | Lost[Pose]
    ball: Track[Circle] | Lost[Circle]
    markers: tuple[Track[Circle], ...]
    marked: bool


class BallTrackParameters(msgspec.Struct, frozen=True):
    """How one ball is predicted while it is not seen.

    All were chosen by hand; `python -m benchmarks --only localization_neighbors` would show a change.

    Parameters
    ----------
    points : int
        Lines across a ball's outline, see `Tracker`.
    velocity_decay : float
        Time after which the velocity of a ball that is not seen has decayed to 1/e, s.
    velocity_gain : float
        Share of a new velocity that is taken over (alpha-beta filter).
    radius_gain : float
        The same of a new radius for the typical one.
    min_growth, max_growth : float
        Smallest and largest predicted radius, in typical ones.
    tracker : TrackerParameters
        Of the ball's tracker. By default it does not search the whole frame: `BallSearch` does, once for all balls.
    markers : MarkerParameters
    localizer : LocalizerParameters
    """

    points: int = 64
    velocity_decay: float = 0.5
    velocity_gain: float = 0.4
    radius_gain: float = 0.3
    min_growth: float = 0.8
    max_growth: float = 1.25
    tracker: TrackerParameters = WITHOUT_SEARCH
    markers: MarkerParameters = MarkerParameters()
    localizer: LocalizerParameters = LocalizerParameters()


class BallTrackSetup(NamedTuple):
    """What all balls of a `Neighbors` have in common; see there."""

    camera: CameraModel
    target: BallTarget
    ball_color: ColorModel
    marker_color: ColorModel
    parameters: BallTrackParameters


class BallTrack:
    """One ball that is followed: a tracker that never searches the whole frame, its markers, its pose.

    Parameters
    ----------
    identity : int
    setup : BallTrackSetup
    circle : Circle
        Where it was detected, px.
    time : float
        When, s.
    """

    def __init__(self, identity: int, setup: BallTrackSetup, circle: Circle, time: float) -> None:
        self.identity, self.parameters = identity, setup.parameters
        self.tracker = Tracker(Circle, setup.ball_color, setup.parameters.points, parameters=self.parameters.tracker)
        self.markers = MarkerTracker(setup.marker_color, setup.target, self.parameters.markers)
        self.localizer = Localizer(setup.camera, setup.target, self.parameters.localizer)
        self.circle, self.time, self.marker_time = circle, time, -math.inf
        self.typical_radius = circle.radius
        self._velocity = [0.0, 0.0, 0.0]
        self.tracker.start(circle)

    def predict(self, time: float) -> Circle:
        """Circle at a time, s; the velocity decays while the ball is not seen."""
        limits = self.parameters
        gone = max(time - self.time, 0.0)
        ahead = limits.velocity_decay * (1.0 - math.exp(-gone / limits.velocity_decay))
        x, y, radius = (
            value + ahead * speed
            for value, speed in zip((self.circle.x, self.circle.y, self.circle.radius), self._velocity, strict=True)
        )
        least, most = limits.min_growth * self.typical_radius, limits.max_growth * self.typical_radius
        return Circle(x, y, min(max(radius, least), most))

    def follow(self, frame: Frame, restart: bool) -> Track[Circle] | Lost[Circle]:
        """Track the ball in a frame; after it was hidden, `restart` from the prediction."""
        if restart:
            self.tracker.start(self.predict(frame.time))
        return self.tracker.update(frame)

    def reacquire(self, circle: Circle, time: float) -> None:
        """Go on from where a search detected the ball again."""
        self.tracker.start(circle)
        self.circle, self.time, self.typical_radius = circle, time, circle.radius
        self._velocity = [0.0, 0.0, 0.0]

    def correct(self, ball: Track[Circle], clear: bool) -> None:
        """Correct circle and velocity by a track; the typical radius only if no other ball touches it."""
        limits = self.parameters
        self.typical_radius += limits.radius_gain * (ball.shape.radius - self.typical_radius) if clear else 0.0
        passed = ball.time - self.time
        if passed > 0.0:
            new = (ball.shape.x, ball.shape.y, ball.shape.radius)
            old = (self.circle.x, self.circle.y, self.circle.radius)
            self._velocity = [
                speed + limits.velocity_gain * ((b - a) / passed - speed)
                for speed, a, b in zip(self._velocity, old, new, strict=True)
            ]
        self.circle, self.time = ball.shape, ball.time

    def report(self, frame: Frame, ball: Track[Circle] | Lost[Circle], marker_memory: float) -> Neighbor:
        """Find the markers, estimate the pose, and answer."""
        markers = self.markers.update(frame, ball)
        if markers:
            self.marker_time = frame.time
        pose = self.localizer.update(ball, markers)
        return Neighbor(self.identity, pose, ball, markers, frame.time - self.marker_time <= marker_memory)
