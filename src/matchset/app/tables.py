"""Tables on disk: a writer of CSV and JSON lines for any row, and a reader of CSV whose errors name the line."""

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import msgspec

from matchset.app.disk import UnfinishedFileError, WholeFile
from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_limited
from matchset.media.closing import Closing, close_all

Cell = int | float | str | None
Cells = Mapping[str, Cell]
Row = TypeVar("Row")
Framed = TypeVar("Framed", bound="RowOfFrame")

_ENCODER = msgspec.json.Encoder()


class Column(NamedTuple):
    """A column of a table.

    Parameters
    ----------
    name : str
        Its name, in the first line of the CSV file and as a key of the JSON lines.
    value : callable
        From a row to its cell in this column; None leaves the cell empty.
    """

    name: str
    value: Callable[[Any], Cell]


class RowOfFrame(Protocol):
    """A row that belongs to a frame."""

    @property
    def frame(self) -> int:
        """Index of the frame."""


class RowWriter(Closing, Generic[Row]):
    """Writes a table row by row; each is with the operating system before the next one, so a crash leaves whole rows.

    Parameters
    ----------
    csv_path : Path
        The table to write.
    columns : sequence of Column
        Its columns.
    jsonl_path : Path, optional
        Where to write the same rows as JSON lines.

    Attributes
    ----------
    columns : tuple of Column

    Raises
    ------
    OSError
        If a file cannot be written, with its name; also by `write`.
    """

    def __init__(self, csv_path: Path, columns: Sequence[Column], jsonl_path: Path | None = None) -> None:
        self.columns, self._rows = tuple(columns), 0
        self._csv = WholeFile(csv_path)
        self._jsonl: WholeFile | None = None
        try:
            if jsonl_path is not None:
                self._jsonl = WholeFile(jsonl_path)
            self._csv.append(_csv_line([column.name for column in self.columns]).encode())
        except BaseException:
            self.close()
            raise

    def lines(self, row: Row) -> list[Cells]:
        """Return a row's values by column name, None where there is none: one line of the table."""
        return [{column.name: column.value(row) for column in self.columns}]

    def write(self, row: Row) -> None:
        """Append one row.

        Raises
        ------
        UnfinishedFileError
            If it does not fit on the disk: the file ends with the row before.
        """
        for cells in self.lines(row):
            self._append(self._csv, _csv_line(["" if value is None else str(value) for value in cells.values()]))
            if self._jsonl is not None:
                self._append(self._jsonl, json_line(cells))
            self._rows += 1

    def _append(self, file: WholeFile, line: str) -> None:
        try:
            file.append(line.encode())
        except OSError as error:
            raise UnfinishedFileError(error, file.path, f"{self._rows} rows") from None

    def close(self) -> None:
        """Close the files."""
        close_all(self._csv.close, *([] if self._jsonl is None else [self._jsonl.close]))


def json_line(cells: Cells) -> str:
    """Return a row as one line of JSON, with its line end."""
    return _ENCODER.encode(cells).decode() + "\n"


def _csv_line(values: Sequence[str]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(values)
    return text.getvalue()


class CsvLine(msgspec.Struct, frozen=True):
    """One line of a CSV file, its cells by column name.

    Parameters
    ----------
    path : str
        The file, for error messages.
    line : int
        The line in it, from 1.
    cells : dict of str to str
        The text of its cells.
    """

    path: str
    line: int
    cells: dict[str, str]

    def error(self, problem: str) -> ValueError:
        """Make the error that names the file, the line and the problem."""
        return ValueError(f"{self.path}, line {self.line}: {problem}")

    def text(self, name: str) -> str:
        """Return a cell's text, empty where the file has no such column."""
        return self.cells.get(name, "").strip()

    def number(self, name: str) -> float:
        """Return a cell as a finite number."""
        try:
            value = float(self.text(name))
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.error(f"{name} must be a number, got {self.text(name)!r}")
        return value

    def index(self, name: str) -> int:
        """Return a cell as an integer from 0."""
        text = self.text(name)
        if not (text.isascii() and text.isdigit() and len(text) <= 12):
            raise self.error(f"{name} must be an integer from 0, got {text!r}")
        return int(text)

    def flag(self, name: str) -> bool:
        """Return a cell that holds 0 or 1."""
        text = self.text(name)
        if text not in ("0", "1"):
            raise self.error(f"{name} must be 0 or 1, got {text!r}")
        return text == "1"


def read_csv(path: str | Path, required: Sequence[str]) -> list[CsvLine]:
    """Read a CSV file that begins with a line of column names.

    Parameters
    ----------
    path : str or Path
        The file.
    required : sequence of str
        Columns that must be there; more are allowed, in any order.

    Returns
    -------
    list of CsvLine
        The lines after the first that are not empty.

    Raises
    ------
    ValueError
        If the file cannot be read, is not CSV text, or lacks a column.
    """
    lines = _lines(path)
    if not lines:
        raise ValueError(f"{path} is empty")
    names = [name.strip() for name in lines[0][1]]
    missing = [name for name in required if name not in names]
    if missing:
        raise ValueError(f"{path}, line 1: there is no column {', '.join(missing)}")
    if len(set(names)) < len(names):
        raise ValueError(f"{path}, line 1: a column is named twice")
    return [_csv_line_of(str(path), line, names, cells) for line, cells in lines[1:]]


def by_frame(lines: Iterable[CsvLine], row_of: Callable[[CsvLine], Framed]) -> list[Framed]:
    """Turn lines into rows, in the order of their frames.

    Parameters
    ----------
    lines : iterable of CsvLine
    row_of : callable
        From a line to its row.

    Raises
    ------
    ValueError
        If two rows are of one frame.
    """
    rows: dict[int, Framed] = {}
    for line in lines:
        row = row_of(line)
        if row.frame in rows:
            raise line.error(f"frame {row.frame} was given before")
        rows[row.frame] = row
    return [rows[frame] for frame in sorted(rows)]


def _lines(path: str | Path) -> list[tuple[int, list[str]]]:
    """Return the lines of a CSV file that are not empty, with their numbers."""
    try:
        text = read_limited(Path(path), LIMITS.table, text=True).decode("utf-8-sig")
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        return [(reader.line_num, cells) for cells in reader if cells]
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from error
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path} is not a CSV table: {error}") from error


def _csv_line_of(path: str, line: int, names: list[str], cells: list[str]) -> CsvLine:
    if len(cells) != len(names):
        raise ValueError(f"{path}, line {line}: {len(names)} cells were expected, got {len(cells)}")
    return CsvLine(path, line, dict(zip(names, cells, strict=True)))
