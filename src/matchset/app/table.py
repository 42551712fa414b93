"""The table of a run, `tracks.csv`, and the same as JSON lines, `tracks.jsonl`: written and read back."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

import msgspec

from matchset.app.csv_file import Cells, read_csv
from matchset.app.row import Row

_STD = "_std"
_ENCODER = msgspec.json.Encoder()


def columns(parameters: Sequence[str]) -> list[str]:
    """Return the names of the columns of `tracks.csv` for a shape with these parameters."""
    return ["frame", "time", "found", *parameters, *(name + _STD for name in parameters), "support", "reason"]


def cells(row: Row, parameters: Sequence[str]) -> dict[str, int | float | str | None]:
    """Return a row's values by column, None where there is none.

    Parameters
    ----------
    row : Row
        The row.
    parameters : sequence of str
        The names of the shape's parameters.
    """
    shape, std = row.shape or {}, row.std or {}
    values: dict[str, int | float | str | None] = {
        "frame": row.frame,
        "time": round(row.time, 6),
        "found": int(row.found),
    }
    values |= {name: shape.get(name) for name in parameters}
    values |= {name + _STD: std.get(name) for name in parameters}
    values |= {"support": row.support, "reason": row.reason}
    return values


def csv_line(row: Row, parameters: Sequence[str]) -> str:
    """Return a row as one line of `tracks.csv`, with its line end."""
    values = ["" if value is None else str(value) for value in cells(row, parameters).values()]
    return _joined(values)


def json_line(row: Row, parameters: Sequence[str]) -> str:
    """Return a row as one line of `tracks.jsonl`, with its line end."""
    return _ENCODER.encode(cells(row, parameters)).decode() + "\n"


class TableWriter:
    """Writes rows as they come; a run that is cut short leaves every finished row whole.

    Parameters
    ----------
    csv_path : Path
        The table to write.
    parameters : sequence of str
        The names of the shape's parameters.
    jsonl_path : Path, optional
        Where to write the same rows as JSON lines.
    """

    def __init__(self, csv_path: Path, parameters: Sequence[str], jsonl_path: Path | None = None) -> None:
        self._parameters = tuple(parameters)
        # Line buffering hands each row to the system in one piece, so what a crash leaves behind is readable.
        self._csv = csv_path.open("w", encoding="utf-8", newline="", buffering=1)
        self._jsonl = None if jsonl_path is None else jsonl_path.open("w", encoding="utf-8", buffering=1)
        self._csv.write(_joined(columns(self._parameters)))

    def write(self, row: Row) -> None:
        """Append one row."""
        self._csv.write(csv_line(row, self._parameters))
        if self._jsonl is not None:
            self._jsonl.write(json_line(row, self._parameters))

    def close(self) -> None:
        """Finish the files."""
        self._csv.close()
        if self._jsonl is not None:
            self._jsonl.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def read_tracks(path: str | Path) -> list[Row]:
    """Read a `tracks.csv`, of this program or another's.

    Parameters
    ----------
    path : str or Path
        A CSV file with the columns ``frame,found`` and a shape's parameters; ``time``, standard
        deviations, ``support`` and ``reason`` may be missing.

    Returns
    -------
    list of Row
        In the order of their frames.

    Raises
    ------
    ValueError
        If the file cannot be read or a row is wrong; the message holds the file and the line.
    """
    rows: dict[int, Row] = {}
    for line in read_csv(path, required=("frame", "found", "x", "y", "radius")):
        row = _row(line)
        if row.frame in rows:
            raise line.error(f"frame {row.frame} was given before")
        rows[row.frame] = row
    return [rows[frame] for frame in sorted(rows)]


def _row(line: Cells) -> Row:
    frame = line.index("frame")
    time = line.number("time") if line.text("time") else 0.0
    if not line.flag("found"):
        return Row(frame, time, reason=line.text("reason"))
    others = ("frame", "time", "found", "support", "reason")
    names = [name for name in line.cells if name not in others and not name.endswith(_STD)]
    return Row(
        frame=frame,
        time=time,
        shape={name: line.number(name) for name in names},
        std={name: line.number(name + _STD) for name in names if line.text(name + _STD)},
        support=line.number("support") if line.text("support") else None,
        reason=line.text("reason"),
    )


def _joined(values: Sequence[str]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(values)
    return text.getvalue()
