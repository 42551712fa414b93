import math
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

import matchset as ms
from balls import BARREL, PINHOLE, Floats, ball, rim, square, track
from matchset.localization.cone import CONE, BallParameters, ConeFailure, OutlineRays, fit_cone, reweight
from matchset.localization.localizer import LocalizerParameters
from matchset.numeric.jit import kernel
from matchset.numeric.record import fields, new_block, store
from matchset.sim.clips.truth import sphere_outline

EXACT = BallParameters(edge_shift_px=0.0)
BARE = BallParameters(edge_shift_px=0.0, inflation=1.0, center_sigma_px=1e-6, size_sigma_px=1e-6)
cameras = st.sampled_from([PINHOLE, BARREL])
places = st.tuples(st.floats(-0.55, 0.55), st.floats(-0.4, 0.4), st.floats(0.7, 6.0)).map(
    lambda p: np.array((p[0] * p[2], p[1] * p[2], p[2]))
)


def pose_of(
    camera: ms.CameraModel, seen: "ms.Track[ms.Circle]", parameters: BallParameters = EXACT, radius: float = 0.14
) -> "ms.Pose | ms.Lost[ms.Pose]":
    target = ms.BallTarget(diameter=2.0 * radius)
    return ms.Localizer(camera, target, LocalizerParameters(ball=parameters)).update(seen)


def located(
    camera: ms.CameraModel, seen: "ms.Track[ms.Circle]", parameters: BallParameters = EXACT, radius: float = 0.14
) -> tuple[Floats, Floats]:
    found = pose_of(camera, seen, parameters, radius)
    assert isinstance(found, ms.Pose), found
    return found.position, found.covariance[:3, :3]


def slow_position(camera: ms.CameraModel, points: Floats, start: Floats) -> Floats:
    """Twin of the kernel, without weights: the sphere whose projected rim is nearest to the points, in px."""

    def errors(position: Floats) -> Floats:
        outline = camera.project(rim(position, count=720))
        middle = outline.mean(axis=0)
        turns = np.arctan2(*(outline - middle).T[::-1])
        order = np.argsort(turns)
        out = []
        for point in points:
            angle = math.atan2(point[1] - middle[1], point[0] - middle[0])
            far = np.interp(angle, turns[order], np.hypot(*(outline - middle).T)[order], period=2.0 * math.pi)
            out.append(math.hypot(*(point - middle)) - far)
        return np.array(out)

    return np.asarray(least_squares(errors, start, x_scale=(0.01, 0.01, 0.1)).x)


@given(cameras, places)
def test_an_exact_outline_gives_the_exact_place_at_any_angle_off_axis(camera: ms.CameraModel, place: Floats) -> None:
    position, covariance = located(camera, ball(camera, place))
    np.testing.assert_allclose(position, place, rtol=1e-6, atol=1e-8)
    assert np.linalg.eigvalsh(covariance).min() > 0.0


@given(places, st.floats(0.02, 3.0))
@settings(max_examples=30)
def test_all_lengths_scale_with_the_diameter(place: Floats, scale: float) -> None:
    seen = ball(PINHOLE, place)
    found, _ = located(PINHOLE, seen, radius=0.14 * scale)
    np.testing.assert_allclose(found, scale * located(PINHOLE, seen)[0], rtol=1e-9)


@pytest.mark.parametrize("camera", [PINHOLE, BARREL])
def test_the_kernel_agrees_with_its_slow_twin_on_noisy_points(camera: ms.CameraModel) -> None:
    rng = np.random.default_rng(3)
    place = np.array((0.5, -0.25, 1.3))
    for _ in range(3):
        points = camera.project(rim(place)) + rng.normal(0.0, 0.2, (64, 2))
        block = new_block(CONE)
        fit = fields(block, CONE)
        store(fit.limits, BARE)
        fit.intrinsics[:], fit.inside[:], fit.radius = camera.intrinsics, points.mean(axis=0), 0.14
        assert fit_cone(block.view(CONE)[0], points) == ConeFailure.NONE
        slow = slow_position(camera, points, place)
        np.testing.assert_allclose(fit.position, slow, atol=2e-4 * 1.3)


@pytest.mark.parametrize("camera", [PINHOLE, BARREL])
@pytest.mark.parametrize("place", [(0.0, 0.0, 1.5), (0.6, -0.3, 1.2)])
def test_the_covariance_of_independent_noise_is_honest(camera: ms.CameraModel, place: tuple[float, ...]) -> None:
    rng = np.random.default_rng(1)
    truth, squares, errors = np.array(place), [], []
    outline = camera.project(rim(truth))
    for _ in range(400):
        seen = track(outline + rng.normal(0.0, 0.3, outline.shape))
        position, covariance = located(camera, seen, BARE)
        errors.append(position - truth)
        squares.append(square(position - truth, covariance))
    assert np.abs(np.mean(errors, axis=0)).max() < 3e-4
    assert 2.4 < np.mean(squares) < 3.8
    assert 0.90 < np.mean(np.array(squares) < 7.815) < 0.98


