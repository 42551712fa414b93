"""How fast: `Tracker.update` and `detect` against converting a frame's color and against copying it."""

from pathlib import Path

import numpy as np

from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Picture, Section, table
from benchmarks.tracking import races, stopwatch
from benchmarks.tracking.contenders import Pool
from benchmarks.tracking.races import CONVERSION, COPY, DETECT, RADII, SEARCH, SIZES, UPDATE, Result


def run(options: Options) -> Section:
    """Race the tracker against the yardsticks."""
    pool = races.sweep_pool(options)
    swept = races.sweep(pool, options)
    cold = races.cold_sweep(pool, options)
    alone = races.alone(pool, options)
    whole = races.whole_frames(pool, options)
    fixed = races.fixed_radii(options)
    sizes = races.resolutions(options)
    wide, narrow = (f"{width} × {height}" for width, height in SIZES)
    findings = [
        against("speed", "`Tracker.update`, 640 × 480, r 20-120", swept, (UPDATE, CONVERSION), (0.1, 0.05)),
        against("speed_copy", "the same", swept, (UPDATE, COPY), (2.0, 1.0)),
        against("speed_cold", "the same, on frames that nobody has touched lately", cold, (UPDATE, CONVERSION), None),
        radius_finding(fixed),
        against("speed_wide", f"`Tracker.update`, {wide}", sizes, (wide, narrow), (1.5, 1.1)),
        against("speed_detect", "`detect`, whole 640 × 480 frame", whole, (DETECT, CONVERSION), (1.0, 0.25)),
        against("speed_search", "a tracker that searches in vain", whole, (SEARCH, CONVERSION), None),
    ]
    named = {
        "r 20-120, all on the same frame": swept,
        "r 20-120, each on a frame of its own": cold,
        "The same frames, nothing else done between them": alone,
        "The whole frame": whole,
        "Fixed radii": fixed,
        "Resolution, equal r": sizes,
    }
    tables = [f"\n**{name}**\n\n{times_table(result)}" for name, result in named.items()]
    pictures = () if options.pictures is None else draw_times(pool, swept, options.pictures)
    return Section("Speed", findings, "\n".join([_method(pool), *tables]), pictures)


def against(name: str, what: str, result: Result, pair: tuple[str, str], most: tuple[float, float] | None) -> Finding:
    """Compare the first of a pair with the second: ratio of medians, of minima, and both medians.

    Parameters
    ----------
    name, what : str
        Of the finding.
    result : dict of str to Times
    pair : tuple of 2 str
        Names of contenders.
    most : tuple of 2 floats, or None
        Largest ratio of medians that holds the bar, and that wins the prize.
    """
    ours, theirs = (result[each] for each in pair)
    goals = [(Goal("ratio", high=high),) for high in most] if most else [(), ()]
    figures = (
        Figure("ratio", ours.median_us / theirs.median_us, "", 3),
        Figure("of minima", ours.least_us / theirs.least_us, "", 3),
        Figure("median", ours.median_us, "µs", 1),
        Figure("against", theirs.median_us, "µs", 1),
        Figure("minimum", ours.least_us, "µs", 1, aside=True),
        Figure("missed", 100.0 * ours.misses / len(ours.ns), "%", 2, aside=True),
    )
    return Finding(name=name, what=f"{what}, against {pair[1]}", figures=figures, bar=goals[0], prize=goals[1])


def radius_finding(result: Result) -> Finding:
    """Hold what a large ball costs more than a small one against the conversion."""
    large, small = (result[f"r = {r}"] for r in (max(RADII), min(RADII)))
    more = large.median_us - small.median_us
    figures = (
        Figure("ratio", more / result[CONVERSION].median_us, "", 3),
        Figure("of minima", (large.least_us - small.least_us) / result[CONVERSION].least_us, "", 3),
        Figure("r = 20", small.median_us, "µs", 1),
        Figure("r = 120", large.median_us, "µs", 1),
    )
    return Finding(
        name="speed_radius",
        what="update(r = 120) - update(r = 20), against the conversion",
        figures=figures,
        bar=(Goal("ratio", high=1 / 20),),
        prize=(Goal("ratio", high=1 / 40),),
    )


def times_table(result: Result) -> str:
    """Write the times of a race."""
    rows = [
        [
            name,
            *(f"{value:.1f}" for value in (times.median_us, times.least_us, times.most_us)),
            f"{1e6 / times.median_us:,.0f}",
            str(len(times.ns)),
            str(times.misses),
        ]
        for name, times in result.items()
    ]
    return table(["", "median, µs", "minimum", "99 %", "per second", "calls", "misses"], rows)


def draw_times(pool: Pool, swept: Result, folder: Path) -> tuple[Picture, ...]:
    """Draw the time of an update against the radius of the ball."""
    from benchmarks.tracking.pictures import times_over_radius

    levels = {name: swept[name].median_us for name in (CONVERSION, COPY)}
    times_over_radius(np.array(pool.radii), swept[UPDATE].by_place_us(), levels, UPDATE, folder / "time.png")
    return (Picture("time.png", "Time of one update against the radius of the ball"),)


def _method(pool: Pool) -> str:
    method = (stopwatch.__doc__ or "").partition("\n\n")[2]
    size = pool.frames[0].image.nbytes / 1e6
    return (
        f"{method}\nFrames: {len(pool.frames)} different ones of {size:.2f} MB, `typical`, in which r falls "
        f"from {max(pool.radii):.0f} to {min(pool.radii):.0f} px and the ball moves up to 10 px a frame; "
        "default settings; one thread. *Misses*: calls that were not answered."
    )
