"""Accuracy beside what people use: every peer on every sequence, from the same first frame."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from benchmarks.contest import run as contest
from benchmarks.contest.field import NEEDS_WORDS, OURS, PAPER, peer
from benchmarks.contest.run import Results
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, quantity, table
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.trial import GONE, WHAT, Trial
from matchset.app.track.score import VALID_BELOW_PX, Score, error_px

NEAR_PX = 0.05
HARD_ONES = ("occlusion", "clutter", "light")
Scores = dict[str, dict[str, Score]]
"""By sequence and peer."""


def run(options: Options) -> Section:
    """Score everybody."""
    results = contest.results(options)
    scores = scored(results)
    findings = [first_finding(scores), valid_finding(scores), paper_finding(scores)]
    tables = [f"\n**{title}**\n\n{matrix(scores, show)}" for title, show in COLUMNS.items()]
    seeds = ", ".join(str(trial[OURS].seed) for trial in results["clean"])
    lines = "\n".join(f"- `{name}`: {what}" for name, what in WHAT.items())
    text = (
        f"Seeds {seeds}, {len(results['clean'][0][OURS].truths)} frames each after the first. Everybody is told the "
        "truth of the first frame, as far as he needs it, and nothing after that; matchset is told a click. The peers' "
        "parameters are the best that a search found on seeds 0-9 (`benchmarks/contest/search.py`, "
        "`benchmarks/peers/parameters.toml`); matchset has its defaults. *Told nothing but the color* are detectors: "
        "they look at every frame anew, find a ball without being started, and cannot drift.\n\n"
        f"{lines}\n" + "".join(tables) + "\n**Frames until found again**, mean over the returns, after the ball had "
        "left or was hidden; in brackets how often it was not found\n\n" + again_table(results)
    )
    return Section("Accuracy beside what people use", findings, text)


def scored(results: Mapping[str, Sequence[Results]]) -> Scores:
    """Score each peer on each sequence, all seeds as one."""
    return {name: {key: pooled([run[key] for run in runs]) for key in runs[0]} for name, runs in results.items()}


def first_finding(scores: Scores) -> Finding:
    """How far matchset's mean error lies behind the best of those that answer in all frames, at worst."""
    behind = {}
    for name, row in scores.items():
        always = [s.mean_error_px for key, s in row.items() if key != OURS and s.visible and not s.lost]
        means = [mean for mean in always if mean is not None]
        ours = row[OURS].mean_error_px
        if means and ours is not None:
            behind[name] = ours - min(means)
    worst = max(behind, key=lambda name: behind[name])
    return Finding(
        name="first_in_accuracy",
        what="mean error less that of the best peer that answers in all frames, on the worst sequence for matchset: "
        f"`{worst}`",
        figures=(
            Figure("difference", behind[worst], "px", 3),
            Figure("first on", sum(value <= 0.0 for value in behind.values()), f"of {len(behind)} sequences", 0),
        ),
        bar=(Goal("difference", high=NEAR_PX),),
        prize=(Goal("difference", high=0.0),),
    )


def valid_finding(scores: Scores) -> Finding:
    """Percentage valid under occlusion, clutter and changing light, against the best of the others in each."""
    leads, figures = [], []
    for name in HARD_ONES:
        ours = scores[name][OURS].valid_percent or 0.0
        best = max(s.valid_percent or 0.0 for key, s in scores[name].items() if key != OURS)
        leads.append(ours - best)
        figures += [Figure(name, ours, "%", 2), Figure(f"best other, {name}", best, "%", 2)]
    return Finding(
        name="valid_in_the_hard_ones",
        what="valid under occlusion, among clutter, in changing light; *lead*: over the best peer, least of the three",
        figures=(Figure("lead", min(leads), "%", 2), *figures),
        bar=(Goal("lead", low=0.0),),
        prize=tuple(Goal(name, low=100.0) for name in HARD_ONES),
    )


def paper_finding(scores: Scores) -> Finding:
    """Count the sequences on which matchset is more exact than the paper's algorithm, and no less valid."""
    names = [name for name, row in scores.items() if PAPER in row and row[PAPER].tight]
    ahead = [
        name
        for name in names
        if (scores[name][OURS].mean_error_px or np.inf) < (scores[name][PAPER].mean_error_px or np.inf)
        and (scores[name][OURS].valid_percent or 0.0) >= (scores[name][PAPER].valid_percent or 0.0)
    ]
    ours, theirs = scores["typical"][OURS], scores["typical"][PAPER]
    return Finding(
        name="paper_accuracy",
        what="the paper to the letter on the same frames: sequences on which matchset is more exact and no less valid",
        figures=(
            Figure("ahead on", len(ahead), f"of {len(names)}", 0),
            Figure("mean, typical", ours.mean_error_px, "px", 2),
            Figure("the paper's", theirs.mean_error_px, "px", 2),
        ),
        bar=(Goal("ahead on", low=float(len(names))),),
    )


def _px(value: float | None) -> str:
    return quantity(value, "", 2)


COLUMNS: dict[str, Callable[[Score], str]] = {
    "Mean error, px, over answered frames": lambda s: _px(s.mean_error_px),
    "Median error, px": lambda s: _px(s.median_error_px),
    "95 % of the errors below, px": lambda s: _px(s.error_95_px),
    "Valid, % of all frames with the ball well visible": lambda s: quantity(s.valid_percent, "", 1),
    "Not answered, % of the frames with the ball visible": lambda s: quantity(s.lost_percent, "", 1),
    "Trembling, px": lambda s: _px(s.trembling_px),
    "False locks, frames": lambda s: str(s.false_locks),
}


def matrix(scores: Scores, show: Callable[[Score], str]) -> str:
    """Write one figure of all peers on all sequences."""
    keys = list(scores["clean"])
    rows = []
    for key in keys:
        one = peer(key)
        cells = [show(row[key]) if key in row else "-" for row in scores.values()]
        rows.append([f"{one.name}{' (d)' if one.detects and key != OURS else ''}", *cells])
    return table(["(d): a detector, needs no start", *scores], rows)


def again_table(results: Mapping[str, Sequence[Results]]) -> str:
    """Write how soon everybody finds the ball again."""
    rows = []
    for key in results["return"][0]:
        cells = []
        for name in GONE:
            waits = [wait for run in results[name] for wait in waits_of(run[key], GONE[name])]
            found = [wait for wait in waits if wait is not None]
            mean = f"{np.mean(found):.1f}" if found else "-"
            cells.append(f"{mean} ({len(waits) - len(found)} of {len(waits)})")
        rows.append([peer(key).name, NEEDS_WORDS[peer(key).needs], *cells])
    return table(["", "is told", "`return`", "`hidden`"], rows)


def waits_of(trial: Trial, gone: Sequence[tuple[int, int]]) -> list[int | None]:
    """Frames until a valid answer after each window in which the ball is gone; None: not before the next one.

    Counted are frames with the ball well visible; 1: the first of them.
    """
    last = trial.truths[-1].frame
    untils = [*(begin for begin, _ in gone[1:]), last + 1]
    waits: list[int | None] = []
    for (_, end), until in zip(gone, untils, strict=True):
        if end > last:
            break
        seen, found = 0, None
        for truth, answer in zip(trial.truths, trial.answers, strict=True):
            if not end <= truth.frame < until or not truth.tight or truth.circle is None:
                continue
            seen += 1
            if answer and error_px(answer, truth.circle) < VALID_BELOW_PX:
                found = seen
                break
        waits.append(found)
    return waits
