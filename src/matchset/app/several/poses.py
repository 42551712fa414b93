"""Where several balls are in meters: their rows in `poses.csv`, and each frame (`locate_several`)."""

from collections.abc import Iterable, Iterator
from typing import Any

import msgspec

from matchset.app.exit_codes import StopRequest
from matchset.app.locate.loop import PathLog
from matchset.app.locate.rows import PoseRow, pose_columns, pose_row
from matchset.app.several.crowd import CrowdWatch
from matchset.app.several.follow import FrameTargets, Targets, follow_several
from matchset.app.several.painter import numbered
from matchset.app.several.target_rows import TargetsRow, whose_columns
from matchset.app.tables import Column
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
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
    """Follows balls, and locates each by a localizer of its own, with its markers if there are any.

    Parameters
    ----------
    follower : FrameTargets
    camera : CameraModel
    ball : BallTarget
    marker_color : ColorModel, optional
        Of the markers that each ball has.

    Attributes
    ----------
    poses : list of Pose or Lost
        Of the balls in the last frame.
    """

    def __init__(
        self, follower: FrameTargets, camera: CameraModel, ball: BallTarget, marker_color: ColorModel | None = None
    ) -> None:
        self._follower, self._camera, self._ball, self._marker_color = follower, camera, ball, marker_color
        self._of: dict[int, tuple[MarkerTracker | None, Localizer]] = {}
        self.poses: list[Pose | Lost[Pose]] = []

    def update(self, frame: Frame) -> Targets:
        """Follow all balls in a frame, and locate them."""
        targets = self._follower.update(frame)
        known = self._of
        self._of = {each.identity: known.get(each.identity) or self._new() for each in targets}
        self.poses = []
        for each in targets:
            markers, localizer = self._of[each.identity]
            seen = () if markers is None else markers.update(frame, each.track)
            self.poses.append(localizer.update(each.track, seen))
        return targets

    def _new(self) -> tuple[MarkerTracker | None, Localizer]:
        """Make what locates one ball."""
        markers = None if self._marker_color is None else MarkerTracker(self._marker_color, self._ball)
        return markers, Localizer(self._camera, self._ball)

    def distance_words(self, target: Target[Any]) -> str:
        """Write a ball's identity and how far away it is, m."""
        rows = self._of.keys()
        pose = self.poses[list(rows).index(target.identity)] if target.identity in rows else None
        if not isinstance(pose, Pose):
            return numbered(target)
        return f"{numbered(target)}  {float(pose.position @ pose.position) ** 0.5:.2f} m"


class PathsLog:
    """Where each ball was, frame by frame; 64 bytes each.

    Attributes
    ----------
    paths : dict of int to PathLog
        By identity.
    """

    def __init__(self) -> None:
        self.paths: dict[int, PathLog] = {}

    @property
    def any_found(self) -> bool:
        """Whether any ball was located."""
        return any(path.any_found for path in self.paths.values())

    def record(self, frames: Iterable[LocatedTargets]) -> Iterator[LocatedTargets]:
        """Pass frames on, noting each."""
        for located in frames:
            for target, pose in zip(located.answer, located.poses, strict=True):
                self.paths.setdefault(target.identity, PathLog()).append_pose(located.row.time, pose)
            yield located


def locate_several(
    frames: Iterable[Frame],
    locator: TargetsLocator,
    gaps: bool,
    stop: StopRequest,
    whole: bool = True,
    watch: CrowdWatch | None = None,
) -> Iterator[LocatedTargets]:
    """Locate balls in a video frame by frame, see `follow_several`."""
    for followed in follow_several(frames, locator, gaps, stop, whole, watch):
        index, time, targets = followed.row.frame, followed.row.time, followed.answer
        poses: list[Any] = locator.poses if followed.frame is not None else [each.track for each in targets]
        rows = tuple(_row(index, each, pose) for each, pose in zip(targets, poses, strict=True))
        row = PosesRow(index, time, rows, followed.row.doubtful)
        yield LocatedTargets(followed.frame, targets, tuple(poses), row, followed.seconds)


def _row(index: int, target: Target[Any], pose: "Pose | Lost[Any]") -> TargetPoseRow:
    values = msgspec.structs.asdict(pose_row(index, pose))
    return TargetPoseRow(**values, identity=target.identity, label=target.label, alternatives=target.alternatives)
