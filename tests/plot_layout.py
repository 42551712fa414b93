"""What makes a figure unreadable, found mechanically in Matplotlib's layout: `faults`."""

import itertools
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

LEAST_TICKS = 3
LEAST_WIDTH = 0.5  # of the figure, covered by plots side by side


def faults(figure: Figure, covered: float = LEAST_WIDTH) -> list[str]:
    """Say what is wrong with the layout of a figure.

    Texts outside it or on one another, axes with fewer than three numbers, plots that leave most of the width empty.
    """
    FigureCanvasAgg(figure).draw()  # type: ignore[no-untyped-call]
    boxes = texts(figure)
    found = [f"{name!r} is cut off" for name, box in boxes if _cut(figure, box)]
    for (one, a), (other, b) in itertools.combinations(boxes, 2):
        if overlap(a, b):
            found.append(f"{one!r} lies on {other!r}")
    shown = [axes for axes in figure.axes if axes.axison]
    for axes in shown:
        for name, axis in (("x", axes.xaxis), ("y", axes.yaxis)):
            count = len(numbers_at(axis))
            if count < LEAST_TICKS and not _numbers_elsewhere(axes, axis):
                found.append(f"{count} numbers at the {name} axis of {axes.get_title(loc='left')!r}")
    share = _width(shown) / figure.bbox.width
    if shown and share < covered:
        found.append(f"plots cover {100.0 * share:.0f} % of the width")
    return found


def texts(figure: Figure) -> list[tuple[str, Bbox]]:
    """Every visible text of a figure with its box, px; numbers at axes only where they are drawn."""
    renderer: Any = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    ticks = {label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for label in _tick_texts(axis)}
    drawn = {label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for label in numbers_at(axis)}
    off = {each for axes in figure.axes if not axes.axison for each in (*ticks, axes.xaxis.label, axes.yaxis.label)}
    found = []
    for text in figure.findobj(Text):
        assert isinstance(text, Text)
        if (
            not text.get_visible()
            or not text.get_text().strip()
            or text in off
            or (text in ticks and text not in drawn)
        ):
            continue
        # An annotation's own box would hold its arrow, too.
        found.append((text.get_text(), Text.get_window_extent(text, renderer)))
    return found


def numbers_at(axis: Axis) -> list[Text]:
    """The numbers that are drawn at an axis, within its limits."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-6 * (high - low)
    return [
        tick.label1
        for tick in axis.get_major_ticks()
        if tick.label1.get_visible() and tick.label1.get_text() and low - slack <= tick.get_loc() <= high + slack
    ]


def overlap(a: Bbox, b: Bbox, slack: float = 1.0) -> bool:
    """Whether two boxes share more than a rim, px."""
    wide = min(a.x1, b.x1) - max(a.x0, b.x0)
    high = min(a.y1, b.y1) - max(a.y0, b.y0)
    return bool(wide > slack and high > slack)


def crossed(figure: Figure) -> list[str]:
    """Texts inside plots, numbers at axes left out, through which a line runs."""
    FigureCanvasAgg(figure).draw()  # type: ignore[no-untyped-call]
    ticks = {each.get_text() for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for each in _tick_texts(axis)}
    lines = []
    for axes in figure.axes:
        for line in axes.lines:
            path = line.get_transform().transform_path(line.get_path())
            if np.shape(path.vertices)[0] > 1 and line.get_linestyle() != "None":
                lines.append(path)
        lines += [patch.get_transform().transform_path(patch.get_path()) for patch in axes.patches]
    found = []
    for name, box in texts(figure):
        inner = Bbox.from_extents(box.x0 + 1.0, box.y0 + 2.0, box.x1 - 1.0, box.y1 - 2.0)
        if name not in ticks and any(path.intersects_bbox(inner, filled=False) for path in lines):
            found.append(name)
    return found


def _tick_texts(axis: Axis) -> list[Text]:
    every = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    return [label for tick in every for label in (tick.label1, tick.label2)]


def _numbers_elsewhere(axes: Axes, axis: Axis) -> bool:
    """Whether another plot of the figure has the numbers of a shared axis."""
    figure: Any = axes.get_figure()
    if not axis.get_tick_params().get("labelbottom", axis.get_tick_params().get("labelleft", True)):
        return True
    shared = axes.get_shared_x_axes() if axis is axes.xaxis else axes.get_shared_y_axes()
    others = [each for each in figure.axes if each is not axes and shared.joined(axes, each)]
    return any(len(numbers_at(each.xaxis if axis is axes.xaxis else each.yaxis)) >= LEAST_TICKS for each in others)


def _cut(figure: Figure, box: Bbox) -> bool:
    edge = figure.bbox
    return bool(box.x0 < edge.x0 - 0.5 or box.y0 < edge.y0 - 0.5 or box.x1 > edge.x1 + 0.5 or box.y1 > edge.y1 + 0.5)


def _width(shown: list[Axes]) -> float:
    """How many columns of pixels have a plot."""
    if not shown:
        return 0.0
    columns = np.zeros(20000, bool)
    for axes in shown:
        box = axes.get_window_extent()
        columns[max(int(box.x0), 0) : int(box.x1)] = True
    return float(columns.sum())
