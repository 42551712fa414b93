"""Speed beside what people use: time per frame, against the radius, and against the size of the picture."""

from collections.abc import Mapping
from pathlib import Path

from benchmarks.contest import times as contest_times
from benchmarks.contest.field import GRAY, HEAVY, LIGHT, NEEDS_WORDS, OURS, PAPER, RIVAL, TAGS, missing, peer
from benchmarks.contest.times import CONVERSION, RADII, Result
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Picture, Section, table
from benchmarks.tracking.stopwatch import Times

PAPER_FPS = 500


def run(options: Options) -> Section:
    """Race everybody."""
    light, heavy = contest_times.everybody(options)
    by_radius = contest_times.against_radius(options)
    by_size = contest_times.against_size(options)
    rivals, rival_valid = contest_times.head_to_head(options)
    findings = [rival_finding(rivals, rival_valid), gray_finding(heavy), fps_finding(light), paper_finding(heavy)]
    named = {f"r = {radius}": result for radius, result in by_radius.items()}
    pairs = {f"r = {radius}": result for radius, result in rivals.items()}
    sizes = {f"{width} × {height}": result for (width, height), result in by_size.items()}
    text = "\n".join(
        [
            _method(),
            "\n**The light ones, `typical`, r 120-20**\n\n" + times_table(light),
            "\n**The heavy ones, the same frames (tag systems: their cards on the same path)**\n\n"
            + times_table(heavy),
            "\n**Head to head**: matchset, its strongest everyday rival and a conversion of the whole frame by turns, "
            "nobody else; median (minimum), µs, `clean`, where the rival holds the ball\n\n" + scaling_table(pairs),
            "\n**Against the radius**, all of these by turns; median (minimum), µs, `typical`\n\n"
            + scaling_table(named),
            f"\n**Against the size of the picture**, median (minimum), µs, `clean`, "
            f"r = {contest_times.RADIUS_PX:.0f} px in all of them\n\n" + scaling_table(sizes),
        ]
    )
    pictures: tuple[Picture, ...] = ()
    if options.pictures is not None:
        pictures = _draw(by_radius, {w * h / 1e6: result for (w, h), result in by_size.items()}, options.pictures)
    return Section("Speed beside what people use", findings, text, pictures)


def ratio(theirs: Times, ours: Times) -> tuple[float, float]:
    """How many times as long they take: of medians, of minima."""
    return theirs.median_us / ours.median_us, theirs.least_us / ours.least_us


def rival_finding(by_radius: Mapping[int, Result], rival_valid: float) -> Finding:
    """Hold matchset against its strongest everyday rival at every radius; the least favorable one counts."""
    ratios = {radius: ratio(result[RIVAL], result[OURS]) for radius, result in by_radius.items()}
    return Finding(
        name="rival_speed",
        what="region + BGR inRange + contour takes so many times as long as `Tracker.update`, least of r 20-120",
        figures=(
            Figure("ratio", min(each[0] for each in ratios.values()), "", 2),
            Figure("of minima", min(each[1] for each in ratios.values()), "", 2),
            *(Figure(f"r = {radius}", each[0], "", 2) for radius, each in ratios.items()),
            Figure("rival valid", rival_valid, "%", 0),
        ),
        bar=(Goal("ratio", low=1.0),),
        prize=(Goal("ratio", low=3.0),),
    )


def gray_finding(heavy: Result) -> Finding:
    """Hold matchset against EdgeDrawing, Hough and AprilTag on the whole gray frame; the fastest of them counts."""
    ratios = {key: ratio(heavy[key], heavy[OURS]) for key in (*GRAY, "april_tag") if key in heavy}
    return Finding(
        name="gray_speed",
        what="detectors on the gray whole frame take so many times as long, the fastest of them",
        figures=(
            Figure("ratio", min(each[0] for each in ratios.values()), "", 0),
            Figure("of minima", min(each[1] for each in ratios.values()), "", 0),
            *(Figure(key, each[0], "", 0) for key, each in ratios.items()),
        ),
        bar=(Goal("ratio", low=50.0),),
        prize=(Goal("ratio", low=200.0),),
    )


