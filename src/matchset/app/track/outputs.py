"""Where the answers of a run go: table, JSON lines, annotated video, a pipe."""

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.app.cell_writer import Cell, json_line
from matchset.app.drawing.annotate import annotate
from matchset.app.drawing.video_writer import Recorder
from matchset.app.exit_codes import forget_stdout
from matchset.app.run_folder import output_file
from matchset.app.track.loop import Step
from matchset.app.track.row_table import TableWriter
from matchset.image.video import Video

Picture = npt.NDArray[np.uint8]

_FPS_IF_UNKNOWN = 30.0


class Table(Protocol):
    """A table on disk, such as `TableWriter`."""

    def cells(self, row: Any) -> dict[str, Cell]:
        """Return a row's values by column, None where there is none."""
        ...

    def write(self, row: Any) -> None:
        """Append one row."""
        ...

    def close(self) -> None:
        """Finish the files."""
        ...


class Entry(Protocol):
    """One frame of a run: its row of the table, and what else is drawn."""

    @property
    def row(self) -> Any:
        """The row."""
        ...


E = TypeVar("E", bound=Entry)


class Outlets(Generic[E]):
    """The files of a run, and its pipe; leaving the `with` block finishes them all.

    Parameters
    ----------
    table : Table
        The table.
    draw : callable
        From an entry to its annotated frame; None where there is no frame.
    recorder : Recorder, optional
        The annotated video.

    Attributes
    ----------
    pipe_closed : bool
        Whether the reader of stdout has gone.
    """

    def __init__(self, table: Table, draw: Callable[[E], Picture | None], recorder: Recorder | None = None) -> None:
        self._table, self._draw, self._recorder = table, draw, recorder
        self.pipe_closed = False

    def write(self, entry: E) -> None:
        """Write one frame's answer to every file."""
        self._table.write(entry.row)
        if self._recorder is not None:
            picture = self._draw(entry)
            if picture is not None:
                self._recorder.write(picture)

    def print(self, entry: E, extra: dict[str, Cell]) -> None:
        """Write one frame's answer to stdout as a line of JSON.

        Parameters
        ----------
        entry : Entry
            The frame.
        extra : dict of str to value
            What else to tell, by name.
        """
        try:
            sys.stdout.write(json_line(self._table.cells(entry.row) | extra))
            sys.stdout.flush()
        except BrokenPipeError:
            self.pipe_closed = True
            forget_stdout()

    def close(self) -> None:
        """Finish the files; the video, which takes longest and can fail, last."""
        self._table.close()
        if self._recorder is not None:
            self._recorder.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def track_outlets(folder: Path, parameters: Sequence[str], jsonl: bool, recorder: Recorder | None) -> Outlets[Step]:
    """Begin the files of a run that tracks: its tables in `folder`, and its video."""
    table = TableWriter(folder / "tracks.csv", parameters, folder / "tracks.jsonl" if jsonl else None)
    return Outlets(table, _drawn, recorder)


def recorder_for(path: Path | None, video: Video, force: bool) -> Recorder | None:
    """Begin the annotated video of a source, if one is wanted; what the user should know of it goes to stderr."""
    if path is None:
        return None
    size = video.width, video.height
    recorder = Recorder(output_file(path, force), video.fps or _FPS_IF_UNKNOWN, size, video.live)
    if recorder.note:
        print("note: " + recorder.note, file=sys.stderr)
    return recorder


def live_figures(video: Video, taken: float) -> dict[str, Cell]:
    """Return what a pipe is told of a live frame taken at a time, s, besides its row; nothing of a file's."""
    if not video.live:
        return {}
    return {"age_ms": round(1000.0 * (time.monotonic() - taken), 1), "dropped": video.dropped}


def _drawn(step: Step) -> Picture | None:
    return None if step.frame is None else annotate(step.frame, step.answer, step.row)
