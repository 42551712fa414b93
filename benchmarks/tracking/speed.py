"""How fast: `Tracker.update` and `detect` against converting a frame's color and against copying it."""

from pathlib import Path

from benchmarks.figures.kept import draw_kept
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Picture, Section, table
from benchmarks.tracking import contenders as kinds
from benchmarks.tracking import stopwatch
from benchmarks.tracking.contenders import Pool
from benchmarks.tracking.stopwatch import Times, time_by_turns
from benchmarks.tracking.trial import sequence

Result = dict[str, Times]

RADII = (20, 40, 60, 80, 100, 120)
SIZES = ((3840, 2160), (640, 480))
SIZES_RADIUS = 60.0
UPDATE, DETECT, SEARCH = "Tracker.update", "detect", "Tracker.update, searching in vain"
CONVERSION, COPY = "cvtColor + inRange", "frame.copy()"
CONVERSION_KEPT, COPY_KEPT = "cvtColor + inRange into kept buffers", "copy into a kept buffer"


def sweep_pool(options: Options) -> Pool:
    """Render `typical` frames in which the ball goes from r = 120 to 20 px."""
    frames = 120 if options.quick else 200
    return Pool.render(sequence("typical", options.seeds[0], frames, shrink_to=20.0))


def sweep(pool: Pool, options: Options) -> Result:
    """Race the tracker, while r changes, against both yardsticks, all on the same frame."""
    frames = pool.frames
    contenders = [
        kinds.update(UPDATE, pool),
        kinds.convert(CONVERSION, frames, 0),
        kinds.copy(COPY, frames, 0),
    ]
    return time_by_turns(contenders, len(frames) * _laps(options))


def cold_sweep(pool: Pool, options: Options) -> Result:
    """Race the same, each on a frame that nobody has touched lately, and against kept buffers."""
    frames, count = pool.frames, len(pool.frames)
    contenders = [
        kinds.update(UPDATE, pool),
        kinds.convert(CONVERSION, frames, count // 5),
        kinds.copy(COPY, frames, 2 * count // 5),
        kinds.convert_kept(CONVERSION_KEPT, frames, 3 * count // 5),
        kinds.copy_kept(COPY_KEPT, frames, 4 * count // 5),
    ]
    return time_by_turns(contenders, count * _laps(options))


def alone(pool: Pool, options: Options) -> Result:
    """Time the tracker on the same frames with no one else: its code and its data stay in the cache."""
    return time_by_turns([kinds.update(UPDATE, pool)], len(pool.frames) * _laps(options))


def fixed_radii(options: Options) -> Result:
    """Race trackers of balls of fixed radii, each with frames of its own, and the conversion."""
    count = 40 if options.quick else 100
    pools = {
        f"r = {r}": Pool.render(sequence("typical", options.seeds[0], count, radii=(float(r), float(r)))) for r in RADII
    }
    contenders = [kinds.update(name, pool) for name, pool in pools.items()]
    middle = pools[f"r = {RADII[len(RADII) // 2]}"]
    contenders.append(kinds.convert(CONVERSION, middle.frames, count // 2))
    return time_by_turns(contenders, count * _laps(options))


def resolutions(options: Options) -> Result:
    """Race trackers of balls of equal radius in frames of two sizes; by "640 × 480".

    The large frames are few; the small ones are more, so that they do not stay in the cache.
    """
    contenders = []
    for width, height in SIZES:
        count = 100 if width == SIZES[-1][0] else (10 if options.quick else 20)
        radii = (SIZES_RADIUS, SIZES_RADIUS)
        clip = sequence("clean", options.seeds[0], count, width=width, height=height, radii=radii)
        contenders.append(kinds.update(f"{width} × {height}", Pool.render(clip)))
    return time_by_turns(contenders, 100 * _laps(options))


def whole_frames(pool: Pool, options: Options) -> Result:
    """Race detection in the whole frame, and a search in vain, against the conversion."""
    frames, count = pool.frames, len(pool.frames)
    empty = [frame for frame, _ in sequence("typical", options.seeds[0], count // 2, ball=False)]
    contenders = [
        kinds.detect(DETECT, pool, 0),
        kinds.convert(CONVERSION, frames, count // 2),
        kinds.search(SEARCH, empty, pool.color),
    ]
    return time_by_turns(contenders, count * (2 if options.quick else 5))


def _laps(options: Options) -> int:
    return 5 if options.quick else 12


def run(options: Options) -> Section:
    """Race the tracker against the yardsticks."""
    pool = sweep_pool(options)
    swept = sweep(pool, options)
    cold = cold_sweep(pool, options)
    by_itself = alone(pool, options)
    whole = whole_frames(pool, options)
    fixed = fixed_radii(options)
    sizes = resolutions(options)
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
        "The same frames, nothing else done between them": by_itself,
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
    levels = {name: swept[name].median_us for name in (CONVERSION, COPY)}
    data = {"radii": pool.radii, "times": swept[UPDATE].by_place_us(), "levels": levels, "name": UPDATE}
    draw_kept(folder, "time", "times over radius", data)
    return (Picture("time.svg", "Time of one update against the radius of the ball"),)


def _method(pool: Pool) -> str:
    method = (stopwatch.__doc__ or "").partition("\n\n")[2]
    size = pool.frames[0].image.nbytes / 1e6
    return (
        f"{method}\nFrames: {len(pool.frames)} different ones of {size:.2f} MB, `typical`, in which r falls "
        f"from {max(pool.radii):.0f} to {min(pool.radii):.0f} px and the ball moves up to 10 px a frame; "
        "default settings; one thread. *Misses*: calls that were not answered."
    )
