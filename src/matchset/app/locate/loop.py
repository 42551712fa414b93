"""The loop of `matchset locate`: each frame through tracker, markers and localizer."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import msgspec

from matchset.app.exit_codes import StopRequest
from matchset.app.locate.rows import PoseRow, pose_row_of
from matchset.app.track.loop import Follower, follow
from matchset.image.frame import Frame
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost, Track


class Sighting(msgspec.Struct, frozen=True):
    """One frame and what became of it.

    Parameters
    ----------
    frame : Frame or None
        The frame; None if it did not decode.
    ball : Track or Lost
        What the tracker said.
    markers : tuple of Track
        The markers that were found.
    pose : Pose or Lost
        Where that puts the ball.
    row : PoseRow
        The same for the table.
    seconds : float
        Computing time that all this took, s.
    """

    frame: Frame | None
    ball: Track[Any] | Lost[Any]
    markers: tuple[Track[Any], ...]
    pose: "Pose | Lost[Pose]"
    row: PoseRow
    seconds: float = 0.0


class Locator:
    """Follows ball and markers and places them; it is a `Follower` of the ball.

    Parameters
    ----------
    tracker_at : callable
        Asked before each frame: a new tracker to go on with, or None to keep the one there is.
    finder : MarkerTracker or None
        What finds the markers, if there are any.
    localizer : Localizer
        What places them.

    Attributes
    ----------
    markers : tuple of Track
        Those of the last frame.
    pose : Pose or Lost
        That of the last frame.
    """

    def __init__(
        self, tracker_at: Callable[[Frame], Follower | None], finder: MarkerTracker | None, localizer: Localizer
    ) -> None:
        self._tracker_at, self._finder, self._localizer = tracker_at, finder, localizer
        self._tracker: Follower | None = None
        self.markers: tuple[Track[Any], ...] = ()
        self.pose: Pose | Lost[Pose] = Lost("no frame yet", 0.0)

    def update(self, frame: Frame) -> Track[Any] | Lost[Any]:
        """Follow the ball into `frame` and place it."""
        self._tracker = self._tracker_at(frame) or self._tracker
        if self._tracker is None:
            raise ValueError(f"nothing follows frame {frame.index}")
        ball = self._tracker.update(frame)
        self.markers = () if self._finder is None else self._finder.update(frame, ball)
        self.pose = self._localizer.update(ball, self.markers)
        return ball


def locate(frames: Iterable[Frame], locator: Locator, gaps: bool, stop: StopRequest) -> Iterator[Sighting]:
    """Place the ball in a video frame by frame.

    Parameters
    ----------
    frames : iterable of Frame
        The video.
    locator : Locator
        What follows and places it.
    gaps : bool
        See `follow`.
    stop : StopRequest
        Looked at after each frame.

    Yields
    ------
    Sighting
        One for each frame, in order.
    """
    for step in follow(frames, lambda _: locator, gaps, stop):
        if step.frame is None:
            lost: Lost[Pose] = Lost(step.row.reason, step.row.time)
            yield Sighting(None, step.answer, (), lost, pose_row_of(step.row.frame, lost))
        else:
            row = pose_row_of(step.row.frame, locator.pose)
            yield Sighting(step.frame, step.answer, locator.markers, locator.pose, row, step.seconds)
