"""Where it flies: survival and accuracy against each constant that was varied; loads Matplotlib, slowly."""

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from matchset.app.drawing.plot_style import INK, OURS, QUIET, SERIES, TEXT, figure_of, linear_ticks, style_axes, title
from matchset.flight.simulate.table import Flown
from matchset.flight.simulate.variation import Axis, quantity

# format: width of a figure, height of a plot and of what is above the first, px
WIDTH, HEIGHT, HEAD = 760, 190, 30
LEAST_TOP = 12.0  # format: upper end of the accuracy at least, cm
MOST_TOP = 60.0  # format: at most: who is farther off is written among the fallen
PARTS = 6  # format: of a range, each with its share of survivors, where values were drawn


def survival_figure(axes: Sequence[Axis], flown: Sequence[Flown]) -> Figure:
    """Draw a plot for each constant: a point for each flight that survived, a cross for each that did not.

    Parameters
    ----------
    axes : sequence of Axis
    flown : sequence of Flown
    """
    figure, plots = figure_of((WIDTH, HEAD + HEIGHT * len(axes)), [1.0] * len(axes), share_x=False)
    top = _top([each.score.worst_spread for each in flown if each.score.survived])
    for axis, plot in zip(axes, plots, strict=True):
        alone = [each for each in flown if each.case.alone == axis.name]
        _draw(plot, axis, alone or [each for each in flown if not each.case.alone], top)
    for words, color, marker, x in (("survived", OURS, "o", 0.74), ("did not", SERIES[0], "x", 0.88)):
        plots[0].plot([x], [1.13], marker, color=color, markersize=5, transform=plots[0].transAxes, clip_on=False)
        plots[0].text(x + 0.012, 1.13, words, transform=plots[0].transAxes, va="center", color=INK, fontsize=TEXT)
    return figure


def _top(spreads: Sequence[float]) -> float:
    """Upper end of the accuracy, cm."""
    worst = max((100.0 * each for each in spreads if math.isfinite(each)), default=LEAST_TOP)
    return min(max(1.1 * worst, LEAST_TOP), MOST_TOP)


def _draw(plot: Axes, axis: Axis, flown: Sequence[Flown], top: float) -> None:
    """Draw the flights over one constant; above them how many of each part survived."""
    style_axes(plot)
    fallen = 1.12 * top
    alive = [each for each in flown if each.score.survived]
    dead = [each for each in flown if not each.score.survived]
    heights = [min(100.0 * each.score.worst_spread, fallen) for each in alive]
    plot.plot([each.case.values[axis.name] for each in alive], heights, "o", color=OURS, markersize=4, alpha=0.8)
    plot.plot([each.case.values[axis.name] for each in dead], [fallen] * len(dead), "x", color=SERIES[0], markersize=5)
    for x, survived, count in _parts(axis, flown):
        plot.text(x, 1.3 * top, f"{survived}/{count}", ha="center", va="center", color=QUIET, fontsize=TEXT - 1.5)
    words = quantity(axis.name)
    unit = {"x": "factor", "": ""}.get(words.unit, words.unit)
    title(plot, f"{axis.name}" + (f", {unit}" if unit else ""))
    plot.set_ylabel("rms, cm")
    plot.set_ylim(0.0, 1.42 * top)
    linear_ticks(plot.yaxis, 4)
    plot.set_yticks([tick for tick in plot.get_yticks() if tick <= top])
    if axis.low < axis.high:
        margin = 0.03 * (axis.high - axis.low)
        plot.set_xlim(axis.low - margin, axis.high + margin)
    linear_ticks(plot.xaxis)


def _parts(axis: Axis, flown: Sequence[Flown]) -> list[tuple[float, int, int]]:
    """Where to write, how many survived and how many flew: of each value, or of each part of the range."""
    drawn = any(not each.case.alone for each in flown) and axis.low < axis.high and not axis.values
    if drawn:
        size = (axis.high - axis.low) / PARTS
        places = [min(int((each.case.values[axis.name] - axis.low) / size), PARTS - 1) for each in flown]
        groups = [
            (axis.low + (k + 0.5) * size, [each for each, place in zip(flown, places, strict=True) if place == k])
            for k in range(PARTS)
        ]
    else:
        values = sorted({each.case.values[axis.name] for each in flown})
        groups = [(value, [each for each in flown if each.case.values[axis.name] == value]) for value in values]
    return [(x, sum(each.score.survived for each in group), len(group)) for x, group in groups if group]
