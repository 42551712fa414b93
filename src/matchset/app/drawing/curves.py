"""The error of a run over time, as a figure; Matplotlib loads slowly, so import this module only to draw."""

from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from matchset.app.drawing.plot_style import (
    DASHES,
    INK,
    OURS,
    PAD,
    PALE,
    PAPER,
    POINTS_PER_INCH,
    QUIET,
    TEXT,
    LineLabel,
    apart,
    figure_of,
    label_lines,
    linear_ticks,
    title,
)

SIZE_PX = 1096, 330  # format: of the figure
_GAP_PX = 40.0  # format: least distance of the numbers of frames, px


class ErrorCurve(msgspec.Struct, frozen=True):
    """What is known of a run, frame by frame.

    Parameters
    ----------
    time : sequence of float
        When each frame was taken, s.
    error : sequence of float
        Eq. 10, px; NaN where it was not answered.
    radius : sequence of float
        True radius of the ball, px; NaN where it is absent.
    shown : sequence of int
        Indices of frames that are shown elsewhere; they are marked.
    """

    time: Sequence[float]
    error: Sequence[float]
    radius: Sequence[float]
    shown: Sequence[int] = ()


def error_figure(curve: ErrorCurve) -> Figure:
    """Plot the error of a run over time with its mean, and below it the radius of the ball.

    Parameters
    ----------
    curve : ErrorCurve

    Returns
    -------
    Figure
    """
    figure, (above, below) = figure_of(SIZE_PX, (3.0, 1.0))
    labels = _draw_errors(above, curve.time, np.asarray(curve.error, float))
    below.plot(curve.time, np.asarray(curve.radius, float), color=INK, linewidth=1.2)
    below.set_ylim(bottom=0)
    below.set_ylabel("radius, px")
    below.set_xlabel("time, s")
    linear_ticks(below.xaxis, 10)
    linear_ticks(below.yaxis, 3)
    marked = "; the numbers are those of the frames above" if curve.shown else ""
    title(
        above, f"error of each frame, |Δx| + |Δy| + |Δr| against the truth{marked}", 2.0 * TEXT if curve.shown else PAD
    )
    label_lines(above, labels)
    if curve.shown:
        _mark_frames(above, curve)
    return figure


def _draw_errors(axes: Axes, time: Sequence[float], errors: npt.NDArray[np.float64]) -> list[LineLabel]:
    axes.plot(time, errors, color=OURS, linewidth=1.3)
    lost = np.asarray(time)[np.isnan(errors)]
    if len(lost):  # a line without points has no extent, and would leave the plot no room
        across = axes.get_xaxis_transform()
        axes.plot(lost, np.full(len(lost), 0.02), "|", color=INK, markersize=8, transform=across, clip_on=False)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("error, px")
    linear_ticks(axes.yaxis, 5)
    if not np.isfinite(errors).any():
        return [LineLabel("never found", 0.0, INK)]
    mean = float(np.nanmean(errors))
    axes.axhline(mean, color=QUIET, linewidth=1.0, linestyle=DASHES)
    ticks = [LineLabel("ticks: not found", 0.0, INK)] if len(lost) else []
    return [*ticks, LineLabel(f"mean {mean:.2f} px", mean, QUIET)]


def _mark_frames(axes: Axes, curve: ErrorCurve) -> None:
    """Mark frames at the curve, and write their numbers above the plot."""
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    figure.set_layout_engine("none")  # what follows needs no room of its own
    shown = sorted(curve.shown)
    wanted = [float(axes.transData.transform((curve.time[index], 0.0))[0]) for index in shown]
    box = axes.get_window_extent()
    for index, at, place in zip(shown, wanted, apart(wanted, _GAP_PX, (box.x0, box.x1)), strict=True):
        time, error = curve.time[index], curve.error[index]
        axes.axvline(time, color=PALE, linewidth=0.8, zorder=1.5)
        if np.isfinite(error):
            axes.plot(time, error, "o", color=OURS, markersize=6, markeredgecolor=PAPER, zorder=4)
        axes.annotate(
            f"{index}",
            (time, 1.0),
            xycoords=axes.get_xaxis_transform(),
            xytext=((place - at) * POINTS_PER_INCH / figure.dpi, 3.0),
            textcoords="offset points",
            ha="center",
            va="bottom",
            color=INK,
            fontsize=TEXT,
        )
