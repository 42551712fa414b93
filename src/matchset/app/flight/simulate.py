"""`matchset simulate`: many flights under changed conditions, a table, and one sentence with the verdict."""

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec

from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.app.flight.config import with_world
from matchset.app.flight.flight import FlightParameters
from matchset.app.flight.score import FlightScore
from matchset.app.flight.series import fly_all
from matchset.app.flight.simulation_table import (
    HEADER,
    Limits,
    SweepRow,
    csv_line,
    markdown_table,
    rows_by_value,
    verdict,
)
from matchset.app.run_folder import output_folder
from matchset.links.simulated import SimulationParameters

UNIT = {"latency_ms": "ms", "swing": "m", "yaw_deg": "degrees", "bias_deg": "degrees", "hidden": "s", "start_off": "m"}


class SimulateOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset simulate`.

    Parameters
    ----------
    flight : FlightParameters
        What is flown, but for what is swept and the seed.
    sweep : str
        NAME=VALUE,VALUE,...: a number of `SimulationParameters` and its values.
    seeds : int
        How many flights at each value.
    first_seed : int
    limits : Limits
    jobs : int
        How many flights at once; 0: one for every core.
    out : Path or None
    force : bool
    quiet : bool
    """

    flight: FlightParameters
    sweep: str = "latency_ms=0,33,67,100,133"
    seeds: int = 20
    first_seed: int = 100
    limits: Limits = Limits()
    jobs: int = 0
    out: Path | None = None
    force: bool = False
    quiet: bool = False


def parse_sweep(sweep: str) -> tuple[str, list[float]]:
    """Read NAME=VALUE,VALUE,...

    Raises
    ------
    ValueError
        If the name is no number of `SimulationParameters`, or a value is no number.
    """
    name, mark, values = sweep.partition("=")
    known = SimulationParameters()
    numbers = [
        each for each in known.__struct_fields__ if isinstance(getattr(known, each), float) or each == "vehicles"
    ]
    if not mark or name not in numbers:
        raise ValueError(f"--sweep is NAME=VALUE,VALUE,... with one of {', '.join(numbers)}, got {sweep!r}")
    try:
        read = [float(value) for value in values.split(",")]
    except ValueError:
        raise ValueError(f"--sweep {name} needs numbers with commas between, got {values!r}") from None
    return name, read


def simulate(options: SimulateOptions) -> int:
    """Run the command.

    Returns
    -------
    int
        0 if every row is within the limits, 1 if not, or the code of the signal that stopped it.
    """
    name, values = parse_sweep(options.sweep)
    whole = isinstance(getattr(options.flight.world, name), int)
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    cases = [(value, seed) for value in values for seed in seeds]
    # All flights are checked before the first one begins.
    flights = [
        with_world(options.flight, **{name: int(value) if whole else value, "seed": seed}) for value, seed in cases
    ]
    folder = output_folder(options.out, "simulate", options.force)
    done: list[tuple[float, FlightScore]] = []
    with StopRequest() as stop, (folder / "flights.csv").open("w", encoding="utf-8") as file:
        print(f"{name},{HEADER}", file=file, flush=True)
        with _bar(len(cases), options.quiet) as advance:
            for number, score in fly_all(flights, options.jobs or os.cpu_count() or 1, lambda: bool(stop)):
                value = cases[number][0]
                done.append((value, score))
                print(f"{value:g},{csv_line(score)}", file=file, flush=True)
                advance()
    rows = rows_by_value(values, done)
    words = markdown_table(name, UNIT.get(name, ""), rows)
    (folder / "table.md").write_text(words + "\n", encoding="utf-8")
    print(words)
    print(f"  {folder / 'flights.csv'}")
    return _end(options, name, rows, stop, len(done), len(cases))


def _end(options: SimulateOptions, name: str, rows: list[SweepRow], stop: StopRequest, done: int, wanted: int) -> int:
    """Say the verdict in the last line."""
    holds, sentence = verdict(name, UNIT.get(name, ""), rows, options.flight, options.limits)
    if stop:
        print(f"Stopped after {done} of {wanted} flights: no verdict.")
        return stop.code
    print(sentence)
    return FOUND if holds else NOT_FOUND


@contextlib.contextmanager
def _bar(total: int, quiet: bool) -> Iterator[Callable[[], None]]:
    """Show how many flights are done, on stderr."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("flights"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=quiet or not sys.stderr.isatty(), transient=True) as progress:
        task = progress.add_task("flights", total=total)
        yield lambda: progress.advance(task)
