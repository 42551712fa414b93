"""The speed of a course: exact for parabolas, steady in noise, never across a gap."""

import math

import numpy as np
import pytest

from matchset.app.course.log import Course, found_stretches
from matchset.app.course.speed import CourseSpeedParameters, local_slope, speed_of

LABELS = "x, px (right)", "y, px (down)", "radius, px"


def course_of(time: np.ndarray, place: np.ndarray, lost: tuple[int, ...] = (), dimensions: int = 2) -> Course:
    values = np.column_stack((place, np.full((len(time), 3 - place.shape[1]), 20.0)))
    values[list(lost)] = math.nan
    return Course(time, values, 0.0 * values, LABELS, "px", dimensions)


@pytest.mark.parametrize("fps", [10.0, 25.0, 30.0, 240.0])
def test_a_throw_has_its_speed_to_the_last_frame(fps: float) -> None:
    time = np.arange(2.0, 3.2, 1.0 / fps)
    place = np.column_stack((300.0 * time, 50.0 - 400.0 * time + 490.0 * time**2))
    speed = speed_of(course_of(time, place))
    assert speed == pytest.approx(np.hypot(300.0, 980.0 * time - 400.0), rel=1e-6)


def test_times_that_jitter_count_as_they_are() -> None:
    time = np.cumsum(np.random.default_rng(0).uniform(0.01, 0.06, 80))
    place = np.column_stack((90.0 * time, 40.0 * time))
    assert speed_of(course_of(time, place)) == pytest.approx(math.hypot(90.0, 40.0), rel=1e-6)


def test_noise_gives_the_deviation_that_the_window_promises() -> None:
    time = np.arange(0.0, 200.0, 1.0 / 30.0)
    noise = np.random.default_rng(1).normal(0.0, 0.2, (len(time), 2))
    slope = local_slope(time, noise)[10:-10]
    assert slope.std() == pytest.approx(1.1, rel=0.1)


def test_a_gap_stays_a_gap_and_nothing_is_taken_across_it() -> None:
    time = np.arange(60) / 30.0
    place = np.column_stack((100.0 * time, 0.0 * time))
    place[30:, 0] += 500.0  # it jumps while nobody sees it
    speed = speed_of(course_of(time, place, lost=(28, 29, 45, 47)))
    assert np.flatnonzero(np.isnan(speed)).tolist() == [28, 29, 45, 46, 47]  # 46 alone has no speed
    assert speed[np.isfinite(speed)] == pytest.approx(100.0)


def test_two_frames_give_their_difference_and_one_gives_none() -> None:
    two = speed_of(course_of(np.array([0.0, 0.1]), np.array([[0.0, 0.0], [3.0, 4.0]])))
    assert two == pytest.approx([50.0, 50.0])
    assert np.isnan(speed_of(course_of(np.array([0.0]), np.array([[0.0, 0.0]])))).all()
    assert len(speed_of(course_of(np.empty(0), np.empty((0, 2))))) == 0


def test_meters_count_in_three_dimensions() -> None:
    time = np.arange(20) / 30.0
    place = np.column_stack((1.0 * time, 2.0 * time, 2.0 * time))
    assert speed_of(course_of(time, place, dimensions=3)) == pytest.approx(3.0)


def test_few_pictures_a_second_take_a_longer_window() -> None:
    time = np.arange(12) / 2.0
    noise = np.random.default_rng(2).normal(0.0, 1.0, (len(time), 1))
    five = np.array([np.polyfit(time[k - 2 : k + 3], noise[k - 2 : k + 3, 0], 2) for k in range(2, 10)])
    exact = 2.0 * five[:, 0] * time[2:10] + five[:, 1]
    assert local_slope(time, noise, CourseSpeedParameters(least=5))[2:10, 0] == pytest.approx(exact)


@pytest.mark.parametrize("time", [[0.0], [0.0, 0.0], [1.0, 0.5]])
def test_times_that_do_not_increase_are_refused(time: list[float]) -> None:
    with pytest.raises(ValueError, match="each later than the one before"):
        local_slope(np.array(time), np.zeros((len(time), 1)))


def test_stretches_are_those_of_found_frames() -> None:
    assert found_stretches(np.array([True, True, False, True])) == [(0, 2), (3, 4)]
    assert found_stretches(np.zeros(3, bool)) == []
