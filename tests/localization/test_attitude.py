"""The rotation from directions of markers, against SciPy's `Rotation.align_vectors`."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from balls import BARREL
from matchset.localization.attitude import (
    ATTITUDE,
    AttitudeFit,
    AttitudeParameters,
    fit_level_rotation,
    fit_rotation,
    marker_direction,
    rotation_from_two,
)
from matchset.numeric.record import fields, new_block, store

Floats = npt.NDArray[np.float64]
RNG = np.random.default_rng(0)


def unit_vectors(count: int) -> Floats:
    vectors = RNG.normal(size=(count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


@pytest.mark.parametrize("count", [2, 3, 6])
def test_with_equal_weights_it_is_scipy_s(count: int) -> None:
    for seed in range(5):
        bodies, truth = unit_vectors(count), Rotation.random(random_state=seed)
        seen = truth.apply(bodies) + RNG.normal(0.0, 0.01, (count, 3))
        seen /= np.linalg.norm(seen, axis=1, keepdims=True)
        block = new_block(ATTITUDE)
        fit = fields(block, ATTITUDE)
        store(fit.limits, AttitudeParameters())
        fit.count = count
        fit.bodies[:count], fit.directions[:count] = bodies, seen
        fit.weights[:] = np.eye(3)
        rotation = truth.as_matrix()
        cost = fit_rotation(block.view(ATTITUDE)[0], np.arange(count), rotation)
        theirs, _ = Rotation.align_vectors(seen, bodies)
        np.testing.assert_allclose(rotation, theirs.as_matrix(), atol=1e-7)
        assert cost == pytest.approx(np.square(seen - theirs.apply(bodies)).sum(), rel=1e-6)


def test_two_directions_fix_a_rotation() -> None:
    bodies, truth, rotation = unit_vectors(2), Rotation.random(random_state=1), np.empty((3, 3))
    assert rotation_from_two(bodies, truth.apply(bodies), 0.02, rotation)
    np.testing.assert_allclose(rotation, truth.as_matrix(), atol=1e-12)
    assert not rotation_from_two(bodies[[0, 0]], truth.apply(bodies), 0.02, rotation)


PLACE, REACH = np.array((0.2, -0.1, 1.2)), 0.13


def watching(place: Floats = PLACE) -> tuple[Floats, AttitudeFit]:
    """A workspace with the camera and a ball."""
    block = new_block(ATTITUDE)
    fit = fields(block, ATTITUDE)
    store(fit.limits, AttitudeParameters())
    fit.intrinsics[:], fit.position[:], fit.rim_distance = BARREL.intrinsics, place, REACH
    return block, fit


def direction_at(x: float, y: float, place: Floats = PLACE) -> Floats:
    direction = np.empty(3)
    assert marker_direction(watching(place)[0].view(ATTITUDE)[0], x, y, direction, np.empty((3, 5)))
    return direction


def turned_from_the_camera(cosine: float, around: float) -> Floats:
    """A unit vector from the ball with this cosine to the line of sight of what it points at."""
    toward = -PLACE / np.linalg.norm(PLACE)
    across = np.cross(toward, (0.0, 1.0, 0.0))
    across = Rotation.from_rotvec(around * toward).apply(across / np.linalg.norm(across))
    out = np.sqrt(1.0 - cosine * cosine) * across + cosine * toward
    for _ in range(20):  # the line of sight to the marker, not to the middle of the ball
        toward = -(PLACE + REACH * out) / np.linalg.norm(PLACE + REACH * out)
        across = across - (across @ toward) * toward
        across /= np.linalg.norm(across)
        out = np.sqrt(1.0 - cosine * cosine) * across + cosine * toward
    return np.asarray(out)


@given(st.floats(0.22, 0.999), st.floats(0.0, 6.28))
@settings(max_examples=40)
def test_a_marker_on_the_near_side_is_where_its_ray_meets_the_ball_first(cosine: float, around: float) -> None:
    out = turned_from_the_camera(cosine, around)
    x, y = BARREL.project((PLACE + REACH * out)[np.newaxis])[0].tolist()
    np.testing.assert_allclose(direction_at(x, y), out, atol=1e-6)


@pytest.mark.parametrize("around", [0.0, 2.0, 4.0])
def test_a_ray_that_grazes_the_ball_or_misses_it_fixes_no_direction(around: float) -> None:
    out = turned_from_the_camera(0.15, around)
    miss = PLACE + 1.5 * REACH * out
    for place in (PLACE + REACH * out, miss):
        x, y = BARREL.project(place[np.newaxis])[0].tolist()
        assert not marker_direction(watching()[0].view(ATTITUDE)[0], x, y, np.empty(3), np.empty((3, 5)))


def test_the_derivatives_of_a_direction_are_those_of_its_differences() -> None:
    x, y = BARREL.project((PLACE + REACH * turned_from_the_camera(0.8, 1.0))[np.newaxis])[0].tolist()
    jacobian = np.empty((3, 5))
    assert marker_direction(watching()[0].view(ATTITUDE)[0], x, y, np.empty(3), jacobian)
    step = 1e-4
    pixels = [(direction_at(x + step * (k == 0), y + step * (k == 1)) - direction_at(x, y)) / step for k in range(2)]
    np.testing.assert_allclose(jacobian[:, :2].T, pixels, rtol=1e-3, atol=1e-6)
    step = 1e-6
    places = [(direction_at(x, y, PLACE + step * np.eye(3)[k]) - direction_at(x, y)) / step for k in range(3)]
    np.testing.assert_allclose(jacobian[:, 2:].T, places, rtol=1e-3, atol=1e-3)


def level_rotation(direction: Floats, body: Floats) -> tuple[Floats, AttitudeFit]:
    block, fit = watching()
    fit.directions[0], fit.bodies[0] = direction, body
    rotation = np.empty((3, 3))
    assert fit_level_rotation(block.view(ATTITUDE)[0], 0, 0, rotation)
    return rotation, fit


def test_one_marker_of_level_vehicles_is_met_exactly_and_its_derivatives_are_those_of_differences() -> None:
    body, direction = np.array((0.0, 0.0, 1.0)), np.array((0.6, 0.1, -0.7))
    direction /= np.linalg.norm(direction)
    rotation, fit = level_rotation(direction, body)
    np.testing.assert_allclose(rotation @ body, direction, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(rotation), 1.0)
    assert rotation[1, 1] == pytest.approx(np.sqrt(1.0 - direction[1] ** 2))  # down is as near to down as that allows
    step = 1e-5
    for k in range(3):
        there = direction + step * (np.eye(3)[k] - direction[k] * direction)
        moved, _ = level_rotation(there / np.linalg.norm(there), body)
        turn = Rotation.from_matrix(moved @ rotation.T).as_rotvec() / step
        np.testing.assert_allclose(fit.gains[0, :, k], turn, atol=1e-3)
