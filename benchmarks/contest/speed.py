"""Speed beside what people use: time per frame, against the radius, and against the size of the picture."""

import functools
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import msgspec

import matchset as ms
from benchmarks.common.start import Start
from benchmarks.contest.field import (
    GRAY,
    HEAVY,
    LIGHT,
    NEEDS_WORDS,
    OURS,
    PAPER,
    RIVAL,
    TAGS,
    Peer,
    missing,
    peer,
    present,
)
from benchmarks.contest.run import first_sight, follow_with_all
from benchmarks.contest.tags import TagClip
from benchmarks.figures.kept import draw_kept
from benchmarks.options import Options
from benchmarks.peers.tags import CARDS
from benchmarks.peers.visp import Visp
from benchmarks.results import Figure, Finding, Goal, Picture, Section, table
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.contenders import convert
from benchmarks.tracking.stopwatch import Contender, Times, time_in_pairs
from benchmarks.tracking.trial import sequence
from matchset.sim.clips.clip import Clip

Result = dict[str, Times]

FRAMES, QUICK_FRAMES = 100, 40
RADII = (20, 40, 60, 80, 100, 120)
SIZES = ((320, 240), (640, 480), (1280, 960), (1920, 1080), (3840, 2160))
RADIUS_PX = 60.0
CONVERSION = "cvtColor + inRange"
SHARP = {"low": 0.6, "slack": 80, "opening": 0, "reach": 1.25, "margin": 12.0}
SCALED = (OURS, "region_bgr", "region_moments", "contour_moments", "visp_ellipse", "edge_drawing", "hough_gradient")
"""Those whose time is taken against the radius and against the size of the picture."""


class Pool(msgspec.Struct, frozen=True):
    """Frames after the first, and what everybody is told about the first."""

    start: Start
    frames: list[ms.Frame]

    @classmethod
    def render(cls, clip: Clip | TagClip) -> "Pool":
        """Render a clip."""
        pairs = list(clip)
        return cls(first_sight(*pairs[0]), [frame for frame, _ in pairs[1:]])


def everybody(options: Options) -> tuple[Result, Result]:
    """Time the light peers among themselves and the heavy ones among themselves, matchset in both.

    Returns
    -------
    light, heavy : dict of str to Times
        By the key of the peer.
    """
    return _everybody(options.seeds[0], options.quick)


