"""The pictures of the results. Matplotlib is slow to load: import this file only where pictures are drawn."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]

INK, PALE, GRID, PINK = "#444444", "#bbbbbb", "#eeeeee", "#ff28be"
COLORS = ("#0b7a75", "#2f6fde", "#e08a00", PINK)  # of the sequences, from easy to hard
MANY = ("#b9b9b9", "#0b7a75", "#2f6fde", "#e08a00", PINK)  # the last is the one that matters
SMALLEST_PX = 0.01


def errors_over_frames(errors: Mapping[str, Sequence[float]], radii: Sequence[float], path: Path) -> None:
    """Draw the error of Eq. 10 over the frames of some sequences, and below it how large the ball is.

    Parameters
    ----------
    errors : mapping of str to sequence of float
        By sequence; NaN where a frame was not answered, px.
    radii : sequence of float
        True radius of the ball, px.
    path : Path
        A .png file.
    """
    figure, (above, below) = _figure(2, (9.0, 4.2), (4, 1))
    for (name, values), color in zip(errors.items(), MANY if len(errors) > len(COLORS) else COLORS, strict=False):
        above.plot(np.clip(values, SMALLEST_PX, None), color=color, linewidth=1.0)
        mean = float(np.nanmean(values)) if np.isfinite(values).any() else np.nan
        above.plot([], [], color=color, linewidth=4.0, label=f"{name}, mean {mean:.2f} px")
    above.axhline(5.0, color=INK, linewidth=0.8, linestyle=(0, (4, 4)))
    _note(above, "valid below 5 px", (0.0, 5.0), (4, 4), INK)
    above.set_yscale("log")
    above.yaxis.set_major_formatter("{x:g}")
    above.set_ylabel("|Δx| + |Δy| + |Δr|, px")
    _legend(above)
    below.plot(radii, color=INK, linewidth=1.0)
    below.set_ylim(bottom=0)
    below.set_ylabel("r, px")
    below.set_xlabel("frame")
    _save(figure, path)


def error_histogram(errors: Mapping[str, Sequence[float]], path: Path) -> None:
    """Draw how often which error occurs, on a logarithmic scale.

    Parameters
    ----------
    errors : mapping of str to sequence of float
        By sequence, px; NaN is left out.
    path : Path
        A .png file.
    """
    figure, (axes,) = _figure(1, (9.0, 3.2))
    bins = np.geomspace(SMALLEST_PX, 100.0, 81).tolist()
    for (name, values), color in zip(errors.items(), MANY if len(errors) > len(COLORS) else COLORS, strict=False):
        answered = np.asarray(values, float)
        share = 100.0 / max(len(answered), 1)
        answered = np.clip(answered[np.isfinite(answered)], bins[0], bins[-1])
        weights = np.full(len(answered), share)
        axes.hist(answered, bins, weights=weights, histtype="stepfilled", color=color, alpha=0.16)
        axes.hist(answered, bins, weights=weights, histtype="step", color=color, linewidth=1.2)
        axes.plot([], [], color=color, linewidth=4.0, label=name)
    axes.axvline(5.0, color=INK, linewidth=0.8, linestyle=(0, (4, 4)))
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_xlabel("|Δx| + |Δy| + |Δr|, px")
    axes.set_ylabel("% of the frames")
    _legend(axes)
    _save(figure, path)


def times_over_radius(radii: Floats, times: Floats, levels: Mapping[str, float], name: str, path: Path) -> None:
    """Draw what a frame costs against how large the ball is in it.

    Parameters
    ----------
    radii, times : ndarray of shape (n,), float64
        px, and us.
    levels : mapping of str to float
        What does not depend on the radius, us.
    name : str
        What `times` are of.
    path : Path
        A .png file.
    """
    figure, (axes,) = _figure(1, (9.0, 3.4))
    axes.plot(radii, times, "o", color=PINK, markersize=3.5, markeredgewidth=0, alpha=0.8)
    places = {name: float(np.median(times)), **levels}
    for (label, level), color in zip(places.items(), (PINK, INK, INK), strict=False):
        axes.axhline(level, color=color, linewidth=1.0, alpha=0.5 if color == PINK else 1.0)
        axes.annotate(
            f"{label}  {level:.0f} µs",
            (1.0, level),
            xycoords=("axes fraction", "data"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="right",
            color=color,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
            fontsize=9,
        )
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylim(0.5 * min(times.min(), *levels.values()), 2.0 * max(times.max(), *levels.values()))
    axes.set_xlabel("radius of the ball, px")
    axes.set_ylabel("time per frame, µs")
    _save(figure, path)


def range_errors(angles_deg: Sequence[float], errors: Mapping[str, Floats], path: Path) -> None:
    """Draw the error of the range against the angle off the camera's axis: mean, and every single answer.

    Parameters
    ----------
    angles_deg : sequence of float
        One for each column.
    errors : mapping of str to ndarray of shape (angles, n), float64
        By method, %.
    path : Path
        A .png file.
    """
    figure, (axes,) = _figure(1, (9.0, 4.0))
    axes.axhline(0.0, color=PALE, linewidth=1.0)
    for (name, values), color in zip(errors.items(), (COLORS[1], COLORS[2], PINK), strict=True):
        means = np.nanmean(values, axis=1)
        axes.plot(angles_deg, values, ".", color=color, markersize=3, alpha=0.3)
        axes.plot(angles_deg, means, color=color, linewidth=1.6, label=name)
        _note(axes, f"{means[-1]:+.2f} %", (angles_deg[-1], float(means[-1])), (6, -4), color)
    axes.margins(y=0.1)
    axes.set_xlabel("angle between the camera's axis and the ball, degrees")
    axes.set_ylabel("error of the range, %")
    _legend(axes)
    _save(figure, path)


def _figure(rows: int, size: tuple[float, float], heights: tuple[int, ...] = (1,)) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=size, dpi=110, layout="constrained")
    axes = figure.subplots(rows, 1, sharex=True, height_ratios=heights, squeeze=False)[:, 0].tolist()
    for each in axes:
        _calm(each)
    return figure, axes


def _legend(axes: Axes) -> None:
    axes.legend(
        ncols=5,
        frameon=False,
        labelcolor=INK,
        fontsize=9,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        borderaxespad=0.2,
    )


def _note(axes: Axes, text: str, place: tuple[float, float], shift: tuple[float, float], color: str) -> None:
    axes.annotate(text, place, xytext=shift, textcoords="offset points", color=color, fontsize=9)


def _calm(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(PALE)
    axes.tick_params(which="both", color=PALE, labelcolor=INK, labelsize=9)
    axes.yaxis.label.set_color(INK)
    axes.xaxis.label.set_color(INK)
    axes.grid(axis="y", color=GRID)
    axes.set_axisbelow(True)
    axes.margins(x=0.01)


def _save(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    FigureCanvasAgg(figure).print_png(str(path))  # type: ignore[no-untyped-call]
