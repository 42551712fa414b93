"""A course as curves over time: `course_picture`. It loads Matplotlib, slowly: import it only to draw."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from matchset.app.course.log import Course, found_stretches
from matchset.app.course.speed import speed_of, window_words
from matchset.app.drawing.plot_style import OURS, PALE, SERIES, figure_of, linear_ticks, picture_of, title

Floats = npt.NDArray[np.float64]

SIGMAS = 2.0  # geometry: half-width of the shaded bands, standard deviations
COLORS = (OURS, SERIES[1], SERIES[0])  # format: of the three numbers
SIZE_PX = 540, 310  # format: of each of the two figures
SPEED_COLOR = SERIES[6]  # format: of the speed


def course_picture(course: Course, width: int) -> npt.NDArray[np.uint8]:
    """Draw a course over time: its place on the left, its speed and the third number on the right.

    Parameters
    ----------
    course : Course
        With at least one frame in which it was found.
    width : int
        px

    Returns
    -------
    ndarray of shape (h, width, 3), uint8
        BGR.
    """
    scale = 0.5 * width / SIZE_PX[0]
    return np.hstack([picture_of(each, scale) for each in course_figures(course)])


def course_figures(course: Course) -> tuple[Figure, Figure]:
    """Draw the first two numbers of a course, and its speed with the third one."""
    left, (first, second) = figure_of(SIZE_PX, (1.0, 1.0))
    right, (fast, third) = figure_of(SIZE_PX, (1.0, 1.0))
    draw_numbers([first, second, third], course)
    speed = speed_of(course)
    draw_over_time(fast, course.time, speed, color=SPEED_COLOR)
    mark_lost(fast, course.time, course.found)
    fast.set_ylabel(f"speed, {course.unit}/s")
    most = float(np.max(speed[np.isfinite(speed)], initial=0.0))
    fast.set_ylim(0.0, 1.05 * most or 1.0)
    linear_ticks(fast.yaxis, 4)
    title(fast, f"speed: {window_words()}")
    for axes in (second, third):
        linear_ticks(axes.xaxis)
        axes.set_xlabel("time since the first frame, s")
    return left, right


def draw_numbers(rows: list[Axes], course: Course) -> None:
    """Draw the three numbers of a course, one below the other, with their bands and what they are."""
    for place, (axes, color, label) in enumerate(zip(rows, COLORS, course.labels, strict=True)):
        draw_over_time(axes, course.time, course.values[:, place], SIGMAS * course.std[:, place], color)
        mark_lost(axes, course.time, course.found)
        axes.set_ylabel(label)
        linear_ticks(axes.yaxis, 4)
    lost = "" if course.found.all() else "; gray: not found"
    title(rows[0], f"shaded: ±{SIGMAS:.0f} standard deviations{lost}")


def draw_over_time(axes: Axes, time: Floats, values: Floats, band: Floats | None = None, color: str = OURS) -> None:
    """Draw values over time with a band around them; a gap stays a gap, and a value between two gaps is a dot.

    Parameters
    ----------
    axes : Axes
    time : ndarray of shape (n,), float64
        s
    values : ndarray of shape (n,), float64
        NaN where there is none.
    band : ndarray of shape (n,), float64, optional
        Half the width of the band.
    color : str
    """
    if band is not None:
        axes.fill_between(time, values - band, values + band, color=color, alpha=0.3, linewidth=0)
    axes.plot(time, values, color=color, linewidth=1.3)
    single = [first for first, end in found_stretches(np.isfinite(values)) if end - first == 1]
    if single:
        axes.plot(time[single], values[single], "o", color=color, markersize=4 if len(time) > 1 else 6)


def mark_lost(axes: Axes, time: Floats, found: npt.NDArray[np.bool_]) -> None:
    """Make the stretches gray in which it was not found; the shortest one can be seen."""
    if len(time) < 2:
        return
    middles = 0.5 * (time[1:] + time[:-1])
    edges = np.concatenate(([time[0]], middles, [time[-1]]))
    for first, end in found_stretches(~found):
        axes.axvspan(edges[first], edges[end], facecolor=PALE, edgecolor=PALE, alpha=0.35, linewidth=0.8, zorder=0.5)
    axes.set_xlim(time[0] - 0.01 * (time[-1] - time[0]), time[-1] + 0.01 * (time[-1] - time[0]))
