"""The plots of a flight's report, as SVG for one column; only reports import this file, which loads Matplotlib."""

import itertools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from matchset.app.drawing.plot_style import (
    DASHES,
    INK,
    PAPER,
    QUIET,
    TEXT,
    LineLabel,
    figure_of,
    label_lines,
    linear_ticks,
    log_ticks,
    style_axes,
    title,
)
from matchset.app.timing.durations import times_of
from matchset.flight.chain.score import SCORING
from matchset.flight.fly.log import FIGURES, FlightLog, FollowerLog
from matchset.flight.report.chain_frame import set_places
from matchset.flight.report.colors import as_hex, vehicle_rgb

Floats = npt.NDArray[np.float64]

BARS = 40  # format: of a histogram
# format: width of a plot, px: letters can be read on a phone, where it is shrunk to three quarters
WIDTH = 540
POINTS = 1000  # format: of a line at most; a longer flight keeps the extremes between them
NAMES = ("side, m", "height, m", "heading, m")


def room_figure(log: FlightLog) -> Figure:
    """Draw the paths in the room from above, by the truth."""
    _, (axes,) = figure_of((WIDTH, 380))
    for number in range(log.setup.followers + 1):
        path = log.balls_in_room[:, number]
        path = path[:: max(len(path) // POINTS, 1)]
        axes.plot(path[:, 2], path[:, 0], color=_color(number), linewidth=1.4)
        _name(axes, str(number + 1), (float(np.median(path[:, 2])), float(path[:, 0].min())), number)
    title(axes, "in the room, by the truth; the last one hangs on the rope")
    return _from_above(axes, "z, m (forward)", "x, m (right)")


def chain_figure(log: FlightLog) -> Figure:
    """Draw the paths from above in the frame of the last ball: as the chain estimates them, and by the truth."""
    _, (axes,) = figure_of((WIDTH, 380))
    for number, follower in enumerate(log.followers):
        step = max(len(follower.time) // (POINTS // 2), 1)
        estimated, true = follower.estimated_in_chain[::step], follower.true_in_chain[::step]
        axes.plot(estimated[:, 2], estimated[:, 0], ".", color=_color(number), markersize=3.5, alpha=0.5)
        axes.plot(true[:, 2], true[:, 0], color=INK, linewidth=0.8)
        known = np.vstack((estimated, true))[:, ::2]
        known = known[np.isfinite(known).all(axis=1)]
        if len(known):
            _name(axes, str(number + 1), (float(np.median(known[:, 1])), float(known[:, 0].max())), number)
    last = log.setup.followers
    axes.plot(0.0, 0.0, "o", color=_color(last), markersize=13)
    axes.annotate(str(last + 1), (0.0, 0.0), ha="center", va="center", color=PAPER, fontsize=TEXT, fontweight="bold")
    for place in set_places(log.setup):
        if place is not None:
            at = place[2], place[0]
            axes.plot(*at, "+", color=PAPER, markersize=17, markeredgewidth=4.5, zorder=5)
            axes.plot(*at, "+", color=INK, markersize=15, markeredgewidth=1.8, zorder=6)
    truth = "; lines: the truth" if log.setup.has_truth else ""
    title(axes, f"in the frame of the last ball, +: set places\ndots: as the chain estimates it{truth}")
    figure = _from_above(axes, "before the last ball's marker, m", "to its right, m")
    axes.invert_xaxis()
    axes.invert_yaxis()
    return figure


def coordinates_figure(log: FlightLog, number: int) -> Figure:
    """Draw side, height and heading of a follower, from 0, over time: truth, estimate, and set place."""
    figure, rows = figure_of((WIDTH, 440), (1.0, 1.0, 1.0))
    follower, place = log.followers[number], log.setup.parameters.pilot.place
    delay = log.setup.parameters.pilot.follower.ego_motion.delay
    for axis, axes in enumerate(rows):
        wanted = (place.side, place.height, place.heading)[axis]
        axes.axhline(wanted, color=QUIET, linewidth=1.0, linestyle=DASHES)
        axes.plot(*thin(follower.time, follower.true_position[:, axis]), color=INK, linewidth=1.1)
        estimated = follower.estimated_position[:, axis]
        axes.plot(*thin(follower.time + delay, estimated), color=_color(number), linewidth=1.0)
        _mark_losses(axes, follower)
        axes.set_ylabel(NAMES[axis])
        linear_ticks(axes.yaxis, 4)
    _time_axis(rows[-1])
    title(rows[0], f"{number + 1} beside {number + 2}; ticks below: the ball was not found")
    first = rows[0].get_ylim()
    ends = (_last(follower.true_position[:, 0], place.side), _last(follower.estimated_position[:, 0], place.side))
    labels = [LineLabel("set place", place.side, QUIET)]
    labels += [LineLabel("truth", ends[0], INK)] if log.setup.has_truth else []
    label_lines(rows[0], [*labels, LineLabel("acted on", ends[1], _color(number))])
    rows[0].set_ylim(first)
    return figure


def circle_error_figure(log: FlightLog) -> Figure:
    """Draw the histogram of the error of the circles, as in the paper's Fig. 6c, a row for each follower."""
    values = [follower.circle_error_px for follower in log.followers]
    figure = _histograms(values, "px")
    title(figure.axes[0], f"error of the ball's circle, |Δx| + |Δy| + |Δr|\n{figure.axes[0].get_title(loc='left')}")
    return figure


def place_error_figure(log: FlightLog) -> Figure:
    """Draw the histogram of the true distance from the set place, a row for each follower."""
    values = [100.0 * np.linalg.norm(log.position_error(number), axis=1) for number in range(len(log.followers))]
    figure = _histograms(values, "cm")
    words = f"distance from the set place, from {SCORING.transient:g} s after the start on"
    title(figure.axes[0], f"{words}\n{figure.axes[0].get_title(loc='left')}")
    return figure


def computing_figure(log: FlightLog) -> Figure:
    """Draw the histogram of the computing time on a logarithmic axis, a row for each follower."""
    figure = _histograms([1e6 * follower.processing for follower in log.followers], "µs", log_scale=True)
    title(figure.axes[0], f"computing of a command: {FIGURES}\n{figure.axes[0].get_title(loc='left')}")
    return figure


def age_figure(log: FlightLog) -> Figure:
    """Draw the age of the pictures when their commands were sent, a row for each follower, with the losses."""
    figure, rows = figure_of((WIDTH, 90 + 74 * len(log.followers)), [1.0] * len(log.followers))
    oldest = max(float(follower.age[np.isfinite(follower.age)].max(initial=0.0)) for follower in log.followers)
    for number, (axes, follower) in enumerate(zip(rows, log.followers, strict=True)):
        axes.plot(*thin(follower.time, 1000.0 * follower.age), color=_color(number), linewidth=1.3)
        _mark_losses(axes, follower)
        axes.set_ylim(0.0, 1.25e3 * max(oldest, 1e-3))
        linear_ticks(axes.yaxis, 3)
        _row_title(axes, _label(number))
    title(rows[0], f"age of a picture when its command was sent; ticks: losses\n{_label(0)}")
    figure.supylabel("ms", color=INK, fontsize=TEXT)
    _time_axis(rows[-1])
    return figure


def thin(time: Floats, values: Floats, most: int = POINTS) -> tuple[Floats, Floats]:
    """Leave out points of a long line; of each stretch its least and largest value stay.

    Parameters
    ----------
    time, values : ndarray of shape (n,), float64
    most : int
        Points to keep, about.

    Returns
    -------
    time, values : ndarray, float64
        As given where there are few.
    """
    if len(values) <= most:
        return time, values
    edges = np.linspace(0, len(values), most // 2 + 1).astype(int)
    kept = set()
    for low, high in itertools.pairwise(edges.tolist()):
        some = values[low:high]
        if np.isfinite(some).any():
            kept |= {low + int(np.nanargmin(some)), low + int(np.nanargmax(some))}
        if not np.isfinite(some).all():
            kept.add(low + int(np.argmin(np.isfinite(some))))  # a gap stays a gap
    order = sorted(kept)
    return time[order], values[order]


def _from_above(axes: Axes, along: str, across: str) -> Figure:
    style_axes(axes, grid="both")
    axes.margins(0.08, 0.2)
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_yaxis()
    linear_ticks(axes.xaxis)
    linear_ticks(axes.yaxis, 5)
    axes.set_xlabel(along)
    axes.set_ylabel(across)
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    return figure


def _name(axes: Axes, words: str, at: tuple[float, float], number: int) -> None:
    text = axes.annotate(words, at, xytext=(0, 5), textcoords="offset points", color=_color(number), fontsize=TEXT)
    text.set(ha="center", va="bottom", fontweight="bold")


def _histograms(values: Sequence[Floats], unit: str, log_scale: bool = False) -> Figure:
    """Draw a row for each follower; what exceeds 99.5 % of all of them is counted in the last bar."""
    known = [each[np.isfinite(each)] for each in values]
    every = np.concatenate(known)
    low, high = (float(np.percentile(every, q)) for q in (0.5, 99.5)) if len(every) else (1.0, 2.0)
    if log_scale:
        low, high = 0.8 * low, 1.25 * high
        bins = np.geomspace(low, max(high, 4.0 * low), BARS + 1)
    else:
        bins = np.linspace(0.0, max(high, 1e-3), BARS + 1)
    figure, rows = figure_of((WIDTH, 100 + 84 * len(known)), [1.0] * len(known))
    most = 0.0
    for number, (axes, some) in enumerate(zip(rows, known, strict=True)):
        share = 100.0 * np.histogram(np.clip(some, bins[0], bins[-1]), bins)[0] / max(len(some), 1)
        axes.stairs(share, bins, fill=True, color=_color(number), alpha=0.3)
        axes.stairs(share, bins, color=_color(number), linewidth=1.3)
        _row_title(axes, f"{_label(number)}: {_in_figures(some, unit, log_scale)}")
        most = max(most, float(share.max()))
    for axes in rows:
        axes.set_ylim(0.0, 1.1 * max(most, 1.0))
        linear_ticks(axes.yaxis, 3)
    if log_scale:
        log_ticks(rows[-1].xaxis, float(bins[0]), float(bins[-1]))
    else:
        rows[-1].set_xlim(0.0, float(bins[-1]))
        linear_ticks(rows[-1].xaxis)
    rows[-1].set_xlabel(f"{unit}; the last bar holds what is more")
    figure.supylabel("share of the pictures, %", color=INK, fontsize=TEXT)
    return figure


def _in_figures(values: Floats, unit: str, all_four: bool) -> str:
    """Write the median of values; of those that have a long tail `FIGURES`."""
    figures = times_of(values)
    if figures is None:
        return "none"
    if not all_four:
        return f"median {_brief(figures.median)} {unit}"
    four = figures.median, figures.mean, figures.percentile_95, figures.worst
    return f"{', '.join(map(_brief, four))} {unit}"


def _mark_losses(axes: Axes, follower: FollowerLog) -> None:
    lost = follower.time[~follower.found]
    if not len(lost):  # a line without points has no extent, and would leave its plot no room
        return
    lost = lost[:: max(len(lost) // POINTS, 1)]
    across = axes.get_xaxis_transform()
    axes.plot(lost, np.full(len(lost), 0.02), "|", color=INK, markersize=6, transform=across, clip_on=False)


def _time_axis(axes: Axes) -> None:
    linear_ticks(axes.xaxis)
    axes.set_xlabel("time, s")


def _row_title(axes: Axes, words: str) -> None:
    axes.set_title(words, loc="left", color=INK, fontsize=TEXT, pad=3)


def _last(values: Floats, otherwise: float) -> float:
    known = values[np.isfinite(values)]
    return float(known[-1]) if len(known) else otherwise


def _brief(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _label(number: int) -> str:
    return f"{number + 1} watches {number + 2}"


def _color(number: int) -> str:
    return as_hex(vehicle_rgb(number))
