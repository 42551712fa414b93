"""Is the covariance honest: the normalized error squared against the chi-square distribution."""

import numpy as np
from scipy.stats import chi2

from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.tracking.trial import PRESETS, SEQUENCES, Trial, trials

FREEDOM = 3
LEVEL = 0.95
BAR = (Goal("below", low=88.0, high=99.0), Goal("mean", low=1.5, high=4.8))
PRIZE = (Goal("below", low=93.0, high=97.0), Goal("mean", low=1.5, high=4.8))


def run(options: Options) -> Section:
    """Compare the errors of every sequence with the covariance that the tracker claims."""
    findings = [_finding(name, trials(name, options)) for name in SEQUENCES]
    head = ["sequence", *(figure.name for figure in findings[0].figures)]
    rows = [
        [name, *(figure.text for figure in finding.figures)] for name, finding in zip(SEQUENCES, findings, strict=True)
    ]
    text = (
        "e = answer - truth, P the covariance of the answer: eᵀP⁻¹e of an honest tracker follows chi-square "
        f"with {FREEDOM} degrees of freedom: 95 % lie below {chi2.ppf(LEVEL, FREEDOM):.2f}, the mean is 3, "
        f"the median {chi2.median(FREEDOM):.2f}. Over all answered frames of the sequences of *Accuracy*; "
        "nothing is asked of `hard`, where an occluder and motion blur break the model.\n\n" + table(head, rows)
    )
    return Section("Covariance", [finding for finding in findings if finding.bar], text)


def figures(squares: list[float]) -> tuple[Figure, ...]:
    """Name the numbers of a sample of normalized errors squared.

    Parameters
    ----------
    squares : list of float

    Returns
    -------
    tuple of Figure
        The percentage below the quantile, mean and median.
    """
    values = np.array(squares)
    some = len(values) > 0
    below = 100.0 * float((values < chi2.ppf(LEVEL, FREEDOM)).mean()) if some else None
    return (
        Figure("below", below, "%", 1),
        Figure("mean", float(values.mean()) if some else None, "", 2),
        Figure("median", float(np.median(values)) if some else None, "", 2, aside=True),
        Figure("frames", len(values), "", 0, aside=True),
    )


def _finding(name: str, runs: list[Trial]) -> Finding:
    squares = [square for trial in runs for square in trial.squares if square is not None]
    return Finding(
        name=f"covariance_{name}",
        what=f"covariance, `{name}`: normalized error squared below the 95 % quantile, and its mean",
        figures=figures(squares),
        bar=BAR if name in PRESETS else (),
        prize=PRIZE if name in PRESETS else (),
    )
