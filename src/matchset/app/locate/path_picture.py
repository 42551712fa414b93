"""The path of a ball from above and over time: `path_picture`. It loads Matplotlib, slowly: import it only to draw."""

import math

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from matchset.app.drawing.curves import INK, PALE, PINK, figure_of, picture_of, style_axes
from matchset.app.locate.loop import PathLog
from matchset.camera.camera_model import CameraModel

Floats = npt.NDArray[np.float64]

SIGMAS = 2.0  # geometry: half-width of the shaded bands, standard deviations
_MAX_ELLIPSES = 600  # geometry: more make the picture no clearer
_AXIS_LABELS = ("x, m (right)", "y, m (down)", "z, m (forward)")


def path_picture(path: PathLog, camera: CameraModel, size: tuple[int, int] = (1480, 760)) -> npt.NDArray[np.uint8]:
    """Plot where the ball was: from above, and each coordinate over time, with bands of two standard deviations.

    Parameters
    ----------
    path : PathLog
        With the ball located in at least one frame.
    camera : CameraModel
        The camera, at the origin.
    size : tuple of two ints
        Width and height of the picture, px.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR.
    """
    figure = figure_of(size)
    grid = figure.add_gridspec(
        3, 2, width_ratios=(1.0, 1.25), left=0.05, right=0.985, top=0.94, bottom=0.08, wspace=0.14, hspace=0.14
    )
    _draw_top(figure.add_subplot(grid[:, 0]), path, camera)
    curves = [figure.add_subplot(grid[axis, 1]) for axis in range(3)]
    for axis, axes in enumerate(curves):
        _draw_coordinate(axes, path, axis)
    for axes in curves[:-1]:
        axes.tick_params(labelbottom=False)
    curves[0].set_title("each coordinate over time", loc="left", color=INK, fontsize=11)
    curves[-1].set_xlabel("time since the first frame, s")
    for axes in figure.axes:
        style_axes(axes)
    figure.axes[0].grid(color="#eeeeee")
    return picture_of(figure)


def _draw_top(axes: Axes, path: PathLog, camera: CameraModel) -> None:
    """Draw the path from above: x to the right, z up, the camera with its field of view at the origin."""
    position = path.position
    x, z = position[:, 0], position[:, 2]
    found = np.flatnonzero(np.isfinite(x))
    _frame_top(axes, float(np.nanmax(np.abs(x))), float(np.nanmax(z)))
    some = found[:: max(1, math.ceil(len(found) / _MAX_ELLIPSES))]
    axes.add_collection(PolyCollection(_ellipses(path, some), facecolor=PINK, edgecolor="none", alpha=0.10))
    axes.plot(x, z, color=PINK, linewidth=1.4)
    for index, words, marker in ((found[0], "first", "o"), (found[-1], "last", "s")):
        axes.plot(x[index], z[index], marker, color=INK, markersize=5)
        axes.annotate(words, (x[index], z[index]), xytext=(7, 4), textcoords="offset points", color=INK, fontsize=9)
    _draw_camera(axes, camera, axes.get_ylim()[1])
    axes.set_xlabel("x, m (right)")
    axes.set_ylabel("z, m (forward)")
    axes.set_title(f"from above; shaded: ±{SIGMAS:.0f} standard deviations", loc="left", color=INK, fontsize=11)


def _frame_top(axes: Axes, wide: float, far: float) -> None:
    """Show x to both sides and z from the camera on, with the same scale for both."""
    box = axes.get_window_extent()
    height = max(1.25 * far, 2.3 * wide * box.height / box.width)
    width = height * box.width / box.height
    axes.set_xlim(-0.5 * width, 0.5 * width)
    axes.set_ylim(-0.07 * height, 0.93 * height)


def _draw_camera(axes: Axes, camera: CameraModel, far: float) -> None:
    """Draw the borders of the picture as seen from above, as far as the lens model has directions there."""
    middle = camera.cy
    for ray in camera.rays(((-0.5, middle), (camera.width - 0.5, middle))):
        if ray[2] > 0.0:
            axes.plot((0.0, far * ray[0] / ray[2]), (0.0, far), color=PALE, linewidth=1.0, linestyle=(0, (4, 4)))
    axes.plot(0.0, 0.0, "^", color=INK, markersize=9)
    axes.annotate("camera", (0.0, 0.0), xytext=(9, -3), textcoords="offset points", color=INK, fontsize=9)


def _ellipses(path: PathLog, some: npt.NDArray[np.intp]) -> list[Floats]:
    """Return the covariance ellipses in x and z, each (24, 2), m."""
    values, vectors = np.linalg.eigh(path.horizontal_covariance[some])
    root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    angles = 2.0 * math.pi * np.arange(24) / 24
    circle = SIGMAS * np.column_stack((np.cos(angles), np.sin(angles)))
    middle = path.position[some][:, (0, 2)]
    return list(middle[:, None, :] + np.einsum("nij,kj->nki", root, circle))


def _draw_coordinate(axes: Axes, path: PathLog, axis: int) -> None:
    time, value, std = path.time, path.position[:, axis], path.std[:, axis]
    axes.fill_between(time, value - SIGMAS * std, value + SIGMAS * std, color=PINK, alpha=0.35, linewidth=0)
    axes.plot(time, value, color=PINK, linewidth=0.8)
    lost = time[~np.isfinite(value)]
    across = axes.get_xaxis_transform()
    axes.plot(lost, np.full(len(lost), 0.02), "|", color=INK, markersize=6, transform=across, clip_on=False)
    typical_mm = 1000.0 * SIGMAS * float(np.nanmedian(std))
    words = f"±{SIGMAS:.0f} standard deviations: {typical_mm:.1f} mm (median)"
    axes.text(1.0, 1.0, words, transform=axes.transAxes, ha="right", va="bottom", color=INK, fontsize=9)
    axes.set_ylabel(_AXIS_LABELS[axis])
