"""The table of a run, `tracks.csv`, and the same as JSON lines, `tracks.jsonl`: written and read back."""

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from matchset.app.cell_writer import Cell, CellWriter
from matchset.app.tables import Cells, read_csv
from matchset.app.track.rows import Row

_STD = "_std"


def columns(parameters: Sequence[str]) -> list[str]:
    """Return the names of the columns of `tracks.csv` for a shape with these parameters."""
    return ["frame", "time", "found", *parameters, *(name + _STD for name in parameters), "support", "reason"]


def cells(row: Row, parameters: Sequence[str]) -> dict[str, Cell]:
    """Return a row's values by column, None where there is none.

    Parameters
    ----------
    row : Row
        The row.
    parameters : sequence of str
        The names of the shape's parameters.
    """
    shape, std = row.shape or {}, row.std or {}
    values: dict[str, Cell] = {
        "frame": row.frame,
        "time": round(row.time, 6),
        "found": int(row.found),
    }
    values |= {name: shape.get(name) for name in parameters}
    values |= {name + _STD: std.get(name) for name in parameters}
    values |= {"support": row.support, "reason": row.reason}
    return values


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
        self._writer = CellWriter(csv_path, columns(self._parameters), jsonl_path)

    def cells(self, row: Row) -> dict[str, Cell]:
        """Return a row's values by column, None where there is none."""
        return cells(row, self._parameters)

    def write(self, row: Row) -> None:
        """Append one row."""
        self._writer.write(self.cells(row))

    def close(self) -> None:
        """Finish the files."""
        self._writer.close()

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
