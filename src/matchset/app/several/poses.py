"""Where several balls are in meters: their rows in `poses.csv`, and each frame (`locate_several`)."""

from collections.abc import Iterable, Iterator
from typing import Any

import msgspec

from matchset.app.exit_codes import StopRequest
from matchset.app.locate.rows import PoseRow, pose_columns, pose_row
from matchset.app.several.follow import Targets, TargetsFollower, follow_several
from matchset.app.several.target_rows import TargetsRow, whose_columns
from matchset.app.tables import Column
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.pose import Pose
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost


class TargetPoseRow(PoseRow, frozen=True):
    """The pose of one ball in one frame; whose it is is said as in `TargetRow`."""

    identity: int = 0
    label: str = ""
    alternatives: tuple[int, ...] = ()


PosesRow = TargetsRow[TargetPoseRow]


def target_pose_columns() -> list[Column]:
    """Return the columns of `poses.csv` of several balls."""
    return [*pose_columns(), *whose_columns()]


class LocatedTargets(msgspec.Struct, frozen=True):
    """One frame, the balls in it, their poses, also as rows; `seconds` of computing."""

    frame: Frame | None
    answer: Targets
    poses: tuple[Any, ...]
    row: PosesRow
    seconds: float = 0.0


class TargetsLocator:
    """Follows balls, and locates each by a localizer of its own.

    Parameters
    ----------
    follower : TargetsFollower
    camera : CameraModel
    ball : BallTarget

    Attributes
    ----------
    poses : list of Pose or Lost
        Of the balls in the last frame.
    """

    def __init__(self, follower: TargetsFollower, camera: CameraModel, ball: BallTarget) -> None:
        self._follower, self._camera, self._ball = follower, camera, ball
        self._localizers: dict[int, Localizer] = {}
        self.poses: list[Pose | Lost[Pose]] = []

    def update(self, frame: Frame) -> Targets:
        """Follow all balls in a frame, and locate them."""
        targets = self._follower.update(frame)
        known = self._localizers
        self._localizers = {
            each.identity: known.get(each.identity) or Localizer(self._camera, self._ball) for each in targets
        }
        self.poses = [self._localizers[each.identity].update(each.track) for each in targets]
        return targets

    def distance_words(self, target: Target[Any]) -> str:
        """Write a ball's identity and how far away it is, m."""
        rows = self._localizers.keys()
        pose = self.poses[list(rows).index(target.identity)] if target.identity in rows else None
        if not isinstance(pose, Pose):
            return str(target.identity)
        return f"{target.identity}  {float(pose.position @ pose.position) ** 0.5:.2f} m"


def locate_several(
    frames: Iterable[Frame], locator: TargetsLocator, gaps: bool, stop: StopRequest, whole: bool = True
) -> Iterator[LocatedTargets]:
    """Locate balls in a video frame by frame, see `follow_several`."""
    for followed in follow_several(frames, locator, gaps, stop, whole):
        index, time, targets = followed.row.frame, followed.row.time, followed.answer
        poses: list[Any] = locator.poses if followed.frame is not None else [each.track for each in targets]
        rows = tuple(_row(index, each, pose) for each, pose in zip(targets, poses, strict=True))
        yield LocatedTargets(followed.frame, targets, tuple(poses), PosesRow(index, time, rows), followed.seconds)


def _row(index: int, target: Target[Any], pose: "Pose | Lost[Any]") -> TargetPoseRow:
    values = msgspec.structs.asdict(pose_row(index, pose))
    return TargetPoseRow(**values, identity=target.identity, label=target.label, alternatives=target.alternatives)
