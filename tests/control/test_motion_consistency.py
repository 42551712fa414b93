"""The motion of the ball answers to the commands of now, or to old ones: poses made with the vehicle's equations."""

import math

import numpy as np
import pytest

from matchset.control.ego_motion import EgoMotion
from matchset.control.motion_consistency import MotionConsistency, MotionConsistencyParameters
from matchset.control.sticks.ego_parameters import AttitudeCommand
from matchset.localization.pose import Pose

FPS, LATENCY = 30, 0.067
BALL = np.array((0.1, 0.0, 1.5))
SETTLED = 1.5  # s
LIMIT = MotionConsistencyParameters().max_evidence


def results(
    amplitude: float = 0.15,
    delay: float = 0.0,
    begin: float = 3.0,
    noise: float = 0.001,
    gust: float = 0.0,
    gain: float = 1.0,
    steps: range = range(180),
    freeze: bool = False,
    drift: float = 0.0,
) -> list[tuple[float, float]]:
    """Fly before a ball with a pitch that changes by so much, rad; time and evidence of each pose.

    From a time on the pictures are so much too old, or the last one. A gust moves the ball, m/s; by a gain the vehicle
    tilts more than its model. The model drifts upward with so much lift, m/s^2, and distances have an error of 1 %.
    """
    rng = np.random.default_rng(5)
    model, ego, consistency, answers = EgoMotion(), EgoMotion(), MotionConsistency(), []
    ball, speed = BALL.copy(), 0.0
    for step in range(max(steps) + 1):
        time = step / FPS
        true = time if time < begin else begin if freeze else time - delay
        there = ego.at(true)
        speed += (gust * rng.standard_normal() * math.sqrt(2.0 / FPS) - speed / FPS) if gust else 0.0
        ball[1] += speed / FPS
        away = there.rotation.T @ (ball - there.position) + noise * rng.standard_normal(3)
        away *= 1.0 + (0.01 * rng.standard_normal() if drift else 0.0)
        if step in steps:
            pose = Pose(position=away, rotation_matrix=None, covariance=np.eye(6), observed="position", time=time)
            consistency.update(pose, model)
            answers.append((time, consistency.evidence))
        wave = amplitude * math.sin(8.0 * time) + 0.5 * amplitude * math.sin(13.0 * time + 1.0)
        model.update(AttitudeCommand(pitch=wave, lift=drift), time + LATENCY)
        ego.update(AttitudeCommand(pitch=gain * wave), time + LATENCY)
    return answers


def worst(answers: list[tuple[float, float]], since: float = SETTLED) -> float:
    return max(value for time, value in answers if time >= since)


def known(answers: list[tuple[float, float]], begin: float = 3.0) -> float:
    """How long after the first old picture it is known that they are old, s; before, nothing may be said."""
    assert worst([each for each in answers if each[0] < begin]) < 1.2
    return next(time for time, value in answers if time >= begin and value > LIMIT) - begin


def test_a_ball_that_moves_as_commanded_answers() -> None:
    assert worst(results(begin=math.inf)) < 0.5
    assert worst(results(begin=math.inf, noise=0.01)) < 1.2
    assert worst(results(begin=math.inf, amplitude=0.0, noise=0.01)) < 1.2


@pytest.mark.parametrize("delay", [-0.03, 0.05, 0.133, 0.2])
def test_a_latency_that_was_told_a_little_wrong_is_no_old_picture(delay: float) -> None:
    assert worst(results(begin=0.0, delay=delay)) < 1.2
    assert worst(results(delay=delay)) < LIMIT


@pytest.mark.parametrize(("gust", "gain"), [(1.0, 1.0), (2.0, 1.0), (0.0, 0.6), (0.0, 1.5), (1.0, 1.4)])
def test_gusts_and_a_poor_model_are_no_old_pictures(gust: float, gain: float) -> None:
    assert worst(results(begin=math.inf, gust=gust, gain=gain)) < LIMIT


@pytest.mark.parametrize("amplitude", [0.15, 0.03])
@pytest.mark.parametrize("delay", [0.4, 0.5, 0.55, 0.8])
def test_old_pictures_are_known_also_when_the_motion_is_small(delay: float, amplitude: float) -> None:
    assert known(results(delay=delay, amplitude=amplitude)) <= 0.4


