"""Which of the balls in the picture is the neighbor's, before one was ever believed: `first_ball`."""

import math

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.localizer import Localizer
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.detect import detect

MOST = 6  # balls that are looked at


def first_ball(
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
