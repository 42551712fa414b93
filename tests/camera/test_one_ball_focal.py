"""The focal length from a ball at one known distance."""

import math

import numpy as np
import pytest

import matchset as ms
from matchset.camera.ball_focal_length import HeldBall
from matchset.camera.one_ball_focal import focal_from_one_ball

TRUTH = ms.CameraModel(width=640, height=480, fx=520.0, fy=524.0, cx=322.0, cy=236.0, distortion=(-0.2, 0.05, 0, 0, 0))
RADIUS = 0.14


def outline(center: np.ndarray, noise: float, seed: int) -> np.ndarray:
    """Pixels of the rim of a ball."""
    distance = float(np.linalg.norm(center))
    axis = center / distance
    across = np.cross(axis, (0.0, 1.0, 0.0))
    across /= np.linalg.norm(across)
    up = np.cross(axis, across)
    angle, half = np.linspace(0.0, 2.0 * math.pi, 80, endpoint=False)[:, None], math.asin(RADIUS / distance)
    rays = math.cos(half) * axis + math.sin(half) * (np.cos(angle) * across + np.sin(angle) * up)
    return TRUTH.project(rays) + np.random.default_rng(seed).normal(0.0, noise, (80, 2))


@pytest.mark.parametrize("wrong", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("place", [(0.0, 0.0, 1.5), (0.4, -0.2, 1.2)])
def test_the_focal_length_is_found_whatever_it_was_thought_to_be(wrong: float, place: tuple[float, ...]) -> None:
    center = np.array(place)
    thought = ms.CameraModel(
        width=640, height=480, fx=520.0 * wrong, fy=524.0 * wrong, cx=322.0, cy=236.0, distortion=TRUTH.distortion
    )
    held = HeldBall(float(np.linalg.norm(center)), [outline(center, 0.05, seed) for seed in range(10)])
    camera = focal_from_one_ball(held, RADIUS, thought)
    assert camera.fx == pytest.approx(TRUTH.fx, rel=0.003)
    assert camera.fy / camera.fx == pytest.approx(524.0 / 520.0)
    assert camera.covariance is not None
    sigma = math.sqrt(camera.covariance[0, 0]) / camera.fx
    assert 0.005 < sigma < 0.02
    assert abs(camera.fx - TRUTH.fx) < 3.0 * sigma * TRUTH.fx
    assert np.linalg.eigvalsh(camera.covariance).min() > -1e-6


def test_what_was_known_of_the_lens_stays() -> None:
    rows = np.diag(np.arange(1.0, 10.0)) + 0.1
    thought = ms.CameraModel(
        width=640, height=480, fx=500.0, fy=500.0, cx=320.0, cy=240.0,
        intrinsics_covariance=tuple(tuple(row) for row in rows.tolist()),
    )  # fmt: skip
    camera = focal_from_one_ball(HeldBall(1.5, [outline(np.array((0.0, 0.0, 1.5)), 0.05, 1)]), RADIUS, thought)
    assert camera.covariance is not None
    assert np.array_equal(camera.covariance[2:, 2:], rows[2:, 2:])
    assert not camera.covariance[:2, 2:].any()


@pytest.mark.parametrize(
    ("distance", "words"), [(0.1, "within its radius"), (100.0, "would at"), (math.inf, "within"), (math.nan, "within")]
)
def test_a_distance_that_cannot_be_is_refused(distance: float, words: str) -> None:
    points = [outline(np.array((0.0, 0.0, 0.6)), 0.0, 1)]
    with pytest.raises(ValueError, match=words):
        focal_from_one_ball(HeldBall(distance, points), RADIUS, TRUTH)


def test_no_outline_is_refused() -> None:
    with pytest.raises(ValueError, match="not seen"):
        focal_from_one_ball(HeldBall(1.0, [np.empty((0, 2))]), RADIUS, TRUTH)
    with pytest.raises(ValueError, match="radius must be positive"):
        focal_from_one_ball(HeldBall(1.0, []), 0.0, TRUTH)
