"""Figures of runs on real clips: the standard click, all starts together, radius and covariance."""

from collections.abc import Mapping, Sequence

import msgspec
import numpy as np
from scipy.stats import chi2

from benchmarks.real.clips import Clip
from benchmarks.real.following import Run
from benchmarks.real.starts import BEGINNINGS, CLICKS
from benchmarks.results import Figure, Finding, Goal, table
from benchmarks.tracking.covariance import FREEDOM, LEVEL
from matchset.app.track.score import Score

CLIP_BAR = (Goal("valid", low=95.0), Goal("mean", high=1.3))
CLIP_PRIZE = (Goal("valid", low=99.0), Goal("mean", high=0.9))
ALL_BAR = (Goal("mean valid", low=95.0), Goal("least valid", low=90.0), Goal("mean of means", high=1.3))
ALL_PRIZE = (Goal("mean valid", low=99.0), Goal("least valid", low=99.0), Goal("mean of means", high=0.9))
STARTS_BAR = (Goal("mean valid", low=94.0), Goal("nothing", high=1.0))
COVARIANCE_BAR = (Goal("below", low=80.0),)
COVARIANCE_PRIZE = (Goal("below", low=88.0, high=99.0),)
LABEL_SIGMA = 0.5
"""Standard deviation of a label where the ball is sharp, px, of x, y and r each (`../shared/data/README.md`)."""

Runs = Mapping[str, Sequence[Run]]


class Offsets(msgspec.Struct, frozen=True):
    """Errors of a run's answered tight rows.

    Parameters
    ----------
    radius : list of float
        r - r*, px.
    squares : list of float
        Normalized error squared with the covariance of the track and the variance of the label.
    """

    radius: list[float]
    squares: list[float]


def standard_findings(clips: Sequence[Clip], runs: Runs) -> list[Finding]:
    """Hold the standard click of each clip, and all of them together, against the goals."""
    scores = {clip.name: standard_of(runs[clip.name]).score(clip) for clip in clips}
    findings = [
        Finding(
            name=f"real_{name}",
            what=f"`{name}`, one click at (x - r/2, y) of the first tight row",
            figures=standard_figures(each),
            bar=CLIP_BAR,
            prize=CLIP_PRIZE,
        )
        for name, each in scores.items()
    ]
    valid = [each.valid_percent or 0.0 for each in scores.values()]
    means = [each.mean_error_px for each in scores.values() if each.mean_error_px is not None]
    together = Finding(
        name="real_standard",
        what=f"{len(clips)} real clips, one click each: valid frames and error, each clip counting the same",
        figures=(
            Figure("mean valid", float(np.mean(valid)), "%", 1),
            Figure("least valid", min(valid), "%", 1),
            Figure("mean of means", float(np.mean(means)) if means else None, "px", 2),
            Figure("far answers", sum(each.false_locks for each in scores.values()), "", 0),
        ),
        bar=ALL_BAR,
        prize=ALL_PRIZE,
    )
    return [together, *findings]


def standard_of(runs: Sequence[Run]) -> Run:
    """Return the run of the standard click."""
    return next(run for run in runs if run.start.standard)


def standard_figures(result: Score) -> tuple[Figure, ...]:
    """Name the numbers of one run."""
    return (
        Figure("valid", result.valid_percent, "%", 1),
        Figure("mean", result.mean_error_px, "px", 2),
        Figure("median", result.median_error_px, "px", 2, aside=True),
        Figure("lost", result.lost, "", 0),
        Figure("far answers", result.false_locks, "", 0),
    )


def standard_table(clips: Sequence[Clip], runs: Runs) -> str:
    """Write the runs of the standard click as a table."""
    head = ["clip", "tight rows", "valid", "mean", "median", "lost", "of visible", "answers on absent", "of", "far"]
    rows = []
    for clip in clips:
        run = standard_of(runs[clip.name])
        result = run.score(clip)
        absent = answers_on_absent(run, clip)
        words = {figure.name: figure.text for figure in standard_figures(result)}
        rows.append(
            [
                clip.name,
                str(result.tight),
                *(words[name] for name in ("valid", "mean", "median", "lost")),
                *(str(count) for count in (result.visible, absent, result.absent, result.false_locks - absent)),
            ]
        )
    return table(head, rows)


def answers_on_absent(run: Run, clip: Clip) -> int:
    """Count the answers in frames that are known not to show the ball."""
    return sum(run.answers.get(row.frame) is not None for row in clip.truths if row.circle is None)


def starts_finding(clips: Sequence[Clip], runs: Runs) -> Finding:
    """Hold the distribution over all starts of all clips against the goals."""
    every = [(clip, run) for clip in clips for run in runs[clip.name]]
    return Finding(
        name="real_starts",
        what=f"{len(clips)} real clips, {len(every)} clicks and frames to begin at: valid frames of each",
        figures=distribution(every),
        bar=STARTS_BAR,
    )