@pytest.mark.parametrize("drift", [0.5, -0.5])
def test_a_height_that_drifts_does_not_matter(drift: float) -> None:
    assert worst(results(begin=math.inf, drift=drift, steps=range(450))) < 1.2
    assert known(results(delay=0.5, begin=12.0, drift=drift, steps=range(450)), 12.0) <= 0.4


def test_in_gusts_they_are_known_too() -> None:
    assert known(results(delay=0.5, gust=0.5)) <= 0.6


def test_so_is_a_picture_that_stands_still() -> None:
    assert known(results(freeze=True)) <= 0.45


def test_without_own_motion_nothing_is_said_of_old_pictures() -> None:
    assert worst(results(amplitude=0.0, delay=0.5, noise=0.0)) == pytest.approx(0.0, abs=1e-9)


def test_one_outlier_is_left_out() -> None:
    rng = np.random.default_rng(1)
    for _ in range(30):
        consistency, ego, model = MotionConsistency(), EgoMotion(), EgoMotion()
        for step in range(80):
            time, own = step / FPS, ego.at(step / FPS)
            away = own.rotation.T @ (BALL - own.position) + 0.001 * rng.standard_normal(3)
            away[1] += 0.1 * (step == 60)
            pose = Pose(position=away, rotation_matrix=None, covariance=np.eye(6), observed="position", time=time)
            consistency.update(pose, model)
            assert consistency.is_current
            command = AttitudeCommand(pitch=0.1 * math.sin(8.0 * time + rng.uniform(0.0, 0.3)))
            for each in (ego, model):
                each.update(command, time + LATENCY)


def test_it_says_nothing_before_it_has_enough_poses_close_together() -> None:
    answers = results(delay=0.5, begin=0.0)
    assert all(value == 0.0 for time, value in answers if time < 0.8 + 16 / FPS - 1e-9)
    assert worst(answers) > LIMIT
    assert worst(results(delay=0.5, begin=0.0, steps=range(0, 180, 6))) == 0.0


def watched(parameters: MotionConsistencyParameters, steps: int) -> tuple[MotionConsistency, list[tuple[float, bool]]]:
    """Evidence, and whether pictures may be those of now, of pictures that are half a second old from 3 s on."""
    model, ego, consistency, said = EgoMotion(), EgoMotion(), MotionConsistency(parameters), []
    for step in range(steps):
        time = step / FPS
        there = ego.at(time if time < 3.0 else time - 0.5)
        away = there.rotation.T @ (BALL - there.position)
        pose = Pose(position=away, rotation_matrix=None, covariance=np.eye(6), observed="position", time=time)
        consistency.update(pose, model)
        said.append((consistency.evidence, consistency.is_current))
        for each in (ego, model):
            each.update(AttitudeCommand(pitch=0.1 * math.sin(8.0 * time)), time + LATENCY)
    return consistency, said


@pytest.mark.parametrize("confirmations", [1, 2, 3])
def test_so_many_poses_in_a_row_must_give_too_much_evidence(confirmations: int) -> None:
    said = watched(MotionConsistencyParameters(confirmations=confirmations), 120)[1]
    row = 0
    for evidence, holds in said:
        row = row + 1 if evidence > LIMIT else 0
        assert holds == (row < confirmations)
    assert not all(holds for _, holds in said)
    alone = watched(MotionConsistencyParameters(confirmations=1000), 120)[1]
    assert all(holds for _, holds in alone)


def test_after_a_reset_it_begins_anew() -> None:
    consistency = watched(MotionConsistencyParameters(), 120)[0]
    assert not consistency.is_current
    consistency.reset()
    assert consistency.is_current


def test_zero_is_one_of_the_small_delays() -> None:
    small, far = MotionConsistencyParameters().delays
    assert 0.0 in small
    assert small[[0, -1]] == pytest.approx((-1 / 30, 0.2))
    assert far[[0, -1]] == pytest.approx((0.4, 0.8))
    consistency = MotionConsistency()
    assert len(consistency.delays) == len(small) + len(far)


@pytest.mark.parametrize(
    "name",
    [
        "max_duration", "noise", "max_evidence", "settling_time", "window", "min_latency_count",
        "min_evidence_count", "min_changed_count", "stride",
        "delay_spacing", "min_delay", "max_delay", "min_old_delay", "max_old_delay", "moving_average",
    ],
)  # fmt: skip
def test_numbers_out_of_range_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=name):
        MotionConsistencyParameters(**{name: -1})  # type: ignore[arg-type]