def fps_finding(light: Result) -> Finding:
    """Set frames per second on one core beside the paper's."""
    ours = light[OURS]
    return Finding(
        name="fps",
        what=f"frames per second on one core, others in between (the paper: {PAPER_FPS} on a laptop of 2014)",
        figures=(
            Figure("of the median", 1e6 / ours.median_us, "", 0),
            Figure("of the minimum", 1e6 / ours.least_us, "", 0),
        ),
        bar=(Goal("of the median", low=float(PAPER_FPS)),),
    )


def paper_finding(heavy: Result) -> Finding:
    """Hold matchset against the paper's algorithm, as printed and in NumPy."""
    medians, minima = ratio(heavy[PAPER], heavy[OURS])
    return Finding(
        name="paper_speed",
        what="the paper to the letter, in NumPy, takes so many times as long",
        figures=(Figure("ratio", medians, "", 0), Figure("of minima", minima, "", 0)),
        bar=(Goal("ratio", low=1.0),),
    )


def times_table(result: Result) -> str:
    """Write the times of everybody, the fastest first."""
    ours = result[OURS]
    rows = []
    for key, times in sorted(result.items(), key=lambda item: item[1].median_us):
        name, needs = (key, "-") if key == CONVERSION else (peer(key).name, NEEDS_WORDS[peer(key).needs])
        medians, minima = ratio(times, ours)
        numbers = [f"{v:,.1f}" for v in (times.median_us, times.least_us)] + [f"{medians:.2f}", f"{minima:.2f}"]
        answered = 100.0 * (1.0 - times.misses / len(times.ns))
        rows.append([name, *numbers, f"{1e6 / times.median_us:,.0f}", f"{answered:.0f} %", needs])
    head = ["", "median, µs", "minimum", "× matchset", "of minima", "per second", "answered", "is told"]
    return table(head, rows)


def scaling_table(named: Mapping[str, Result]) -> str:
    """Write the times of some at several radii or sizes."""
    keys = list(next(iter(named.values())))
    rows = [
        [_name(key), *(f"{result[key].median_us:,.0f} ({result[key].least_us:,.0f})" for result in named.values())]
        for key in keys
    ]
    return table(["", *named], rows)


def _name(key: str) -> str:
    return key if key == CONVERSION else peer(key).name


def _draw(by_radius: Mapping[int, Result], by_size: Mapping[float, Result], folder: Path) -> tuple[Picture, ...]:
    from benchmarks.contest.pictures import times_over

    keys = list(by_radius[RADII[0]])
    radii = {_name(key): [by_radius[radius][key].median_us for radius in RADII] for key in keys}
    times_over(list(RADII), radii, "radius of the ball, px", folder / "time_radius.png")
    sizes = {_name(key): [result[key].median_us for result in by_size.values()] for key in keys}
    times_over(list(by_size), sizes, "size of the picture, million px (r = 60 px in all)", folder / "time_size.png")
    return (
        Picture("time_radius.png", "Time per frame against the radius of the ball"),
        Picture("time_size.png", "Time per frame against the size of the picture"),
    )


def _method() -> str:
    absent = [f"{key}: {reason}" for key in (*LIGHT, *HEAVY, *TAGS) if (reason := missing(key))]
    return (
        "Everybody works on the same frame, one after the other, in an order that is drawn anew for each frame, on one "
        "thread; those under about a millisecond among themselves, the others among themselves, matchset in both "
        "races. Each is told the truth of the first frame only. A peer that has lost the ball is timed as it is: see "
        "*answered*. ViSP runs in a process of its own; the way to it and back is not counted."
        + (f" Not run here: {'; '.join(absent)}." if absent else "")
    )
