"""How fast are the other shapes: `Tracker.update` of each family against the conversion and a mask's contour."""

from collections.abc import Callable
from typing import Any

import matchset as ms
from benchmarks import rivals, stopwatch
from benchmarks.finding import Figure, Finding, Goal, Section
from benchmarks.options import Options
from benchmarks.shapes_cases import CASES
from benchmarks.shapes_contours import contour_method
from benchmarks.speed import times_table
from benchmarks.stopwatch import Contender, Times, race

FRAMES, QUICK_FRAMES = 100, 40
LAPS, QUICK_LAPS = 8, 4
UPDATE, CONVERSION, CONTOUR = "Tracker.update", "cvtColor + inRange", "mask, contour, fit"


def run(options: Options) -> Section:
    """Race every family on frames of its own."""
    results = {case: race_of(case, options) for case in CASES}
    findings = [finding(case, result) for case, result in results.items()]
    method = (stopwatch.__doc__ or "").partition("\n\n")[2]
    tables = [f"\n**{case}**\n\n{times_table(result)}" for case, result in results.items()]
    return Section("Speed of other shapes", findings, "\n".join([method, *tables]))


def race_of(case: str, options: Options) -> dict[str, Times]:
    """Race the tracker of a family, the conversion and the contour on the same `typical` frames."""
    count = QUICK_FRAMES if options.quick else FRAMES
    clip = CASES[case].clip("typical", options.seeds[0], count)
    pairs = list(clip)
    frames, (first, outline) = [frame for frame, _ in pairs], pairs[0]
    color = ms.ColorModel.pick(first.image, *clip.first_click)
    found = ms.Tracker(CASES[case].family, color, start=clip.first_click).update(first)
    if not isinstance(found, ms.Track):
        raise RuntimeError(f"{case}: not found in the first frame: {found.reason}")
    method = contour_method(case, first.image, outline)

    def begin() -> Callable[[ms.Frame], Any]:
        tracker: ms.Tracker[Any] = ms.Tracker(CASES[case].family, color)
        tracker.start(found.shape)
        return tracker.update

    contenders = [
        Contender(name=UPDATE, frames=frames, begin=begin),
        rivals.convert(CONVERSION, frames, count // 3),
        Contender(name=CONTOUR, frames=frames, begin=lambda: lambda frame: method(frame.image), offset=2 * count // 3),
    ]
    return race(contenders, count * (QUICK_LAPS if options.quick else LAPS))


def finding(case: str, result: dict[str, Times]) -> Finding:
    """Ratio of the medians to the conversion, and to the contour."""
    ours, conversion, contour = (result[name] for name in (UPDATE, CONVERSION, CONTOUR))
    figures = (
        Figure("ratio", ours.median_us / conversion.median_us, "", 3),
        Figure("of minima", ours.least_us / conversion.least_us, "", 3),
        Figure("median", ours.median_us, "µs", 1),
        Figure("to the contour", ours.median_us / contour.median_us, "", 3),
        Figure("missed", 100.0 * ours.misses / len(ours.ns), "%", 2, aside=True),
    )
    return Finding(
        name=f"speed_shape_{case.replace(' ', '_')}",
        what=f"{case}: `Tracker.update` against {CONVERSION}",
        figures=figures,
        bar=(Goal("ratio", high=0.2), Goal("to the contour", high=1.0)),
        prize=(Goal("ratio", high=0.1), Goal("to the contour", high=1.0)),
    )
