"""The motion of the ball answers to the commands, or it does not: poses made with the vehicle's own equations."""

import math

import numpy as np
import pytest

from matchset.control.ego_motion import AttitudeCommand, EgoMotion
from matchset.control.motion_consistency import MotionConsistency, MotionConsistencyParameters, measure
from matchset.localization.pose import Pose

FPS, LATENCY = 30, 0.067
BALL = np.array((0.1, 0.0, 1.5))
SETTLED = 1.5  # s


def results(
    amplitude: float = 0.15,
    delay: float = 0.0,
    begin: float = 2.0,
    noise: float = 0.0,
    steps: range = range(150),
    freeze: bool = False,
) -> list[tuple[float, float]]:
    """Fly before a ball at rest with a pitch that changes by so much, rad; time and inconsistency of each pose.

    From a time on the pictures are so much too old, or the last one.
    """
    rng = np.random.default_rng(5)
    ego, consistency, answers = EgoMotion(), MotionConsistency(), []
    for step in range(max(steps) + 1):
        time = step / FPS
        true = time if time < begin else begin if freeze else time - delay
        own, there = ego.at(time), ego.at(true)
        away = there.rotation.T @ (BALL - there.position) + noise * rng.standard_normal(3)
        if step in steps:
            pose = Pose(position=away, rotation_matrix=None, covariance=np.eye(6), observed="position", time=time)
            consistency.update(pose, own)
            answers.append((time, consistency.inconsistency))
        wave = amplitude * math.sin(8.0 * time) + 0.5 * amplitude * math.sin(13.0 * time + 1.0)
        ego.update(AttitudeCommand(pitch=wave), time + LATENCY)
    return answers


def worst(answers: list[tuple[float, float]], since: float = SETTLED) -> float:
    return max(value for time, value in answers if time >= since)


def test_a_ball_that_moves_as_commanded_is_consistent() -> None:
    assert worst(results(begin=math.inf)) < 0.1
    assert worst(results(begin=math.inf, noise=0.005)) < 0.2
    assert worst(results(begin=math.inf, amplitude=0.0, noise=0.01)) < 0.4


@pytest.mark.parametrize("delay", [0.2, 0.3, 0.5, 0.8])
def test_old_pictures_are_not(delay: float) -> None:
    answers = results(delay=delay)
    assert worst([each for each in answers if each[0] < 2.0]) < 0.1
    first = next(time for time, value in answers if time >= 2.0 and value > 0.4)
    assert first - 2.0 <= 0.3


def test_neither_is_a_picture_that_stands_still() -> None:
    answers = results(freeze=True)
    assert next(time for time, value in answers if time >= 2.0 and value > 0.4) - 2.0 <= 0.3


def test_without_own_motion_nothing_is_said_of_old_pictures() -> None:
    assert worst(results(amplitude=0.0, delay=0.5)) == pytest.approx(0.0, abs=1e-9)


def test_one_outlier_is_left_out() -> None:
    rng = np.random.default_rng(1)
    for _ in range(100):
        window = np.zeros((10, 9))
        window[:, 0], window[:, 8] = np.arange(10) / 30, 1.5
        pitch = 0.1 * np.sin(8.0 * window[:, 0] + rng.uniform(0.0, 6.0))
        window[:, 2], window[:, 3] = np.cos(pitch), np.sin(pitch)
        window[:, 5], window[:, 6] = -np.sin(pitch), np.cos(pitch)
        assert measure(window, 0.012) < 1e-6
        order = rng.permutation(10)
        window[5, 5] += 0.03
        assert measure(window, 0.012) < 0.4
        assert measure(np.ascontiguousarray(window[order]), 0.012) == pytest.approx(measure(window, 0.012))


def test_it_says_nothing_before_it_has_enough_poses_close_together() -> None:
    answers = results(delay=0.5, begin=0.0)
    assert all(value == 0.0 for time, value in answers if time < 0.8 + 9 / FPS - 1e-9)
    assert worst(answers) > 0.4
    assert worst(results(delay=0.5, begin=0.0, steps=range(0, 150, 3))) == 0.0


def test_after_a_reset_it_begins_anew() -> None:
    consistency = MotionConsistency()
    assert consistency.holds
    consistency.inconsistency = 1.0
    assert not consistency.holds
    consistency.reset()
    assert consistency.holds


@pytest.mark.parametrize("name", ["max_duration", "noise", "max_inconsistency", "settling_time", "window"])
def test_numbers_out_of_range_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=name):
        MotionConsistencyParameters(**{name: -1})
