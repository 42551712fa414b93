"""Where the answers of a run are written: tables, JSON lines, pictures, stdout (`Outputs`)."""

import operator
import sys
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

from matchset.app.course.log import ShapeLog
from matchset.app.drawing.annotate import TrackPainter
from matchset.app.exit_codes import discard_stdout
from matchset.app.pictures.run_pictures import RunPictures, WantedPictures
from matchset.app.progress import display_for
from matchset.app.tables import Column, RowWriter, json_line
from matchset.app.track.loop import CountedFrame, RunStatistics, TrackedFrame
from matchset.app.track.rows import FrameRow, TrackRow
from matchset.media.closing import Closing, close_all
from matchset.media.video import Video

Answered = TypeVar("Answered", bound=CountedFrame)
"""One frame of a run with its answer, such as a `TrackedFrame`."""


class LatencyRow(FrameRow, frozen=True):
    """What one answer took.

    Parameters
    ----------
    compute_ms : float
        Computing time of the answer, ms.
    age_ms : float or None
        Of a live frame: time since it was taken when the answer was there, ms.
    """

    compute_ms: float
    age_ms: float | None = None


class Outputs(Closing, Generic[Answered]):
    """The files of a run, and stdout; leaving the `with` block closes the files.

    Parameters
    ----------
    table : RowWriter
        The table.
    pictures : RunPictures
        Its pictures.
    latency : RowWriter, optional
        The table of what each answer took.

    Attributes
    ----------
    pipe_closed : bool
        Whether the reader of stdout has closed the pipe.
    """

    def __init__(
        self,
        table: RowWriter[Any],
        pictures: RunPictures[Any],
        latency: RowWriter[LatencyRow] | None = None,
    ) -> None:
        self._table, self.pictures, self._latency = table, pictures, latency
        self.pipe_closed = False

    def write(self, answered: Answered, age_ms: float | None = None) -> None:
        """Write one frame's answer to every file; of a live frame with its age when it was answered, ms."""
        self._table.write(answered.row)
        if self._latency is not None and answered.frame is not None:
            row = answered.row
            took_ms = round(1000.0 * answered.seconds, 3)
            self._latency.write(LatencyRow(row.frame, round(row.time, 6), took_ms, age_ms))
        self.pictures.add(answered)

    def print(self, answered: Answered, extra: Mapping[str, float]) -> None:
        """Write one frame's answer to stdout as a line of JSON.

        Parameters
        ----------
        answered : Answered
            The frame.
        extra : dict of str to value
            More values, by name.
        """
        try:
            for cells in self._table.lines(answered.row):
                sys.stdout.write(json_line({**cells, **extra}))
            sys.stdout.flush()
        except BrokenPipeError:
            self.pipe_closed = True
            discard_stdout()

    def close(self) -> None:
        """Close the files; the pictures last, since they take longest and can fail."""
        latency = [] if self._latency is None else [self._latency.close]
        close_all(self._table.close, *latency, self.pictures.close)


def track_outputs(
    table: RowWriter[TrackRow],
    wanted: WantedPictures,
    size: tuple[int, int],
    log: ShapeLog,
    latency: RowWriter[LatencyRow] | None = None,
) -> Outputs[TrackedFrame]:
    """Begin the files of a run that tracks; its table was begun first, for a film that was begun must be closed."""
    painter = TrackPainter(size, log.family.parameters)
    pictures = RunPictures[TrackedFrame](
        wanted, painter.size, lambda frame, tracked: painter.paint(frame, tracked.answer, tracked.row), log
    )
    return Outputs(table, pictures, latency)


def latency_table(folder: Path) -> RowWriter[LatencyRow]:
    """Begin `latency.csv`: beside the table of answers, whose columns are fixed."""
    names = ("frame", "time", "compute_ms", "age_ms")
    return RowWriter(folder / "latency.csv", [Column(name, operator.attrgetter(name)) for name in names])


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
    with outputs, display_for(video, to_stdout, statistics.durations, words) as display:
        for answered in frames:
            extra = live_values(video, answered.row.time)
            outputs.write(answered, extra.get("age_ms"))
            statistics.count(answered)
            display.show(answered.row)
            if to_stdout:
                outputs.print(answered, extra)
            if outputs.pipe_closed:
                break


def live_values(video: Video, taken: float) -> dict[str, float]:
    """Return what is printed of a live frame taken at a time, s, besides its row: its age; nothing for a file."""
    if not video.live:
        return {}
    return {"age_ms": round(1000.0 * (time.monotonic() - taken), 1), "dropped": video.dropped}
