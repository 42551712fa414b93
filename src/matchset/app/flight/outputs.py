"""What shows and writes a flight while it is flown or replayed: view, video, recording, report: `FlightOutputs`."""

import functools
from collections.abc import Callable, Sequence
from contextlib import ExitStack

from matchset.app.closing import Closing, close_all
from matchset.app.drawing.video_writer import Recorder
from matchset.app.flight.flight import ChainStep, FlightSetup
from matchset.app.flight.live_view import LiveView
from matchset.app.flight.log import FlightLog
from matchset.app.flight.output_files import FlightFiles
from matchset.app.flight_report.picture import FlightPicture
from matchset.app.flight_report.report import write_report
from matchset.app.recording.writer import RecordingWriter
from matchset.links.simulated import FPS


class FlightOutputs(Closing):
    """Gives each step of a flight to the view, the video, the recording and the report.

    Leaving the `with` block finishes every file, also after an error.

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
        self._view = LiveView(parameters.pilot.place, parameters.duration, quiet)
        self._picture: FlightPicture | None = None
        self._video: Recorder | None = None
        self._recording: RecordingWriter | None = None
        with ExitStack() as stack:  # what is open is closed if the next cannot be opened
            if self._files.video is not None:
                self._picture = FlightPicture(setup)
                self._video = stack.enter_context(Recorder(self._files.video, FPS, self._picture.size))
            if self._files.record is not None:
                self._recording = stack.enter_context(RecordingWriter(self._files.record, setup))
            stack.enter_context(self._view)
            stack.pop_all()

    def add(self, chain_step: ChainStep, armed: Sequence[bool] | None = None) -> None:
        """Add a step of the flight to all outputs.

        Parameters
        ----------
        chain_step : ChainStep
        armed : sequence of bool, optional
            Which pilots have been told to fly; all of them by default.
        """
        self.log.add(chain_step)
        self._view.show(chain_step, self.log.counters)
        if self._video is not None and self._picture is not None:
            self._video.write(self._picture.draw(chain_step))
        if self._recording is not None:
            self._recording.write(chain_step, [True] * len(chain_step.steps) if armed is None else armed)

    def close(self) -> None:
        """Finish all files, the report last."""
        if self._closed:
            return
        self._closed = True
        closes: list[Callable[[], None]] = [each.close for each in (self._recording, self._video) if each is not None]
        if self._files.report is not None:
            closes.append(functools.partial(write_report, self.log, self._files.report))
        close_all(functools.partial(self._view.__exit__, None, None, None), *closes)
