import math

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

import matchset as ms
from balls import Floats, square
from matchset.localization.pose import UNOBSERVED_VARIANCE
from matchset.localization.pose_filter import FilterParameters


def at(
    time: float, place: Floats, spread: Floats | None = None, turn: Rotation | None = None, turn_std: float = 0.01
) -> ms.Pose:
    own = np.diag((1e-6, 1e-6, 1e-4)) if spread is None else spread
    angles = UNOBSERVED_VARIANCE * np.eye(3) if turn is None else turn_std**2 * np.eye(3)
    return ms.Pose(
        position=place,
        rotation_matrix=None if turn is None else turn.as_matrix(),
        covariance=block_diag(own, angles),
        observed="position" if turn is None else "full",
        time=time,
    )


def predicted(filtered: ms.PoseFilter, now: float) -> ms.Pose:
    pose = filtered.predict(now)
    assert isinstance(pose, ms.Pose)
    return pose


def test_a_steady_flight_is_extrapolated_with_jittering_times() -> None:
    rng = np.random.default_rng(1)
    filtered, speed = ms.PoseFilter(), np.array((0.4, -0.1, 0.2))
    time = 0.0
    for _ in range(60):
        time += max(1.0 / 30.0 + rng.normal(0.0, 0.005), 0.002)
        place = np.array((0.0, 0.0, 1.5)) + time * speed
        assert filtered.update(at(time, rng.normal(place, (1e-3, 1e-3, 1e-2))))
    now = time + 0.1
    pose = predicted(filtered, now)
    assert square(pose.position - (0.0, 0.0, 1.5) - now * speed, pose.covariance[:3, :3]) < 11.3
    assert np.linalg.norm(pose.position - (0.0, 0.0, 1.5) - now * speed) < 0.03
    assert pose.time == now
    grown = [np.trace(predicted(filtered, time + ahead).covariance[:3, :3]) for ahead in (0.0, 0.1, 0.3)]
    assert grown == sorted(grown)


def test_the_covariance_of_a_prediction_is_honest() -> None:
    rng = np.random.default_rng(2)
    own = FilterParameters(acceleration=0.5, common_share=0.0)
    squares = []
    for _ in range(60):
        filtered, state, spread = ms.PoseFilter(own), np.zeros(6), np.diag((1e-6, 1e-6, 1e-4))
        state[3:] = rng.normal(0.0, 0.3, 3)
        for k in range(40):
            q = 0.25 * np.kron([[(1 / 30) ** 3 / 3, (1 / 30) ** 2 / 2], [(1 / 30) ** 2 / 2, 1 / 30]], np.eye(3))
            state[:3] += state[3:] / 30
            state += rng.multivariate_normal(np.zeros(6), q)
            filtered.update(at(k / 30, state[:3] + rng.multivariate_normal(np.zeros(3), spread)))
            if k > 20:
                pose = predicted(filtered, k / 30)
                squares.append(square(pose.position - state[:3], pose.covariance[:3, :3]))
    assert 2.4 < np.mean(squares) < 3.6


def test_looking_ahead_halves_the_error_of_a_target_that_turns() -> None:
    rng = np.random.default_rng(3)

    def place(time: float) -> Floats:
        return np.array((0.5 * math.cos(time), 0.1 * math.sin(time), 1.4 + 0.5 * math.sin(time)))

    filtered, ours, theirs = ms.PoseFilter(), [], []
    for k in range(600):
        stamp = k / 30 + float(np.clip(rng.normal(0.0, 0.003), -0.01, 0.01))
        if rng.random() < 0.1:
            filtered.update(ms.Lost("hidden", stamp))
            continue
        pose = at(stamp, rng.normal(place(k / 30), (3e-4, 3e-4, 3e-3)))
        filtered.update(pose)
        if k > 30:
            truth = place(k / 30 + 0.067)
            ours.append(np.linalg.norm(predicted(filtered, stamp + 0.067).position - truth))
            theirs.append(np.linalg.norm(pose.position - truth))
    assert np.sqrt(np.mean(np.square(ours))) < 0.5 * np.sqrt(np.mean(np.square(theirs)))


def test_an_outlier_is_left_out_and_a_new_place_is_believed_in_the_end() -> None:
    filtered = ms.PoseFilter()
    here, there = np.array((0.0, 0.0, 1.5)), np.array((0.5, 0.0, 1.0))
    for k in range(20):
        assert filtered.update(at(k / 30, here))
    assert not filtered.update(at(20 / 30, there))
    np.testing.assert_allclose(predicted(filtered, 20 / 30).position, here, atol=1e-3)
    believed = [filtered.update(at((21 + k) / 30, there)) for k in range(3)]
    assert believed == [False, False, True]
    np.testing.assert_allclose(predicted(filtered, 23 / 30).position, there, atol=1e-3)


def test_turning_is_extrapolated() -> None:
    filtered, spin = ms.PoseFilter(), np.array((0.0, 1.2, 0.3))
    start = Rotation.from_euler("yxz", (170.0, 5.0, 3.0), degrees=True)
    for k in range(60):
        filtered.update(at(k / 30, np.array((0.0, 0.0, 1.5)), turn=Rotation.from_rotvec(k / 30 * spin) * start))
    now = 59 / 30 + 0.1
    pose = predicted(filtered, now)
    assert pose.rotation is not None
    assert pose.observed == "full"
    assert math.degrees((pose.rotation * (Rotation.from_rotvec(now * spin) * start).inv()).magnitude()) < 0.3


def test_a_rotation_that_is_no_longer_observed_is_forgotten() -> None:
    filtered, place = ms.PoseFilter(), np.array((0.0, 0.0, 1.5))
    filtered.update(at(0.0, place, turn=Rotation.identity()))
    for k in range(1, 40):
        filtered.update(at(k / 30, place))
        pose = predicted(filtered, k / 30)
        assert (pose.rotation is not None) == (k <= 15)
        assert pose.observed == ("full" if k <= 15 else "position")
    np.testing.assert_allclose(pose.covariance[3:, 3:], UNOBSERVED_VARIANCE * np.eye(3))


def test_without_a_pose_or_with_an_old_one_it_is_lost() -> None:
    filtered = ms.PoseFilter()
    nothing = filtered.predict(0.0)
    assert isinstance(nothing, ms.Lost)
    assert nothing.reason == "no pose yet"
    filtered.update(at(1.0, np.array((0.0, 0.0, 1.5))))
    assert filtered.predict(1.4)
    old = filtered.predict(2.25)
    assert isinstance(old, ms.Lost)
    assert old.reason == "the last pose is 1.25 s old"
    assert not filtered.update(ms.Lost("hidden", 2.3))
    assert filtered.update(at(2.4, np.array((1.0, 0.0, 3.0))))  # begins anew


def test_time_runs_forward() -> None:
    filtered = ms.PoseFilter()
    filtered.update(at(1.0, np.array((0.0, 0.0, 1.5))))
    for time in (1.0, 0.5, math.nan):
        with pytest.raises(ValueError, match="time must run forward"):
            filtered.update(ms.Lost("hidden", time))
    for now in (0.9, math.nan, math.inf):
        with pytest.raises(ValueError, match=f"got {now}"):
            filtered.predict(now)
