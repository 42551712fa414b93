"""What shows and writes a flight while it is flown or replayed: view, video, recording, report: `FlightOutputs`."""

import functools
import shutil
import sys
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import NamedTuple

import msgspec

from matchset.app.disk import MB, size_text
from matchset.app.films.video_writer import FilmWriter, FilmWriterParameters
from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.chain.score import FlightCounters
from matchset.flight.fly.live_view import LiveView
from matchset.flight.fly.log import FlightLog
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.real_time.background import Background, BackgroundParameters
from matchset.flight.recording.writer import RecordingWriter
from matchset.flight.report.picture import FlightPicture
from matchset.flight.report.report import write_report
from matchset.media.closing import Closing, close_all

Item = tuple[ChainStep, Sequence[bool]]
"""A step, and which pilots had been told to fly."""
Work = Callable[[Item], None]
Say = Callable[[str], None]


class OutputParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much of a flight may wait to be shown and written.

    Parameters
    ----------
    pictures : int
        Pictures that wait to be recorded at most, of all followers together, but at least `least` steps. More outlast a
        longer pause of the disk; each takes 1 MB. Chosen by hand: two seconds of two followers.
    least : int
        Steps that wait for the recording at least, and for the video. Chosen by hand.
    film_rate : float
        What the video is said to take at the start, MB for a second of the flight. Chosen by: 5 MB for 20 s of two
        followers, packed by PyAV or `ffmpeg`; OpenCV alone takes 0.8.
    """

    pictures: int = 128
    least: int = 8
    film_rate: float = 0.25


class _Shown(NamedTuple):
    """A step as the view needs it: the counters go on meanwhile."""

    chain_step: ChainStep
    counters: FlightCounters


class FlightOutputs(Closing):
    """Gives each step of a flight to the view, the video, the recording and the report, each in a thread of its own.

    None of them ends a flight: one that fails stops, with a line that says so, and its error is raised by `close`.
    Leaving the `with` block finishes every file, also after an error.

    Parameters
    ----------
    setup : FlightSetup
    files : FlightFiles, optional
        `FlightFiles.check` comes before.
    quiet : bool
        Show nothing on the terminal.
    real_time : bool
        Whether somebody flies meanwhile: then `add` never waits, and what there is no room for is dropped and counted.

    Attributes
    ----------
    log : FlightLog
        All numbers of the flight so far.
    say : callable
        Shows a line.
    """

    def __init__(
        self, setup: FlightSetup, files: FlightFiles | None = None, quiet: bool = False, real_time: bool = False
    ) -> None:
        self.log = FlightLog(setup)
        self._files = files or FlightFiles()
        self._closed = False
        self._messages: deque[str] = deque()
        parameters, limits = setup.parameters, OutputParameters()
        length = setup.countdown + parameters.duration
        self._view = LiveView(parameters.pilot.place, length, quiet, kind=setup.kind)
        self.say = self._messages.append
        self._writers: list[Background[Item]] = []
        recorder = FilmWriterParameters(space=self._files.space, small=True)
        opened: list[Closing] = []
        with ExitStack() as stack:  # what is open is closed if the next cannot be opened
            if self._files.video is not None:
                picture = FlightPicture(setup)
                video = stack.enter_context(FilmWriter(self._files.video, setup.fps, picture.size, parameters=recorder))
                opened.append(video)
                draw = _telling("the video", video, lambda item: video.write(picture.draw(item[0])), self.say)
                self._writers.append(stack.enter_context(self._writer("the video", draw, limits.least, real_time)))
            if self._files.record is not None:
                recording = stack.enter_context(
                    RecordingWriter(self._files.record, setup, self._files.space, self._files.jpeg)
                )
                opened.append(recording)
                if not quiet:
                    print(f"note: {recording.note}", file=sys.stderr)
                room = max(limits.pictures // setup.followers, limits.least)
                write = _telling("the recording", recording, lambda item: recording.write(*item), self.say)
                self._writers.append(stack.enter_context(self._writer("the recording", write, room, real_time)))
            if opened and not quiet:
                print(f"note: {self._size_note(opened, length)}", file=sys.stderr)
            stack.enter_context(self._view)
            newest = BackgroundParameters(waiting=2, drops=real_time)
            self._screen = stack.enter_context(Background("the screen", self._show, newest))
            stack.pop_all()
        close_view = functools.partial(self._view.__exit__, None, None, None)
        in_order: list[Closing] = [*self._writers, *opened]
        self._closes: list[Callable[[], None]] = [self._screen.close, close_view, *(each.close for each in in_order)]

    @property
    def notes(self) -> list[str]:
        """What is missing in the files, in words."""
        return [each.note for each in self._writers if each.note]

    def add(self, chain_step: ChainStep, armed: Sequence[bool] | None = None) -> None:
        """Add a step of the flight to all outputs.

        Parameters
        ----------
        chain_step : ChainStep
        armed : sequence of bool, optional
            Which pilots have been told to fly; all of them by default.
        """
        self.log.add(chain_step)
        told = [True] * len(chain_step.steps) if armed is None else armed
        for writer in self._writers:
            writer.add((chain_step, told))
        self._screen.add(_Shown(chain_step, self.log.counters.copy()))

    def close(self) -> None:
        """Finish all files, the report last.

        Raises
        ------
        OSError, ValueError
            If one of them could not be written.
        """
        if self._closed:
            return
        self._closed = True
        closes = [*self._closes, self._say_messages]
        if self._files.report is not None:
            closes.append(functools.partial(write_report, self.log, self._files.report))
        close_all(*closes)

    def _size_note(self, opened: Sequence[Closing], duration: float) -> str:
        """Say what film and recording will take, and what the disk has."""
        films = sum(isinstance(each, FilmWriter) for each in opened) * OutputParameters().film_rate * MB
        rate = films + sum(each.rate for each in opened if isinstance(each, RecordingWriter))
        path = next(path for path in (self._files.record, self._files.video) if path is not None)
        free = shutil.disk_usage(path.absolute().parent).free
        words = f"{duration:g} s of flight take about {size_text(rate * duration)} of disk, {size_text(free)} are free"
        return words if rate * duration < free else f"{words}: they will end early"

    def _writer(self, name: str, work: Work, room: int, real_time: bool) -> Background[Item]:
        return Background(name, work, BackgroundParameters(waiting=room, drops=real_time), self.say)

    def _show(self, shown: _Shown) -> None:
        self._say_messages()
        self._view.show(shown.chain_step, shown.counters)

    def _say_messages(self) -> None:
        while self._messages:
            self._view.say(self._messages.popleft())


def _telling(name: str, writer: FilmWriter | RecordingWriter, work: Callable[[Item], None], say: Say) -> Work:
    """Make a function that does the work, and says once that the writer has stopped, as at a full disk."""
    told = False

    def do(item: Item) -> None:
        nonlocal told
        work(item)
        if writer.failure is not None and not told:
            told = True
            say(f"{name} stopped: {writer.failure}")

    return do
