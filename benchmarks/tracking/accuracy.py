"""How exact: the error of Eq. 10 on rendered sequences, from one click, on seeds the tuning never saw."""

import math
from collections.abc import Sequence
from pathlib import Path

from benchmarks.figures.kept import draw_kept
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Picture, Section, table
from benchmarks.tracking.trial import SEQUENCES, Trial, trials
from matchset.app.track.score import Score, TruthRow, score

# sequence: mean error and share of valid frames asked for, then those hoped for
GOALS = {
    "clean": ((0.25, 99.0), (0.1, 100.0)),
    "typical": ((0.6, 98.0), (0.3, 100.0)),
    "bad": ((1.2, 95.0), (0.6, 100.0)),
    "hard": ((0.9, 99.0), (0.5, 100.0)),
}
WHAT = {
    "clean": "rendered `clean`, one click",
    "typical": "rendered `typical`, one click",
    "bad": "rendered `bad`, one click",
    "hard": "`typical`, a fifth occluded, blue clutter, light × 2, motion blur, JPEG 40",
}


def run(options: Options) -> Section:
    """Follow every sequence and hold the scores against the goals."""
    findings, tables = [], []
    for name in SEQUENCES:
        runs = trials(name, options)
        findings.append(accuracy_finding(name, pooled(runs)))
        tables.append(f"\n**{name}**, seed by seed\n\n" + _table(runs))
    seeds = ", ".join(str(trial.seed) for trial in runs)
    text = (
        f"Seeds {seeds}; {len(runs[0].truths)} frames each. Seeds 0-9 served for tuning and are not among "
        "them. The color is learned from one click in the first frame; after it the tracker gets no help. "
        "*Mean*, *median* and *95 %* are of |Δx| + |Δy| + |Δr| over answered frames; *valid*: answered with "
        "an error below 5 px, of all frames with the ball visible; the other columns are defined in "
        "`matchset.app.track.score`.\n\n" + _table_of(findings) + "".join(tables)
    )
    pictures = () if options.pictures is None else draw_errors(options, options.pictures)
    return Section("Accuracy", findings, text, pictures)


def draw_errors(options: Options, folder: Path) -> tuple[Picture, ...]:
    """Draw the error over the frames of one sequence of each kind, and the histogram of all."""
    runs = {name: trials(name, options) for name in SEQUENCES}
    radii = [truth.circle[2] if truth.circle else math.nan for truth in runs["typical"][0].truths]
    first = {name: run[0].errors for name, run in runs.items()}
    draw_kept(folder, "error", "errors over frames", {"errors": first, "radii": radii, "best": "hard"})
    every = {name: [error for trial in run for error in trial.errors] for name, run in runs.items()}
    draw_kept(folder, "histogram", "error histogram", {"errors": every, "best": "hard"})
    return (
        Picture("error.svg", f"Error over the frames of seed {runs['typical'][0].seed}"),
        Picture("histogram.svg", "How often which error occurs, all seeds"),
    )


def accuracy_finding(name: str, result: Score) -> Finding:
    """Hold the score of a sequence against its goals."""
    goals = [(Goal("mean", high=mean), Goal("valid", low=valid)) for mean, valid in GOALS[name]]
    return Finding(name=name, what=WHAT[name], figures=figures(result), bar=goals[0], prize=goals[1])


def figures(result: Score) -> tuple[Figure, ...]:
    """Name the numbers of a score."""
    return (
        Figure("mean", result.mean_error_px, "px", 3),
        Figure("median", result.median_error_px, "px", 3, aside=True),
        Figure("95 %", result.error_95_px, "px", 3, aside=True),
        Figure("valid", result.valid_percent, "%", 2),
        Figure("lost", result.lost_percent, "%", 2, aside=True),
        Figure("false locks", result.false_locks, "", 0, aside=True),
        Figure("trembling", result.trembling_px, "px", 3, aside=True),
        Figure("jitter", result.jitter_px, "px", 3, aside=True),
    )


def pooled(runs: Sequence[Trial]) -> Score:
    """Score several trials as one: every frame counts the same, and no difference spans two trials.

    Parameters
    ----------
    runs : sequence of Trial

    Returns
    -------
    Score
    """
    answers, truths, begin = {}, [], 0
    for trial in runs:
        for truth, answer in zip(trial.truths, trial.answers, strict=True):
            answers[begin + truth.frame] = answer
            truths.append(TruthRow(begin + truth.frame, truth.circle, truth.lowconf))
        begin += len(trial.truths) + 3
    return score(answers, truths)


def _table_of(findings: Sequence[Finding]) -> str:
    head = ["sequence", *(figure.name for figure in findings[0].figures)]
    return table(head, [[finding.name, *_cells(finding.figures)] for finding in findings])


def _table(runs: Sequence[Trial]) -> str:
    scores = [figures(pooled([trial])) for trial in runs]
    head = ["seed", *(figure.name for figure in scores[0])]
    return table(head, [[str(trial.seed), *_cells(row)] for trial, row in zip(runs, scores, strict=True)])


def _cells(row: Sequence[Figure]) -> list[str]:
    return [figure.text for figure in row]
