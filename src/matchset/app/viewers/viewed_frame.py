"""A frame as viewers take it: its picture as JPEG, its targets with outlines and poses (`ViewedFrame`)."""

import math
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.locate.loop import LocatedFrame
from matchset.app.pictures.run_pictures import DrawnFrame
from matchset.app.several.mot_file import targets_of
from matchset.app.several.painter import color_of, target_words
from matchset.app.several.poses import LocatedTargets
from matchset.localization.pose import Pose
from matchset.shapes.shape import outline
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost, Track

Points = npt.NDArray[np.float64]

OUTLINE_POINTS = 64  # geometry: points of a smooth outline; of 100 px radius they are 0.1 px off it
DASHES = 24  # geometry: dashes of a predicted outline
CORNER = 0.5  # format: viewers count from the corner of the first pixel, px; here its center is 0

_words = target_words(True, lambda target: str(target.identity))


class ViewedTarget(msgspec.Struct, frozen=True):
    """One target in one frame.

    Parameters
    ----------
    target : Target
    pose : Pose or None
        None where it was not located.
    """

    target: Target[Any]
    pose: Pose | None = None

    @property
    def track(self) -> Track[Any] | None:
        """Where it is; None where it is not seen."""
        return self.target.track if isinstance(self.target.track, Track) else None

    @property
    def color(self) -> tuple[int, int, int]:
        """Red, green, blue of its identity, 0 ... 255."""
        blue, green, red = color_of(self.target.identity)
        return red, green, blue

    @property
    def words(self) -> str:
        """Its identity, with its label and its distance where these are known."""
        words = _words(self.target).strip()
        return words if self.pose is None else f"{words}  {self.pose.distance:.2f} m"

    @property
    def outline(self) -> Points | None:
        """Its outline in the pixels of viewers, (n, 2), px; None where it is not seen."""
        track = self.track
        return None if track is None else outline(track.shape, OUTLINE_POINTS) + CORNER

    @property
    def predicted(self) -> Points | None:
        """Of a target that is not seen: where it should be, as dashes, (n, 2, 2), px; None where that is not known."""
        track = self.target.track
        if isinstance(track, Track) or track.predicted is None:
            return None
        return _dashes(outline(track.predicted, OUTLINE_POINTS) + CORNER)

    def measured(self) -> dict[str, tuple[float, float | None]]:
        """Return the pose's numbers with their standard deviations, m and rad; without a pose the shape's, px."""
        if self.pose is not None:
            found = self.pose.measured()
            return {name: (value, sigma if math.isfinite(sigma) else None) for name, (value, sigma) in found.items()}
        return {} if self.track is None else self.track.measured()


class ViewedFrame(msgspec.Struct, frozen=True):
    """One frame of a run with its targets.

    Parameters
    ----------
    number : int
        Its index.
    time : float
        When it was taken, s.
    jpeg : bytes
        The picture; empty if it could not be decoded.
    targets : tuple of ViewedTarget
    """

    number: int
    time: float
    jpeg: bytes
    targets: tuple[ViewedTarget, ...]


def viewed_frame(answered: DrawnFrame, quality: int) -> ViewedFrame:
    """Take a frame of a run.

    Parameters
    ----------
    answered : DrawnFrame
        A `TrackedFrame`, `FollowedFrame`, `LocatedFrame` or `LocatedTargets`.
    quality : int
        Of the JPEG, 1 ... 100.
    """
    targets = targets_of(answered.answer)
    poses: tuple[Pose | Lost[Pose] | None, ...] = (None,) * len(targets)
    if isinstance(answered, LocatedFrame):
        poses = (answered.pose,)
    elif isinstance(answered, LocatedTargets):
        poses = answered.poses
    seen = tuple(
        ViewedTarget(each, pose if isinstance(pose, Pose) else None) for each, pose in zip(targets, poses, strict=True)
    )
    row, frame = answered.row, answered.frame
    return ViewedFrame(row.frame, row.time, b"" if frame is None else _jpeg(frame.image, quality), seen)


def _jpeg(image: npt.NDArray[np.uint8], quality: int) -> bytes:
    done, coded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not done:
        raise ValueError(f"a picture of {image.shape} cannot be encoded as JPEG")
    return coded.tobytes()


def _dashes(points: Points) -> Points:
    """Cut a closed line into dashes of equal length, with gaps as long, (n, 2, 2)."""
    closed = np.vstack((points, points[:1]))
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))))
    if not (math.isfinite(way[-1]) and way[-1] > 0.0):
        return np.empty((0, 2, 2))
    places = np.linspace(0.0, way[-1], 2 * DASHES, endpoint=False)
    ends = np.column_stack([np.interp(places, way, closed[:, axis]) for axis in (0, 1)])
    return ends.reshape(-1, 2, 2)
