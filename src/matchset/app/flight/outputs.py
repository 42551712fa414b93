"""Everything that is made of a flight while it is flown, or replayed: `FlightOutputs`."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

import msgspec

from matchset.app.drawing.video_writer import Recorder, codecs_for
from matchset.app.flight.flight import ChainStep, FlightSetup
from matchset.app.flight.live_view import LiveView
from matchset.app.flight.log import FlightLog
from matchset.app.flight_report.picture import FlightPicture
from matchset.app.flight_report.report import check_report, write_report
from matchset.app.recording.mcap_file import check_mcap
from matchset.app.recording.writer import RecordingWriter
from matchset.app.run_folder import output_file
from matchset.links.simulated import FPS


class FlightFiles(msgspec.Struct, frozen=True, kw_only=True):
    """What is wanted of a flight.

    Parameters
    ----------
    video : Path or None
        Every camera side by side and the chain from above: .mp4, .webm or .avi.
    report : Path or None
        Pictures and figures: .html.
    record : Path or None
        A recording to replay: .mcap.
    force : bool
        Whether existing files are overwritten.
    """

    video: Path | None = None
    report: Path | None = None
    record: Path | None = None
    force: bool = False

    def check(self) -> None:
        """Refuse what cannot be made, before anything moves.

        Raises
        ------
        ValueError
            If a name has a wrong ending, a file exists or cannot be written, or a package is missing.
        """
        if self.video is not None:
            codecs_for(self.video)
        if self.report is not None:
            check_report(self.report)
        if self.record is not None:
            check_mcap()
        for path in self.paths:
            output_file(path, self.force)

    @property
    def paths(self) -> list[Path]:
        """The files, the quickest to finish first."""
        return [path for path in (self.record, self.video, self.report) if path is not None]


class FlightOutputs:
    """Shows, films, records and reports ticks; leaving the `with` block finishes every file, however it is left.

    Parameters
    ----------
    setup : FlightSetup
    files : FlightFiles, optional
        `FlightFiles.check` comes before.
    quiet : bool
        Show nothing on the terminal.

    Attributes
    ----------
    log : FlightLog
        All numbers of the flight so far.
    """

    def __init__(self, setup: FlightSetup, files: FlightFiles | None = None, quiet: bool = False) -> None:
        self.log = FlightLog(setup)
        self._files = files or FlightFiles()
        self._closed = False
        parameters = setup.parameters
        self._screen = LiveView(parameters.pilot.place, parameters.duration, quiet)
        self._picture: FlightPicture | None = None
        self._recorder: Recorder | None = None
        self._recording: RecordingWriter | None = None
        with ExitStack() as stack:  # what is open is closed if the next cannot be opened
            if self._files.video is not None:
                self._picture = FlightPicture(setup)
                self._recorder = stack.enter_context(Recorder(self._files.video, FPS, self._picture.size))
            if self._files.record is not None:
                self._recording = stack.enter_context(RecordingWriter(self._files.record, setup))
            stack.enter_context(self._screen)
            self._stack = stack.pop_all()

    def show(self, chain_step: ChainStep, armed: Sequence[bool] | None = None) -> None:
        """Give a tick to everything.

        Parameters
        ----------
        chain_step : ChainStep
        armed : sequence of bool, optional
            Which pilots have been told to fly; all of them by default.
        """
        self.log.add(chain_step)
        self._screen.show(chain_step, self.log.counters)
        if self._recorder is not None and self._picture is not None:
            self._recorder.write(self._picture.draw(chain_step))
        if self._recording is not None:
            self._recording.write(chain_step, [True] * len(chain_step.steps) if armed is None else armed)

    def close(self) -> None:
        """Finish all files, the report last."""
        if self._closed:
            return
        self._closed = True
        try:
            self._stack.close()
        finally:
            if self._files.report is not None:
                write_report(self.log, self._files.report)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
