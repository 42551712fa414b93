"""The contest in one table and one picture: what the README shows."""

from collections.abc import Mapping, Sequence

from benchmarks.contest import run as contest
from benchmarks.contest import speed as contest_times
from benchmarks.contest.field import LIGHT, OURS, peer
from benchmarks.contest.run import Results
from benchmarks.figures.kept import draw_kept
from benchmarks.options import Options
from benchmarks.results import Picture, Section, quantity, table
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.trial import WHAT

TITLE = "In one table"
NAMED = (
    "matchset",
    "region + HSV mask, contour, moments",
    "hobby recipe: blur, HSV, inRange, minEnclosingCircle",
    "ViSP vpMeEllipse",
    "scikit-image: RANSAC CircleModel on the contour",
    "EdgeDrawing (EDCircles), gray whole frame",
    "HoughCircles (gradient), gray whole frame",
    "CSRT",
    "the paper to the letter (NumPy)",
)
"""Whose names stand in the figure."""

BALLS = tuple(name for name in WHAT if name != "empty")


def run(options: Options) -> Section:
    """Set speed and accuracy of everybody side by side."""
    results = contest.results(options)
    light, heavy = contest_times.everybody(options)
    rows = []
    for key in results["clean"][0]:
        timed = light if key in LIGHT else heavy
        times = timed[key].median_us
        ours = timed[OURS].median_us
        shown = [f"{times:,.0f} µs", f"{ours:,.0f} µs", f"{times / ours:,.1f}"]
        rows.append([peer(key).name, *shown, *_exactness(results, key)])
    head = [
        "",
        "time",
        "matchset beside it",
        "× ours",
        "error, `clean`",
        "`typical`",
        "`bad`",
        "`hard`",
        "valid, all sequences",
        "false locks",
    ]
    text = (
        table(head, rows)
        + "\nTime: median of a 640 × 480 frame, one core, all by turns on the same frames; the light and heavy ones "
        "in a race each, with matchset in both. Error: median of "
        "|Δx| + |Δy| + |Δr| over the frames that were answered, px. Valid: answered with an error below 5 px, of all "
        f"frames with the ball well visible, in {len(BALLS)} kinds of sequences. False locks: frames answered with "
        "something else than the ball, in those and in one kind without a ball.\n"
    )
    pictures = () if options.pictures is None else _draw(results, options)
    return Section(TITLE, [], text, pictures)


def _exactness(results: Mapping[str, Sequence[Results]], key: str) -> list[str]:
    """Median error on the four main sequences, percentage valid on all, false locks."""
    scores = {name: pooled([run[key] for run in runs if key in run]) for name, runs in results.items()}
    medians = [quantity(scores[name].median_error_px, "px", 2) for name in ("clean", "typical", "bad", "hard")]
    false = sum(score.false_locks for score in scores.values())
    return [*medians, f"{_valid_percent(results, key):.1f} %", str(false)]


def _valid_percent(results: Mapping[str, Sequence[Results]], key: str) -> float:
    """Percentage of the frames with the ball well visible that are right, on all sequences with a ball."""
    scores = [pooled([run[key] for run in results[name] if key in run]) for name in BALLS]
    return 100.0 * sum(score.valid for score in scores) / max(sum(score.tight for score in scores), 1)


def _draw(results: Mapping[str, Sequence[Results]], options: Options) -> tuple[Picture, ...]:
    light, heavy = contest_times.everybody(options)
    times = {key: each.median_us for key, each in (heavy | light).items()}
    points = {}
    for key in results["clean"][0]:
        points[peer(key).name] = (times[key], _valid_percent(results, key))
    assert options.pictures is not None
    draw_kept(options.pictures, "accuracy_speed", "valid over time", {"points": points, "named": NAMED})
    return (Picture("accuracy_speed.svg", "Frames that are right against the time of one, all sequences with a ball"),)
