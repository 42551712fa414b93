"""What a person sees of a flight while it is flown: a live table on a terminal, plain lines elsewhere; on stderr."""

import math
import time
from types import TracebackType
from typing import Self

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from matchset.app.flight.flight import Tick
from matchset.app.flight.pilot import Step
from matchset.app.flight.score import FlightTally, FollowerTally
from matchset.app.flight_report.colors import PHASES, as_hex
from matchset.app.flight_report.step_text import age_words, distance_words, off_place, place_words, state_words
from matchset.control.follower import SetPlace

COLUMNS = ("", "state", "distance", "side, m", "height, m", "heading, m", "off by", "age", "rate", "lost")
EVERY = 5.0  # s of the flight between plain lines


def flight_view(tick: Tick, tally: FlightTally, place: SetPlace, duration: float, speed: float | None) -> Group:
    """Make the live view of a moment: a line on the whole flight, and a row per follower.

    Parameters
    ----------
    tick : Tick
    tally : FlightTally
        Of all ticks up to this one.
    place : SetPlace
        Where the followers are to be.
    duration : float
        Of the whole flight, s.
    speed : float or None
        Seconds of flight per second; None if not known yet.
    """
    table = Table(box=None, pad_edge=False, header_style="dim")
    for number, name in enumerate(COLUMNS):
        table.add_column(name, justify="left" if number < 2 else "right", no_wrap=True)
    for number, (step, figures) in enumerate(zip(tick.steps, tally.followers, strict=True), 1):
        table.add_row(*_cells(number, step, figures, place))
    reasons = [
        Text(f"{number} {state_words(step)}", style=_style(step), no_wrap=True, overflow="ellipsis")
        for number, step in enumerate(tick.steps, 1)
        if step.memory.phase != "flying"
    ]
    return Group(_head(tick, duration, speed), table, *reasons)


def plain_line(tick: Tick, tally: FlightTally) -> str:
    """Say a moment in one line: ``  5.0 s   1: flying, 1.51 m, side +0.01 ... m, 67 ms old, lost 0   2: ...``."""
    parts = []
    for number, (step, figures) in enumerate(zip(tick.steps, tally.followers, strict=True), 1):
        words = " ".join(place_words(step.answer).split())
        parts.append(
            f"{number}: {state_words(step)}, {distance_words(step)}, {words}, {age_words(step.age)} old, "
            f"lost {figures.lost}"
        )
    return f"{tick.time:6.1f} s   " + "   ".join(parts)


class FlightScreen:
    """Shows a flight on a terminal, redrawn 10 times a second; elsewhere it prints a plain line now and then.

    Parameters
    ----------
    place : SetPlace
    duration : float
        Of the whole flight, s.
    quiet : bool
        Show nothing.
    console : Console, optional
        Stderr by default.
    """

    def __init__(self, place: SetPlace, duration: float, quiet: bool = False, console: Console | None = None) -> None:
        self._console = console or Console(stderr=True, highlight=False)
        self._place, self._duration, self._quiet = place, duration, quiet
        self._live = Live(console=self._console, refresh_per_second=10, transient=True)
        self._shown = self._console.is_terminal and not quiet
        self._begun: tuple[float, float] | None = None
        self._told, self._crashes = -math.inf, 0

    def show(self, tick: Tick, tally: FlightTally) -> None:
        """Show a tick that the tally has counted."""
        for crash in tick.crashes[self._crashes :]:
            self._say(f"{crash.time:6.1f} s   vehicle {crash.vehicle} {crash.what}")
        self._crashes = len(tick.crashes)
        if self._shown:
            speed = self._speed(tick)
            self._live.update(flight_view(tick, tally, self._place, self._duration, speed))
        elif tick.time - self._told >= EVERY:
            self._told = tick.time
            self._say(plain_line(tick, tally))

    def _say(self, words: str) -> None:
        if not self._quiet:
            self._console.print(words, soft_wrap=True, markup=False)

    def _speed(self, tick: Tick) -> float | None:
        """Seconds of flight per second since the first tick."""
        now = time.monotonic()
        if self._begun is None:
            self._begun = now, tick.time
        passed = now - self._begun[0]
        return (tick.time - self._begun[1]) / passed if passed > 0.5 else None

    def __enter__(self) -> Self:
        if self._shown:
            self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            self._live.__exit__(kind, error, trace)


def _head(tick: Tick, duration: float, speed: float | None) -> Text:
    line = Text(f"{tick.time:.1f} of {duration:g} s", style="bold", no_wrap=True, overflow="ellipsis")
    if speed is not None:
        line.append(f"   {speed:.2g} times as fast as real time", style="dim not bold")
    for crash in tick.crashes:
        line.append(f"   {crash.vehicle} {crash.what}", style="bold red")
    return line


def _cells(number: int, step: Step, figures: FollowerTally, place: SetPlace) -> tuple[Text | str, ...]:
    """One follower's row."""
    answer, off = step.answer, off_place(step.answer, place)
    there = ("-",) * 3 if answer is None else (f"{v:+z.2f}" for v in (answer.side, answer.height, answer.heading))
    return (
        f"{number} \u2192 {number + 1}",
        Text(step.memory.phase, style=_style(step)),
        distance_words(step),
        *there,
        "-" if off is None else f"{100.0 * off:.0f} cm",
        age_words(step.age),
        "-" if figures.rate is None else f"{figures.rate:.1f}/s",
        str(figures.lost + figures.missing),
    )


def _style(step: Step) -> str:
    return as_hex(PHASES[step.memory.phase])