@functools.cache
def _everybody(seed: int, quick: bool) -> tuple[Result, Result]:
    frames = QUICK_FRAMES if quick else FRAMES
    clip = sequence("typical", seed, frames + 1, shrink_to=20.0)
    pool = Pool.render(clip)
    light = time_in_pairs(
        [*contenders(present(LIGHT), pool), convert(CONVERSION, pool.frames, 0)], laps=2 if quick else 8
    )
    short = Pool(pool.start, pool.frames[: frames // 2])
    heavy = contenders([peer(OURS), *present(HEAVY)], short)
    for each in present(TAGS):
        tags = Pool.render(TagClip(sequence("typical", seed, frames // 2 + 1, shrink_to=40.0), CARDS[each.key]))
        heavy += contenders([each], tags)
    return light, time_in_pairs(heavy, laps=1 if quick else 2, warm_up=3)


def against_radius(options: Options) -> dict[int, Result]:
    """Time some of them on balls of fixed radii, `typical`."""
    count = 20 if options.quick else 60
    results = {}
    for radius in RADII:
        fixed = (float(radius), float(radius))
        pool = Pool.render(sequence("typical", options.seeds[0], count + 1, radii=fixed))
        results[radius] = _scaled(pool, laps=3 if options.quick else 8)
    return results


def head_to_head(options: Options) -> tuple[dict[int, Result], float]:
    """Time matchset, its strongest everyday rival and the conversion, nobody else, on balls of fixed radii.

    The frames are `clean` and the rival's color range is one for such frames: over a link it drifts into the
    background, and what a region costs that has lost the ball says nothing.

    Returns
    -------
    results : dict of int to dict of str to Times
        By radius.
    valid : float
        Frames in which the rival's error was below 5 px, %, where it did worst.
    """
    count = 20 if options.quick else 60
    results, valid = {}, 100.0
    for radius in RADII:
        clip = sharp_clip(options.seeds[0], float(radius), count + 1)
        pool = Pool.render(clip)
        both = contenders([peer(OURS), sharp_rival()], pool)
        results[radius] = time_in_pairs([*both, convert(CONVERSION, pool.frames, 0)], laps=5 if options.quick else 20)
        score = pooled([follow_with_all(iter(clip), None, [sharp_rival()], clip.seed)[RIVAL]])
        valid = min(valid, score.valid_percent or 0.0)
    return results, valid


def sharp_clip(seed: int, radius: float, frames: int) -> Clip:
    """Build the sequence on which the strongest everyday rival is timed: `clean`, the radius fixed."""
    return sequence("clean", seed, frames, radii=(radius, radius))


def sharp_rival() -> Peer:
    """Return the strongest everyday rival with a color range for `clean` frames."""
    rival = peer(RIVAL)
    return msgspec.structs.replace(rival, parameters=type(rival.parameters)(**SHARP))


def against_size(options: Options) -> dict[tuple[int, int], Result]:
    """Time some of them on pictures of several sizes, the ball as large in each, `clean`."""
    results = {}
    for width, height in SIZES[: 3 if options.quick else None]:
        count = max(min(20_000_000 // (width * height), 60), 6)
        fixed = (RADIUS_PX, RADIUS_PX)
        clip = sequence("clean", options.seeds[0], count + 1, width=width, height=height, radii=fixed)
        results[width, height] = _scaled(Pool.render(clip), laps=max(240 // count, 2))
    return results


def _scaled(pool: Pool, laps: int) -> Result:
    """Time the light ones often and the heavy ones once."""
    chosen = present(SCALED)
    light = contenders([each for each in chosen if each.key in LIGHT], pool)
    few = Pool(pool.start, pool.frames[:10])
    heavy = contenders([each for each in chosen if each.key not in LIGHT], few)
    return time_in_pairs([*light, convert(CONVERSION, pool.frames, 0)], laps) | time_in_pairs(heavy, 1, warm_up=2)


def contenders(peers: Iterable[Peer], pool: Pool) -> list[Contender]:
    """Turn peers into contenders; each begins anew at the first frame with each turn through the pool."""
    return [
        Contender(
            name=each.key,
            frames=pool.frames,
            begin=_begin(each, pool.start),
            idle=_pipe_ns if each.key.startswith("visp") else int,
        )
        for each in peers
    ]


def _pipe_ns() -> int:
    return Visp.idle_ns


def _begin(one: Peer, start: Start) -> Callable[[], Callable[[ms.Frame], Any]]:
    def begin() -> Callable[[ms.Frame], Any]:
        step = one.follow(start)
        return lambda frame: step(frame.image)

    return begin


PAPER_FPS = 500


def run(options: Options) -> Section:
    """Race everybody."""
    light, heavy = everybody(options)
    by_radius = against_radius(options)
    by_size = against_size(options)
    rivals, rival_valid = head_to_head(options)
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
            f"r = {RADIUS_PX:.0f} px in all of them\n\n" + scaling_table(sizes),
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
    keys = list(by_radius[RADII[0]])
    radii = {_name(key): [by_radius[radius][key].median_us for radius in RADII] for key in keys}
    axis = {"label": "radius of the ball, px", "log_x": False}
    draw_kept(folder, "time_radius", "times of many", {"xs": list(RADII), "times": radii, **axis})
    sizes = {_name(key): [result[key].median_us for result in by_size.values()] for key in keys}
    axis = {"label": "size of the picture, million px (radius 60 px in all)", "log_x": True}
    draw_kept(folder, "time_size", "times of many", {"xs": list(by_size), "times": sizes, **axis})
    return (
        Picture("time_radius.svg", "Time per frame against the radius of the ball"),
        Picture("time_size.svg", "Time per frame against the size of the picture"),
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
