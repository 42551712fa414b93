"""A flight on the screen while it is flown: a live table on a terminal, lines of text elsewhere; both on stderr."""

import math
import time
from collections.abc import Sequence

import msgspec
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderResult
from rich.table import Table
from rich.text import Text

from matchset.app.progress import RedrawnDisplay, duration_text
from matchset.control.follower import RelativeSetpoint
from matchset.flight.chain.chain_step import ChainStep, FlightKind
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.chain.score import FlightCounters, FollowerCounters
from matchset.flight.report.colors import PHASE_COLORS, as_hex
from matchset.flight.report.step_text import (
    age_text,
    distance_text,
    distance_to_set_place,
    position_text,
    reason_text,
    state_text,
    unsent_text,
)


class ViewColumn(msgspec.Struct, frozen=True):
    """A column of the live table.

    Parameters
    ----------
    name : str
    width : int
        Least width, cells: what it holds most of the time, so that columns do not come and go with every number.
    keep : int
        The lower, the sooner it is left out where the terminal is too narrow; columns of one `keep` go together.
    """

    name: str
    width: int
    keep: int


COLUMNS = (
    ViewColumn("", 5, 9),
    ViewColumn("state", 10, 8),
    ViewColumn("distance", 8, 7),
    ViewColumn("side, m", 7, 2),
    ViewColumn("height, m", 9, 2),
    ViewColumn("heading, m", 10, 2),
    ViewColumn("off by", 6, 6),
    ViewColumn("age", 6, 3),
    ViewColumn("rate", 6, 1),
    ViewColumn("lost", 4, 5),
)  # format: of the live table; a number that is cut would be a wrong number
REFRESHES = 10  # format: of the live table, a second
SPEED_AFTER = 0.5  # format: s after which the speed of the simulation is shown
LINE_PERIOD = 5.0  # format: s of the flight between two lines of text


def render_view(
    chain_step: ChainStep, counters: FlightCounters, place: RelativeSetpoint, duration: float, speed: float | None
) -> Group:
    """Make the live view of a step: a line about the whole flight, and a row per follower.

    Parameters
    ----------
    chain_step : ChainStep
    counters : FlightCounters
        Of all steps up to this one.
    place : RelativeSetpoint
        The set place of every follower.
    duration : float
        Length of the whole flight, s.
    speed : float or None
        Seconds of the flight per second of computing; None if not known yet.
    """
    rows = [
        _cells(number, step, each, place)
        for number, (step, each) in enumerate(zip(chain_step.steps, counters.followers, strict=True), 1)
    ]
    reasons = [
        Text(f"{number} {state_text(step)}", style=_style(step))
        for number, step in enumerate(chain_step.steps, 1)
        if step.safety.phase != "flying" or reason_text(step)
    ]
    return Group(_head(chain_step, duration, speed), FittingTable(rows), *reasons)


class FittingTable:
    """A table with as many of `COLUMNS` as the terminal has room for: whole ones, the most important."""

    def __init__(self, rows: Sequence[Sequence[Text]]) -> None:
        self._rows = rows

    def columns(self, width: int) -> list[int]:
        """Return the numbers of the columns that fit into a width in cells."""
        widths = [
            max(column.width, cell_len(column.name), *(row[number].cell_len for row in self._rows))
            for number, column in enumerate(COLUMNS)
        ]
        for least in sorted({column.keep for column in COLUMNS}):
            kept = [number for number, column in enumerate(COLUMNS) if column.keep >= least]
            if sum(widths[number] + 1 for number in kept) - 1 <= width:
                break
        return kept

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="dim")
        kept = self.columns(options.max_width)
        for number in kept:
            name, width = COLUMNS[number].name, COLUMNS[number].width
            table.add_column(name, justify="left" if number < 2 else "right", no_wrap=True, min_width=width)
        for row in self._rows:
            table.add_row(*(row[number] for number in kept))
        yield table


def text_line(chain_step: ChainStep, counters: FlightCounters, dry: bool = False) -> str:
    """Write a step in one line: ``  5.0 s   1: flying, 1.51 m, side +0.01 ... m, 67 ms old, lost 0   2: ...``.

    In a dry run with what would have been sent.
    """
    parts = []
    for number, (step, each) in enumerate(zip(chain_step.steps, counters.followers, strict=True), 1):
        position = " ".join(position_text(step.control).split())
        parts.append(
            f"{number}: {state_text(step)}, {distance_text(step)}, {position}, {age_text(step.age)} old, "
            f"lost {each.lost}" + (f", {unsent_text(step)}" if dry else "")
        )
    return f"{chain_step.time:6.1f} s   " + "   ".join(parts)


