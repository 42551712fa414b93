"""Curves of a course: laid out well, gray where it was lost, and a gap stays a gap."""

import math
from collections.abc import Callable

import numpy as np
import pytest

import matchset as ms
from matchset.app.course.figure import course_figures, course_picture
from matchset.app.course.log import ShapeLog
from matchset.app.track.loop import TrackedFrame
from matchset.app.track.rows import track_row
from plot_layout import faults


def course_log(frames: int, lost: range = range(0), start: float = 0.0) -> ShapeLog:
    log = ShapeLog(ms.Circle)
    for index in range(frames):
        time = start + index / 30.0
        circle = ms.Circle(300.0 + 90.0 * time, 200.0 + 50.0 * math.sin(3.0 * time), 40.0)
        answer: ms.Track[ms.Circle] | ms.Lost[ms.Circle]
        answer = ms.Track(circle, 0.04 * np.eye(3), 1.0, np.empty((0, 2)), time)
        if index in lost:
            answer = ms.Lost("behind a tree", time)
        log.add(TrackedFrame(None, answer, track_row(index, answer)))
    return log


LOGS: dict[str, Callable[[], ShapeLog]] = {
    "whole": lambda: course_log(150),
    "with a gap": lambda: course_log(150, range(40, 60)),
    "one frame": lambda: course_log(1),
    "two frames": lambda: course_log(2),
    "found once": lambda: course_log(90, range(1, 90)),
    "lost once": lambda: course_log(3000, range(1500, 1501)),
}


@pytest.mark.parametrize("name", sorted(LOGS))
def test_any_course_is_laid_out_well(name: str) -> None:
    for figure in course_figures(LOGS[name]().course):
        assert not faults(figure)


def test_a_lost_stretch_is_gray_in_every_plot_and_no_line_crosses_it() -> None:
    course = course_log(150, range(40, 60)).course
    for axes in (axes for figure in course_figures(course) for axes in figure.axes):
        (span,) = axes.patches
        left, right = span.get_extents().transformed(axes.transData.inverted()).intervalx
        assert left == pytest.approx(39.5 / 30.0, abs=1e-3)
        assert right == pytest.approx(59.5 / 30.0, abs=1e-3)
        values = np.asarray(axes.lines[0].get_ydata(), float)
        assert np.flatnonzero(np.isnan(values)).tolist() == list(range(40, 60))


def test_one_lost_frame_of_many_can_be_seen() -> None:
    whole, once = (course_picture(course_log(3000, lost).course, 1480) for lost in (range(0), range(1500, 1501)))
    changed = (whole != once).any(axis=2)
    assert changed.any(axis=0).sum() >= 2  # columns of pixels, in both figures


def test_the_curves_show_what_was_measured() -> None:
    course = course_log(60, start=1000.0).course
    left, right = course_figures(course)
    labels = [axes.get_ylabel() for axes in (*left.axes, *right.axes)]
    assert labels == ["x, px (right)", "y, px (down)", "speed, px/s", "radius, px"]
    times = np.arange(60) / 30.0
    x, speed = left.axes[0].lines[0], right.axes[0].lines[0]
    assert np.asarray(x.get_xdata(), float) == pytest.approx(times, abs=1e-6)  # since the first frame
    assert np.asarray(x.get_ydata(), float) == pytest.approx(300.0 + 90.0 * (1000.0 + times))
    expected = np.hypot(90.0, 150.0 * np.cos(3.0 * (1000.0 + times)))
    assert np.asarray(speed.get_ydata(), float)[4:-4] == pytest.approx(expected[4:-4], rel=0.02)


@pytest.mark.parametrize(
    ("shape", "label", "size"),
    [
        (ms.Ellipse(60.0, 50.0, 30.0, 20.0, 0.0), "half-width, px", 30.0),
        (ms.Quadrilateral(((0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0))), "half-width, px", None),
    ],
)
def test_other_shapes_have_a_center_and_a_half_width(shape: ms.Ellipse, label: str, size: float | None) -> None:
    log = ShapeLog(type(shape))
    count = len(shape.parameters)
    answer = ms.Track(shape, 0.04 * np.eye(count), 1.0, np.empty((0, 2)), 0.0)
    log.add(TrackedFrame(None, answer, track_row(0, answer)))
    course = log.course
    assert course.labels[2] == label
    assert course.values[0, :2] == pytest.approx(shape.center)
    assert course.values[0, 2] > 0.0
    if size is not None:
        assert course.values[0, 2] == pytest.approx(size, rel=0.4)


def test_nothing_found_is_a_course_of_gaps() -> None:
    log = course_log(5, range(5))
    assert not log.any_found
    assert not log.course.found.any()
    assert not ShapeLog(ms.Circle).course.found.any()
