"""The error of a run over time, plotted by Matplotlib; Matplotlib loads slowly, so import this module only to draw."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

PINK, INK, PALE = "#ff28be", "#444444", "#bbbbbb"


def error_plot(
    time: Sequence[float], error: Sequence[float], radius: Sequence[float], size: tuple[int, int]
) -> npt.NDArray[np.uint8]:
    """Plot the error of a run over time, and below it the radius of the ball.

    Parameters
    ----------
    time : sequence of float
        When each frame was taken, s.
    error : sequence of float
        Error of each frame, Eq. 10, px; NaN where it was not answered.
    radius : sequence of float
        True radius of the ball, px; NaN where it is absent.
    size : tuple of two ints
        Width and height of the plot, px.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR.
    """
    figure = figure_of(size)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    figure.subplots_adjust(left=0.045, right=0.985, top=0.9, bottom=0.14, hspace=0.2)
    _draw_errors(above, time, np.asarray(error, float))
    below.plot(time, np.asarray(radius, float), color=INK, linewidth=1.0)
    below.set_ylim(bottom=0)
    below.set_ylabel("radius, px")
    below.set_xlabel("time, s")
    for axes in (above, below):
        style_axes(axes)
    return picture_of(figure)


def figure_of(size: tuple[int, int]) -> Figure:
    """Begin a plot of a width and height in px."""
    return Figure(figsize=(size[0] / 100, size[1] / 100), dpi=100)


def picture_of(figure: Figure) -> npt.NDArray[np.uint8]:
    """Draw a plot as a picture, (h, w, 3), BGR."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    rgba = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(rgba[..., 2::-1])


def _draw_errors(axes: Axes, time: Sequence[float], errors: npt.NDArray[np.float64]) -> None:
    axes.plot(time, errors, color=PINK, linewidth=1.2)
    lost = np.asarray(time)[np.isnan(errors)]
    axes.plot(lost, np.zeros(len(lost)), "|", color=INK, markersize=8, clip_on=False)
    title = "|Δx| + |Δy| + |Δr| against the truth, frame by frame"
    if np.isfinite(errors).any():
        mean = float(np.nanmean(errors))
        axes.axhline(mean, color=INK, linewidth=0.8, linestyle=(0, (4, 4)))
        title += f"; dashed: their mean, {mean:.2f} px"
    axes.set_ylim(bottom=0)
    axes.set_title(title, loc="left", color=INK, fontsize=11)
    axes.set_ylabel("error, px")


def style_axes(axes: Axes) -> None:
    """Give a plot the style of all plots: no frame, pale axes, horizontal grid lines."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(PALE)
    axes.tick_params(color=PALE, labelcolor=INK, labelsize=9)
    axes.yaxis.label.set_color(INK)
    axes.xaxis.label.set_color(INK)
    axes.grid(axis="y", color="#eeeeee")
    axes.margins(x=0.01)
