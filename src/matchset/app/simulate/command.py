"""`matchset simulate`: many flights at several values of one parameter, a table, and a last line with the verdict.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

import contextlib
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from matchset.app.cli_options import Folder, Force
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest
from matchset.app.flight.command import Config, Duration, Latency, Pal, Vehicles
from matchset.app.flight.output_files import Quiet

if TYPE_CHECKING:
    from matchset.app.flight.flight import FlightParameters
    from matchset.app.flight.score import FlightScore
    from matchset.app.simulate.table import Limits

SIMULATE_EPILOG = """
[bold]Examples[/bold]

  matchset simulate

  matchset simulate --sweep hidden=0.5,1.0 --seeds 20 --pal bad

  matchset simulate --sweep vehicles=3,5,10 --seeds 2 --duration 20

The last line is the verdict. Latency is from the middle of a picture's exposure to the command leaving the laptop; the
radio's delay comes on top.

Exit codes: 0 the limits hold in every row, 1 they do not, 2 bad input or options, 130 stopped by Ctrl-C.
"""

World = Annotated[str, typer.Option("--world", help="What is simulated: chain.")]
Sweep = Annotated[str, typer.Option(metavar="NAME=VALUES", help="What to change, and to which values.")]
Seeds = Annotated[int, typer.Option(min=1, max=10_000, help="Flights at each value.")]
FirstSeed = Annotated[int, typer.Option(min=0, help="The first of their seeds.")]
Survival = Annotated[float, typer.Option(help="Limit: least share of flights that survive.")]
InView = Annotated[float, typer.Option(help="Limit: least share of pictures with the ball in view.")]
Spread = Annotated[float, typer.Option(metavar="M", help="Limit: largest rms off the set place, m.")]
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
    sweep: Sweep = "latency_ms=0,33,67,100,133"
    seeds: Seeds = 5
    first_seed: FirstSeed = 100
    survival: Survival = 1.0
    in_view: InView = 0.99
    spread: Spread = 0.10
    quick: Quick = False
    jobs: Jobs = 0
    out: Folder = None
    quiet: Quiet = False
    force: Force = False

    def flight(self) -> "FlightParameters":
        """Read the settings and change what the options name: every flight, but for its seed and the swept value."""
        from matchset.app.flight.config import flight_parameters, with_world

        if self.world != "chain":
            raise ValueError(f"--world must be chain, got {self.world!r}")
        flight = flight_parameters(self.config, self.duration)
        named = {name: getattr(self, name) for name in ("vehicles", "pal", "latency_ms")}
        named["quick"] = self.quick or flight.world.quick
        return with_world(flight, **{name: value for name, value in named.items() if value is not None})

    def limits(self) -> "Limits":
        """Make the limits that every row of the table must reach."""
        from matchset.app.simulate.table import Limits

        return Limits(survival=self.survival, in_view=self.in_view, spread=self.spread)


def simulate(options: SimulateOptions) -> int:
    """Fly many simulated flights under changed conditions and judge them by limits."""
    from matchset.app.run_folder import check_run, output_folder

    check_run(options.out, ("flights.csv", "table.md"), [], [options.config], options.force)
    from matchset.app.disk import WholeFile
    from matchset.app.simulate import table
    from matchset.image.files.whole_file import write_whole

    flight, limits = options.flight(), options.limits()
    name, values = parse_sweep(options.sweep)
    cases = [(value, options.first_seed + k) for value in values for k in range(options.seeds)]
    flights = _flights(flight, name, cases)
    folder = output_folder(options.out, "simulate", options.force)
    jobs = options.jobs or os.cpu_count() or 1
    if not options.quiet:
        print(work_text(flights, jobs), file=sys.stderr)
    done: list[tuple[float, FlightScore]] = []
    with StopRequest() as stop, WholeFile(folder / "flights.csv") as file:
        file.append(f"{name},{table.HEADER}\n".encode())
        with _progress_bar(len(cases), options.quiet) as advance:
            for number, score in fly_all(flights, jobs, lambda: bool(stop)):
                value = cases[number][0]
                done.append((value, score))
                file.append(f"{value:g},{table.csv_line(score)}\n".encode())
                advance()
    rows = table.rows_by_value(values, done)
    text = table.markdown_table(name, rows)
    write_whole(folder / "table.md", f"{text}\n".encode())
    print(text)
    print(f"  {folder / 'flights.csv'}")
    holds, sentence = table.sweep_verdict(name, rows, flight, limits)
    if stop:
        print(f"Stopped after {len(done)} of {len(cases)} flights: no verdict.")
        return stop.code
    print(sentence)
    return FOUND if holds else NOT_FOUND


class WorkParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What a simulated flight costs, to say beforehand how long many will take.

    Parameters
    ----------
    seconds : float
        Processor time for one follower and one second of a flight, s. Chosen by: an hour for 100 flights of 60 s with
        two followers each.
    """

    seconds: float = 0.3


