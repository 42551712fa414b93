"""The paths of several balls from above and over time: `paths_picture`. It loads Matplotlib: import it only to draw."""

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from matchset.app.course.figure import draw_over_time
from matchset.app.drawing.plot_style import INK, PAPER, TEXT, figure_of, linear_ticks, picture_of, style_axes, title
from matchset.app.locate.loop import PathLog
from matchset.app.locate.path_picture import SCALE, SIZE_PX, draw_camera, frame_from_above
from matchset.app.several.painter import color_of
from matchset.camera.camera_model import CameraModel

MOST = 20  # format: paths in a picture; those of the balls that were located most often
LABELS = "x, m (right)", "y, m (down)", "z, m (forward)"  # format: of the coordinates


def paths_picture(paths: Mapping[int, PathLog], camera: CameraModel) -> npt.NDArray[np.uint8]:
    """Plot where balls were: from above, and each coordinate over time, each ball in the color of its identity.

    Parameters
    ----------
    paths : mapping of int to PathLog
        By identity; at least one located in at least one frame.
    camera : CameraModel
        The camera, at the origin.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR.
    """
    found = {identity: path for identity, path in paths.items() if path.any_found}
    often = sorted(found, key=lambda identity: -int(np.isfinite(found[identity].position[:, 0]).sum()))
    shown = {identity: found[identity] for identity in sorted(often[:MOST])}
    figures = top_figure(shown, camera, len(found)), coordinates_figure(shown)
    return np.hstack([picture_of(each, SCALE) for each in figures])


def top_figure(paths: Mapping[int, PathLog], camera: CameraModel, count: int) -> Figure:
    """Draw the paths from above: x to the right, z up; each with its identity where it ends. `count`: of all balls."""
    figure, (axes,) = figure_of(SIZE_PX)
    style_axes(axes, grid="both")
    axes.set_xlabel(LABELS[0])
    axes.set_ylabel(LABELS[2])
    linear_ticks(axes.xaxis)
    linear_ticks(axes.yaxis)
    more = "" if count == len(paths) else f" (the {len(paths)} seen most often, of {count})"
    title(axes, f"from above; the number is where a ball was last{more}")
    places = np.concatenate([path.position for path in paths.values()])
    frame_from_above(axes, float(np.nanmax(np.abs(places[:, 0]))), float(np.nanmax(places[:, 2])))
    draw_camera(axes, camera)
    for identity, path in paths.items():
        axes.plot(path.position[:, 0], path.position[:, 2], color=rgb(identity), linewidth=1.6)
    for identity, path in paths.items():
        _mark_end(axes, identity, path)
    return figure


def coordinates_figure(paths: Mapping[int, PathLog]) -> Figure:
    """Draw x, y and z of all balls over time; a gap is where one was not located."""
    figure, rows = figure_of(SIZE_PX, (1.0, 1.0, 1.0))
    for place, (axes, label) in enumerate(zip(rows, LABELS, strict=True)):
        for identity, path in paths.items():
            draw_over_time(axes, path.table[:, 0], path.position[:, place], color=rgb(identity))
        axes.set_ylabel(label)
        linear_ticks(axes.yaxis, 4)
    linear_ticks(rows[-1].xaxis)
    rows[-1].set_xlabel("time, s")
    title(rows[0], "each coordinate over time, in the colors at the left")
    return figure


def rgb(identity: int) -> str:
    """Return the color of an identity as Matplotlib reads it."""
    blue, green, red = color_of(identity)
    return f"#{red:02x}{green:02x}{blue:02x}"


def _mark_end(axes: Axes, identity: int, path: PathLog) -> None:
    """Write an identity where its path ends, on its color."""
    last = int(np.flatnonzero(np.isfinite(path.position[:, 0]))[-1])
    x, z = path.position[last, (0, 2)].tolist()
    if not (math.isfinite(x) and math.isfinite(z)):
        return
    box = {"boxstyle": "round,pad=0.2", "facecolor": PAPER, "edgecolor": rgb(identity), "linewidth": 1.4}
    axes.annotate(str(identity), (x, z), color=INK, fontsize=TEXT, ha="center", va="center", bbox=box, zorder=6)
