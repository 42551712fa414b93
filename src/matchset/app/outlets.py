"""Where the answers of a run go: table, JSON lines, annotated video, a pipe."""

import sys
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

import msgspec

from matchset.app.draw import annotate
from matchset.app.ending import forget_stdout
from matchset.app.follow import Step
from matchset.app.recorder import Recorder
from matchset.app.table import TableWriter, cells

_ENCODER = msgspec.json.Encoder()


class Outlets:
    """The files of a run, and its pipe; leaving the `with` block finishes them all.

    Parameters
    ----------
    table : TableWriter
        The table.
    recorder : Recorder, optional
        The annotated video.

    Attributes
    ----------
    pipe_closed : bool
        Whether the reader of stdout has gone.
    """

    def __init__(self, table: TableWriter, recorder: Recorder | None = None) -> None:
        self._table, self._recorder = table, recorder
        self.pipe_closed = False

    def write(self, step: Step) -> None:
        """Write one frame's answer to every file."""
        self._table.write(step.row)
        if self._recorder is not None and step.frame is not None:
            self._recorder.write(annotate(step.frame, step.answer, step.row))

    def print(self, step: Step, parameters: Sequence[str], extra: dict[str, float]) -> None:
        """Write one frame's answer to stdout as a line of JSON.

        Parameters
        ----------
        step : Step
            The frame.
        parameters : sequence of str
            The names of the shape's parameters.
        extra : dict of str to float
            What else to tell, by name.
        """
        try:
            line = _ENCODER.encode(cells(step.row, parameters) | extra).decode()
            sys.stdout.write(line + "\n")
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


def table_in(folder: Path, parameters: Sequence[str], jsonl: bool) -> TableWriter:
    """Begin the tables of a run in its folder."""
    return TableWriter(folder / "tracks.csv", parameters, folder / "tracks.jsonl" if jsonl else None)
