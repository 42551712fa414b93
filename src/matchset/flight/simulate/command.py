"""`matchset simulate`: many flights under changed conditions, a table, a picture, and a last line with the verdict.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

import contextlib
import math
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from matchset.app.cli_options import Folder, Force
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.flight.fly.options import Config, Duration, Latency, Pal, Vehicles
from matchset.flight.fly.output_files import Quiet

if TYPE_CHECKING:
    from matchset.flight.chain.flight_parameters import FlightParameters
    from matchset.flight.simulate.table import Flown, RowLimits, SweepRow
    from matchset.flight.simulate.variation import Axis, FlightCase

SIMULATE_EPILOG = """
[bold]Examples[/bold]

  matchset simulate

  matchset simulate --vary thrust=0.8..1.2,latency_ms=33..200,gust_m_s=0..0.5 --quick --seeds 50

  matchset simulate --vary mass=0.8..1.2,yaw_trim_deg_s=-10..10 --grid 5 --quick --fly-at-least 0.95

  matchset simulate --sweep hidden=0.5,1.0 --seeds 20 --pal bad

  matchset simulate --print-names

--vary changes the simulated side alone: nobody who flies is told. A latency that is swept is told by the time stamps. \
The last line is the verdict. Latency is from the middle of a picture's exposure to the command leaving the laptop; \
the radio's delay comes on top.

Exit codes: 0 the limits hold in every row, 1 they do not, 2 bad input or options, 130 stopped by Ctrl-C.
"""

World = Annotated[str, typer.Option("--world", help="What is simulated: chain.")]
Sweep = Annotated[str | None, typer.Option(metavar="NAME=VALUES", help="What to change, and to which values.")]
Vary = Annotated[
    str | None, typer.Option(metavar="NAME=LOW..HIGH,...", help="What differs, untold; drawn at random, all at once.")
]
Grid = Annotated[int, typer.Option(min=0, max=101, help="With --vary: each alone at so many values, too.")]
Seeds = Annotated[int, typer.Option(min=1, max=10_000, help="Flights at each value.")]
FirstSeed = Annotated[int, typer.Option(min=0, help="The first of their seeds.")]
Survival = Annotated[
    float, typer.Option("--survival", "--fly-at-least", help="Limit: least share of flights that survive.")
]
InView = Annotated[
    float | None, typer.Option(help="Limit: least share of pictures with the ball in view; 0.99, none with --vary.")
]
Spread = Annotated[
    float | None, typer.Option(metavar="M", help="Limit: largest rms off the set place, m; 0.1, none with --vary.")
]
PrintNames = Annotated[bool, typer.Option("--print-names", help="Print what can be varied, and do not fly.")]
Quick = Annotated[bool, typer.Option("--quick", help="Without pictures: outlines from the truth, with noise.")]
Jobs = Annotated[int, typer.Option(min=0, max=256, help="Flights at once; 0: one for every core.")]


class SimulateOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset simulate`; each is explained where its type is defined."""

    world: World = "chain"
    config: Config = None
    vehicles: Vehicles = None
    duration: Duration = None
    pal: Pal = None
    latency_ms: Latency = None
    sweep: Sweep = None
    vary: Vary = None
    grid: Grid = 0
    seeds: Seeds = 5
    first_seed: FirstSeed = 100
    survival: Survival = 1.0
    in_view: InView = None
    spread: Spread = None
    quick: Quick = False
    jobs: Jobs = 0
    print_names: PrintNames = False
    out: Folder = None
    quiet: Quiet = False
    force: Force = False

    def flight(self) -> "FlightParameters":
        """Read the settings and change what the options name: every flight, but for its seed and the swept value."""
        from matchset.flight.chain.config import flight_parameters, with_world

        if self.world != "chain":
            raise ValueError(f"--world must be chain, got {self.world!r}")
        flight = flight_parameters(self.config, self.duration)
        quick = self.quick or flight.world.quick
        return with_world(flight, vehicles=self.vehicles, pal=self.pal, latency_ms=self.latency_ms, quick=quick)

    def axes(self) -> "list[Axis]":
        """Read what is varied: by default the latency, told."""
        from matchset.flight.simulate.variation import parse_sweep, parse_vary

        if self.vary is not None and self.sweep is not None:
            raise ValueError("--vary and --sweep cannot go together")
        if self.grid and self.vary is None:
            raise ValueError("--grid needs --vary")
        return [parse_sweep(self.sweep or "latency_ms=0,33,67,100,133")] if self.vary is None else parse_vary(self.vary)

    def limits(self) -> "RowLimits":
        """Make the limits that every row of the table must reach: where all is varied, those alone that are given."""
        from matchset.flight.simulate.table import RowLimits

        usual = RowLimits() if self.vary is None else RowLimits(in_view=0.0, spread=math.inf)
        in_view = usual.in_view if self.in_view is None else self.in_view
        return RowLimits(
            survival=self.survival, in_view=in_view, spread=usual.spread if self.spread is None else self.spread
        )


