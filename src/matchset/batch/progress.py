"""What a batch shows on stderr: how many are done, the rate, the time left, the slowest (`BatchDisplay`)."""

import time
from pathlib import Path
from types import TracebackType
from typing import Self

import msgspec
from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from matchset.app.progress import duration_text
from matchset.batch.jobs.job import State, VideoOutcome
from matchset.batch.workers.pool import Pool


class DisplayParameters(msgspec.Struct, frozen=True):
    """How often and how much is shown.

    Parameters
    ----------
    period : float
        s between two lines where stderr is no terminal. Less: longer logs.
    slowest : int
        How many of the videos that take longest are named.
    """

    period: float = 10.0
    slowest: int = 3


PARAMETERS = DisplayParameters()


class BatchCounts:
    """How many videos have ended, and how.

    Parameters
    ----------
    total : int

    Attributes
    ----------
    states : dict of str to int
    earlier : int
        Finished before this run.
    """

    def __init__(self, total: int) -> None:
        self.total, self.earlier, self._begun = total, 0, time.monotonic()
        self.states: dict[State, int] = {}

    def count(self, outcome: VideoOutcome) -> None:
        """Count what became of a video."""
        self.states[outcome.state] = self.states.get(outcome.state, 0) + 1

    @property
    def ended(self) -> int:
        """Videos that have ended in this run."""
        return sum(self.states.values())

    @property
    def words(self) -> str:
        """How many are done, in words, with rate and time left."""
        seconds = max(time.monotonic() - self._begun, 1e-9)
        rate, left = self.ended / seconds, self.total - self.earlier - self.ended
        parts = [f"{self.earlier + self.ended} of {self.total} videos"]
        parts += [f"{count} {state}" for state, count in sorted(self.states.items()) if state != "found" and count]
        if self.ended and left > 0:
            parts += [f"{rate_text(rate)}", f"{duration_text(left / rate)} left"]
        return ", ".join(parts)


def rate_text(rate: float) -> str:
    """Write a rate, 1/s, as people do."""
    return f"{rate:.1f} a second" if rate >= 1.0 else f"{60.0 * rate:.1f} a minute"


class BatchDisplay:
    """Shows the progress of a batch.

    Parameters
    ----------
    counts : BatchCounts
    console : rich.console.Console, optional
    """

    def __init__(self, counts: BatchCounts, console: Console | None = None) -> None:
        self._counts, self._console = counts, console or Console(stderr=True, highlight=False)
        self._live = Live(console=self._console, transient=True, refresh_per_second=4)
        self._said = time.monotonic()

    def show(self, pool: Pool) -> None:
        """Show how far it is, and what the pool has to say."""
        for note in pool.notes:
            self._console.print(f"note: {note}", markup=False, soft_wrap=True)
        pool.notes.clear()
        if self._console.is_terminal:
            self._live.update(self._lines(pool.running))
        elif time.monotonic() - self._said >= PARAMETERS.period:
            self._said = time.monotonic()
            self._console.print(self._counts.words, markup=False, soft_wrap=True)

    def _lines(self, running: dict[str, float]) -> Group:
        counts, now = self._counts, time.monotonic()
        bar = ProgressBar(counts.total, counts.earlier + counts.ended, width=40)
        line = Table.grid(padding=(0, 1))
        line.add_row(bar, Text(counts.words))
        slowest = sorted(running.items(), key=lambda pair: pair[1])[: PARAMETERS.slowest]
        return Group(line, *(Text(f"  {duration_text(now - begun):>6}  {Path(name).name}") for name, begun in slowest))

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.stop()
