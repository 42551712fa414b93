"""One neighbor, with its markers and its pose: `Neighbor`, `NeighborLocalizer`."""

import math

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
from matchset.tracking.track import Lost, Track


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


class NeighborLocalizer:
    """Finds the markers of one ball, and locates it.

    Parameters
    ----------
    camera : CameraModel
    target : BallTarget
    color : ColorModel
        Of the markers.
    markers : MarkerParameters
    localizer : LocalizerParameters
    """

    def __init__(
        self,
        camera: CameraModel,
        target: BallTarget,
        color: ColorModel,
        markers: MarkerParameters,
        localizer: LocalizerParameters,
    ) -> None:
        self._markers = MarkerTracker(color, target, markers)
        self._localizer = Localizer(camera, target, localizer)
        self._marker_time = -math.inf

    def update(self, identity: int, frame: Frame, ball: Track[Circle] | Lost[Circle], memory: float) -> Neighbor:
        """Locate a ball in a frame; markers are remembered for some time, s."""
        markers = self._markers.update(frame, ball)
        if markers:
            self._marker_time = frame.time
        pose = self._localizer.update(ball, markers)
        return Neighbor(identity, pose, ball, markers, frame.time - self._marker_time <= memory)
