"""All rows of all videos in one table: `AllRows` writes CSV, and Parquet where pyarrow is installed."""

import csv
import io
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.exit_codes import print_note
from matchset.media.closing import Closing, close_all

WORDS = frozenset(("video", "label", "reason", "alternatives", "observed"))  # format: columns of text
NUMBERS = frozenset(("frame", "identity"))  # format: columns of whole numbers


class AllRowsParameters(msgspec.Struct, frozen=True):
    """How the table is written.

    Parameters
    ----------
    group : int
        Bytes of CSV text from which they become a group of rows of the Parquet file. More: a smaller file and more
        memory.
    """

    group: int = 8_000_000


PARAMETERS = AllRowsParameters()


class AllRows(Closing):
    """Appends tables of videos to one table; their names are its first column.

    Parameters
    ----------
    folder : Path
        Where all.csv and all.parquet are written.

    Attributes
    ----------
    files : list of Path
    """

    def __init__(self, folder: Path) -> None:
        self._names: list[str] | None = None
        self._others = 0
        self.files = [folder / "all.csv"]
        self._csv = self.files[0].open("w", encoding="utf-8", newline="")
        self._parquet = _parquet(folder / "all.parquet")
        if self._parquet is not None:
            self.files.append(self._parquet.path)

    def append(self, video: str, table: bytes) -> None:
        """Append the table of a video."""
        heading, _, rest = table.partition(b"\n")
        names = heading.decode().split(",")
        if self._names is None:
            self._names = names
            self._csv.write(f"video,{heading.decode()}\n")
        if names != self._names:
            self._others += 1
            return
        text = io.StringIO()
        csv.writer(text, lineterminator="").writerow([video])
        first = text.getvalue()
        lines = "".join(f"{first},{line}\n" for line in _rows(rest.decode()))
        self._csv.write(lines)
        if self._parquet is not None:
            self._parquet.append(["video", *names], lines)

    def close(self) -> None:
        """Write what waits, and close the files."""
        if self._others:
            print_note(f"{self._others} tables have other columns than the first one: they are not in all.csv")
            self._others = 0
        close_all(self._csv.close, *([] if self._parquet is None else [self._parquet.close]))


def _rows(text: str) -> list[str]:
    """Return the rows of a table; one with a line end in a cell stays one."""
    if '"' not in text:
        return text.splitlines()
    rows = []
    for row in csv.reader(io.StringIO(text, newline="")):
        line = io.StringIO()
        csv.writer(line, lineterminator="").writerow(row)
        rows.append(line.getvalue())
    return rows


class _Parquet:
    """Writes the same rows as Parquet, group by group."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._writer: Any = None
        self._names = list[str]()
        self._waiting, self._size = list[str](), 0

    def append(self, names: list[str], lines: str) -> None:
        """Append rows of CSV text."""
        self._names = names
        self._waiting.append(lines)
        self._size += len(lines)
        if self._size >= PARAMETERS.group:
            self._flush()

    def close(self) -> None:
        """Write the last group, and close the file."""
        self._flush()
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def _flush(self) -> None:
        text, self._waiting, self._size = "".join(self._waiting), [], 0
        if not text:
            return
        import pyarrow as arrow
        from pyarrow import csv as arrow_csv
        from pyarrow import parquet

        types = {name: _type(arrow, name) for name in self._names}
        table = arrow_csv.read_csv(
            arrow.BufferReader(text.encode()),
            read_options=arrow_csv.ReadOptions(column_names=self._names),
            parse_options=arrow_csv.ParseOptions(newlines_in_values=True),
            convert_options=arrow_csv.ConvertOptions(column_types=types, strings_can_be_null=False),
        )
        if self._writer is None:
            self._writer = parquet.ParquetWriter(self.path, table.schema)
        self._writer.write_table(table)


def _type(arrow: Any, name: str) -> Any:
    if name in WORDS:
        return arrow.string()
    if name == "found":
        return arrow.bool_()
    return arrow.int64() if name in NUMBERS else arrow.float64()


def _parquet(path: Path) -> _Parquet | None:
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        return None
    return _Parquet(path)
