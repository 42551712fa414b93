"""Figures of errors: over the frames of a sequence, and how often which error occurs."""

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from benchmarks.figures.kept import numbers
from matchset.app.drawing.plot_style import (
    DASHES,
    INK,
    OURS,
    QUIET,
    SERIES,
    WIDTH_PX,
    LineLabel,
    figure_of,
    label_lines,
    linear_ticks,
    log_ticks,
    rolling,
    title,
)

SMALLEST_PX, LARGEST_PX = 0.01, 100.0
VALID_PX = 5.0
WINDOW = 21  # frames
ERROR = "|Δx| + |Δy| + |Δr|"

Floats = npt.NDArray[np.float64]
Column = Sequence[float | None]


def errors_over_frames(errors: Mapping[str, Column], radii: Column, best: str) -> Figure:
    """Draw the error of Eq. 10 over the frames of some sequences, smoothed, and below it how large the ball is.

    Parameters
    ----------
    errors : mapping of str to sequence of float
        By sequence; None where a frame was not answered, px.
    radii : sequence of float
        True radius of the ball, px.
    best : str
        Which of them the figure is about.
    """
    figure, (above, below) = figure_of((WIDTH_PX, 430), (4, 1))
    labels = [LineLabel("valid below 5 px", VALID_PX, QUIET)]
    lows, highs = [], [2.0 * VALID_PX]
    for name, color in colors(errors, best).items():
        values = np.clip(numbers(errors[name]), SMALLEST_PX, None)
        low, middle, high = (rolling(values, WINDOW, percentile) for percentile in (10, 50, 90))
        frames = np.arange(len(values))
        above.fill_between(frames, low, high, color=color, alpha=0.18, linewidth=0)
        above.plot(frames, middle, color=color, linewidth=2.2 if name == best else 1.5)
        last = middle[np.isfinite(middle)]
        labels.append(LineLabel(_mean(name, values), float(last[-1]) if len(last) else VALID_PX, color, name == best))
        lows.append(float(np.nanmin(low)))
        highs.append(float(np.nanmax(high)))
    above.axhline(VALID_PX, color=QUIET, linewidth=0.9, linestyle=DASHES)
    log_ticks(above.yaxis, 0.8 * max(min(lows), SMALLEST_PX), 1.2 * min(max(highs), LARGEST_PX))
    above.set_ylabel(f"{ERROR}, px")
    title(above, f"median of {WINDOW} frames; band: 80 % of them; at the right: the mean of all")
    below.plot(numbers(radii), color=INK, linewidth=1.2)
    below.set_ylim(0.0, 1.15 * float(np.nanmax(numbers(radii))))
    below.set_ylabel("radius, px")
    below.set_xlabel("frame")
    linear_ticks(below.yaxis, 3)
    linear_ticks(below.xaxis, 8)
    label_lines(above, labels)
    return figure


def error_histogram(errors: Mapping[str, Column], best: str) -> Figure:
    """Draw how often which error occurs, on a logarithmic scale, a row for each sequence.

    Parameters
    ----------
    errors : mapping of str to sequence of float
        By sequence, px; None, where there was no answer, is in no bar.
    best : str
        Which of them the figure is about.
    """
    figure, rows = figure_of((WIDTH_PX, 60 + 92 * len(errors)), [1.0] * len(errors))
    bins = np.geomspace(SMALLEST_PX, LARGEST_PX, 81)
    most = 0.0
    for axes, (name, color) in zip(rows, colors(errors, best).items(), strict=True):
        values = numbers(errors[name])
        answered = np.clip(values[np.isfinite(values)], bins[0], bins[-1])
        share = 100.0 * np.histogram(answered, bins)[0] / max(len(values), 1)
        axes.stairs(share, bins, fill=True, color=color, alpha=0.25)
        axes.stairs(share, bins, color=color, linewidth=1.3)
        axes.axvline(VALID_PX, color=QUIET, linewidth=0.9, linestyle=DASHES)
        median = float(np.median(answered)) if len(answered) else np.nan
        axes.set_title(
            f"{name}: median {median:.2f} px",
            loc="left",
            color=INK,
            fontsize=9.5,
            pad=3,
            fontweight="bold" if name == best else "normal",
        )
        most = max(most, float(share.max()))
    for axes in rows:
        axes.set_ylim(0.0, 1.1 * most)
        linear_ticks(axes.yaxis, 3)
    log_ticks(rows[-1].xaxis, bins[0], bins[-1])
    rows[0].annotate(
        "valid below 5 px",
        (VALID_PX, 1.0),
        xycoords=rows[0].get_xaxis_transform(),
        xytext=(4, 3),
        textcoords="offset points",
        color=QUIET,
        fontsize=9.5,
    )
    rows[-1].set_xlabel(f"{ERROR}, px")
    figure.supylabel("share of the frames, %", color=INK, fontsize=9.5)
    return figure


def colors(names: Mapping[str, object], best: str) -> dict[str, str]:
    """Give each its color: the style's first to the one that the figure is about."""
    others = iter(SERIES)
    return {name: OURS if name == best else next(others) for name in names}


def _mean(name: str, values: Floats) -> str:
    answered = values[np.isfinite(values)]
    if not len(answered):
        return f"{name}: no answer"
    share = 100.0 * len(answered) / len(values)
    missed = "" if share > 99.0 else f", {share:.0f} % found"
    return f"{name} {answered.mean():.2f} px{missed}"
