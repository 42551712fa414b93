"""A table on disk, written row by row: CSV, and the same as JSON lines."""

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import msgspec

Cell = int | float | str | None
Cells = Mapping[str, Cell]

_ENCODER = msgspec.json.Encoder()


class CellWriter:
    """Writes rows as they come; a run that is cut short leaves every finished row whole.

    Parameters
    ----------
    csv_path : Path
        The table to write.
    columns : sequence of str
        Names of its columns.
    jsonl_path : Path, optional
        Where to write the same rows as JSON lines.
    """

    def __init__(self, csv_path: Path, columns: Sequence[str], jsonl_path: Path | None = None) -> None:
        # Line buffering hands each row to the system in one piece, so what a crash leaves behind is readable.
        self._csv = csv_path.open("w", encoding="utf-8", newline="", buffering=1)
        self._jsonl = None if jsonl_path is None else jsonl_path.open("w", encoding="utf-8", buffering=1)
        self._csv.write(_joined(columns))

    def write(self, cells: Cells) -> None:
        """Append one row; what is None stays empty."""
        self._csv.write(_joined(["" if value is None else str(value) for value in cells.values()]))
        if self._jsonl is not None:
            self._jsonl.write(json_line(cells))

    def close(self) -> None:
        """Finish the files."""
        self._csv.close()
        if self._jsonl is not None:
            self._jsonl.close()


def json_line(cells: Cells) -> str:
    """Return a row as one line of JSON, with its line end."""
    return _ENCODER.encode(cells).decode() + "\n"


def _joined(values: Sequence[str]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(values)
    return text.getvalue()
