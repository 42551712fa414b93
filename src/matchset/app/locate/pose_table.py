"""The table of poses, `poses.csv`, and the same as JSON lines, `poses.jsonl`: written and read back."""

from pathlib import Path

from matchset.app.cell_writer import Cell, CellWriter
from matchset.app.locate.rows import POSITION, SEEN, PoseRow
from matchset.app.tables import Cells, read_csv

_STD = "_std"


def pose_columns() -> list[str]:
    """Return the names of the columns of `poses.csv`."""
    place = [*POSITION, *(name + _STD for name in POSITION)]
    return ["frame", "time", "found", *place, *SEEN, *(name + _STD for name in SEEN), "observed", "reason"]


def pose_cells(row: PoseRow) -> dict[str, Cell]:
    """Return a row's values by column, None where there is none.

    Parameters
    ----------
    row : PoseRow
        The row.
    """
    values, std = row.values or {}, row.std or {}
    cells: dict[str, Cell] = {"frame": row.frame, "time": round(row.time, 6), "found": int(row.found)}
    for names in (POSITION, SEEN):
        cells |= {name: values.get(name) for name in names}
        cells |= {name + _STD: std.get(name) for name in names}
    return cells | {"observed": row.observed, "reason": row.reason}


class PoseWriter:
    """Writes poses as they come; a run that is cut short leaves every finished row whole.

    Parameters
    ----------
    folder : Path
        Where `poses.csv` is written.
    jsonl : bool
        Whether to write `poses.jsonl` too.
    """

    def __init__(self, folder: Path, jsonl: bool) -> None:
        self._writer = CellWriter(folder / "poses.csv", pose_columns(), folder / "poses.jsonl" if jsonl else None)

    def cells(self, row: PoseRow) -> dict[str, Cell]:
        """Return a row's values by column, None where there is none."""
        return pose_cells(row)

    def write(self, row: PoseRow) -> None:
        """Append one row."""
        self._writer.write(pose_cells(row))

    def close(self) -> None:
        """Finish the files."""
        self._writer.close()


def read_poses(path: str | Path) -> list[PoseRow]:
    """Read a `poses.csv`.

    Parameters
    ----------
    path : str or Path
        A CSV file with the columns ``frame,time,found,x,y,z``; the others may be missing.

    Returns
    -------
    list of PoseRow
        In the order of the file.

    Raises
    ------
    ValueError
        If the file cannot be read or a row is wrong; the message holds the file and the line.
    """
    return [_row(line) for line in read_csv(path, required=("frame", "time", "found", *POSITION))]


def _row(line: Cells) -> PoseRow:
    frame, time = line.index("frame"), line.number("time")
    if not line.flag("found"):
        return PoseRow(frame, time, reason=line.text("reason"))
    names = [name for name in (*POSITION, *SEEN) if name in POSITION or line.text(name)]
    return PoseRow(
        frame,
        time,
        values={name: line.number(name) for name in names},
        std={name: line.number(name + _STD) for name in names if line.text(name + _STD)},
        observed=line.text("observed"),
        reason=line.text("reason"),
    )
