"""What a picture says about the ball: `PoseSensor` tracks it and returns its pose as a vector of eight numbers."""

import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BALLOON
from matchset.localization.localizer import Localizer
from matchset.localization.markers.ball_colors import learn_colors
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost
from matchset.tracking.tracker import Tracker

Vector = npt.NDArray[np.float32]

FARTHEST = 20.0  # geometry: m, bound of every length in the vector; rooms are smaller
# geometry: found, x, y, z, marker seen, side, height, heading
LOW = np.array((0.0, -FARTHEST, -FARTHEST, 0.0, 0.0, -FARTHEST, -FARTHEST, -FARTHEST), np.float32)
# geometry: the same
HIGH = np.array((1.0, FARTHEST, FARTHEST, FARTHEST, 1.0, FARTHEST, FARTHEST, FARTHEST), np.float32)


class PoseSensor:
    """Measures the pose of the neighbor's ball in pictures; it knows nothing else.

    Parameters
    ----------
    camera : CameraModel
    sample : Frame
        A ball 1 m before the camera, its marker in the middle: it teaches the colors.
    """

    def __init__(self, camera: CameraModel, sample: Frame) -> None:
        target, colors = BALLOON, learn_colors(sample)
        self._tracker = Tracker(Circle, colors.ball)
        self._markers = MarkerTracker(colors.marker, target)
        self._localizer = Localizer(camera, target)

    def measure(self, frame: Frame) -> Pose | Lost[Pose]:
        """Track the ball into a picture and locate it.

        Parameters
        ----------
        frame : Frame

        Returns
        -------
        Pose or Lost
        """
        ball = self._tracker.update(frame)
        return self._localizer.update(ball, self._markers.update(frame, ball))


def pose_vector(pose: Pose | Lost[Pose]) -> Vector:
    """Write a pose as numbers.

    Parameters
    ----------
    pose : Pose or Lost

    Returns
    -------
    ndarray of shape (8,), float32
        1 if the ball is found; its position x, y, z in the camera frame, m; 1 if its marker is seen; side, height and
        heading of the camera in the ball's frame, m (Epstein & Feldman, Eq. 6-8). What was not measured is 0.
    """
    vector = np.zeros(len(LOW), np.float32)
    if isinstance(pose, Pose):
        vector[0], vector[1:4] = 1.0, pose.position
        if pose.side is not None and pose.height is not None and pose.heading is not None:
            vector[4:] = 1.0, pose.side, pose.height, pose.heading
    clipped: Vector = np.clip(vector, LOW, HIGH)
    return clipped
