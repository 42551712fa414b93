"""How exact are the other shapes: rendered with exact truth, whole and with a third hidden, beside a mask's contour."""

from collections.abc import Iterable

import numpy as np

from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.shapes.cases import CASES, THIRD, Errors
from benchmarks.shapes.ellipses import missing
from benchmarks.shapes.trial import (
    CONTOUR,
    EDGE_DRAWING,
    EDGE_GRAY,
    ShapeTask,
    ShapeTrial,
    follow_all,
    lost_percent,
    mean_error,
    scalar,
)

FRAMES, QUICK_FRAMES = 100, 40
SEEDS = 4
WORLDS = {"typical": ("typical", 0.0), "a third hidden": ("typical", THIRD), "bad": ("bad", 0.0)}
# name of a figure: unit, digits, bar, prize
GOALS: dict[str, tuple[str, int, float, float]] = {
    "center": ("px", 3, 0.5, 0.25),
    "axes": ("px", 3, 0.5, 0.25),
    "angle": ("deg", 3, 1.5, 0.75),
    "corners": ("px", 3, 0.7, 0.3),
    "overlap": ("", 4, 0.97, 0.985),
}


def run(options: Options) -> Section:
    """Follow every shape in every world, and hold the errors against the goals and against the contours."""
    seeds, frames = (options.seeds[:1], QUICK_FRAMES) if options.quick else (options.seeds[:SEEDS], FRAMES)
    keys = [(case, world) for case in CASES for world in WORLDS]
    tasks = [
        ShapeTask(case, *_preset(world, seed, frames), peers=peers_of(case)) for case, world in keys for seed in seeds
    ]
    trials = follow_all(tasks, options.jobs)
    runs = {key: trials[k * len(seeds) : (k + 1) * len(seeds)] for k, key in enumerate(keys)}
    findings = []
    for case in CASES:
        findings += [
            exactness(case, runs[case, "typical"]),
            hidden(case, runs[case, "typical"], runs[case, "a third hidden"]),
        ]
    for world in WORLDS:
        findings.append(against_contours(world, [(case, runs[case, world]) for case in CASES]))
    findings += [
        against_edge_drawing(world, runs["ellipse", world], peer)
        for world in WORLDS
        for peer in (EDGE_DRAWING, EDGE_GRAY)
    ]
    text = (
        f"Seeds {', '.join(map(str, seeds))}, {frames} frames each, 640 × 480, half-width 40-100 px, one click in the "
        "first frame. *Overlap*: common area over joint area. *Hidden*: four fingers cover a third of the outline. The "
        "contour is that of the mask `cvtColor + inRange`, with a range learned inside the true outline of the first "
        "frame, opened, through `fitEllipse`, `minAreaRect`, `approxPolyDP` or the hull. Compared are px (center and "
        "semi-axes, or corners) or the share of the area not in common, in %; who does not answer loses the frame. "
        "EdgeDrawing's ellipse is the one nearest to its last answer, parameters from `benchmarks.shapes.search`.\n\n"
    )
    return Section("Other shapes", findings, text + _table(runs))


def _preset(world: str, seed: int, frames: int) -> tuple[str, int, int, float]:
    preset, share = WORLDS[world]
    return preset, seed, frames, share


def peers_of(case: str) -> tuple[str, ...]:
    """Who else is measured: the contour of a mask, and for an ellipse EdgeDrawing where this OpenCV has it."""
    return (CONTOUR, EDGE_DRAWING, EDGE_GRAY) if case == "ellipse" and not missing() else (CONTOUR,)


def _answers(trials: Iterable[ShapeTrial], peer: str = CONTOUR) -> tuple[list[Errors | None], list[Errors | None]]:
    ours, theirs = [], []
    for trial in trials:
        ours += trial.ours
        theirs += trial.theirs[peer]
    return ours, theirs


def _means(answers: list[Errors | None]) -> dict[str, float]:
    found = [each for each in answers if each is not None]
    return {name: float(np.mean([each[name] for each in found])) for name in found[0]} if found else {}


