"""The contest in one table and one picture: what the README shows."""

from collections.abc import Mapping, Sequence

from benchmarks.contest import run as contest
from benchmarks.contest import speed as contest_times
from benchmarks.contest.field import LIGHT, OURS, peer
from benchmarks.contest.run import Results
from benchmarks.contest.search import loss_px
from benchmarks.options import Options
from benchmarks.results import Picture, Section, quantity, table
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.trial import WHAT

TITLE = "In one table"
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
    tight = sum(scores[name].tight for name in BALLS)
    valid = 100.0 * sum(scores[name].valid for name in BALLS) / max(tight, 1)
    false = sum(score.false_locks for score in scores.values())
    return [*medians, f"{valid:.1f} %", str(false)]


def _draw(results: Mapping[str, Sequence[Results]], options: Options) -> tuple[Picture, ...]:
    from benchmarks.contest.pictures import accuracy_over_speed

    light, heavy = contest_times.everybody(options)
    times = {key: each.median_us for key, each in (heavy | light).items()}
    points = {}
    for key in results["clean"][0]:
        points[peer(key).name] = (times[key], loss_px([run[key] for name in BALLS for run in results[name]]))
    assert options.pictures is not None
    accuracy_over_speed(points, options.pictures / "accuracy_speed.png")
    return (Picture("accuracy_speed.png", "Accuracy against speed, all sequences with a ball"),)
