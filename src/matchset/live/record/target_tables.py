"""`tracks.csv` and `poses.csv` of what is followed, a pair for each target: `TargetTables`."""

import re
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.locate.rows import POSITION, PoseRow, pose_columns, pose_row
from matchset.app.several.poses import TargetPoseRow, target_pose_columns
from matchset.app.several.target_rows import TargetRow, target_columns
from matchset.app.tables import RowWriter
from matchset.app.track.rows import TrackRow, track_columns
from matchset.image.frame import Frame
from matchset.live.feed import StreamPicture
from matchset.live.wire.state import TargetState
from matchset.media.closing import Closing, close_all
from matchset.shapes.circle import Circle

DECIMALS = 4  # format: as tracks.csv has them, 1e-4 px


class TargetTables(Closing):
    """Writes a row for each picture and target.

    The first target's tables are `tracks.csv` and `poses.csv`; those of a further one have its name:
    `tracks_circle_2.csv`. Where there are several when a table begins, or its target has a name of its own, the columns
    `identity`, `label` and `alternatives` say whose each row is.

    Parameters
    ----------
    folder : Path
        Exists.

    Attributes
    ----------
    targets : list of dict
        Name, diameter in m, and tables of each target; the name that it had last.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._endings: dict[int, str] = {}
        self._tracks: dict[int, RowWriter[TrackRow]] = {}
        self._poses: dict[int, RowWriter[PoseRow]] = {}
        self._entries: dict[int, dict[str, Any]] = {}
        self._whose: set[int] = set()

    @property
    def targets(self) -> list[dict[str, Any]]:
        """Return what `recording.json` says of them."""
        return list(self._entries.values())

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
            self._entries[target.id]["name"] = target.name
            self._tracks[target.id].write(_track_row(number, frame.time, target))
            row = _pose_row(number, frame.time, target, seen)
            if row is not None or target.id in self._poses:
                lost = PoseRow(number, frame.time, reason=target.reason or "diameter or camera are not known")
                row = row or lost
                self._poses_of(target).write(TargetPoseRow(**msgspec.structs.asdict(row), **_whose(target)))

    def close(self) -> None:
        """Close the tables."""
        tracks = [table.close for table in self._tracks.values()]
        close_all(*tracks, *(table.close for table in self._poses.values()))

    def _begin(self, target: TargetState, seen: StreamPicture) -> None:
        ending = f"_{plain_name(target)}" if self._endings else ""
        while ending in self._endings.values():
            ending += f"_{target.id}"
        self._endings[target.id] = ending
        path = self._folder / f"tracks{ending}.csv"
        names = seen.parameters.get(target.id) or tuple(target.values) or Circle.parameters
        if self._tracks or len(seen.state.targets) > 1 or target.name != f"{target.shape} {target.id}":
            self._whose.add(target.id)
        columns = target_columns(names) if target.id in self._whose else track_columns(names)
        self._tracks[target.id] = RowWriter(path, columns)
        self._entries[target.id] = {"name": target.name, "tracks": path.name}

    def _poses_of(self, target: TargetState) -> RowWriter[PoseRow]:
        if target.id not in self._poses:
            path = self._folder / f"poses{self._endings[target.id]}.csv"
            self._poses[target.id] = RowWriter(
                path, target_pose_columns() if target.id in self._whose else pose_columns()
            )
            entry = self._entries[target.id]
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


def plain_name(target: TargetState) -> str:
    """Return a target's name of letters, digits and underscores alone, for files and topics."""
    return re.sub(r"[^A-Za-z0-9]+", "_", target.name).strip("_") or f"{target.shape}_{target.id}"


def _whose(target: TargetState) -> dict[str, Any]:
    """Whose a row is."""
    return {"identity": target.id, "label": target.name, "alternatives": tuple(target.alternatives)}


def _track_row(number: int, time: float, target: TargetState) -> TargetRow:
    if not target.found:
        return TargetRow(number, time, reason=target.reason, **_whose(target))
    return TargetRow(
        frame=number,
        time=time,
        shape={name: round(value, DECIMALS) for name, (value, _) in target.values.items()},
        std={name: round(sigma, DECIMALS) for name, (_, sigma) in target.values.items() if sigma is not None},
        support=None if target.support is None else round(target.support, DECIMALS),
        **_whose(target),
    )