def exactness(case: str, trials: list[ShapeTrial]) -> Finding:
    """Hold the mean errors of a case against its goals."""
    ours, _ = _answers(trials)
    means = _means(ours)
    figures = [Figure(name, value, GOALS[name][0], GOALS[name][1]) for name, value in means.items()]
    goals = [[_goal(name, GOALS[name][2:][k]) for name in means] for k in (0, 1)]
    lost = Figure("lost", lost_percent(ours), "%", 1)
    return Finding(
        name=f"shape_{case.replace(' ', '_')}",
        what=f"{case}, `typical`",
        figures=(*figures, lost),
        bar=(*goals[0], Goal("lost", high=0.0)),
        prize=(*goals[1], Goal("lost", high=0.0)),
    )


def _goal(name: str, limit: float) -> Goal:
    return Goal(name, low=limit) if name == "overlap" else Goal(name, high=limit)


def hidden(case: str, whole: list[ShapeTrial], covered: list[ShapeTrial]) -> Finding:
    """Compare the error with a third hidden to that without."""
    ours, others = _answers(covered)[0], _answers(whole)[0]
    plain, now = (np.mean([scalar(each) for each in found if each is not None]) for found in (others, ours))
    figures = (
        Figure("times the error", float(now / plain), "", 2),
        Figure("error", float(now), "", 3),
        Figure("lost", lost_percent(ours), "%", 1),
    )
    return Finding(
        name=f"shape_{case.replace(' ', '_')}_hidden",
        what=f"{case}, a third of the outline hidden",
        figures=figures,
        bar=(Goal("times the error", high=2.0), Goal("lost", high=0.0)),
    )


def against_contours(world: str, cases: list[tuple[str, list[ShapeTrial]]]) -> Finding:
    """Share of the frames in which the tracker is nearer to the truth than the contour; of the worst case too."""
    shares = {}
    for case, trials in cases:
        shares[case] = _frames_won(trials, CONTOUR)
    worst = min(shares, key=lambda case: shares[case])
    figures = (
        Figure("frames won", float(np.mean(list(shares.values()))), "%", 1),
        Figure(f"of the worst, {worst}", shares[worst], "%", 1),
    )
    return Finding(
        name=f"shape_contours_{world.replace(' ', '_')}",
        what=f"all shapes against the contour of a mask, {world}",
        figures=figures,
        bar=(Goal(figures[1].name, low=50.0),),
    )


def against_edge_drawing(world: str, trials: list[ShapeTrial], peer: str = EDGE_DRAWING) -> Finding:
    """Share of the frames in which the ellipse is nearer to the truth than EdgeDrawing's; errors where both answer."""
    name = f"shape_edge_{'gray' if peer == EDGE_GRAY else 'drawing'}_{world.replace(' ', '_')}"
    what = f"ellipse against {peer}, {world}"
    if peer not in trials[0].theirs:
        return Finding(name=name, what=f"{what}: skipped, {missing()}", figures=())
    ours, theirs = _answers(trials, peer)
    both = [pair for pair in zip(ours, theirs, strict=True) if None not in pair]
    figures = (
        Figure("frames won", _frames_won(trials, peer), "%", 1),
        Figure("error where both answer", mean_error([one for one, _ in both]), "px", 3),
        Figure("EdgeDrawing's", mean_error([other for _, other in both]), "px", 3),
        Figure("EdgeDrawing lost", lost_percent(theirs), "%", 1),
    )
    return Finding(name=name, what=what, figures=figures, bar=(Goal("frames won", low=50.0),))


def _frames_won(trials: list[ShapeTrial], peer: str) -> float:
    ours, theirs = _answers(trials, peer)
    return 100.0 * float(np.mean([scalar(a) < scalar(b) for a, b in zip(ours, theirs, strict=True)]))


def _table(runs: dict[tuple[str, str], list[ShapeTrial]]) -> str:
    rows = []
    for (case, world), trials in runs.items():
        ours, theirs = _answers(trials)
        rows.append(
            [
                f"{case}, {world}",
                _words(ours),
                f"{lost_percent(ours):.1f}",
                _words(theirs),
                f"{lost_percent(theirs):.1f}",
            ]
        )
        for peer in (each for each in trials[0].theirs if each != CONTOUR):
            _, theirs = _answers(trials, peer)
            rows.append([f"the same, {peer}", "", "", _words(theirs), f"{lost_percent(theirs):.1f}"])
    return table(["shape", "matchset", "lost, %", "contour or EdgeDrawing", "lost, %"], rows)


def _words(answers: list[Errors | None]) -> str:
    return ", ".join(f"{name} {value:.{GOALS[name][1]}f}" for name, value in _means(answers).items()) or "-"
