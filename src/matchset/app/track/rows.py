"""`tracks.csv`: one row for each frame, as it is written (`TrackRow`, `track_columns`) and read (`read_tracks`)."""

import math
import operator
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from matchset.app.tables import Cell, Column, CsvLine, RowWriter, by_frame, read_csv
from matchset.tracking.track import Lost, Track

_DECIMALS = 4  # format: 1e-4 px, far below the noise of any camera
_STD = "_std"


class FrameRow(msgspec.Struct, frozen=True):
    """What every table says of a frame.

    Parameters
    ----------
    frame : int
        Its index in the video, from 0, in decode order.
    time : float
        When it was taken, s.
    """

    frame: int
    time: float


class TrackRow(FrameRow, frozen=True):
    """The answer for one frame, as tables hold it.

    Parameters
    ----------
    shape : dict of str to float, or None
        The shape's parameters by name, px and rad; None where it was not found.
    std : dict of str to float, or None
        Their standard deviations, by the same names; a parameter without a finite one is left out.
    support : float or None
        Share of the outline that was confirmed, 0 ... 1.
    reason : str
        Why it was not found, in words; empty where it was.
    """

    shape: dict[str, float] | None = None
    std: dict[str, float] | None = None
    support: float | None = None
    reason: str = ""

    @property
    def found(self) -> bool:
        """Whether this frame's pixels confirm the shape."""
        return self.shape is not None

    @property
    def brief(self) -> str:
        """The shape in a few words, for the status line; empty where it was not found."""
        named = list((self.shape or {}).items())[:3]
        return "  ".join(f"{'r' if name == 'radius' else name} {value:6.1f}" for name, value in named)


def track_row(frame: int, answer: Track[Any] | Lost[Any]) -> TrackRow:
    """Turn a tracker's answer into the row of its frame.

    Parameters
    ----------
    frame : int
        The frame's index.
    answer : Track or Lost
        What `Tracker.update` returned for it.

    Returns
    -------
    TrackRow
        With numbers rounded to 1e-4 px.
    """
    if isinstance(answer, Lost):
        return TrackRow(frame, answer.time, reason=answer.reason)
    names = answer.shape.parameters
    variances = np.diagonal(answer.covariance)
    return TrackRow(
        frame=frame,
        time=answer.time,
        shape={name: round(float(getattr(answer.shape, name)), _DECIMALS) for name in names},
        std={
            name: round(math.sqrt(variance), _DECIMALS)
            for name, variance in zip(names, variances, strict=True)
            if math.isfinite(variance) and variance >= 0.0
        },
        support=round(float(answer.support), _DECIMALS),
    )


def track_columns(parameters: Sequence[str]) -> list[Column]:
    """Return the columns of `tracks.csv` for a shape with these parameters."""
    return [
        *frame_columns(),
        *value_columns(parameters, "shape"),
        *std_columns(parameters),
        Column("support", operator.attrgetter("support")),
        Column("reason", operator.attrgetter("reason")),
    ]


def frame_columns() -> list[Column]:
    """Return the first columns of every table of frames: frame, time, found."""

    def seconds(row: Any) -> Cell:
        return round(float(row.time), 6)

    def found(row: Any) -> Cell:
        return int(row.found)

    return [Column("frame", operator.attrgetter("frame")), Column("time", seconds), Column("found", found)]


def value_columns(names: Sequence[str], field: str) -> list[Column]:
    """Return columns for the values of these names; the rows hold them in a field, a dict or None."""

    def value_of(name: str) -> Column:
        return Column(name, lambda row: (getattr(row, field) or {}).get(name))

    return [value_of(name) for name in names]


def std_columns(names: Sequence[str]) -> list[Column]:
    """Return columns for the standard deviations of the values of these names, as `std` of the rows holds them."""
    return [Column(name + _STD, value) for name, value in value_columns(names, "std")]


def read_std(line: CsvLine, names: Sequence[str]) -> dict[str, float]:
    """Return the standard deviations in a line of the values of these names, where there are any."""
    return {name: line.number(name + _STD) for name in names if line.text(name + _STD)}


def track_table(csv_path: Path, parameters: Sequence[str], jsonl_path: Path | None = None) -> RowWriter[TrackRow]:
    """Begin a `tracks.csv`.

    Parameters
    ----------
    csv_path : Path
        The table to write.
    parameters : sequence of str
        The names of the shape's parameters.
    jsonl_path : Path, optional
        Where to write the same rows as JSON lines.
    """
    return RowWriter(csv_path, track_columns(parameters), jsonl_path)


def read_tracks(path: str | Path, identity: int | None = None) -> list[TrackRow]:
    """Read a `tracks.csv`, of this program or another's.

    Parameters
    ----------
    path : str or Path
        A CSV file with the columns ``frame,found`` and a shape's parameters; ``time``, standard
        deviations, ``support`` and ``reason`` may be missing.
    identity : int, optional
        Whose rows to take; needed only if the file holds several targets.

    Returns
    -------
    list of TrackRow
        In the order of their frames.

    Raises
    ------
    ValueError
        If the file cannot be read or a row is wrong; the message holds the file and the line.
    """
    lines = read_csv(path, required=("frame", "found", "x", "y", "radius"))
    return by_frame(lines_of(path, lines, identity), _row_of)


def lines_of(path: str | Path, lines: list[CsvLine], identity: int | None = None) -> list[CsvLine]:
    """Return the lines of one target.

    Raises
    ------
    ValueError
        If there are several and none is named, or that one is not there.
    """
    if not any("identity" in line.cells for line in lines):
        if identity is not None:
            raise ValueError(f"{path} holds one target, without an identity, got identity {identity}")
        return lines
    there = sorted({line.index("identity") for line in lines})
    words = ", ".join(map(str, there))
    if identity is None and len(there) > 1:
        raise ValueError(f"{path} holds several targets ({words}): say which by its identity")
    if identity is not None and identity not in there:
        raise ValueError(f"{path} holds no target {identity}; it has {words}")
    return [line for line in lines if identity in (None, line.index("identity"))]


def _row_of(line: CsvLine) -> TrackRow:
    frame = line.index("frame")
    time = line.number("time") if line.text("time") else 0.0
    if not line.flag("found"):
        return TrackRow(frame, time, reason=line.text("reason"))
    others = ("frame", "time", "found", "support", "reason", "identity", "label", "alternatives")
    names = [name for name in line.cells if name not in others and not name.endswith(_STD)]
    return TrackRow(
        frame=frame,
        time=time,
        shape={name: line.number(name) for name in names},
        std=read_std(line, names),
        support=line.number("support") if line.text("support") else None,
        reason=line.text("reason"),
    )
