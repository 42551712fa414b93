"""All rows of simulated flights and the page `benchmarks/FLIGHT.md`: `make bench-fly`, or `-m benchmarks.flight.fly`.

The rows are those of ``flights.toml``, flown in rendered pictures through the tracker. Each flight is kept as soon as
it is flown: a run that was stopped, or killed, flies only what is missing, and so does one on another machine that is
given a share. Only flights of the same sources of the package count.
"""

import math
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from benchmarks.figures.kept import draw_kept
from benchmarks.flight.flown import Flier, KeptFlight, KeptFlights, flier, fly_missing, sources
from benchmarks.flight.page import seeds_text, table_of
from benchmarks.flight.processing import in_words, processing
from benchmarks.flight.rows import (
    Listed,
    Order,
    Row,
    chosen,
    flight_list,
    parse_share,
    rows,
    share_of,
)
from benchmarks.machine import Machine
from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread
from matchset.app.exit_codes import StopRequest
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore
from matchset.flight.simulate.table import centimeters
from matchset.links.simulation_parameters import FPS, SimulationParameters

PAGES = Path(__file__).resolve().parents[1]
KEPT = PAGES / "flights.kept"
SEEDS = "1000-1019"
FIRST = parse_seeds(SEEDS)[0]
TUNED = (
    "Controllers were tuned on seeds below 100, sizes of swings on 110 to 137, and others below 1000 have been "
    "looked at; nothing of a flight was tuned on 1000 and up."
)
TEN = "chain_of_ten"
SPEED = "speed"


class Run:
    """A list of flights, what is kept of it, and its page.

    Parameters
    ----------
    asked : sequence of Row
    seeds : sequence of int
    kept : KeptFlights
    duration : float
        Makes longer flights so short, s.
    quick : bool
        Without pictures.

    Attributes
    ----------
    every : list of Row
        Of the page.
    speed : list of str
        Rows of a second table.
    """

    def __init__(
        self, asked: Sequence[Row], seeds: Sequence[int], kept: KeptFlights, duration: float, quick: bool
    ) -> None:
        self.every = [row for row in rows() if not (quick and row.pictures)]
        self.asked, self.seeds, self.kept = [row for row in asked if row in self.every], seeds, kept
        self.duration, self.quick = duration, quick
        self.speed: list[str] = []

    def flights(self, order: Order, share: tuple[int, int]) -> list[Listed]:
        """List what is to be flown here."""
        return share_of(flight_list(self.asked, self.seeds, self.duration, self.quick, order), share)

    def fly(self, listed: Sequence[Listed], fly: Flier, stop: Callable[[], bool]) -> None:
        """Fly what is missing, and keep it."""
        done = sum(self.kept.get(each.flight) is not None for each in listed)
        now = TextColumn("{task.description}")
        columns = (TextColumn("flights"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), now)
        with Progress(*columns, console=Console(stderr=True)) as progress:
            task = progress.add_task("", total=len(listed), completed=done)
            for each in fly_missing(listed, self.kept, fly, stop, machine_text(Machine.here())):
                progress.update(task, advance=1, description=f"{each.row.name} {each.seed}")

    def found(self) -> dict[str, list[KeptFlight]]:
        """Return what is kept of every row, by its name."""
        found: dict[str, list[KeptFlight]] = {row.name: [] for row in self.every}
        for each in flight_list(self.every, self.seeds, self.duration, self.quick, "rows"):
            kept = self.kept.get(each.flight)
            if kept is not None:
                found[each.row.name].append(kept)
        return found

    def page(self, pictures: Path | None) -> str:
        """Write the page; the figure of the chain of ten goes into a folder, None: none is drawn."""
        found = self.found()
        flown = {name: [each.flown for each in kept] for name, kept in found.items()}
        machines = sorted({each.machine for kept in found.values() for each in kept})
        here = Machine.here()
        commit = here.commit.removesuffix("+") + (" with changes" if here.commit.endswith("+") else "")
        where = f"{here.date}, commit {commit}, flown on {' and '.join(machines) or machine_text(here)}."
        title = "# Flights without pictures" if self.quick else "# Flights"
        parts = [title, where, f"Seeds {seeds_text(self.seeds)}. {TUNED} {self.origin()}"]
        parts.append(table_of(self.every, flown, self.asked, len(self.seeds), self.duration))
        if self.speed:
            parts.append("\n".join(["| what | bar | measured | reached |", "| --- | --- | --- | --- |", *self.speed]))
        ten = next((each.score for each in flown.get("ten", []) if each.score.spread), None)
        return "\n\n".join([*parts, *([ten_text(ten, pictures)] if ten else [])]) + "\n"

    def origin(self) -> str:
        """Say how the page came about, and what does not count."""
        how = "flown as by `matchset simulate --quick`" if self.quick else "in rendered pictures, through the tracker"
        text = f"Written by `make bench-fly`, {how}. Of `benchmarks/flight/flights.toml`, sources {self.kept.code}."
        unseen = ", ".join(row.name for row in rows() if row.pictures)
        text += f" Rows that only pictures show are left out: {unseen}." if self.quick else ""
        return text + (f" {self.left_out()}" if self.kept.left_out else "")

    def left_out(self) -> str:
        """Say how many flights do not count."""
        return f"{self.kept.left_out} kept flights of other sources of matchset are left out."