def test_points_that_are_wrong_hardly_count() -> None:
    rng = np.random.default_rng(2)
    truth = np.array((0.3, 0.2, 1.4))
    outline = PINHOLE.project(rim(truth))
    wrong = []
    for _ in range(50):
        points = outline + rng.normal(0.0, 0.2, outline.shape)
        hidden = rng.integers(64)
        points[hidden : hidden + 12] += 0.08 * (points.mean(axis=0) - points[hidden : hidden + 12])  # a finger's edge
        position, _ = located(PINHOLE, track(points))
        wrong.append(np.linalg.norm(position) / np.linalg.norm(truth) - 1.0)
    assert abs(np.mean(wrong)) < 0.001


@pytest.mark.parametrize("degrees", [0, 15, 25, 35])
def test_a_track_with_few_points_is_placed_by_its_circle(degrees: int) -> None:
    angle = math.radians(degrees)
    truth = 1.5 * np.array((math.sin(angle), 0.0, math.cos(angle)))
    wide = ms.CameraModel(width=1600, height=1200, fx=450.0, fy=450.0, cx=799.5, cy=599.5)
    circle = sphere_outline(wide, truth, 0.14).circle()
    seen = ms.Track(circle, 0.01 * np.eye(3), 1.0, wide.project(rim(truth))[:3], 0.0)
    position, covariance = located(wide, seen)
    assert abs(np.linalg.norm(position) / 1.5 - 1.0) < 0.003
    large, _ = located(wide, ms.Track(seen.shape, seen.covariance, 1.0, np.empty((0, 2)), 0.0))
    np.testing.assert_allclose(large, position)
    louder = ms.Track(seen.shape, 4.0 * seen.covariance, 1.0, seen.match_set, 0.0)
    np.testing.assert_allclose(located(wide, louder)[1], 4.0 * covariance)


def test_the_covariance_of_a_circle_is_carried_over() -> None:
    rng = np.random.default_rng(5)
    truth = np.array((0.4, 0.1, 1.5))
    exact, squares = sphere_outline(PINHOLE, truth, 0.14).circle(), []
    for _ in range(400):
        x, y, radius = rng.normal((exact.x, exact.y, exact.radius), 0.2)
        seen = ms.Track(ms.Circle(x, y, radius), 0.04 * np.eye(3), 1.0, np.empty((0, 2)), 0.0)
        position, covariance = located(PINHOLE, seen)
        squares.append(square(position - truth, covariance))
    assert 2.4 < np.mean(squares) < 3.7


def test_an_outline_that_lies_outside_its_edge_points_is_moved_outward() -> None:
    truth = np.array((0.0, 0.0, 1.5))
    outline = PINHOLE.project(rim(truth))
    middle = outline.mean(axis=0)
    inward = outline - 0.1 * (outline - middle) / np.hypot(*(outline - middle).T)[:, np.newaxis]
    position, _ = located(PINHOLE, track(inward), BallParameters(edge_shift_px=0.1))
    np.testing.assert_allclose(position, truth, atol=1e-6)


@pytest.mark.parametrize("place", [(0.0, 0.0, 1.5), (0.5, 0.3, 1.3)])
def test_the_cameras_uncertainty_is_included(place: tuple[float, ...]) -> None:
    sigmas = np.array((4.0, 4.0, 2.0, 2.0, 0.01, 0.02, 5e-4, 5e-4, 0.0))
    rng = np.random.default_rng(7)
    covariance = tuple(tuple(row) for row in np.diag(sigmas**2).tolist())
    truth, squares = np.array(place), []
    known = ms.CameraModel(
        width=640, height=480, fx=450.0, fy=455.0, cx=315.0, cy=243.0, distortion=(-0.2, 0.05, 1e-3, 0.0, 0.0),
        intrinsics_covariance=covariance,
    )  # fmt: skip
    for _ in range(300):
        fx, fy, cx, cy, *lens = rng.normal(known.intrinsics, sigmas).tolist()
        real = ms.CameraModel(width=640, height=480, fx=fx, fy=fy, cx=cx, cy=cy, distortion=tuple(lens))
        position, claimed = located(known, ball(real, truth), EXACT)
        squares.append(square(position - truth, claimed))
    assert 2.2 < np.mean(squares) < 3.6
    exact = ms.CameraModel(width=640, height=480, fx=450.0, fy=455.0, cx=315.0, cy=243.0)
    assert np.trace(located(exact, ball(exact, truth))[1]) < 0.2 * np.trace(claimed)


def test_what_cannot_be_a_ball_before_the_camera_is_said() -> None:
    straight = np.column_stack((np.linspace(100.0, 500.0, 40), np.full(40, 200.0)))
    assert "not that of a ball" in str(pose_of(PINHOLE, track(straight)))
    near = ms.CameraModel.from_fov(640, 480, 3.1)
    touching = 120.0 * np.column_stack((np.cos(np.arange(64.0)), np.sin(np.arange(64.0)))) + (319.5, 239.5)
    assert "touches the camera" in str(pose_of(near, track(touching)))
    folded = ms.CameraModel(
        width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5, distortion=(-3.0, 0.0, 0.0, 0.0, 0.0)
    )
    assert "no directions" in str(pose_of(folded, track(touching + np.array((250.0, 0.0)))))


