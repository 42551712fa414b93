"""Clicks for the videos of a batch, from a table: `ClickTable`, and `click_line` for one more."""

import csv
import io
from collections.abc import Iterable
from pathlib import Path

from matchset.app.tables import CsvLine, read_csv
from matchset.batch.jobs.videos import plain_name

COLUMNS = "video", "frame", "x", "y"
HEADING = ",".join(COLUMNS) + "\n"
SHOWN = 3  # format: videos that an error names


class ClickTable:
    """Where to click in which video.

    Parameters
    ----------
    path : Path or None
        A table with the columns video, frame, x, y; a video may have several rows, a target each. It is named by its
        whole name, by that in the results, by that from the folder of the table on, or by the file's alone where only
        one video has it. None: no clicks.
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
        self._lines: dict[str, CsvLine] = {}
        self._named: dict[str, list[str]] = {}
        self._folder = Path() if path is None else path.parent
        for line in [] if path is None else read_csv(path, COLUMNS):
            self.add(line.text("video"), _pick(line))
            self._lines.setdefault(line.text("video"), line)

    def add(self, video: str, pick: str) -> None:
        """Add a click, X,Y@FRAME; one that is there already counts once."""
        picks = self._picks.setdefault(video, [])
        if self._of_page:
            picks[:] = [pick]
        elif pick not in picks:
            picks.append(pick)

    def match(self, videos: Iterable[tuple[str, str]]) -> list[CsvLine]:
        """Find which video each row means.

        Parameters
        ----------
        videos : iterable of (str, str)
            The whole name of each video, and that in the results.

        Returns
        -------
        list of CsvLine
            Those that mean none: of each name the first.

        Raises
        ------
        ValueError
            If one may mean several: with the line and the videos.
        """
        if self._of_page or not self._lines:
            return []
        meant: dict[str, tuple[int, list[str]]] = {}
        for video, folder in videos:
            for rank, name in enumerate(self._names(video, folder)):  # the more of its name, the better
                best, found = meant.get(name, (rank, []))
                if name in self._lines and rank <= best and found[-1:] != [video]:
                    meant[name] = rank, [*(found if rank == best else []), video]
        for name, line in self._lines.items():
            _, found = meant.get(name, (0, []))
            if len(found) > 1:
                few = ", ".join(map(plain_name, found[:SHOWN])) + (" ..." if len(found) > SHOWN else "")
                raise line.error(f"{name} is the name of {len(found)} videos, {few}: give the folder, too")
            for video in found:
                self._named.setdefault(video, []).append(name)
        return [line for name, line in self._lines.items() if name not in meant]

    def _names(self, video: str, folder: str) -> tuple[str, str, str, str]:
        path, near = Path(video), self._folder.absolute()
        return video, folder, path.relative_to(near).as_posix() if path.is_relative_to(near) else video, path.name

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
        return [pick for name in self._named.get(video, []) for pick in self._picks[name]]


def _pick(line: CsvLine) -> str:
    x, y, frame = line.number("x"), line.number("y"), line.index("frame")
    return f"{x:g},{y:g}@{frame}"


def click_line(video: str, frame: int, x: float, y: float) -> str:
    """Return the line of a click in such a table."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow([video, frame, f"{x:g}", f"{y:g}"])
    return text.getvalue()
