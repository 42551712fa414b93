"""The one style of every plot: size, letters, colors, ticks, labels at lines; PNG or SVG, light and dark.

Matplotlib loads slowly: import this module only to draw.
"""

import io
import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import msgspec
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter, NullLocator

from matchset.image.files.whole_file import write_whole

Floats = npt.NDArray[np.float64]

WIDTH_PX, DPI = 760, 100  # format: of a figure in a page; pixels per inch
# format: sizes of letters, points: text and tick labels, and the title of a plot
TEXT, TITLE = 9.5, 10.5
# format: of letters, of less important ones, of axes, of grid lines, of the background; RGB
INK, QUIET, PALE, GRID, PAPER = "#333333", "#6b6b6b", "#b5b5b5", "#ececec", "#ffffff"
# format: what a figure is about, then the others in their order (Okabe & Ito, told apart by the color-blind)
OURS = "#d55e00"
SERIES = ("#0072b2", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f", "#5d4a9c")
# format: length of the line from a curve's end to its name, and the unit of letters, points
LEADER, POINTS_PER_INCH = 13.0, 72.0
PAD = 6.0  # format: between a plot and its title, points
LEAST_TICKS = 3  # format: numbers at an axis
DASHES = (0, (4, 3))  # format: of lines that are no measurement
DARK = {
    INK: "#dddddd",
    QUIET: "#a3a3a3",
    PALE: "#6a6a6a",
    GRID: "#2e3136",
    PAPER: "#17191c",
    OURS: "#ff8a3c",
    SERIES[0]: "#4aa8e8",
    SERIES[1]: "#2fc79b",
    SERIES[2]: "#e79cc3",
    SERIES[3]: "#8fd0f5",
    SERIES[4]: "#f2b632",
    SERIES[5]: "#9d9d9d",
    SERIES[6]: "#a897e6",
}
"""Each color's counterpart on a dark background; SVG files hold both."""

# format: the style as Matplotlib reads it
SETTINGS: Any = {
    "font.family": "DejaVu Sans",
    "font.size": TEXT,
    "axes.titlesize": TITLE,
    "axes.labelsize": TEXT,
    "xtick.labelsize": TEXT,
    "ytick.labelsize": TEXT,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.edgecolor": PALE,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": PALE,
    "ytick.color": PALE,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "lines.linewidth": 1.5,
    "lines.solid_capstyle": "round",
    "figure.facecolor": PAPER,
    "axes.facecolor": PAPER,
    "savefig.facecolor": PAPER,
}


class LineLabel(msgspec.Struct, frozen=True):
    """What is written beside the right end of a line, level with it: the text, the y of the end, and the color."""

    text: str
    y: float
    color: str
    strong: bool = False


def figure_of(size: tuple[int, int], rows: Sequence[float] = (1.0,), share_x: bool = True) -> tuple[Figure, list[Axes]]:
    """Begin a figure with plots one below the other.

    Parameters
    ----------
    size : tuple of two ints
        Width and height, px.
    rows : sequence of float
        Heights of the plots, as shares of one another.
    share_x : bool
        Whether they have the same x axis; its numbers are below the last one then.

    Returns
    -------
    Figure
    list of Axes
        From above.
    """
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(size[0] / DPI, size[1] / DPI), dpi=DPI, layout="constrained")
        axes = figure.subplots(len(rows), 1, sharex=share_x, height_ratios=list(rows), squeeze=False)[:, 0].tolist()
    for each in axes:
        style_axes(each)
    return figure, axes


