"""`tracks.csv` and `poses.csv` of what is followed, a pair for each target: `TargetTables`."""

import re
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.locate.rows import POSITION, PoseRow, pose_columns, pose_row
from matchset.app.tables import RowWriter
from matchset.app.track.rows import TrackRow, track_table
from matchset.image.frame import Frame
from matchset.live.feed import StreamPicture
from matchset.live.wire.state import TargetState
from matchset.media.closing import Closing, close_all
from matchset.shapes.circle import Circle

DECIMALS = 4  # format: as tracks.csv has them, 1e-4 px


class TargetTables(Closing):
    """Writes a row for each picture and target.

    The first target's tables are `tracks.csv` and `poses.csv`; those of a further one have its name:
    `tracks_circle_2.csv`.

    Parameters
    ----------
    folder : Path
        Exists.

    Attributes
    ----------
    targets : list of dict
        Name, diameter in m, and tables of each target.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._endings: dict[int, str] = {}
        self._tracks: dict[int, RowWriter[TrackRow]] = {}
        self._poses: dict[int, RowWriter[PoseRow]] = {}
        self.targets: list[dict[str, Any]] = []

    def write(self, number: int, frame: Frame, seen: StreamPicture) -> None:
        """Append the rows of a picture.

        Parameters
        ----------
        number : int
            Of the picture, in the recording.
        frame : Frame
            The picture.
        seen : StreamPicture

        Raises
        ------
        OSError
            If they do not fit on the disk: the tables end with the row before.
        """
        for target in seen.state.targets:
            if target.id not in self._tracks:
                self._begin(target, seen)
            self._tracks[target.id].write(_track_row(number, frame.time, target))
            row = _pose_row(number, frame.time, target, seen)
            if row is not None or target.id in self._poses:
                lost = PoseRow(number, frame.time, reason=target.reason or "diameter or camera are not known")
                self._poses_of(target).write(row or lost)

    def close(self) -> None:
        """Close the tables."""
        tracks = [table.close for table in self._tracks.values()]
        close_all(*tracks, *(table.close for table in self._poses.values()))

    def _begin(self, target: TargetState, seen: StreamPicture) -> None:
        ending = "_" + re.sub(r"[^A-Za-z0-9]+", "_", target.name).strip("_") if self._endings else ""
        while ending in self._endings.values():
            ending += f"_{target.id}"
        self._endings[target.id] = ending
        path = self._folder / f"tracks{ending}.csv"
        names = seen.parameters.get(target.id) or tuple(target.values) or Circle.parameters
        self._tracks[target.id] = track_table(path, names)
        self.targets.append({"name": target.name, "tracks": path.name})

    def _poses_of(self, target: TargetState) -> RowWriter[PoseRow]:
        if target.id not in self._poses:
            path = self._folder / f"poses{self._endings[target.id]}.csv"
            self._poses[target.id] = RowWriter(path, pose_columns())
            entry = next(each for each in self.targets if each["name"] == target.name)
            entry |= {"poses": path.name, "diameter": target.diameter}
        return self._poses[target.id]


def _pose_row(number: int, time: float, target: TargetState, seen: StreamPicture) -> PoseRow | None:
    """Return the row of a pose, of a position where the pose is not told; None where it is not located."""
    pose = seen.poses.get(target.id)
    if pose is not None:
        return pose_row(number, msgspec.structs.replace(pose, time=time))
    if not target.position:
        return None
    values = {name: value for name, (value, _) in target.position.items() if name in POSITION}
    std = {name: sigma or 0.0 for name, (_, sigma) in target.position.items() if name in POSITION}
    return PoseRow(number, time, values, std, "position")


def _track_row(number: int, time: float, target: TargetState) -> TrackRow:
    if not target.found:
        return TrackRow(number, time, reason=target.reason)
    return TrackRow(
        frame=number,
        time=time,
        shape={name: round(value, DECIMALS) for name, (value, _) in target.values.items()},
        std={name: round(sigma, DECIMALS) for name, (_, sigma) in target.values.items() if sigma is not None},
        support=None if target.support is None else round(target.support, DECIMALS),
    )
