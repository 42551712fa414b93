"""What a command shows on stderr while it runs: progress bar (file), status line (camera), a note if it is slow."""

import contextlib
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from types import TracebackType
from typing import Protocol, Self

import msgspec
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from matchset.app.timing.durations import Durations
from matchset.media.video import Video


class ProgressParameters(msgspec.Struct, frozen=True):
    """When and how fast the display reacts.

    Parameters
    ----------
    smoothing : float
        Weight of the newest frame period in the shown frame rate, 0 ... 1: smaller is steadier and slower. Chosen by
        hand; no result depends on it.
    slow_after : float
        Time after which `announce_if_slow` prints, s: a shorter wait needs no explanation. Chosen by hand; no result
        depends on it.
    """

    smoothing: float = 0.05
    slow_after: float = 0.7


PARAMETERS = ProgressParameters()


class DisplayedRow(Protocol):
    """What the display needs to know of a frame: a row of any table."""

    @property
    def time(self) -> float:
        """When it was taken, s."""
        ...

    @property
    def found(self) -> bool:
        """Whether there is an answer."""
        ...

    @property
    def brief(self) -> str:
        """The answer in a few words."""
        ...

    @property
    def reason(self) -> str:
        """Why there is none."""
        ...


def duration_text(seconds: float) -> str:
    """Write a time that is estimated: ``40 s``, ``4 min``, ``2.5 h``."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.2g} h"


class Display(Protocol):
    """What shows the progress of a video, frame by frame."""

    def show(self, row: DisplayedRow) -> None:
        """Show the row of the newest frame."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


class FrameRate:
    """Frames per second, smoothed exponentially."""

    def __init__(self) -> None:
        self._last: float | None = None
        self._period: float | None = None

    def update(self, now: float) -> float | None:
        """Count a frame at the time `now`, s; return the rate, None after the first frame."""
        if self._last is not None:
            period = now - self._last
            old = self._period
            self._period = period if old is None else old + PARAMETERS.smoothing * (period - old)
        self._last = now
        return 1.0 / self._period if self._period else None


def live_line(row: DisplayedRow, rate: float | None, age: float, dropped: int) -> Text:
    """Format the status line of a live frame.

    Parameters
    ----------
    row : DisplayedRow
        The answer.
    rate : float or None
        Frames per second.
    age : float
        Time since the frame was captured, s.
    dropped : int
        Frames that were skipped so far because a newer one was there.
    """
    line = Text(no_wrap=True, overflow="ellipsis")
    speed = "    -" if rate is None else f"{rate:5.1f}"
    line.append(f"{speed} frames/s   age {1000.0 * age:4.0f} ms   dropped {dropped:<4d}   ", style="dim")
    if row.found:
        line.append(row.brief, style="bold")
    else:
        line.append(f"Lost: {row.reason}", style="yellow")
    return line


class ComputingLine:
    """A second line below what is shown: what the frames took so far; made anew whenever it is drawn."""

    def __init__(self, durations: Durations) -> None:
        self._durations = durations

    def __rich__(self) -> Text:
        times = self._durations.times()
        words = "" if times is None else f"computing a frame: {times.words}"
        return Text(words, style="dim", no_wrap=True, overflow="ellipsis")


class RedrawnDisplay:
    """What is redrawn in place until its `with` block ends, on a terminal only.

    Parameters
    ----------
    console : Console
        Where.
    refreshes : int
        How often it is redrawn at most, per second.
    quiet : bool
        Show nothing.

    Attributes
    ----------
    visible : bool
        Whether anything is shown.
    """

    def __init__(self, console: Console, refreshes: int, quiet: bool = False) -> None:
        self.visible = console.is_terminal and not quiet
        self._live = Live(console=console, refresh_per_second=refreshes, transient=True)

    def redraw(self, content: RenderableType) -> None:
        """Show this in place of what was shown before."""
        if self.visible:
            self._live.update(content)

    def __enter__(self) -> Self:
        if self.visible:
            self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.visible:
            self._live.__exit__(kind, error, trace)


class LiveLine(RedrawnDisplay):
    """The status line of a camera, rewritten with every frame, and what the frames took."""

    def __init__(self, video: Video, console: Console, durations: Durations) -> None:
        super().__init__(console, 15)
        self._video, self._rate, self._computing = video, FrameRate(), ComputingLine(durations)

    def show(self, row: DisplayedRow) -> None:
        """Show a frame's row."""
        now = time.monotonic()
        line = live_line(row, self._rate.update(now), now - row.time, self._video.dropped)
        self.redraw(Group(line, self._computing))


class _SpeedColumn(ProgressColumn):
    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:.0f} frames/s", style="cyan")


class _TimedProgress(Progress):
    """A progress bar, and below it what the frames took."""

    below: ComputingLine | None = None

    def get_renderables(self) -> Iterable[RenderableType]:
        yield from super().get_renderables()
        if self.below is not None:
            yield self.below


class FrameBar:
    """The progress bar of a video file, and what the frames took if somebody counts that."""

    def __init__(
        self, words: str, length: int | None, console: Console, visible: bool, durations: Durations | None = None
    ) -> None:
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), _SpeedColumn())
        self._progress = _TimedProgress(*columns, console=console, disable=not visible, transient=True)
        self._progress.below = None if durations is None else ComputingLine(durations)
        self._task = self._progress.add_task(words, total=length)

    def show(self, row: DisplayedRow) -> None:  # noqa: ARG002 - counted, not looked at
        """Count a frame."""
        self.advance()

    def advance(self) -> None:
        """Count a frame."""
        self._progress.advance(self._task)

    def __enter__(self) -> Self:
        self._progress.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.__exit__(kind, error, trace)


class InstructionLine(RedrawnDisplay):
    """One line that tells a person in front of a camera what to do next; on a terminal only, and not if `quiet`."""

    def __init__(self, quiet: bool = False) -> None:
        super().__init__(Console(stderr=True, highlight=False), 8, quiet)

    def show(self, words: str) -> None:
        """Replace the line."""
        self.redraw(Text(words, no_wrap=True, overflow="ellipsis"))


def progress_bar(words: str, length: int | None, durations: Durations | None = None) -> FrameBar:
    """Make a progress bar for `length` frames (None: unknown), and what they took; shown on a terminal only."""
    console = Console(stderr=True, highlight=False)
    return FrameBar(words, length, console, console.is_terminal, durations)


def display_for(video: Video, quiet: bool, durations: Durations, words: str = "tracking") -> Display:
    """Choose the display of a video and of what its frames take: nothing if `quiet` or if stderr is no terminal."""
    console = Console(stderr=True, highlight=False)
    if video.live and console.is_terminal and not quiet:
        return LiveLine(video, console, durations)
    visible = console.is_terminal and not quiet and not video.live
    return FrameBar(words, video.length, console, visible, durations)


@contextlib.contextmanager
def announce_if_slow(words: str, after: float = PARAMETERS.slow_after) -> Iterator[None]:
    """Print a note on stderr if the block takes long.

    Parameters
    ----------
    words : str
        What the user waits for.
    after : float
        Time before the note is printed, s.
    """
    timer = threading.Timer(after, lambda: print(words, file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