def work_text(flights: "Sequence[FlightParameters]", jobs: int) -> str:
    """Say how long flights will take, so many at once: they are told apart by their vehicles only."""
    from matchset.app.progress import duration_text

    work = sum(each.duration * (each.world.vehicles - 1) for each in flights) * WorkParameters().seconds
    at_once = min(jobs, len(flights))
    total = duration_text(work / at_once)
    return f"{len(flights)} flights of {flights[0].duration:g} s, {at_once} at once: about {total} of computing"


def parse_sweep(sweep: str) -> tuple[str, list[float]]:
    """Read NAME=VALUE,VALUE,...

    Raises
    ------
    ValueError
        If the name is no number of `SimulationParameters`, or a value is no number.
    """
    from matchset.links.simulated import SimulationParameters

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


def fly_once(parameters: "FlightParameters", stopped: Callable[[], bool] | None = None) -> "FlightScore":
    """Fly to the end, or to the first crash, and score the flight.

    Parameters
    ----------
    parameters : FlightParameters
    stopped : callable, optional
        Asked at every step; if it answers True the flight ends there.
    """
    from matchset.app.flight.flight import Flight
    from matchset.app.flight.score import FlightScorer

    scorer = FlightScorer(parameters)
    with Flight(parameters) as flight:
        for chain_step in flight:
            scorer.add(chain_step)
            if scorer.crashed or (stopped is not None and stopped()):
                break
    return scorer.score()


def fly_all(
    flights: "Sequence[FlightParameters]", jobs: int, stop: Callable[[], bool] | None = None
) -> "Iterator[tuple[int, FlightScore]]":
    """Fly many flights.

    Parameters
    ----------
    flights : sequence of FlightParameters
    jobs : int
        How many at once, each in a process of its own; 1: in this process, one after the other.
    stop : callable, optional
        Asked now and then; after True no further flight begins and unfinished ones are dropped.

    Yields
    ------
    (int, FlightScore)
        Index into `flights` and score, in the order in which they end.
    """
    asked = stop or (lambda: False)
    if jobs > 1:
        yield from _fly_in_processes(flights, jobs, asked)
        return
    for number, parameters in enumerate(flights):
        if asked():
            return
        score = fly_once(parameters, asked)
        if asked():
            return
        yield number, score


def _fly_in_processes(
    flights: "Sequence[FlightParameters]", jobs: int, asked: Callable[[], bool]
) -> "Iterator[tuple[int, FlightScore]]":
    import multiprocessing
    from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait

    poll_time = 0.3  # s, between two looks at `asked`
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=_ignore_interrupts) as pool:
        waiting = {pool.submit(fly_once, parameters): number for number, parameters in enumerate(flights)}
        try:
            while waiting and not asked():
                done, _ = wait(waiting, timeout=poll_time, return_when=FIRST_COMPLETED)
                for future in done:
                    yield waiting.pop(future), future.result()
        finally:
            for future in waiting:
                future.cancel()
            if waiting:
                for process in list((pool._processes or {}).values()):
                    process.terminate()


def _ignore_interrupts() -> None:
    """Leave Ctrl-C to the process that started this one."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _flights(flight: "FlightParameters", name: str, cases: Sequence[tuple[float, int]]) -> "list[FlightParameters]":
    """Make the parameters of all flights, which checks them before the first one begins.

    Parameters
    ----------
    flight : FlightParameters
    name : str
        The swept parameter.
    cases : sequence of (float, int)
        Its value, and the seed.
    """
    from matchset.app.flight.config import with_world

    whole = isinstance(getattr(flight.world, name), int)
    return [with_world(flight, **{name: int(value) if whole else value, "seed": seed}) for value, seed in cases]


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
