"""The table of a video (`kept_table`, `noted_table`), its frames, and those with something found (`counts_in`)."""

import csv
import zlib
from pathlib import Path

from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.results.store import Store

TABLES = "tracks.csv", "poses.csv"


def kept_table(store: Store, folder: str) -> tuple[str, bytes] | None:
    """Return name and content of the table in the folder of a video's results; None if there is none."""
    tables = ((name, store.read(f"{folder}/{name}")) for name in TABLES)
    return next(((name, data) for name, data in tables if data is not None), None)


def noted_table(store: Store, outcome: VideoOutcome) -> bytes | None:
    """Return the table that was noted; None if there is none, or another one."""
    _, data = kept_table(store, outcome.folder) or ("", b"")
    return data if outcome.frames and outcome.table == f"{zlib.crc32(data):08x}" else None


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
