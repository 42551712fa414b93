"""`tracks.csv` of several targets: one row for each target and frame (`TargetRow`, `TargetTable`)."""

import operator
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

import msgspec

from matchset.app.locate.rows import PoseRow
from matchset.app.tables import Cells, Column, RowWriter
from matchset.app.track.rows import FrameRow, TrackRow, track_columns, track_row
from matchset.tracking.many.target import Target
from matchset.tracking.track import Track

R = TypeVar("R", bound=TrackRow | PoseRow)


class TargetRow(TrackRow, frozen=True):
    """The answer for one target in one frame.

    Parameters
    ----------
    identity : int
        Its number, never given again.
    label : str
        The name of its color.
    alternatives : tuple of int
        Which other targets it may be as well.
    """

    identity: int = 0
    label: str = ""
    alternatives: tuple[int, ...] = ()


class TargetsRow(FrameRow, Generic[R], frozen=True):
    """The answers for all targets in one frame.

    Parameters
    ----------
    targets : tuple of TargetRow or TargetPoseRow
    doubtful : tuple of Track
        What may be one of them, and is not followed: drawn, not written.
    """

    targets: tuple[R, ...] = ()
    doubtful: tuple[Track[Any], ...] = ()

    @property
    def found(self) -> bool:
        """Whether one of them is seen."""
        return any(each.found for each in self.targets)

    @property
    def reason(self) -> str:
        """Why none is seen; empty where one is."""
        if self.found:
            return ""
        return self.targets[0].reason if self.targets else "no target was found yet"

    @property
    def brief(self) -> str:
        """How many are seen, for the status line."""
        words = counted_words(self.targets)
        return f"{words}, {len(self.doubtful)} doubtful" if words and self.doubtful else words


def counted_words(rows: Sequence[Any]) -> str:
    """Say how many of several rows have an answer; empty without rows."""
    return f"{sum(each.found for each in rows)} of {len(rows)} targets" if rows else ""


def targets_row(
    frame: int, time: float, targets: Sequence[Target[Any]], doubtful: tuple[Track[Any], ...] = ()
) -> TargetsRow[TargetRow]:
    """Turn the answers for a frame into its rows."""
    return TargetsRow(frame, time, tuple(target_row(frame, each) for each in targets), doubtful)


def target_row(frame: int, target: Target[Any]) -> TargetRow:
    """Turn the answer for one target into its row."""
    values = msgspec.structs.asdict(track_row(frame, target.track))
    return TargetRow(**values, identity=target.identity, label=target.label, alternatives=target.alternatives)


def target_columns(parameters: Sequence[str]) -> list[Column]:
    """Return the columns of `tracks.csv` of several targets: those of one, and behind them whose row it is."""
    return [*track_columns(parameters), *whose_columns()]


def whose_columns() -> list[Column]:
    """Return the columns that say whose a row is."""
    return [
        Column("identity", operator.attrgetter("identity")),
        Column("label", operator.attrgetter("label")),
        Column("alternatives", lambda row: " ".join(map(str, row.alternatives))),
    ]


class TargetTable(RowWriter[TargetsRow[Any]]):
    """Writes a table of several targets, and JSON lines, if these are wanted; see `RowWriter`."""

    def lines(self, row: TargetsRow[Any]) -> list[Cells]:
        """Return the values by column name, for each target."""
        return [{column.name: column.value(each) for column in self.columns} for each in row.targets]
