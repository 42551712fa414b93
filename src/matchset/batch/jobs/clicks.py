"""Clicks for the videos of a batch, from a table: `ClickTable`, and `click_line` for one more."""

import csv
import io
from pathlib import Path

from matchset.app.tables import CsvLine, read_csv

COLUMNS = "video", "frame", "x", "y"
HEADING = ",".join(COLUMNS) + "\n"


class ClickTable:
    """Where to click in which video.

    Parameters
    ----------
    path : Path or None
        A table with the columns video, frame, x, y; a video may have several rows, a target each. None: no clicks.
    of_page : bool
        Whether a page has written it: videos by their names in the results alone, and the last click counts.

    Raises
    ------
    ValueError
        If it cannot be read; with the line.
    """

    def __init__(self, path: Path | None = None, of_page: bool = False) -> None:
        self._of_page = of_page
        self._picks: dict[str, list[str]] = {}
        self._folder = Path() if path is None else path.parent
        for line in [] if path is None else read_csv(path, COLUMNS):
            self.add(line.text("video"), _pick(line))

    def add(self, video: str, pick: str) -> None:
        """Add a click, X,Y@FRAME; one that is there already counts once."""
        picks = self._picks.setdefault(video, [])
        if self._of_page:
            picks[:] = [pick]
        elif pick not in picks:
            picks.append(pick)

    def of(self, video: str, folder: str) -> list[str]:
        """Return the clicks in a video.

        Parameters
        ----------
        video : str
            Its whole name.
        folder : str
            Its name in the results.
        """
        if self._of_page:
            return self._picks.get(folder, [])
        path, near = Path(video), self._folder.absolute()
        beside = [path.relative_to(near).as_posix()] if path.is_relative_to(near) else []
        names = video, folder, *beside, path.name
        return next((self._picks[name] for name in names if name in self._picks), [])


def _pick(line: CsvLine) -> str:
    x, y, frame = line.number("x"), line.number("y"), line.index("frame")
    return f"{x:g},{y:g}@{frame}"


def click_line(video: str, frame: int, x: float, y: float) -> str:
    """Return the line of a click in such a table."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow([video, frame, f"{x:g}", f"{y:g}"])
    return text.getvalue()