def distribution(every: Sequence[tuple[Clip, Run]]) -> tuple[Figure, ...]:
    """Name the numbers of a sample of runs; one that gave nothing has 0 % valid frames."""
    valid = np.array([run.score(clip).valid_percent or 0.0 for clip, run in every])
    nothing = [run.nothing for _, run in every]
    return (
        Figure("mean valid", float(valid.mean()), "%", 1),
        Figure("10 % quantile", float(np.quantile(valid, 0.1)), "%", 1),
        Figure("nothing", 100.0 * float(np.mean(nothing)), "%", 1),
        Figure("refused", sum(bool(run.refusal) for _, run in every), "", 0, aside=True),
        Figure("far answers", sum(run.score(clip).false_locks for clip, run in every), "", 0),
    )


def starts_table(clips: Sequence[Clip], runs: Runs) -> str:
    """Write the distribution of each clip as a table."""
    rows = []
    for clip in clips:
        every = [(clip, run) for run in runs[clip.name]]
        means = [run.score(clip).mean_error_px for _, run in every]
        known = [mean for mean in means if mean is not None]
        worst = min(runs[clip.name], key=lambda run, clip=clip: run.score(clip).valid_percent or 0.0)  # type: ignore[misc]
        found = distribution(every)
        rows.append(
            [
                clip.name,
                str(len(every)),
                *(figure.text for figure in found),
                f"{np.median(known):.2f} px" if known else "-",
                f"click {worst.start.click}, start {worst.start.beginning}",
            ]
        )
    names = [figure.name for figure in found]
    return table(["clip", "starts", *names, "median of means", "worst"], rows)


def places_table(clips: Sequence[Clip], runs: Runs) -> str:
    """Write the mean share of valid frames of each place of a click, and of each frame to begin at, as a table."""
    rows = []
    for clip in clips:
        scored = [(run.start, run.score(clip).valid_percent or 0.0) for run in runs[clip.name]]
        by_click = [[valid for start, valid in scored if start.click == k] for k in range(len(CLICKS))]
        by_frame = [[valid for start, valid in scored if start.beginning == k] for k in range(BEGINNINGS)]
        cells = [f"{np.mean(values):.0f} %" if values else "-" for values in (*by_click, *by_frame)]
        rows.append([clip.name, *cells])
    head = ["clip", *(f"{k}: ({x:+.1f}, {y:+.1f})" for k, (x, y) in enumerate(CLICKS))]
    return table([*head, *(f"start {k}" for k in range(BEGINNINGS))], rows)


def offsets_of(run: Run, clip: Clip) -> Offsets:
    """Compare the answers of a run with the tight rows of its clip."""
    radius, squares = [], []
    for row in clip.tight:
        answer = run.answers.get(row.frame)
        if answer is None or row.circle is None:
            continue
        error = np.subtract(answer, row.circle)
        whole = np.array(run.covariances[row.frame]) + LABEL_SIGMA**2 * np.eye(3)
        radius.append(float(error[2]))
        squares.append(float(error @ np.linalg.solve(whole, error)))
    return Offsets(radius, squares)


def offset_figures(offsets: Sequence[Offsets]) -> tuple[Figure, ...]:
    """Name the numbers of some runs' errors."""
    radius = np.array([value for each in offsets for value in each.radius])
    squares = np.array([value for each in offsets for value in each.squares])
    some = len(squares) > 0
    limit = chi2.ppf(LEVEL, FREEDOM)
    return (
        Figure("below", 100.0 * float((squares < limit).mean()) if some else None, "%", 1),
        Figure("median square", float(np.median(squares)) if some else None, "", 2),
        Figure("mean radius error", float(radius.mean()) if some else None, "px", 2),
        Figure("median radius error", float(np.median(radius)) if some else None, "px", 2, aside=True),
        Figure("rows", len(squares), "", 0, aside=True),
    )


def covariance_finding(clips: Sequence[Clip], runs: Runs) -> Finding:
    """Hold the normalized errors squared of all standard clicks against the goals."""
    return Finding(
        name="real_covariance",
        what=f"{len(clips)} real clips, one click each: normalized error squared below the 95 % quantile, radius",
        figures=offset_figures([offsets_of(standard_of(runs[clip.name]), clip) for clip in clips]),
        bar=COVARIANCE_BAR,
        prize=COVARIANCE_PRIZE,
    )


def covariance_table(clips: Sequence[Clip], runs: Runs) -> str:
    """Write radius and covariance of each clip as a table, over the standard click."""
    found = {clip.name: offset_figures([offsets_of(standard_of(runs[clip.name]), clip)]) for clip in clips}
    head = ["clip", *(figure.name for figure in next(iter(found.values())))]
    return table(head, [[name, *(figure.text for figure in figures)] for name, figures in found.items()])
