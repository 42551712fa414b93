"""What a person sees while a video is tracked: a bar for files, a live line for cameras; on stderr."""

import time
from types import TracebackType
from typing import Protocol, Self

from rich.console import Console
from rich.live import Live
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from matchset.image.video import Video

_SMOOTHING = 0.05


class Told(Protocol):
    """What a screen needs to know of a frame: a row of any table."""

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


class Screen(Protocol):
    """Something that is told of each frame."""

    def show(self, row: Told) -> None:
        """Take note of a frame's row."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


class Rate:
    """Frames per second of the last moments."""

    def __init__(self) -> None:
        self._last: float | None = None
        self._period: float | None = None

    def tick(self, now: float) -> float | None:
        """Count a frame at the time `now`, s; return the rate, None at first."""
        if self._last is not None:
            step = now - self._last
            old = self._period
            self._period = step if old is None else old + _SMOOTHING * (step - old)
        self._last = now
        return 1.0 / self._period if self._period else None


def live_line(row: Told, rate: float | None, age: float, dropped: int) -> Text:
    """Say a live frame in one line.

    Parameters
    ----------
    row : Told
        The answer.
    rate : float or None
        Frames per second.
    age : float
        Time since the frame was captured, s.
    dropped : int
        Frames that were skipped so far because newer ones had come.
    """
    line = Text(no_wrap=True, overflow="ellipsis")
    speed = "    -" if rate is None else f"{rate:5.1f}"
    line.append(f"{speed} frames/s   age {1000.0 * age:4.0f} ms   dropped {dropped:<4d}   ", style="dim")
    if row.found:
        line.append(row.brief, style="bold")
    else:
        line.append(f"Lost: {row.reason}", style="yellow")
    return line


class LiveLine:
    """The live line of a camera."""

    def __init__(self, video: Video, console: Console) -> None:
        self._video, self._rate = video, Rate()
        self._live = Live(console=console, refresh_per_second=15, transient=True)

    def show(self, row: Told) -> None:
        """Show a frame's row."""
        now = time.monotonic()
        self._live.update(live_line(row, self._rate.tick(now), now - row.time, self._video.dropped))

    def __enter__(self) -> Self:
        self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.__exit__(kind, error, trace)


class _Speed(ProgressColumn):
    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:.0f} frames/s", style="cyan")


class Bar:
    """The progress bar of a file."""

    def __init__(self, words: str, length: int | None, console: Console, visible: bool) -> None:
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), _Speed())
        self._progress = Progress(*columns, console=console, disable=not visible, transient=True)
        self._task = self._progress.add_task(words, total=length)

    def show(self, row: Told) -> None:  # noqa: ARG002 - counted, not looked at
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


class Hint:
    """One line that tells a person before a camera what to do next; on a terminal only, and not if `quiet`."""

    def __init__(self, quiet: bool = False) -> None:
        console = Console(stderr=True, highlight=False)
        self._shown = console.is_terminal and not quiet
        self._live = Live(console=console, refresh_per_second=8, transient=True)

    def say(self, words: str) -> None:
        """Show these words in place of those before."""
        if self._shown:
            self._live.update(Text(words, no_wrap=True, overflow="ellipsis"))

    def __enter__(self) -> Self:
        if self._shown:
            self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            self._live.__exit__(kind, error, trace)


def counting(words: str, length: int | None) -> Bar:
    """Make a progress bar, shown only on a terminal."""
    console = Console(stderr=True, highlight=False)
    return Bar(words, length, console, console.is_terminal)


def screen_for(video: Video, quiet: bool, words: str = "tracking") -> Screen:
    """Choose what to show for a video: nothing if `quiet` or if stderr is no terminal."""
    console = Console(stderr=True, highlight=False)
    if video.live and console.is_terminal and not quiet:
        return LiveLine(video, console)
    visible = console.is_terminal and not quiet and not video.live
    return Bar(words, video.length, console, visible)
