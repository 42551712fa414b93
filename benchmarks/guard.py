"""Has a change made it slower or less exact? `python -m benchmarks.guard`, or `make bench-quick`: four minutes.

Ratios of times and figures of accuracy are held against those in `limits.toml`; what has lost more than a quarter
fails. Ratios are of minima over some rounds, the best round counts: a busy machine can make one round slow, not all
of them. On other machines ratios differ more than that: `--slack 2` allows twice as much for times. Figures of
accuracy hang on neither the machine nor the hour. The fast part of `make bench-real` follows: small balls, and where
the real clips are, the quickest of them and single pictures.
"""

import time
import tomllib
from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.console import Console
from rich.table import Table

from benchmarks.contest.field import OURS, RIVAL, peer
from benchmarks.contest.speed import CONVERSION, Pool, contenders, sharp_clip, sharp_rival
from benchmarks.machine import Machine
from benchmarks.regression.run import DATA, fast_part
from benchmarks.shapes.cases import THIRD
from benchmarks.shapes.trial import ShapeTask, follow_shape, lost_percent, mean_error
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.contenders import Pool as SearchPool
from benchmarks.tracking.contenders import convert, search
from benchmarks.tracking.stopwatch import time_in_pairs
from benchmarks.tracking.trial import follow, sequence
from benchmarks.workers import one_thread

LIMITS = Path(__file__).resolve().parent / "limits.toml"
QUARTER = 1.25
ROUNDS = 3
RADII = (20, 40, 120)
POOL, LAPS = 24, 8
SEQUENCES = (
    "clean",
    "typical",
    "bad",
    "hard",
    "occlusion",
    "clutter",
    "light",
    "shrink",
    "fast",
    "hidden",
    "compressed",
    "phone",
)
SEEDS, FRAMES = (100, 101), 70
SHAPES = {"quadrilateral": ("quadrilateral", 0.0, "px"), "hidden hexagon": ("affine hexagon", THIRD, "% of the area")}
SHAPE_SEEDS, SHAPE_FRAMES = (101, 103), 30
NOISE_PERCENT = 0.5  # of the frames may be invalid more than before, whatever the quarter says


class Limit(msgspec.Struct, frozen=True):
    """A stored figure and the largest that passes; smaller is better for all of them."""

    name: str
    stored: float
    most: float


def main(
    slack: Annotated[float, typer.Option(help="Factor on the limits of times, for noisy or other machines.")] = 1.0,
    store: Annotated[bool, typer.Option("--store", help="Write what is measured as the new limits.")] = False,
    data: Annotated[Path, typer.Option(help="Folder with the real clips.")] = DATA,
) -> None:
    """Measure, compare with the stored limits, exit with 1 if something has lost more than a quarter."""
    if slack < 1.0:
        raise typer.BadParameter(f"the slack is at least 1, got {slack}")
    begin = time.perf_counter()
    one_thread()
    console = Console(highlight=False)
    times, misses = best_ratios(), {**exactness(), **shape_exactness()}
    if store:
        write(times, misses)
        console.print(f"written: {LIMITS}")
        return
    limits = {limit.name: limit for limit in read(LIMITS.read_text(encoding="utf-8"), slack)}
    measured = {**times, **misses}
    show(console, measured, limits)
    worse = too_much(measured, limits)
    console.print(f"{time.perf_counter() - begin:.0f} s; " + ("\n".join(worse) or "all within their limits"))
    on_footage = fast_part(console, data, slack)
    raise typer.Exit(1 if worse or on_footage else 0)


def best_ratios() -> dict[str, float]:
    """Ratios of minima against the yardsticks, the best of some rounds."""
    one = SearchPool.render(sequence("typical", SEEDS[0], 1))
    empty = [frame for frame, _ in sequence("typical", SEEDS[0], POOL, ball=False)]
    pools = {r: Pool.render(sharp_clip(SEEDS[0], float(r), POOL + 1)) for r in RADII}
    best: dict[str, float] = {}
    for _ in range(ROUNDS):
        for radius, pool in pools.items():
            both = contenders([peer(OURS), sharp_rival()], pool)
            least = {
                k: t.least_us for k, t in time_in_pairs([*both, convert(CONVERSION, pool.frames, 0)], LAPS).items()
            }
            _keep(best, f"update(r = {radius}) / conversion", least[OURS] / least[CONVERSION])
            _keep(best, f"update(r = {radius}) / region + BGR + contour", least[OURS] / least[RIVAL])
        raced = time_in_pairs([search("search", empty, one.color), convert(CONVERSION, empty, 0)], 2)
        _keep(best, "search in vain / conversion", raced["search"].least_us / raced[CONVERSION].least_us)
    return best


