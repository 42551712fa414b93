"""Figures of computing time: over the ball's radius, over the picture's size, and against the frames that are right."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from benchmarks.figures.errors import colors
from benchmarks.figures.kept import numbers
from matchset.app.drawing.plot_style import (
    DASHES,
    INK,
    OURS,
    PALE,
    QUIET,
    SERIES,
    TEXT,
    WIDTH_PX,
    LineLabel,
    figure_of,
    label_lines,
    linear_ticks,
    log_ticks,
    style_axes,
    title,
)

BEST = "matchset"
PLACES = ((8, 0, "left"), (0, 10, "center"), (0, -10, "center"), (-8, 0, "right"), (8, 9, "left"), (8, -9, "left"))
"""Where a name may stand beside its point: shift, points, and side."""


def times_over_radius(radii: Sequence[float], times: Sequence[float], levels: Mapping[str, float], name: str) -> Figure:
    """Draw what a frame costs against how large the ball is in it.

    Parameters
    ----------
    radii, times : sequence of float
        px, and us.
    levels : mapping of str to float
        What does not depend on the radius, us.
    name : str
        What `times` are of.
    """
    figure, (axes,) = figure_of((WIDTH_PX, 330))
    axes.plot(radii, times, "o", color=OURS, markersize=3.5, markeredgewidth=0, alpha=0.7)
    middle = float(np.median(times))
    axes.axhline(middle, color=OURS, linewidth=1.5)
    labels = [LineLabel(f"{name}: {middle:.0f} µs", middle, OURS, strong=True)]
    for (label, level), color in zip(levels.items(), SERIES, strict=False):
        axes.axhline(level, color=color, linewidth=1.5, linestyle=DASHES)
        labels.append(LineLabel(f"{label}: {level:.0f} µs", level, color))
    every = [*times, *levels.values()]
    log_ticks(axes.yaxis, 0.6 * min(every), 1.6 * max(every))
    linear_ticks(axes.xaxis)
    axes.set_xlabel("radius of the ball, px")
    axes.set_ylabel("time per frame, µs")
    title(axes, "a dot for each frame; lines: medians")
    label_lines(axes, labels)
    return figure


def times_over(xs: Sequence[float], times: Mapping[str, Sequence[float]], label: str, log_x: bool) -> Figure:
    """Draw what a frame costs, a line for each contender, on a logarithmic scale.

    Parameters
    ----------
    xs : sequence of float
    times : mapping of str to sequence of float
        By contender, us.
    label : str
        Of the x axis.
    log_x : bool
        Whether that is logarithmic, too.
    """
    figure, (axes,) = figure_of((WIDTH_PX, 420))
    labels = []
    for name, color in colors(times, BEST).items():
        ours = name == BEST
        axes.plot(xs, times[name], "o-", color=color, linewidth=2.4 if ours else 1.4, markersize=4.5 if ours else 3.5)
        labels.append(LineLabel(short(name), times[name][-1], color, ours))
    every = [each for values in times.values() for each in values]
    log_ticks(axes.yaxis, 0.7 * min(every), 1.4 * max(every))
    if log_x:
        log_ticks(axes.xaxis, 0.9 * min(xs), 1.05 * max(xs))
    else:
        linear_ticks(axes.xaxis)
    axes.set_xlabel(label)
    axes.set_ylabel("median time per frame, µs")
    label_lines(axes, labels)
    return figure


def valid_over_time(points: Mapping[str, Sequence[float]], named: Sequence[str]) -> Figure:
    """Draw the share of the frames that are right against the time of a frame, a point for each contender.

    Parameters
    ----------
    points : mapping of str to (us, %)
    named : sequence of str
        Whose names are written; the others are in the table below the figure.
    """
    figure, (axes,) = figure_of((WIDTH_PX, 430))
    style_axes(axes, grid="both")
    for name, (time, share) in points.items():
        ours, known = name == BEST, name in named
        color = OURS if ours else SERIES[0] if known else PALE
        axes.plot(
            time, share, "o", color=color, markersize=11 if ours else 7 if known else 5.5, zorder=4 if known else 3
        )
    every = [time for time, _ in points.values()]
    log_ticks(axes.xaxis, 0.6 * min(every), 2.2 * max(every))
    axes.set_ylim(-4.0, 108.0)
    axes.set_yticks([0, 20, 40, 60, 80, 100])
    axes.set_xlabel("median time per frame, µs")
    axes.set_ylabel("frames right, error below 5 px, %")
    title(axes, f"better: up and to the left; gray: {len(points) - len(named)} others, in the table below")
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    taken = [_around(axes, *point) for point in numbers(list(points.values()))]
    for name in sorted(named, key=lambda each: each != BEST):
        taken.append(_write_beside(axes, name, points[name], taken))
    return figure


def short(name: str) -> str:
    """Shorten the name of a contender for a figure."""
    return re.split(r", | \(|: blur", name)[0]


def _around(axes: Axes, x: float, y: float) -> Bbox:
    u, v = axes.transData.transform((x, y))
    return Bbox.from_extents(u - 5, v - 5, u + 5, v + 5)


def _write_beside(axes: Axes, name: str, point: Sequence[float], taken: Sequence[Bbox]) -> Bbox:
    """Write a name where it touches nothing, as far as there is such a place."""
    figure: Any = axes.get_figure()
    tried: list[tuple[int, int, Any, Bbox]] = []
    for x, y, side in PLACES:
        text = axes.annotate(
            short(name),
            (point[0], point[1]),
            xytext=(x, y),
            textcoords="offset points",
            ha=side,
            va="center",
            color=INK if name == BEST else QUIET,
            fontsize=TEXT,
            fontweight="bold" if name == BEST else "normal",
        )
        box = text.get_window_extent(figure.canvas.get_renderer())
        outside = box.x1 > figure.bbox.x1 or box.x0 < axes.get_window_extent().x0
        tried.append((sum(box.overlaps(each) for each in taken) + 10 * outside, len(tried), text, box))
        text.set_visible(False)
    _, _, text, box = min(tried, key=lambda each: each[:2])
    for _, _, other, _ in tried:
        if other is not text:
            other.remove()
    text.set_visible(True)
    return box
