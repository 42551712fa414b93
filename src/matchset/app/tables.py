"""Reading a CSV file so that whatever is wrong with it is said with its file and line."""

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import msgspec


class Cells(msgspec.Struct, frozen=True):
    """One line of a CSV file, its cells by column name.

    Parameters
    ----------
    path : str
        The file, for messages.
    line : int
        The line in it, from 1.
    cells : dict of str to str
        What the line holds.
    """

    path: str
    line: int
    cells: dict[str, str]

    def error(self, problem: str) -> ValueError:
        """Make the error that says where `problem` is."""
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


def read_csv(path: str | Path, required: Sequence[str]) -> list[Cells]:
    """Read a CSV file that begins with a line of column names.

    Parameters
    ----------
    path : str or Path
        The file.
    required : sequence of str
        Columns that must be there; more are welcome, in any order.

    Returns
    -------
    list of Cells
        The lines after the first that are not empty.

    Raises
    ------
    ValueError
        If the file cannot be read, is not CSV text, or lacks a column.
    """
    try:
        with Path(path).open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file, strict=True)
            lines = [(reader.line_num, cells) for cells in reader if cells]
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{path} is not a CSV table: {error}") from error
    if not lines:
        raise ValueError(f"{path} is empty")
    names = [name.strip() for name in lines[0][1]]
    missing = [name for name in required if name not in names]
    if missing:
        raise ValueError(f"{path}, line 1: there is no column {', '.join(missing)}")
    if len(set(names)) < len(names):
        raise ValueError(f"{path}, line 1: a column is named twice")
    return [_cells(str(path), line, names, cells) for line, cells in lines[1:]]


def _cells(path: str, line: int, names: list[str], cells: list[str]) -> Cells:
    if len(cells) != len(names):
        raise ValueError(f"{path}, line {line}: {len(names)} cells were expected, got {len(cells)}")
    return Cells(path, line, dict(zip(names, cells, strict=True)))
