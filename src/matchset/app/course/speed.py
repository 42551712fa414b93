"""The speed of what was measured: the slope of a parabola through the measurements around each (`speed_of`)."""

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.course.log import Course, found_stretches

Floats = npt.NDArray[np.float64]

AT_ONCE = 4096  # format: frames whose parabolas are fitted together, for the memory that this takes
COEFFICIENTS = 3  # theorem: of a parabola


class CourseSpeedParameters(msgspec.Struct, frozen=True):
    """Over which measurements a speed is taken.

    Parameters
    ----------
    window : float
        Length of the window, s. Longer is steadier, as its power of -1.5, and rounds off what changes within it: a
        throw is a parabola and keeps its speed, a bounce is drawn out over the window. Chosen by hand: at 30 frames/s,
        7 places known to 0.2 px give the velocity to 1.1 px/s.
    least : int
        Measurements at least, where the stretch has them: few pictures a second take a longer window. Chosen by hand.
    """

    window: float = 0.25
    least: int = 5


PARAMETERS = CourseSpeedParameters()


def speed_of(course: Course, parameters: CourseSpeedParameters = PARAMETERS) -> Floats:
    """Estimate the speed of a place, frame by frame.

    In each stretch in which it was found without a gap a parabola is fitted to every coordinate by least squares, over
    the window around each frame (Savitzky & Golay, 1964, at the times as they are); the slope there is the velocity,
    its length the speed. At the ends of a stretch the window lies within it. Of two frames it is their difference.

    Parameters
    ----------
    course : Course
    parameters : CourseSpeedParameters, optional

    Returns
    -------
    ndarray of shape (n,), float64
        Of the place, px/s or m/s; NaN where it was not found, and in a stretch of a single frame.
    """
    speed = np.full(len(course.time), np.nan)
    for first, end in found_stretches(course.found):
        if end - first > 1:
            slope = local_slope(course.time[first:end], course.values[first:end, : course.place], parameters)
            speed[first:end] = np.hypot.reduce(slope, axis=1)
    return speed


def local_slope(time: Floats, values: Floats, parameters: CourseSpeedParameters = PARAMETERS) -> Floats:
    """Fit a parabola around each time and return its slope there.

    Parameters
    ----------
    time : ndarray of shape (n,), float64
        Increasing, n >= 2, s.
    values : ndarray of shape (n, k), float64
    parameters : CourseSpeedParameters, optional

    Returns
    -------
    ndarray of shape (n, k), float64
        Change of the values per second.

    Raises
    ------
    ValueError
        If there are fewer than two times, or they do not increase.
    """
    if len(time) < 2 or not (np.diff(time) > 0.0).all():
        raise ValueError(f"a slope needs two times or more, each later than the one before, got {time.tolist()!r:.60}")
    begin, end = _windows(time, parameters)
    slope = np.empty_like(values)
    for first in range(0, len(time), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        slope[part] = _fitted(time, values, part, begin[part], end[part])
    return slope


def _windows(time: Floats, parameters: CourseSpeedParameters) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """First measurement of each time's window, and the one after its last."""
    n, half = len(time), 0.5 * parameters.window * (1.0 + 1e-9)
    middle = 0.5 * (time[0] + time[-1])
    center = np.clip(time, min(time[0] + half, middle), max(time[-1] - half, middle))
    begin, end = np.searchsorted(time, center - half, "left"), np.searchsorted(time, center + half, "right")
    least = min(parameters.least, n)
    few = np.clip(np.arange(n) - least // 2, 0, n - least)
    short = end - begin < least
    return np.where(short, few, begin), np.where(short, few + least, end)


def _fitted(
    time: Floats, values: Floats, part: slice, begin: npt.NDArray[np.intp], end: npt.NDArray[np.intp]
) -> Floats:
    """Slopes of the parabolas of some frames: the normal equations of all windows at once."""
    place = begin[:, None] + np.arange(int((end - begin).max()))
    inside = (place < end[:, None]).astype(float)
    place = np.minimum(place, len(time) - 1)
    since = time[place] - time[part, None]
    scale = np.abs(since * inside).max(axis=1, keepdims=True)
    powers = inside[..., None] * (since / scale)[..., None] ** np.arange(min(COEFFICIENTS, len(time)))
    normal = np.einsum("nwi,nwj->nij", powers, powers)
    right = np.einsum("nwi,nwk->nik", powers, values[place])
    found: Floats = np.linalg.solve(normal, right)[:, 1] / scale
    return found


def window_words(parameters: CourseSpeedParameters = PARAMETERS) -> str:
    """Say how the speed was taken."""
    return f"slope of a parabola over {1000.0 * parameters.window:g} ms, {parameters.least} frames at least"
