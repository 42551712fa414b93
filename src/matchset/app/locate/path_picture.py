"""The path of a ball from above and over time: `path_picture`. It loads Matplotlib, slowly: import it only to draw."""

import math

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from matchset.app.course.figure import COLORS, SIGMAS, draw_numbers, draw_over_time, mark_lost
from matchset.app.drawing.plot_style import (
    DASHES,
    INK,
    OURS,
    PAPER,
    QUIET,
    TEXT,
    LineLabel,
    figure_of,
    label_lines,
    linear_ticks,
    log_ticks,
    picture_of,
    style_axes,
    title,
)
from matchset.app.locate.loop import PathLog
from matchset.camera.camera_model import CameraModel

Floats = npt.NDArray[np.float64]

SIZE_PX = 540, 560  # format: of each of the two figures; letters can be read on a phone
SCALE = 1.37  # format: of the picture with both
_MAX_ELLIPSES = 600  # geometry: more make the picture no clearer
_MOST_MARKS = 9  # format: round times along the path
_GAP_POINTS = 7.0  # format: from a mark to its time
_SLOPE = 0.35  # geometry: words stand above or below a path that is flatter, beside one that is steeper


def path_picture(path: PathLog, camera: CameraModel) -> npt.NDArray[np.uint8]:
    """Plot where the ball was: from above, and each coordinate over time, with bands of two standard deviations.

    Parameters
    ----------
    path : PathLog
        With the ball located in at least one frame.
    camera : CameraModel
        The camera, at the origin.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR.
    """
    return np.hstack([picture_of(each, SCALE) for each in (top_figure(path, camera), coordinates_figure(path))])


def top_figure(path: PathLog, camera: CameraModel) -> Figure:
    """Draw the path from above: x to the right, z up, the camera with its field of view at the origin."""
    figure, (axes,) = figure_of(SIZE_PX)
    style_axes(axes, grid="both")
    position = path.position
    x, z = position[:, 0], position[:, 2]
    axes.set_xlabel("x, m (right)")
    axes.set_ylabel("z, m (forward)")
    linear_ticks(axes.xaxis)
    linear_ticks(axes.yaxis)
    title(axes, f"from above; shaded: ±{SIGMAS:.0f} standard deviations")
    frame_from_above(axes, float(np.nanmax(np.abs(x))), float(np.nanmax(z)))
    found = np.flatnonzero(np.isfinite(x))
    some = found[:: max(1, math.ceil(len(found) / _MAX_ELLIPSES))]
    axes.add_collection(PolyCollection(_ellipses(path, some), facecolor=OURS, edgecolor="none", alpha=0.14))
    axes.plot(x, z, color=OURS, linewidth=1.6)
    draw_camera(axes, camera)
    _mark_times(axes, path)
    return figure


def coordinates_figure(path: PathLog) -> Figure:
    """Draw x, y and z over time with their bands, and below them their standard deviations."""
    figure, rows = figure_of(SIZE_PX, (1.0, 1.0, 1.0, 1.15))
    draw_numbers(rows[:3], path.course)
    _draw_deviations(rows[3], path)
    return figure


def _draw_deviations(axes: Axes, path: PathLog) -> None:
    """Draw the standard deviations on a logarithmic axis, each with its name and median at its end."""
    labels, std_mm = [], 1000.0 * path.std
    for name, values, color in zip("xyz", np.maximum(std_mm, 1e-6).T, COLORS, strict=True):
        draw_over_time(axes, path.time, values, color=color)
        last = float(values[np.isfinite(values)][-1])
        labels.append(LineLabel(f"{name}: {float(np.nanmedian(values)):.2g}", last, color))
    mark_lost(axes, path.time, path.course.found)
    log_ticks(axes.yaxis, 0.6 * float(np.nanmin(std_mm)), 1.7 * float(np.nanmax(std_mm)))
    linear_ticks(axes.xaxis)
    axes.set_xlabel("time since the first frame, s")
    axes.set_ylabel("σ, mm")
    title(axes, "standard deviation; at the right: its median, mm")
    label_lines(axes, labels)


def frame_from_above(axes: Axes, wide: float, far: float) -> None:
    """Show x to both sides and z from the camera on, with the same scale for both; the layout is fixed from here on."""
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    FigureCanvasAgg(figure)
    for _ in range(3):  # the numbers at the axes and the room for them depend on each other
        figure.draw_without_rendering()
        box = axes.get_window_extent()
        height = max(1.22 * far, 2.5 * wide * box.height / box.width)
        width = height * box.width / box.height
        axes.set_xlim(-0.5 * width, 0.5 * width)
        axes.set_ylim(-0.07 * height, 0.93 * height)
    figure.set_layout_engine("none")


