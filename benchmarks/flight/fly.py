"""Rows of twenty flights and the page `benchmarks/FLIGHT.md`: `python -m benchmarks.flight.fly`, or `make bench-fly`.

Tuned on seeds 0 to 9; these rows are flown on 110 and up. Scores already flown by the same sources of the package are
kept in a file and not flown again, so that a run may be stopped and gone on with.
"""

import os
import time
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

import matchset
from benchmarks.figures.kept import draw_kept
from benchmarks.flight.processing import in_words, processing
from benchmarks.machine import Machine
from benchmarks.workers import one_thread
from matchset.app.exit_codes import StopRequest
from matchset.app.flight.flight import Flight, FlightParameters
from matchset.app.flight.score import FlightScore
from matchset.app.simulate.flights import fly_all
from matchset.app.simulate.table import Limits, SweepRow, centimeters
from matchset.links.simulated import FPS, SimulationParameters

PAGES = Path(__file__).resolve().parents[1]
FIRST = 110  # seeds 0 to 9 were tuned on, 100 and 101 were looked at on the way
PULLED = 2.0  # s
TEN = "chain_of_ten"


class Case(msgspec.Struct, frozen=True, kw_only=True):
    """A row of the page.

    Parameters
    ----------
    name : str
    words : str
        What is flown.
    bar : str
    duration : float
        s.
    world : dict
        Fields of `SimulationParameters`.
    judge : callable
        From a `SweepRow` to whether the bar is reached, and the figure in words.
    """

    name: str
    words: str
    bar: str
    duration: float
    world: dict[str, Any]
    judge: Callable[[SweepRow], tuple[bool, str]]


def whole(row: SweepRow) -> tuple[bool, str]:
    """Survival, view and spread."""
    limits = Limits()
    axes = ", ".join(centimeters(row.median_spread(axis)) for axis in range(3))
    words = (
        f"{row.survived} of {len(row.scores)} fly to the end; ball in view {100.0 * row.in_view:.1f} % at least; "
        f"spread of side, height, heading {axes} (medians), {centimeters(row.spread)} at worst"
    )
    return not row.violation(limits), words


def alive(row: SweepRow) -> tuple[bool, str]:
    """No crash."""
    crashed = [score.seed for score in row.scores if score.crash]
    words = f"{len(row.scores) - len(crashed)} of {len(row.scores)} without a crash, {row.survived} fly to the end"
    return not crashed, words + (f"; crashed: seeds {', '.join(map(str, crashed))}" if crashed else "")


def settles(limit: float) -> Callable[[SweepRow], tuple[bool, str]]:
    """Time until all are near their places."""

    def judge(row: SweepRow) -> tuple[bool, str]:
        times = [score.settling_time for score in row.scores]
        words = f"{float(np.median(times)):.1f} s (median), {max(times):.1f} s at worst"
        return max(times) <= limit and row.survived == len(row.scores), words

    return judge


def comes_down(row: SweepRow) -> tuple[bool, str]:
    """Time from the pulled cable to the first command of the descent."""
    times = [score.descent_time - PULLED for score in row.scores]
    return max(times) <= 0.5, f"descent begins {max(times):.2f} s after the cable at the latest"


CASES = (
    Case(name="chain", words="chain of three, typical, 67 ms", bar="all fly, in view >= 99 %, <= 10 cm rms per axis",
         duration=60.0, world={}, judge=whole),
    Case(name="prize", words="the same, bad, 133 ms", bar="(the prize) all fly, in view >= 99 %",
         duration=60.0, world={"pal": "bad", "latency_ms": 133.0}, judge=whole),
    Case(name="start", words="0.5 m off in every axis", bar="settled within 6 s", duration=10.0,
         world={"start_off": 0.5}, judge=settles(6.0)),
    Case(name="hidden", words="balloon hidden for 0.5 s ten times a minute", bar="no crash", duration=60.0,
         world={"hidden": 0.5}, judge=alive),
    Case(name="hidden1", words="the same for 1 s", bar="(the prize) no crash", duration=60.0,
         world={"hidden": 1.0}, judge=alive),
    Case(name="cable", words="camera cables pulled at 2 s", bar="descent commanded within 0.5 s", duration=3.5,
         world={"cable": PULLED}, judge=comes_down),
)  # fmt: skip


