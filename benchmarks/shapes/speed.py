"""How fast are the other shapes: `Tracker.update` of each family against the conversion and a mask's contour."""

import functools
from collections.abc import Callable
from typing import Any

import msgspec

import matchset as ms
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section
from benchmarks.shapes.accuracy import peers_of
from benchmarks.shapes.cases import CASES
from benchmarks.shapes.trial import CONTOUR, EDGE_DRAWING, EDGE_GRAY, METHODS
from benchmarks.tracking import contenders as kinds
from benchmarks.tracking import stopwatch
from benchmarks.tracking.speed import CONVERSION, UPDATE, Result, against, times_table
from benchmarks.tracking.stopwatch import Contender, time_by_turns

FRAMES, QUICK_FRAMES = 100, 40
LAPS, QUICK_LAPS = 8, 4
NAMES = {CONTOUR: "mask, contour, fit", EDGE_DRAWING: EDGE_DRAWING, EDGE_GRAY: EDGE_GRAY}
AHEAD = {
    "to the contour": NAMES[CONTOUR],
    "to EdgeDrawing": EDGE_DRAWING,
    "to EdgeDrawing, gray": EDGE_GRAY,
}


def run(options: Options) -> Section:
    """Race every family on a sequence of its own, twice: all on the same frame, and each on a frame of its own."""
    findings: list[Finding] = []
    tables: list[str] = []
    for case in CASES:
        same, cold = races_of(case, options)
        name, what = f"speed_shape_{case.replace(' ', '_')}", f"{case}: `Tracker.update`"
        unseen = f"{case}: the same, on frames that nobody has touched lately"
        findings += [finding(name, what, same, cold), against(f"{name}_cold", unseen, cold, (UPDATE, CONVERSION), None)]
        tables += [f"\n**{case}, all on the same frame**\n\n{times_table(same)}"]
        tables += [f"\n**{case}, each on a frame of its own**\n\n{times_table(cold)}"]
    method = (stopwatch.__doc__ or "").partition("\n\n")[2]
    return Section("Speed of other shapes", findings, "\n".join([method, *tables]))


def races_of(case: str, options: Options) -> tuple[Result, Result]:
    """Race the tracker of a family and the conversion on the same `typical` frame; then, with its rivals, on others.

    A rival that reads all of a frame leaves nothing of the tracker in the cache, so none is in the first race.
    """
    count = QUICK_FRAMES if options.quick else FRAMES
    clip = CASES[case].clip("typical", options.seeds[0], count)
    pairs = list(clip)
    frames, (first, outline) = [frame for frame, _ in pairs], pairs[0]
    color = ms.ColorModel.pick(first.image, *clip.first_click, ball=False)
    found = ms.Tracker(CASES[case].family, color, start=clip.first_click).update(first)
    if not isinstance(found, ms.Track):
        raise RuntimeError(f"{case}: not found in the first frame: {found.reason}")

    def begin() -> Callable[[ms.Frame], Any]:
        tracker: ms.Tracker[Any] = ms.Tracker(CASES[case].family, color)
        tracker.start(found.shape)
        return tracker.update

    def contenders(apart: int) -> list[Contender]:
        theirs = [
            kinds.function(NAMES[peer], frames, functools.partial(METHODS[peer], case, first.image, outline), k * apart)
            for k, peer in enumerate(peers_of(case), 2)
        ]
        return [
            Contender(name=UPDATE, frames=frames, begin=begin),
            kinds.convert(CONVERSION, frames, apart),
            *theirs,
        ]

    steps = count * (QUICK_LAPS if options.quick else LAPS)
    return time_by_turns(contenders(0)[:2], steps), time_by_turns(contenders(count // 5), steps)


def finding(name: str, what: str, same: Result, cold: Result) -> Finding:
    """Hold the ratio of the medians to the conversion's, on the same frame, and to its rivals' against the goals."""
    plain = against(name, what, same, (UPDATE, CONVERSION), (0.2, 0.1))
    rivals_there = [(words, peer) for words, peer in AHEAD.items() if peer in cold]
    more = [Figure(words, cold[UPDATE].median_us / cold[peer].median_us, "", 3) for words, peer in rivals_there]
    ahead = [Goal(words, high=1.0) for words, _ in rivals_there]
    return msgspec.structs.replace(
        plain, figures=(*plain.figures, *more), bar=(*plain.bar, *ahead), prize=(*plain.prize, *ahead)
    )