class LiveView(RedrawnDisplay):
    """Shows a flight: on a terminal a live table, elsewhere a line of text every 5 s of the flight.

    Parameters
    ----------
    place : RelativeSetpoint
    duration : float
        Length of the whole flight, s.
    quiet : bool
        Show nothing.
    kind : FlightKind
        A dry run shows what would have been sent, a simulated flight how fast it is.
    console : Console, optional
        Stderr by default.
    """

    def __init__(
        self,
        place: RelativeSetpoint,
        duration: float,
        quiet: bool = False,
        console: Console | None = None,
        kind: FlightKind = "simulated",
    ) -> None:
        self._console = console or Console(stderr=True, highlight=False)
        super().__init__(self._console, REFRESHES, quiet)
        self._place, self._duration, self._quiet, self._kind = place, duration, quiet, kind
        self._dry = kind == "dry run"
        self._start: tuple[float, float] | None = None
        self._line_time, self._crashes, self._said_left = -math.inf, 0, False

    def show(self, chain_step: ChainStep, counters: FlightCounters) -> None:
        """Show a step that the counters have counted."""
        for crash in chain_step.crashes[self._crashes :]:
            self._print(f"{crash.time:6.1f} s   vehicle {crash.vehicle} {crash.what}")
        self._crashes = len(chain_step.crashes)
        if self.visible:
            speed = self._speed(chain_step)
            view = render_view(chain_step, counters, self._place, self._duration, speed)
            steps = enumerate(chain_step.steps if self._dry else (), 1)
            self.redraw(Group(view, *(f"{number} {unsent_text(step)}" for number, step in steps)))
        elif chain_step.time - self._line_time >= LINE_PERIOD:
            self._line_time = chain_step.time
            self._print(text_line(chain_step, counters, self._dry))
            speed = self._speed(chain_step)
            if speed is not None and not self._said_left:
                self._said_left = True
                self._print(f"about {duration_text((self._duration - chain_step.time) / max(speed, 1e-3))} left")

    def say(self, text: str) -> None:
        """Print a line above the table."""
        self._print(text)

    def _print(self, text: str) -> None:
        if not self._quiet:
            self._console.print(text, soft_wrap=True, markup=False)

    def _speed(self, chain_step: ChainStep) -> float | None:
        """Seconds of the flight per second of computing, since the first step; None at first."""
        now = time.monotonic()
        if self._start is None:
            self._start = now, chain_step.time
        passed = now - self._start[0]
        known = passed > SPEED_AFTER and self._kind == "simulated"
        return (chain_step.time - self._start[1]) / passed if known else None


def _head(chain_step: ChainStep, duration: float, speed: float | None) -> Text:
    line = Text(f"{chain_step.time:.1f} of {duration:g} s", style="bold")
    if speed is not None:
        left = duration_text(max(duration - chain_step.time, 0.0) / max(speed, 1e-3))
        line.append(f"   {speed:.2g} times as fast as real time, {left} left", style="dim not bold")
    for crash in chain_step.crashes:
        line.append(f"   {crash.vehicle} {crash.what}", style="bold red")
    return line


def _cells(number: int, step: PilotStep, counters: FollowerCounters, place: RelativeSetpoint) -> list[Text]:
    """One follower's row."""
    control, error = step.control, distance_to_set_place(step.control, place)
    position = (
        ("-",) * 3 if control is None else (f"{v:+z.2f}" for v in (control.side, control.height, control.heading))
    )
    words = (
        distance_text(step),
        *position,
        "-" if error is None else f"{100.0 * error:.0f} cm",
        age_text(step.age),
        "-" if counters.rate is None else f"{counters.rate:.1f}/s",
        str(counters.lost + counters.missing),
    )
    state = Text(step.safety.phase, style=_style(step))
    return [Text(f"{number} \u2192 {number + 1}"), state, *map(Text, words)]


def _style(step: PilotStep) -> str:
    return as_hex(PHASE_COLORS[step.safety.phase])