def main(
    only: Annotated[str, typer.Option(help=f"Some of {', '.join(case.name for case in CASES)}, speed, ten.")] = "",
    seeds: Annotated[int, typer.Option(min=1, help="Flights in a row.")] = 20,
    duration: Annotated[float | None, typer.Option(help="Shorter flights, s: a first impression.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Flights at once.")] = min(2, os.cpu_count() or 1),
    kept: Annotated[Path, typer.Option(help="Scores already flown.")] = PAGES / "flights.kept",
    output: Annotated[Path, typer.Option("-o", help="The page.")] = PAGES / "FLIGHT.md",
) -> None:
    """Fly rows of twenty seeds and write the page."""
    one_thread()
    names = [name for name in only.split(",") if name]
    lines = ["| what | bar | measured | reached |", "| --- | --- | --- | --- |"]
    with StopRequest() as stop:
        if not names or "speed" in names:
            lines += [speed_line(), processing_line()]
        for case in CASES:
            if names and case.name not in names:
                continue
            row = fly_case(case, range(FIRST, FIRST + seeds), duration, jobs, kept, stop)
            if row.scores:
                reached, words = case.judge(row)
                flown = f"{case.words}: {len(row.scores)} flights of {row.scores[0].duration:g} s"
                lines.append(f"| {flown} | {case.bar} | {words} | {'yes' if reached else '**no**'} |")
        if (not names or "ten" in names) and not stop:
            lines.append(ten_line(min(duration or 30.0, 30.0), kept, stop))
    machine = Machine.here()
    where = f"{machine.date}, commit {machine.commit}, {machine.processor}, {machine.cores} cores."
    how = f"Seeds {FIRST} and up; tuned on seeds 0 to 9. Written by `make bench-fly`."
    page = "\n".join(("# Flights", "", where, how, "", *lines, ""))
    output.write_text(page, encoding="utf-8")
    Console().print(page)


def fly_case(
    case: Case, seeds: range, duration: float | None, jobs: int, kept: Path, stop: Callable[[], bool] | StopRequest
) -> SweepRow:
    """Fly what is missing of a row, and keep it."""
    flights = {
        seed: FlightParameters(
            duration=min(duration or case.duration, case.duration),
            world=SimulationParameters(seed=seed, **case.world),
        )
        for seed in seeds
    }
    code = sources()
    keys = {seed: f"{code} {case.name} {seed} {flight.duration:g}" for seed, flight in flights.items()}
    scores = read_kept(kept)
    missing = [seed for seed in seeds if keys[seed] not in scores]
    columns = (TextColumn(case.name), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress, kept.open("ab") as file:
        task = progress.add_task(case.name, total=len(seeds), completed=len(seeds) - len(missing))
        for number, score in fly_all([flights[seed] for seed in missing], jobs, lambda: bool(stop)):
            key = keys[missing[number]]
            scores[key] = score
            file.write(msgspec.msgpack.encode((key, score)).hex().encode() + b"\n")
            file.flush()
            progress.advance(task)
    return SweepRow(scores=tuple(scores[key] for key in keys.values() if key in scores))


def sources() -> str:
    """Checksum of all that decides a flight but the libraries: the package's Python and its settings."""
    total = 0
    for path in sorted(Path(matchset.__file__).parent.rglob("*")):
        if path.suffix in (".py", ".toml"):
            total = zlib.crc32(path.read_bytes(), total)
    return f"{total:08x}"


def read_kept(path: Path) -> dict[str, FlightScore]:
    """Read the scores that were flown before."""
    if not path.exists():
        return {}
    lines = path.read_bytes().splitlines()
    pairs = (msgspec.msgpack.decode(bytes.fromhex(line.decode()), type=tuple[str, FlightScore]) for line in lines)
    return dict(pairs)


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


def ten_line(duration: float, kept: Path, stop: Callable[[], bool] | StopRequest) -> str:
    """Fly a chain of ten and tell how the spread grows along it."""
    case = Case(name="ten", words="", bar="", duration=duration, world={"vehicles": 10}, judge=alive)
    row = fly_case(case, range(FIRST, FIRST + 1), duration, 1, kept, stop)
    if not row.scores:
        return "| chain of ten | runs | stopped | **no** |"
    score = row.scores[0]
    flown = "to the end" if score.survived else score.crash or score.landing_reason
    words = f"seed {score.seed}, {score.end:.0f} of {duration:g} s: {flown}"
    if score.spread:
        plot(score)
        spreads = ", ".join(centimeters(float(np.linalg.norm(each))) for each in reversed(score.spread))
        words += f"; rms of the distance from the set place, next to the rope first: {spreads} ![](pictures/{TEN}.svg)"
    return f"| chain of ten | runs; growth along the chain | {words} | {'yes' if score.survived else '**no**'} |"


def plot(score: FlightScore) -> None:
    """Draw how the spread grows along a chain."""
    spreads = {
        name: [100.0 * float(each[axis]) for each in reversed(score.spread)]
        for axis, name in enumerate(("side", "height", "heading"))
    }
    draw_kept(PAGES / "pictures", TEN, "spread along a chain", {"spreads_cm": spreads})


if __name__ == "__main__":
    typer.run(main)