@given(st.lists(st.tuples(st.floats(-1e7, 1e7), st.floats(-1e7, 1e7)), max_size=40), cameras)
def test_any_points_give_finite_numbers_or_a_reason(points: list[tuple[float, float]], camera: ms.CameraModel) -> None:
    seen = ms.Track(ms.Circle(300.0, 200.0, 40.0), np.eye(3), 1.0, np.array(points).reshape(-1, 2), 0.0)
    found = pose_of(camera, seen)
    if isinstance(found, ms.Lost):
        assert found.reason
    else:
        assert np.isfinite(found.position).all()
        assert np.isfinite(found.covariance).all()


def fitted(points: Floats, middle: Floats) -> tuple[int, Floats]:
    """Why there is no position, and the position."""
    block = new_block(CONE)
    fit = fields(block, CONE)
    store(fit.limits, EXACT)
    fit.intrinsics[:], fit.inside[:], fit.radius, fit.robust = PINHOLE.intrinsics, middle, 0.14, True
    return fit_cone(block.view(CONE)[0], points), fit.position


def test_a_cone_needs_four_points() -> None:
    place = np.array((0.1, -0.05, 1.3))
    outline = PINHOLE.project(rim(place, count=4))
    for kept in range(4):
        assert fitted(outline[:kept], outline.mean(axis=0))[0] == ConeFailure.TOO_FEW_RAYS
    failure, position = fitted(outline, outline.mean(axis=0))
    assert failure == ConeFailure.NONE
    np.testing.assert_allclose(position, place, rtol=1e-6)


def test_the_covariance_is_honest_also_of_a_ball_that_fills_the_picture() -> None:
    rng = np.random.default_rng(11)
    truth, squares = np.array((0.03, -0.02, 0.2)), []
    outline = PINHOLE.project(rim(truth))
    for _ in range(300):
        position, covariance = located(PINHOLE, track(outline + rng.normal(0.0, 0.3, outline.shape)), BARE)
        squares.append(square(position - truth, covariance))
    assert 2.4 < np.mean(squares) < 3.8


def test_wrong_points_far_from_an_exact_outline_have_no_weight_at_all() -> None:
    truth = np.array((0.2, 0.1, 1.4))
    points = PINHOLE.project(rim(truth))
    middle = points.mean(axis=0)
    points[[3, 4, 20, 41]] += 0.3 * (points[[3, 4, 20, 41]] - middle)
    failure, position = fitted(points, middle)
    assert failure == ConeFailure.NONE
    np.testing.assert_allclose(position, truth, rtol=1e-7)


@kernel
def _reweighted(fit: Any, rays: OutlineRays, absolute: bool) -> float:
    return reweight(rays, fit.limits, absolute)


def test_weights_are_tukey_s_biweight_after_least_absolute_values() -> None:
    residual = np.concatenate((np.linspace(-2.0, 2.0, 41), np.full(9, 0.01)))
    one = np.ones(len(residual))
    block, weight = new_block(CONE), one.copy()
    store(fields(block, CONE).limits, BallParameters())
    flat, space = np.empty((0, 2)), np.empty((0, 3))
    rays = OutlineRays(one, one, one, one, one, one, one, residual, np.abs(residual), weight, flat, space)
    sigma = _reweighted(block.view(CONE)[0], rays, False)
    assert sigma == pytest.approx(1.4826 * np.median(np.abs(residual)) * math.sqrt(50 / 47))
    z = residual / (4.7 * sigma)
    np.testing.assert_allclose(weight, np.where(np.abs(z) < 1.0, (1.0 - z * z) ** 2, 0.0), atol=1e-12)
    assert _reweighted(block.view(CONE)[0], rays, True) == sigma
    np.testing.assert_allclose(weight, np.minimum(1.0, sigma / np.maximum(np.abs(residual), 1e-9)), rtol=1e-9)


def test_fields_that_lie_apart_make_the_place_less_sure_along_their_offset() -> None:
    place, share, offset = np.array((0.0, 0.0, 1.5)), 0.1, np.array((0.0, 12.0))
    seen = ball(PINHOLE, place)
    apart = msgspec.structs.replace(seen, field_offset=tuple(offset.tolist()))
    parameters = msgspec.structs.replace(BARE, field_share=share)
    _, still = located(PINHOLE, seen, parameters)
    _, moved = located(PINHOLE, apart, parameters)
    per_px = place[2] / PINHOLE.intrinsics[0]
    radius = 0.14 / per_px
    added = np.diag(moved - still)
    np.testing.assert_allclose(added[1], (share * 12.0 * per_px) ** 2, rtol=0.05)
    np.testing.assert_allclose(added[2], 0.5 * (share * 12.0 / radius * place[2]) ** 2, rtol=0.05)
    assert added[0] < 0.01 * added[1]
