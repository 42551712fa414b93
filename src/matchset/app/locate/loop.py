"""The loop of `matchset locate`: each frame through tracker, markers and localizer (`locate`); the path (`PathLog`)."""

from collections.abc import Iterable, Iterator
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.course.log import Course, TimeLog
from matchset.app.exit_codes import StopRequest
from matchset.app.locate.rows import PoseRow, pose_row
from matchset.app.track.loop import FrameTracker, TrackerAt, follow
from matchset.image.frame import Frame
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]

_NUMBERS = 7  # format: numbers per frame in a `PathLog`: x, y, z, their variances, covariance of x and z


class LocatedFrame(msgspec.Struct, frozen=True):
    """One frame with ball, markers and pose.

    Parameters
    ----------
    frame : Frame or None
        The frame; None if it could not be decoded.
    ball : Track or Lost
        The tracker's answer.
    markers : tuple of Track
        The markers that were found.
    pose : Pose or Lost
        Position and rotation of the ball.
    row : PoseRow
        The same for the table.
    seconds : float
        Computing time of all this, s.
    """

    frame: Frame | None
    ball: Track[Any] | Lost[Any]
    markers: tuple[Track[Any], ...]
    pose: "Pose | Lost[Pose]"
    row: PoseRow
    seconds: float = 0.0

    @property
    def answer(self) -> Track[Any] | Lost[Any]:
        """The tracker's answer for the ball."""
        return self.ball


class Locator:
    """Tracks ball and markers and computes the pose; it is a `FrameTracker` of the ball.

    Parameters
    ----------
    tracker_at : callable
        See `TrackerAt`.
    marker_tracker : MarkerTracker or None
        Finds the markers, if there are any.
    localizer : Localizer
        Computes the pose.

    Attributes
    ----------
    markers : tuple of Track
        Those of the last frame.
    pose : Pose or Lost
        That of the last frame.
    """

    def __init__(self, tracker_at: TrackerAt, marker_tracker: MarkerTracker | None, localizer: Localizer) -> None:
        self._tracker_at, self._marker_tracker, self._localizer = tracker_at, marker_tracker, localizer
        self._tracker: FrameTracker | None = None
        self.markers: tuple[Track[Any], ...] = ()
        self.pose: Pose | Lost[Pose] = Lost("no frame yet", 0.0)

    def update(self, frame: Frame) -> Track[Any] | Lost[Any]:
        """Track the ball into `frame` and locate it."""
        self._tracker = self._tracker_at(frame) or self._tracker
        if self._tracker is None:
            raise ValueError(f"no tracker for frame {frame.index}")
        ball = self._tracker.update(frame)
        self.markers = () if self._marker_tracker is None else self._marker_tracker.update(frame, ball)
        self.pose = self._localizer.update(ball, self.markers)
        return ball


def locate_frames(
    frames: Iterable[Frame], locator: Locator, gaps: bool, stop: StopRequest, whole: bool = True
) -> Iterator[LocatedFrame]:
    """Locate the ball in a video frame by frame.

    Parameters
    ----------
    frames : iterable of Frame
        The video.
    locator : Locator
        What tracks and locates it.
    gaps, whole : bool
        See `matchset.app.track.loop.follow`.
    stop : StopRequest
        Checked after each frame.

    Yields
    ------
    LocatedFrame
        One for each frame, in order.
    """
    for tracked in follow(frames, lambda _: locator, gaps, stop, whole):
        index = tracked.row.frame
        if tracked.frame is None:
            lost: Lost[Pose] = Lost(tracked.row.reason, tracked.row.time)
            yield LocatedFrame(None, tracked.answer, (), lost, pose_row(index, lost))
        else:
            row = pose_row(index, locator.pose)
            yield LocatedFrame(tracked.frame, tracked.answer, locator.markers, locator.pose, row, tracked.seconds)


class PathLog(TimeLog):
    """Times, positions and their covariance, frame by frame; 64 bytes a frame, so a camera may run for hours."""

    def __init__(self) -> None:
        super().__init__(_NUMBERS)

    def record(self, frames: Iterable[LocatedFrame]) -> Iterator[LocatedFrame]:
        """Pass frames on, appending each."""
        for located in frames:
            self.append(located)
            yield located

    def append(self, located: LocatedFrame) -> None:
        """Append a frame."""
        self.append_pose(located.row.time, located.pose)

    def append_pose(self, time: float, pose: "Pose | Lost[Any]") -> None:
        """Append the pose of a frame at a time, s."""
        numbers = None
        if isinstance(pose, Pose):
            covariance = pose.covariance
            numbers = (*pose.position.tolist(), *np.diag(covariance)[:3].tolist(), float(covariance[0, 2]))
        self.note(time, numbers)

    @property
    def course(self) -> Course:
        """The position over time."""
        labels = "x, m (right)", "y, m (down)", "z, m (forward)"
        return Course(self.time, self.position, self.std, labels, "m", 3)

    @property
    def position(self) -> Floats:
        """Of the ball in the camera frame, (n, 3), m; NaN where it was not located."""
        return self.table[:, 1:4]

    @property
    def std(self) -> Floats:
        """Standard deviations of the position, (n, 3), m; NaN where it was not located."""
        return np.sqrt(self.table[:, 4:7])

    @property
    def horizontal_covariance(self) -> Floats:
        """Covariance of x and z, (n, 2, 2), m^2."""
        table = self.table
        return table[:, (4, 7, 7, 6)].reshape(-1, 2, 2)