def main(
    only: Annotated[str, typer.Option(help=f"Names of rows or parts of their words, with commas; {SPEED}.")] = "",
    seeds: Annotated[str, typer.Option(help="As '1000-1019' or '1000,1005'.")] = SEEDS,
    duration: Annotated[float, typer.Option(min=0.1, help="Shorter flights, s: a trial.")] = math.inf,
    quick: Annotated[bool, typer.Option("--quick", help="Without pictures: a trial.")] = False,
    jobs: Annotated[int, typer.Option(min=1, help="Flights at once.")] = min(2, os.cpu_count() or 1),
    share: Annotated[str, typer.Option(help="I/N: every N-th flight of the list, from the I-th on.")] = "1/1",
    order: Annotated[Order, typer.Option(help="First seed of all rows, then the next one; or row by row.")] = "seeds",
    kept: Annotated[
        list[Path] | None, typer.Option(help=f"Flights already flown, {KEPT.name}; of several, the first is added to.")
    ] = None,
    fly: Annotated[bool, typer.Option("--fly/--no-fly", help="Or only write the page of what is kept.")] = True,
    output: Annotated[
        Path | None,
        typer.Option("-o", help="The page: FLIGHT.md; of a trial, or of no flight at all, it is only printed."),
    ] = None,
) -> None:
    """Fly all rows, and write the page; what is kept is not flown again."""
    one_thread()
    words = [each.strip() for each in only.split(",") if each.strip()]
    files, code = kept or [KEPT], sources()
    try:
        asked = chosen(rows(), ",".join(each for each in words if each != SPEED)) if words != [SPEED] else []
        run = Run(asked, parse_seeds(seeds), KeptFlights(files, code), duration, quick)
        listed = run.flights(order, parse_share(share))
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    say_left_out(run)
    with StopRequest() as stop:
        if fly:
            run.fly(listed, flier(jobs), lambda: bool(stop))
            run.kept = KeptFlights(files, code)  # another share may have been flown into it meanwhile
        if SPEED in words or (not words and fly and not quick and share == "1/1" and not stop):
            run.speed = [speed_line(), processing_line()]
    trial = quick or math.isfinite(duration) or not any(run.found().values())
    write(run, output or (None if trial else PAGES / "FLIGHT.md"))
    raise typer.Exit(stop.code)


def say_left_out(run: Run) -> None:
    """Say on stderr what of the kept files does not count."""
    if run.kept.left_out:
        print(f"{run.left_out()} A page is of one commit.", file=sys.stderr)
    if run.kept.torn:
        print(f"{run.kept.torn} torn lines of kept flights are left out.", file=sys.stderr)


def write(run: Run, path: Path | None) -> None:
    """Print the page, and write it with its figure beside it; None: it is printed only."""
    page = run.page(path.parent / "pictures" if path else None)
    if path:
        path.write_text(page, encoding="utf-8")
    print(page)


def machine_text(machine: Machine) -> str:
    """Say where flights are flown."""
    return f"{machine.processor}, {machine.cores} cores"


def speed_line() -> str:
    """Measure simulated seconds per second of one flight in this process."""
    with Flight(FlightParameters(duration=20.0, world=SimulationParameters(seed=FIRST))) as flight:
        ticks = iter(flight)
        for _ in range(FPS):
            next(ticks)
        walls: list[float] = []
        for _ in range(9):
            begin = time.perf_counter()
            for _ in range(2 * FPS):
                next(ticks)
            walls.append(time.perf_counter() - begin)
    best, median = 2.0 / min(walls), 2.0 / float(np.median(walls))
    words = f"{median:.1f} times real time (best two seconds: {best:.1f})"
    return f"| simulation speed | >= 2 times | {words} | {'yes' if median >= 2.0 else '**no**'} |"


def processing_line() -> str:
    """Measure the computing time per picture, without the simulation."""
    spent = processing(FIRST)
    reached = 1e6 * float(np.median(spent.sum(axis=1))) <= 300.0
    return f"| processing, without rendering | <= 300 µs | {in_words(spent)} | {'yes' if reached else '**no**'} |"


def ten_text(score: FlightScore, pictures: Path | None) -> str:
    """Say how the spread grows along a chain of ten, and draw it."""
    spreads = ", ".join(centimeters(float(np.linalg.norm(each))) for each in reversed(score.spread))
    words = (
        f"Chain of ten, seed {score.seed}, {score.end:.0f} s, next to the rope first: {spreads} (rms of the distance)"
    )
    if pictures is None:
        return words
    plot(score, pictures)
    return f"{words} ![](pictures/{TEN}.svg)"


def plot(score: FlightScore, pictures: Path) -> None:
    """Draw how the spread grows along a chain."""
    spreads = {
        name: [100.0 * float(each[axis]) for each in reversed(score.spread)]
        for axis, name in enumerate(("side", "height", "heading"))
    }
    draw_kept(pictures, TEN, "spread along a chain", {"spreads_cm": spreads})


if __name__ == "__main__":
    typer.run(main)
