"""Which ball in a picture is the neighbor's: `find_neighbor_ball`; how far one is away: `distance_seen`."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.image.light.relighting import relit
from matchset.localization.cone import ConeFailure
from matchset.localization.localizer import REASONS, Localizer
from matchset.localization.pose import Pose
from matchset.numeric.arguments import require_at_least
from matchset.shapes.circle import Circle
from matchset.tracking.detection import detect
from matchset.tracking.too_near import TOO_NEAR
from matchset.tracking.track import Lost


class AssociationParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which of the balls in the picture is the neighbor's.

    Parameters
    ----------
    candidates : int
        Largest number of detected balls that are located before one is followed. More costs time, about a pose each;
        fewer may miss the neighbor's where much of the room has the ball's color. Chosen by hand;
        `python -m benchmarks.flight.fly --only start` would show a change.
    rejected_poses : int
        Number of poses in a row outside the follower's gate after which the tracker is restarted where the neighbor is
        expected. More flies longer by the prediction when another ball is followed; fewer restarts after one bad
        picture. Chosen by hand; `python -m benchmarks.flight.fly --only hidden` would show a change.
    shade : float
        Light on a ball in the shade, as a share of that in which its color was learned, 0 ... 1: before one is followed
        it is looked for in that, too, and in as much more. Less finds darker balls; 1 looks in one light. Chosen on
        rendered balls in half of the light, which 0.4 to 0.7 find.
    """

    candidates: int = 6
    rejected_poses: int = 3
    shade: float = 0.6

    def __post_init__(self) -> None:
        if not 0.0 < self.shade <= 1.0:
            raise ValueError(f"shade must be above 0 and at most 1, got {self.shade}")
        require_at_least(self, 1, "candidates", "rejected_poses")


def in_lights(color: ColorModel, shade: float) -> tuple[ColorModel, ...]:
    """Make models of a color in its light, in the shade, and in as much more light.

    Parameters
    ----------
    color : ColorModel
    shade : float
        See `AssociationParameters`.
    """
    gains = np.ones(color.channels)
    return color, *(relit(color, color.log_odds, share * gains) for share in (shade, 1.0 / shade))


def find_neighbor_ball(
    frame: Frame,
    colors: Sequence[ColorModel],
    localizer: Localizer,
    expected: npt.NDArray[np.float64],
    max_distance: float,
    candidates: int,
) -> Circle | None:
    """Find the nearest ball to the camera of those that may be the neighbor's: the next but one looks the same.

    Parameters
    ----------
    frame : Frame
    colors : sequence of ColorModel
        Of the ball with its marker, in several lights: one of them in each picture, in turn.
    localizer : Localizer
        Locates the balls; a ball without markers leaves no state in it.
    expected : ndarray of shape (3,)
        Expected position of the neighbor's ball in the camera frame, m.
    max_distance : float
        From there, m.
    candidates : int
        Largest number of balls that are located.

    Returns
    -------
    Circle or None
        None if no ball may be the neighbor's.
    """
    best: Circle | None = None
    nearest = math.inf
    for track in detect(frame, Circle, colors[frame.index % len(colors)], limit=candidates):
        pose = localizer.update(track)
        if not isinstance(pose, Pose) or not np.linalg.norm(pose.position - expected) < max_distance:
            continue
        if pose.distance < nearest:
            best, nearest = track.shape, pose.distance
    return best


def distance_seen(pose: Pose | Lost[Pose], before: float) -> float:
    """Distance of the ball that is followed, whosever it is.

    Parameters
    ----------
    pose : Pose or Lost
        Of that ball; lost with the reason why the ball is, if that is.
    before : float
        Distance in the picture before, m.

    Returns
    -------
    float
        m; 0 if the ball fills the picture or touches the camera, as before if it is not seen: what was lost near by is
        still there.
    """
    if isinstance(pose, Pose):
        return pose.distance
    return 0.0 if pose.reason in (TOO_NEAR, REASONS[ConeFailure.TOO_NEAR]) else before
