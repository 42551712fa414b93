"""Where a target is before the camera, and the axes of a marked ball: `TargetLocalizer`."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.live.targets.messages import Diameter, FieldOfView
from matchset.localization.ball_target import BALLOON, BallTarget
from matchset.localization.localizer import Localizer, left_out
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

LENGTH = 1.7  # geometry: of the drawn axes, ball radii
Measured = Mapping[str, tuple[float, float | None]]


class TargetPlace(NamedTuple):
    """Where a target is.

    Attributes
    ----------
    pose : Pose, Lost or None
    position : dict of str to (float, float or None)
        x, y, z and distance, m, with standard deviations; empty if they are not known.
    markers : tuple of Circle
        Those in sight.
    axes : ndarray of shape (4, 2), float64, or None
        In the picture, px: the ball's center and the tips of its axes x, y, z; None where no rotation is observed.
    left_out : str
        What the standard deviations of the position leave out, in words.
    """

    pose: "Pose | Lost[Pose] | None" = None
    position: Measured = MappingProxyType({})
    markers: tuple[Circle, ...] = ()
    axes: npt.NDArray[np.float64] | None = None
    left_out: str = ""


class TargetLocalizer:
    """Turns tracks into places.

    Parameters
    ----------
    camera : CameraModel
    ball : BallTarget
        Its size.
    marker : (ColorModel, float), optional
        Color of the ball's marker, and how wide it is, m.
    """

    def __init__(self, camera: CameraModel, ball: BallTarget, marker: tuple[ColorModel, float] | None = None) -> None:
        self._camera, self._radius = camera, ball.radius
        self._markers: MarkerTracker | None = None
        if marker is not None:
            ball = BallTarget(ball.diameter, BALLOON.markers, marker[1], ball.diameter_sigma)
            self._markers = MarkerTracker(marker[0], ball)
        self._localizer, self._left_out = Localizer(camera, ball), left_out(camera, ball)

    def place(self, frame: Frame, track: Track[Any] | Lost[Any]) -> TargetPlace:
        """Return where a target is in a frame; nowhere if it is no ball."""
        if isinstance(track, Track) and not isinstance(track.shape, Circle):
            return TargetPlace()
        markers = () if self._markers is None else self._markers.update(frame, track)
        pose = self._localizer.update(track, markers)
        shapes = tuple(marker.shape for marker in markers)
        if isinstance(pose, Lost):
            return TargetPlace(pose, markers=shapes)
        return TargetPlace(pose, position_of(pose), shapes, axes_of(pose, self._camera, self._radius), self._left_out)


def ball_of(wish: Diameter) -> BallTarget | None:
    """Return what a page says of a ball; None: nothing is known.

    Raises
    ------
    ValueError
        If its standard deviation is as large as the diameter.
    """
    return None if wish.meters is None else BallTarget(wish.meters, diameter_sigma=wish.sigma)


def camera_of(wish: FieldOfView, width: int, height: int) -> CameraModel:
    """Return the camera that a page describes, of pictures of this size, px.

    Raises
    ------
    ValueError
        If its standard deviation allows any focal length.
    """
    share = wish.sigma / math.sin(wish.angle)  # of f = (width / 2) / tan(angle / 2), to first order
    return CameraModel.from_fov(width, height, wish.angle, share)


def axes_of(pose: Pose, camera: CameraModel, radius: float) -> npt.NDArray[np.float64] | None:
    """Return the center of a ball of this radius, m, and the tips of its axes in the picture, (4, 2), px.

    None where no rotation is observed, or the lens model does not reach.
    """
    if pose.rotation_matrix is None:
        return None
    points = np.vstack((pose.position, pose.position + LENGTH * radius * pose.rotation_matrix.T))
    try:
        return camera.project(points)
    except ValueError:  # outside the region in which the lens model is defined
        return None


def position_of(pose: Pose) -> Measured:
    """Return x, y, z and distance, m, with standard deviations."""
    sigmas = np.sqrt(np.diagonal(pose.covariance)[:3]).tolist()
    along = pose.position / pose.distance
    spread = math.sqrt(max(float(along @ pose.covariance[:3, :3] @ along), 0.0))
    placed: Measured = dict(zip("xyz", zip(pose.position.tolist(), sigmas, strict=True), strict=True))
    return {**placed, "distance": (pose.distance, spread)}
