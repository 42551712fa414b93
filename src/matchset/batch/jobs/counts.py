"""How many frames a table has, and in how many something was found: `counts_in`."""

import csv
from pathlib import Path

TABLES = "tracks.csv", "poses.csv"


def table_in(folder: Path) -> Path | None:
    """Return the table of a run; None if there is none."""
    return next((folder / name for name in TABLES if (folder / name).is_file()), None)


def counts_in(folder: Path) -> tuple[int, int]:
    """Return the frames in the table of a run, and those in which one target or more was found."""
    table = table_in(folder)
    if table is None:
        return 0, 0
    frames = found = 0
    last, seen = "", False
    with table.open(newline="", encoding="utf-8") as text:
        rows = csv.reader(text)
        names = next(rows, [])
        frame, is_found = names.index("frame"), names.index("found")
        for row in rows:
            if row[frame] != last or not frames:
                frames, last, seen = frames + 1, row[frame], False
            if row[is_found] == "1" and not seen:
                found, seen = found + 1, True
    return frames, found