def style_axes(axes: Axes, grid: str = "y") -> None:
    """Give a plot the style of all plots: no frame, pale axes, horizontal grid lines ("both": vertical ones, too)."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(PALE)
    axes.tick_params(color=PALE, labelcolor=INK, labelsize=TEXT)
    for each in (axes.xaxis, axes.yaxis):
        each.label.set(color=INK, size=TEXT)
    axes.grid(visible=False)
    axes.grid(axis=grid, color=GRID, linewidth=0.8)  # type: ignore[arg-type]
    axes.set_axisbelow(True)
    axes.margins(x=0.01)


def title(axes: Axes, text: str, pad: float = PAD) -> None:
    """Write what a plot shows above it, at the left, `pad` points away."""
    axes.set_title(text, loc="left", color=INK, fontsize=TITLE, pad=pad)


def linear_ticks(axis: Axis, most: int = 6) -> None:
    """Put three or more round numbers at an axis."""
    axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10], min_n_ticks=LEAST_TICKS))


def log_ticks(axis: Axis, low: float, high: float) -> None:
    """Make an axis logarithmic from `low` to `high`, with numbers that can be read: 1 2 5 10, 1 3 10, or powers.

    Parameters
    ----------
    axis : Axis
        The x or y axis of a plot.
    low, high : float
        Its ends, more than 0.
    """
    decades = math.log10(high / low)
    steps = (1, 2, 5) if decades < 1.8 else (1, 3) if decades < 3.2 else (1,)
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    ticks = [step * 10.0**power for power in powers for step in steps]
    ticks = [tick for tick in ticks if low * 0.999 <= tick <= high * 1.001]
    if len(ticks) < LEAST_TICKS:
        ticks = [tick for tick in MaxNLocator(5).tick_values(low, high) if low <= tick <= high]
    axis._set_axes_scale("log")  # type: ignore[attr-defined]
    axis.set_view_interval(low, high, ignore=True)
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}" if value >= 100.0 else f"{value:g}"))
    axis.set_minor_locator(NullLocator())
    axis.set_minor_formatter(NullFormatter())


def label_lines(axes: Axes, labels: Iterable[LineLabel], gap_px: float = 15.0) -> None:
    """Write each line's name beside its right end; names that would touch move apart, joined by a thin line.

    Call it last: limits must be final. The layout of the figure is fixed from then on.

    Parameters
    ----------
    axes : Axes
    labels : iterable of LineLabel
    gap_px : float
        Least distance between the middles of two names, px.
    """
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    wanted = sorted(labels, key=lambda label: label.y)
    written = []
    for label in wanted:
        at = (1.0, label.y)
        arrow = {"arrowstyle": "-", "color": label.color, "linewidth": 1.1, "shrinkA": 1.0, "shrinkB": 0.0}
        written.append(
            axes.annotate(
                label.text,
                at,
                xycoords=axes.get_yaxis_transform(),
                xytext=(LEADER, 0),
                textcoords="offset points",
                va="center",
                color=INK,
                fontsize=TEXT,
                fontweight="bold" if label.strong else "normal",
                annotation_clip=False,
                arrowprops=arrow,
            )
        )
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    ends = [axes.transData.transform((1.0, label.y))[1] for label in wanted]
    box = axes.get_window_extent()
    for text, end, place in zip(written, ends, apart(ends, gap_px, (box.y0, box.y1)), strict=True):
        text.xyann = (LEADER, (place - end) * POINTS_PER_INCH / figure.dpi)


def apart(places: Sequence[float], gap: float, limits: tuple[float, float]) -> list[float]:
    """Move increasing numbers as little as possible (least squares) so that none is nearer to the next than `gap`.

    Parameters
    ----------
    places : sequence of float
        Increasing.
    gap : float
        Least distance.
    limits : tuple of two floats
        They stay within, if there is room.

    Returns
    -------
    list of float
    """
    # Pool adjacent violators on place - k gap: blocks that would be out of order share their mean.
    blocks: list[tuple[float, int]] = []
    for number, place in enumerate(places):
        mean, count = place - number * gap, 1
        while blocks and blocks[-1][0] > mean:
            before, many = blocks.pop()
            mean, count = (before * many + mean * count) / (many + count), many + count
        blocks.append((mean, count))
    level = [mean for mean, count in blocks for _ in range(count)]
    low, high = limits[0], limits[1] - gap * (len(places) - 1)
    return [max(min(each, high), low) + number * gap for number, each in enumerate(level)]


def rolling(values: Sequence[float] | Floats, window: int, percentile: float) -> Floats:
    """Percentile of the values within half a window on both sides, NaN left out; NaN where there are none.

    Parameters
    ----------
    values : sequence of float
    window : int
        Odd.
    percentile : float
        50: the median.

    Returns
    -------
    ndarray, float64
        As many as there are values.
    """
    padded = np.pad(np.asarray(values, float), window // 2, constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, window)
    result = np.full(len(windows), np.nan)
    known = np.isfinite(windows).any(axis=1)
    if known.any():
        result[known] = np.nanpercentile(windows[known], percentile, axis=1)
    return result


def picture_of(figure: Figure, scale: float = 1.0) -> npt.NDArray[np.uint8]:
    """Draw a figure as a picture, (h, w, 3), BGR; `scale` times as large as the size it was made for."""
    figure.set_dpi(scale * DPI)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    rgba = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(rgba[..., 2::-1])


def svg_of(figure: Figure, name: str, inside: bool = False) -> str:
    """Write a figure as SVG whose colors follow the reader's light or dark scheme.

    Parameters
    ----------
    figure : Figure
    name : str
        Letters and digits, for the names inside it; two figures of one page need two names.
    inside : bool
        Whether it becomes part of a page: then the page's style sets the colors (`color_rules`) and letters stay text.

    Returns
    -------
    str
    """
    text = io.StringIO()
    settings: Any = {"svg.fonttype": "none" if inside else "path", "svg.hashsalt": name}
    with matplotlib.rc_context(settings):
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r'<g id="[\w.]+_\d+">', "<g>", svg)  # numbered by Matplotlib
    svg = re.sub(r'\b(id="|url\(#|xlink:href="#)', rf"\g<1>{name}-", svg)
    for number, color in enumerate(DARK):
        svg = svg.replace(color, f"var(--plot-{number})")
    svg = re.sub(r"<!--.*?-->\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r' (d|x|y)="[^"]*"', lambda found: re.sub(r"(\.\d\d)\d+|\s*\n", r"\1", found[0]), svg)
    if inside:
        svg = re.sub(r"<defs>\s*<style.*?</style>\s*</defs>", "", svg, flags=re.DOTALL)  # it would hold for the page
        svg = svg.replace("'DejaVu Sans'", "system-ui, 'DejaVu Sans'")
        return re.sub(
            r"<svg[^>]*>", lambda found: re.sub(r' (width|height|xmlns[:\w]*)="[^"]*"', "", found[0]), svg, count=1
        )
    style = f"<style>{color_rules('svg')}</style>"
    return re.sub(r"(<svg[^>]*>)", lambda found: found[1] + style, svg, count=1)


def color_rules(selector: str) -> str:
    """Write the CSS that gives the colors of SVG plots, light and dark; printed light."""
    light = "".join(f"--plot-{number}:{color};" for number, color in enumerate(DARK))
    dark = "".join(f"--plot-{number}:{color};" for number, color in enumerate(DARK.values()))
    return f"{selector}{{{light}}}@media screen and (prefers-color-scheme:dark){{{selector}{{{dark}}}}}"


def write_svg(figure: Figure, path: Path) -> None:
    """Write a figure into an SVG file for light and dark pages."""
    path.parent.mkdir(parents=True, exist_ok=True)
    name = re.sub(r"\W", "", path.stem)
    write_whole(path, svg_of(figure, name).encode())