def simulate(options: SimulateOptions) -> int:
    """Fly many simulated flights under changed conditions and judge them by limits."""
    if options.print_names:
        from matchset.flight.simulate.variation import names_table

        print(names_table())
        return FOUND
    from matchset.app.run_folder import check_run, output_folder

    check_run(options.out, ("flights.csv", "table.md", "flights.svg"), [], [options.config], options.force)
    from matchset.flight.simulate.table import rows_of, sweep_verdict

    axes, flight, limits = options.axes(), options.flight(), options.limits()
    cases = _cases(axes, flight, options)
    folder = output_folder(options.out, "simulate", options.force)
    with StopRequest() as stop:
        flown = _fly(axes, flight, cases, folder, options, stop)
    rows = rows_of(flown, axes)
    _show(axes, flown, rows, folder)
    holds, sentence = sweep_verdict(rows, flight, limits)
    if stop:
        print(f"Stopped after {len(flown)} of {len(cases)} flights: no verdict.")
        return stop.code
    print(sentence)
    return FOUND if holds else NOT_FOUND


def _cases(axes: "list[Axis]", flight: "FlightParameters", options: SimulateOptions) -> "list[FlightCase]":
    """List the flights; the ends of all ranges are checked before the first one begins."""
    from matchset.flight.simulate.variation import changed, plan

    for axis in axes:
        for end in (axis.low, axis.high):
            changed(flight, {axis.name: end}, axis.told)
    return plan(axes, options.grid, range(options.first_seed, options.first_seed + options.seeds))


def _fly(
    axes: "list[Axis]",
    flight: "FlightParameters",
    cases: "list[FlightCase]",
    folder: Path,
    options: SimulateOptions,
    stop: StopRequest,
) -> "list[Flown]":
    """Fly all cases and write a line of ``flights.csv`` as each ends."""
    from matchset.app.disk import WholeFile
    from matchset.flight.chain.config import with_world
    from matchset.flight.simulate.flights import compile_ahead, fly_each, fly_once, work_text
    from matchset.flight.simulate.table import Flown, csv_header, csv_line
    from matchset.flight.simulate.variation import changed

    told = any(axis.told for axis in axes)
    flights = [with_world(changed(flight, case.values, told), seed=case.seed) for case in cases]
    jobs = options.jobs or os.cpu_count() or 1
    if not options.quiet:
        print(work_text(flights, jobs), file=sys.stderr)
    if jobs > 1:
        compile_ahead(flights[0])
    flown: list[Flown] = []
    with WholeFile(folder / "flights.csv") as file, _progress_bar(len(cases), options.quiet) as advance:
        file.append(f"{csv_header(axes)}\n".encode())
        for number, score in fly_each(fly_once, flights, jobs, lambda: bool(stop)):
            flown.append(Flown(cases[number], score))
            file.append(f"{csv_line(axes, flown[-1])}\n".encode())
            advance()
    return flown


def _show(axes: "list[Axis]", flown: "list[Flown]", rows: "list[SweepRow]", folder: Path) -> None:
    """Print the table; write it, and a picture of where it flies."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from matchset.app.drawing.plot_style import write_svg
    from matchset.flight.simulate.picture import survival_figure
    from matchset.flight.simulate.table import TERMINAL_HEADINGS, markdown_table, terminal_cells
    from matchset.image.files.whole_file import write_whole

    write_whole(folder / "table.md", f"{markdown_table(rows)}\n".encode())
    shown, before = Table(box=box.SIMPLE_HEAD), ""
    for number, heading in enumerate(TERMINAL_HEADINGS):
        shown.add_column(heading, justify="right" if number > 1 else "left", no_wrap=True)
    for row in rows:
        if row.name != before:
            shown.add_section()
        before = row.name
        shown.add_row(*terminal_cells(row), style="bold" if row.name == "all at once" else None)
    Console().print(shown)
    if flown:
        write_svg(survival_figure(axes, flown), folder / "flights.svg")
        print(f"  {folder / 'flights.svg'}")
    print(f"  {folder / 'flights.csv'}")


@contextlib.contextmanager
def _progress_bar(total: int, quiet: bool) -> Iterator[Callable[[], None]]:
    """Show on stderr how many flights are done."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("flights"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=quiet or not sys.stderr.isatty(), transient=True) as progress:
        task = progress.add_task("flights", total=total)
        yield lambda: progress.advance(task)
