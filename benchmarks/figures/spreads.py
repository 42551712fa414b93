"""Figures of range and flight: error of the range by three methods, and how the spread grows along a chain."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from benchmarks.figures.errors import colors
from benchmarks.figures.kept import numbers
from matchset.app.drawing.plot_style import (
    INK,
    SERIES,
    WIDTH_PX,
    LineLabel,
    figure_of,
    label_lines,
    linear_ticks,
    title,
)

Column = Sequence[float | None]


def range_errors(angles_deg: Sequence[float], errors: Mapping[str, Sequence[Column]], best: str) -> Figure:
    """Draw the error of the range against the angle off the camera's axis: mean, and every single answer.

    Parameters
    ----------
    angles_deg : sequence of float
        One for each row of the errors.
    errors : mapping of str to rows of float
        By method, (angles, n), %.
    best : str
        Which method the figure is about.
    """
    figure, (axes,) = figure_of((WIDTH_PX, 380))
    axes.axhline(0.0, color=INK, linewidth=0.9)
    labels = []
    for place, (name, color) in enumerate(colors(errors, best).items()):
        values = numbers(errors[name])
        means = np.nanmean(values, axis=1)
        beside = np.asarray(angles_deg, float) + 0.5 * (place - 1)  # so that the three do not hide one another
        axes.plot(beside, values, ".", color=color, markersize=3, alpha=0.35)
        axes.plot(angles_deg, means, color=color, linewidth=2.4 if name == best else 1.6)
        labels.append(LineLabel(f"{name}: {means[-1]:+.2f} %", float(means[-1]), color, name == best))
    axes.margins(x=0.03, y=0.08)
    linear_ticks(axes.yaxis)
    axes.set_xticks(list(angles_deg))
    axes.set_xlabel("angle between the camera's axis and the ball, degrees")
    axes.set_ylabel("error of the range, %")
    title(axes, "a dot for each frame; lines: means; at the right: the mean at the largest angle")
    label_lines(axes, labels)
    return figure


def spread_along_chain(spreads_cm: Mapping[str, Sequence[float]]) -> Figure:
    """Draw how the distance from the set place grows along a chain of followers.

    Parameters
    ----------
    spreads_cm : mapping of str to sequence of float
        By axis: root mean square of each follower, the one next to the rope first, cm.
    """
    figure, (axes,) = figure_of((WIDTH_PX, 330))
    labels = []
    for (name, values), color in zip(spreads_cm.items(), SERIES, strict=False):
        numbers_of = np.arange(1, len(values) + 1)
        axes.plot(numbers_of, values, "o-", color=color, markersize=4.5)
        labels.append(LineLabel(f"{name}: {values[-1]:.1f} cm", values[-1], color))
    axes.set_xticks(numbers_of)
    axes.set_ylim(0.0, 1.08 * max(max(values) for values in spreads_cm.values()))
    axes.margins(x=0.03)
    linear_ticks(axes.yaxis)
    axes.set_xlabel("followers between the rope and this one, itself counted")
    axes.set_ylabel("off the set place, cm rms")
    label_lines(axes, labels)
    return figure