def draw_camera(axes: Axes, camera: CameraModel) -> None:
    """Draw the borders of the picture as seen from above, as far as the lens model has directions there."""
    limits, middle, far = axes.get_xlim(), camera.cy, axes.get_ylim()[1]
    for ray in camera.rays(((-0.5, middle), (camera.width - 0.5, middle))):
        if ray[2] > 0.0:
            axes.plot((0.0, far * ray[0] / ray[2]), (0.0, far), color=QUIET, linewidth=1.0, linestyle=DASHES)
    axes.plot(0.0, 0.0, "^", color=INK, markersize=9)
    axes.annotate(
        "camera", (0.0, 0.0), xytext=(10, 0), textcoords="offset points", color=INK, fontsize=TEXT, va="center"
    )
    axes.set_xlim(limits)


def _mark_times(axes: Axes, path: PathLog) -> None:
    """Mark the first and the last place and those at round times; a time that would lie on another is left out."""
    found, time = np.flatnonzero(np.isfinite(path.position[:, 0])), path.time
    first, last = int(found[0]), int(found[-1])
    step = _round_step(float(time[last] - time[first]))
    rounds = np.arange(math.ceil(time[first] / step), math.floor(time[last] / step) + 1) * step
    at = {first: f"{time[first]:.3g} s"} | ({last: f"{time[last]:.3g} s"} if last > first else {})
    for each in rounds:
        at.setdefault(int(found[np.argmin(np.abs(time[found] - each))]), f"{each:g}")
    places = axes.transData.transform(path.position[found][:, (0, 2)])
    taken: list[Bbox] = []
    for index, words in at.items():
        end = index in (first, last)
        spot = path.position[index, (0, 2)]
        if _write_aside(axes, words, spot, places, taken) or end:
            axes.plot(*spot, "o", color=OURS, markersize=8 if end else 5, markeredgecolor=PAPER, zorder=5)


def _write_aside(axes: Axes, words: str, spot: Floats, places: Floats, taken: list[Bbox]) -> bool:
    """Write beside a point of the path, where neither that (`places`, px) nor other words are; say if there is room."""
    outward = _outward(places, axes.transData.transform(spot))
    for turn in (0.0, math.pi, 0.5, -0.5, 1.0, -1.0, 2.0, -2.0):
        u, v = math.cos(outward + turn), math.sin(outward + turn)
        text = axes.annotate(
            words,
            (float(spot[0]), float(spot[1])),
            xytext=(u * _GAP_POINTS, v * _GAP_POINTS),
            textcoords="offset points",
            color=INK,
            fontsize=TEXT,
            ha="left" if u > _SLOPE else "right" if u < -_SLOPE else "center",
            va="bottom" if v > _SLOPE else "top" if v < -_SLOPE else "center",
        )
        box = text.get_window_extent()
        if not box.count_contains(places) and not any(box.overlaps(other) for other in taken):
            taken.append(box)
            return True
        text.remove()
    return False


def _outward(places: Floats, at: Floats) -> float:
    """Angle of the direction across a path, away from its middle; rad."""
    index = int(np.argmin(np.hypot(*(places - at).T)))
    near = places[max(index - 2, 0) : index + 3]
    along = near[-1] - near[0]
    across = np.array((-along[1], along[0]))
    if across @ (at - places.mean(axis=0)) < 0.0:
        across = -across
    return math.atan2(across[1], across[0])


def _round_step(duration: float) -> float:
    """Least round number of seconds that divides a duration into few parts."""
    if not duration > 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(duration / _MOST_MARKS))
    return next(power * step for step in (1.0, 2.0, 5.0, 10.0) if power * step * _MOST_MARKS >= duration)


def _ellipses(path: PathLog, some: npt.NDArray[np.intp]) -> list[Floats]:
    """Return the covariance ellipses in x and z, each (24, 2), m."""
    values, vectors = np.linalg.eigh(path.horizontal_covariance[some])
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    angles = 2.0 * math.pi * np.arange(24) / 24
    circle = SIGMAS * np.column_stack((np.cos(angles), np.sin(angles)))
    middle = path.position[some][:, (0, 2)]
    return list(middle[:, None, :] + np.einsum("nij,kj->nki", root, circle))
