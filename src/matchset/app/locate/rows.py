"""`poses.csv`: one row for each frame, as it is written (`PoseRow`, `pose_columns`) and read (`read_poses`)."""

import operator
from pathlib import Path

from matchset.app.tables import Column, CsvLine, RowWriter, read_csv
from matchset.app.track.rows import FrameRow, frame_columns, lines_of, read_std, std_columns, value_columns
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost

POSITION = ("x", "y", "z")
RELATIVE = ("side", "height", "heading", "yaw")
_DECIMALS = 6  # format: 1e-6 m and rad


class PoseRow(FrameRow, frozen=True):
    """The pose in one frame, as tables hold it.

    Parameters
    ----------
    values : dict of str to float, or None
        `x`, `y`, `z` of the ball in the camera frame, m; where the rotation was observed `side`, `height`, `heading`,
        m, and `yaw`, rad. None where the ball was not located.
    std : dict of str to float, or None
        Their standard deviations, by the same names.
    observed : str
        "position", "level" or "full", see `Pose`; empty where the ball was not located.
    reason : str
        Why it was not located, in words; empty where it was.
    """

    values: dict[str, float] | None = None
    std: dict[str, float] | None = None
    observed: str = ""
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether this frame's pixels locate the ball."""
        return self.values is not None

    @property
    def brief(self) -> str:
        """The position in a few words, for the status line; empty where there is none."""
        if self.values is None:
            return ""
        return "  ".join(f"{name} {self.values[name]:+7.3f}" for name in POSITION) + f" m  {self.observed}"


def pose_row(frame: int, pose: "Pose | Lost[Pose]") -> PoseRow:
    """Turn a pose into the row of its frame.

    Parameters
    ----------
    frame : int
        The frame's index.
    pose : Pose or Lost
        What `Localizer.update` returned for it.

    Returns
    -------
    PoseRow
        With numbers rounded to 1e-6 m and rad.
    """
    if isinstance(pose, Lost):
        return PoseRow(frame, pose.time, reason=pose.reason)
    measured = pose.measured()
    return PoseRow(
        frame,
        pose.time,
        values={name: _rounded(value) for name, (value, _) in measured.items()},
        std={name: _rounded(sigma) for name, (_, sigma) in measured.items()},
        observed=pose.observed,
    )


def _rounded(value: float) -> float:
    return round(value, _DECIMALS) + 0.0  # no -0.0


def pose_columns() -> list[Column]:
    """Return the columns of `poses.csv`."""
    return [
        *frame_columns(),
        *value_columns(POSITION, "values"),
        *std_columns(POSITION),
        *value_columns(RELATIVE, "values"),
        *std_columns(RELATIVE),
        Column("observed", operator.attrgetter("observed")),
        Column("reason", operator.attrgetter("reason")),
    ]


def pose_table(folder: Path, jsonl: bool) -> RowWriter[PoseRow]:
    """Begin `poses.csv` in a folder and, if wanted, `poses.jsonl`."""
    return RowWriter(folder / "poses.csv", pose_columns(), folder / "poses.jsonl" if jsonl else None)


def read_poses(path: str | Path, identity: int | None = None) -> list[PoseRow]:
    """Read a `poses.csv`.

    Parameters
    ----------
    path : str or Path
        A CSV file with the columns ``frame,time,found,x,y,z``; the others may be missing.
    identity : int, optional
        Whose rows to take; needed only if the file holds several balls.

    Returns
    -------
    list of PoseRow
        In the order of the file.

    Raises
    ------
    ValueError
        If the file cannot be read or a row is wrong; the message holds the file and the line.
    """
    lines = read_csv(path, required=("frame", "time", "found", *POSITION))
    return [_row_of(line) for line in lines_of(path, lines, identity)]


def _row_of(line: CsvLine) -> PoseRow:
    frame, time = line.index("frame"), line.number("time")
    if not line.flag("found"):
        return PoseRow(frame, time, reason=line.text("reason"))
    names = [name for name in (*POSITION, *RELATIVE) if name in POSITION or line.text(name)]
    return PoseRow(
        frame,
        time,
        values={name: line.number(name) for name in names},
        std=read_std(line, names),
        observed=line.text("observed"),
        reason=line.text("reason"),
    )
