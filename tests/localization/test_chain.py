"""Poses composed along a chain: against plain geometry, and the covariance against random errors."""

import math

import numpy as np
import numpy.typing as npt
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from matchset.localization.chain import FACING_AWAY, Mount, compose, seen_from_last
from matchset.localization.pose import UNOBSERVED_VARIANCE, Pose
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]
MOUNT = Mount((0.02, 0.19, -0.05))


def pose(position: Floats, turn: Floats | None, spread: Floats | None = None, time: float = 1.0) -> Pose:
    covariance = np.diag((1e-5, 1e-5, 4e-5, 1e-4, 2e-4, 1e-4)) if spread is None else spread
    observed = "position" if turn is None else "full"
    return Pose(position=position, rotation_matrix=turn, covariance=covariance, observed=observed, time=time)  # type: ignore[arg-type]


def room(seed: int, count: int = 3) -> list[tuple[Floats, Floats]]:
    """Balls in a room, place and turn, each about 1.5 m before the last."""
    rng = np.random.default_rng(seed)
    return [
        (np.array((0.0, 0.0, 1.5 * k)) + rng.normal(0.0, 0.2, 3), _turn(rng.normal(0.0, 0.2, 3)) @ FACING_AWAY)
        for k in range(count)
    ]


def camera_of(ball: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    place, turn = ball
    return place + turn @ np.array(MOUNT.lens), turn @ FACING_AWAY


def sight(camera: tuple[Floats, Floats], ball: tuple[Floats, Floats]) -> Pose:
    return pose(camera[1].T @ (ball[0] - camera[0]), camera[1].T @ ball[1])


def _turn(vector: Floats) -> Floats:
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


@settings(max_examples=50)
@given(st.integers(0, 10_000))
def test_two_sights_make_the_sight_of_who_cannot_be_seen(seed: int) -> None:
    balls = room(seed)
    cameras = [camera_of(ball) for ball in balls]
    composed = compose(sight(cameras[0], balls[1]), sight(cameras[1], balls[2]), MOUNT)
    direct = sight(cameras[0], balls[2])
    assert isinstance(composed, Pose)
    assert composed.rotation_matrix is not None
    assert direct.rotation_matrix is not None
    np.testing.assert_allclose(composed.position, direct.position, atol=1e-12)
    np.testing.assert_allclose(composed.rotation_matrix, direct.rotation_matrix, atol=1e-12)


def test_a_straight_chain_keeps_its_distances() -> None:
    ahead = pose(np.array((0.0, -0.19, 1.5)), FACING_AWAY)
    composed = compose(ahead, ahead)
    assert isinstance(composed, Pose)
    np.testing.assert_allclose(composed.position, (0.0, -0.19, 3.05))
    first, second = seen_from_last([ahead, ahead])
    assert first is not None
    assert second is not None
    np.testing.assert_allclose(first.position, (0.0, 0.19, 3.05), atol=1e-15)
    np.testing.assert_allclose(second.position, (0.0, 0.19, 1.5), atol=1e-15)


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.integers(2, 6))
def test_every_camera_of_a_chain_is_where_it_is(seed: int, count: int) -> None:
    balls = room(seed, count)
    cameras = [camera_of(ball) for ball in balls[:-1]]
    last_place, last_turn = balls[-1]
    places = seen_from_last([sight(me, ball) for me, ball in zip(cameras, balls[1:], strict=True)], MOUNT)
    for place, (where, turn) in zip(places, cameras, strict=True):
        assert place is not None
        np.testing.assert_allclose(place.position, last_turn.T @ (where - last_place), atol=1e-11)
        np.testing.assert_allclose(place.rotation_matrix, last_turn.T @ turn, atol=1e-11)


def test_the_covariance_is_that_of_random_errors() -> None:
    balls, rng = room(4), np.random.default_rng(5)
    cameras = [camera_of(ball) for ball in balls]
    first, second = sight(cameras[0], balls[1]), sight(cameras[1], balls[2])
    exact = compose(first, second, MOUNT)
    assert isinstance(exact, Pose)
    errors = []
    for _ in range(4000):
        tried = compose(_shaken(first, rng), _shaken(second, rng), MOUNT)
        assert isinstance(tried, Pose)
        assert tried.rotation_matrix is not None
        assert exact.rotation_matrix is not None
        turned = Rotation.from_matrix(tried.rotation_matrix @ exact.rotation_matrix.T).as_rotvec()
        errors.append(np.concatenate((tried.position - exact.position, turned)))
    seen = np.cov(np.array(errors).T)
    scale = np.sqrt(np.outer(np.diag(exact.covariance), np.diag(exact.covariance)))
    assert np.abs((seen - exact.covariance) / scale).max() < 0.08


def _shaken(seen: Pose, rng: np.random.Generator) -> Pose:
    off = rng.multivariate_normal(np.zeros(6), seen.covariance)
    assert seen.rotation_matrix is not None
    return pose(seen.position + off[:3], _turn(off[3:]) @ seen.rotation_matrix)


def test_what_is_not_known_is_said() -> None:
    ahead = pose(np.array((0.0, 0.0, 1.5)), FACING_AWAY, time=2.0)
    blind = pose(np.array((0.0, 0.0, 1.5)), None, time=1.0)
    lost: Lost[Pose] = Lost("hidden", 3.0)
    assert compose(lost, ahead) is lost
    assert compose(ahead, lost) is lost
    gap = compose(blind, ahead)
    assert isinstance(gap, Lost)
    assert "not observed" in gap.reason
    end = compose(ahead, blind)
    assert isinstance(end, Pose)
    assert (end.observed, end.rotation_matrix, end.time) == ("position", None, 1.0)
    np.testing.assert_allclose(end.covariance[3:, 3:], UNOBSERVED_VARIANCE * np.eye(3))
    assert math.isfinite(end.covariance.sum())
    assert [place is None for place in seen_from_last([ahead, lost, ahead])] == [True, True, False]
    assert seen_from_last([]) == []
