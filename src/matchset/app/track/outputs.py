"""Where the answers of a run are written: table, JSON lines, annotated video, stdout (`Outputs`)."""

import sys
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.app.closing import Closing, close_all
from matchset.app.drawing.annotate import annotate
from matchset.app.exit_codes import discard_stdout
from matchset.app.films.video_writer import Recorder
from matchset.app.progress import display_for
from matchset.app.run_folder import output_file
from matchset.app.tables import Cell, RowWriter, json_line
from matchset.app.track.loop import CountedFrame, RunStatistics, TrackedFrame
from matchset.app.track.rows import track_table
from matchset.image.video import Video

Picture = npt.NDArray[np.uint8]

_DEFAULT_FPS = 30.0  # format: frame rate of an annotated video whose source has none


Answered = TypeVar("Answered", bound=CountedFrame)
"""One frame of a run with its answer, such as a `TrackedFrame`."""


class Outputs(Closing, Generic[Answered]):
    """The files of a run, and stdout; leaving the `with` block closes the files.

    Parameters
    ----------
    table : RowWriter
        The table.
    draw : callable
        From an answered frame to its annotated picture; None where there is no picture.
    recorder : Recorder, optional
        The annotated video.

    Attributes
    ----------
    pipe_closed : bool
        Whether the reader of stdout has closed the pipe.
    """

    def __init__(
        self, table: RowWriter[Any], draw: Callable[[Answered], Picture | None], recorder: Recorder | None = None
    ) -> None:
        self._table, self._draw, self._recorder = table, draw, recorder
        self.pipe_closed = False

    def write(self, answered: Answered) -> None:
        """Write one frame's answer to every file."""
        self._table.write(answered.row)
        if self._recorder is not None:
            picture = self._draw(answered)
            if picture is not None:
                self._recorder.write(picture)

    def print(self, answered: Answered, extra: dict[str, Cell]) -> None:
        """Write one frame's answer to stdout as a line of JSON.

        Parameters
        ----------
        answered : Answered
            The frame.
        extra : dict of str to value
            More values, by name.
        """
        try:
            sys.stdout.write(json_line(self._table.cells(answered.row) | extra))
            sys.stdout.flush()
        except BrokenPipeError:
            self.pipe_closed = True
            discard_stdout()

    def close(self) -> None:
        """Close the files; the video last, since it takes longest and can fail."""
        close_all(self._table.close, *([] if self._recorder is None else [self._recorder.close]))


def track_outputs(
    folder: Path, parameters: Sequence[str], jsonl: bool, recorder: Recorder | None
) -> Outputs[TrackedFrame]:
    """Begin the files of a run of `matchset track`: its tables in `folder`, and its video."""
    table = track_table(folder / "tracks.csv", parameters, folder / "tracks.jsonl" if jsonl else None)
    return Outputs(table, _annotated, recorder)


def recorder_for(path: Path | None, video: Video, force: bool, source: str) -> Recorder | None:
    """Begin the annotated video of a source, if one is wanted; a note on its codec goes to stderr."""
    if path is None:
        return None
    size = video.width, video.height
    recorder = Recorder(output_file(path, force, source), video.fps or _DEFAULT_FPS, size, video.live)
    if recorder.note:
        print("note: " + recorder.note, file=sys.stderr)
    return recorder


def write_frames(
    frames: Iterable[Answered],
    outputs: Outputs[Answered],
    statistics: RunStatistics,
    video: Video,
    to_stdout: bool,
    words: str = "tracking",
) -> None:
    """Write every frame of a run, until it ends or the reader of stdout closes the pipe.

    Parameters
    ----------
    frames : iterable of Answered
        The frames with their answers.
    outputs : Outputs
        Closed at the end.
    statistics : RunStatistics
        Counts the frames.
    video : Video
        The source.
    to_stdout : bool
        Whether to print each answer as JSON; then no progress is shown.
    words : str
        What is shown beside the progress bar.
    """
    with outputs, display_for(video, to_stdout, words) as display:
        for answered in frames:
            outputs.write(answered)
            statistics.count(answered)
            display.show(answered.row)
            if to_stdout:
                outputs.print(answered, live_values(video, answered.row.time))
            if outputs.pipe_closed:
                break


def live_values(video: Video, taken: float) -> dict[str, Cell]:
    """Return what is printed of a live frame taken at a time, s, besides its row: its age; nothing for a file."""
    if not video.live:
        return {}
    return {"age_ms": round(1000.0 * (time.monotonic() - taken), 1), "dropped": video.dropped}


def _annotated(tracked: TrackedFrame) -> Picture | None:
    return None if tracked.frame is None else annotate(tracked.frame, tracked.answer, tracked.row)