def _keep(best: dict[str, float], name: str, value: float) -> None:
    best[name] = min(value, best.get(name, value))


def exactness() -> dict[str, float]:
    """Mean error, px, and invalid frames, %, of matchset on some sequences."""
    found = {}
    for name in SEQUENCES:
        changes = {"hidden": ((20, 50),)} if name == "hidden" else {}
        result = pooled([follow(sequence(name, seed, FRAMES, **changes)) for seed in SEEDS])
        found[f"{name}: mean error, px"] = result.mean_error_px if result.mean_error_px is not None else float("inf")
        found[f"{name}: not valid, %"] = 100.0 - (result.valid_percent or 0.0)
    return found


def shape_exactness() -> dict[str, float]:
    """Mean error and frames without an answer, %, of other shapes than a ball, which begin with a click too."""
    found = {}
    for name, (case, share, unit) in SHAPES.items():
        trials = [follow_shape(ShapeTask(case, "typical", seed, SHAPE_FRAMES, share)) for seed in SHAPE_SEEDS]
        answers = [each for trial in trials for each in trial.ours]
        error = mean_error(answers)
        found[f"{name}: mean error, {unit}"] = error if error is not None else float("inf")
        found[f"{name}: not answered, %"] = lost_percent(answers)
    return found


def read(text: str, slack: float = 1.0) -> list[Limit]:
    """Read stored figures and make limits of them.

    Parameters
    ----------
    text : str
        Of `limits.toml`.
    slack : float
        Factor on the limits of times.

    Returns
    -------
    list of Limit
    """
    tables = tomllib.loads(text)
    limits = [Limit(name, value, value * QUARTER * slack) for name, value in tables["times"].items()]
    for name, value in tables["accuracy"].items():
        more = NOISE_PERCENT if name.endswith(", %") else 0.0
        limits.append(Limit(name, value, value * QUARTER + more))
    return limits


def too_much(measured: dict[str, float], limits: dict[str, Limit]) -> list[str]:
    """Say what lies above its limit, and what has none or was not measured."""
    words = [
        f"{name}: {measured[name]:.3f}, stored {limit.stored:.3f}, at most {limit.most:.3f}"
        for name, limit in limits.items()
        if name in measured and not measured[name] <= limit.most
    ]
    words += [f"{name}: has a limit but was not measured" for name in limits if name not in measured]
    return words + [
        f"{name}: has no limit (python -m benchmarks.guard --store)" for name in measured if name not in limits
    ]


def show(console: Console, measured: dict[str, float], limits: dict[str, Limit]) -> None:
    """Print all figures beside their limits."""
    table = Table("", "measured", "stored", "at most")
    for name, value in measured.items():
        limit = limits.get(name)
        style = "red" if limit is None or not value <= limit.most else ""
        known = ("-", "-") if limit is None else (f"{limit.stored:.3f}", f"{limit.most:.3f}")
        table.add_row(name, f"{value:.3f}", *known, style=style)
    console.print(table)


def write(times: dict[str, float], misses: dict[str, float]) -> None:
    """Store figures as the new limits."""
    machine = Machine.here()
    lines = [
        "# What `make bench-quick` compares with: a change that loses more than a quarter fails.",
        "# Written by `python -m benchmarks.guard --store`; times are ratios of minima, best of some rounds.",
        f"# {machine.date}, commit {machine.commit}, {machine.processor}",
        "",
        "[times]",
        *(f'"{name}" = {value:.4f}' for name, value in times.items()),
        "",
        "[accuracy]",
        *(f'"{name}" = {value:.4f}' for name, value in misses.items()),
    ]
    LIMITS.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    typer.run(main)
