import math

import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.camera.ball_focal_length import BallFocal, HeldBall, focal_from_ball

Floats = npt.NDArray[np.float64]
RADIUS = 0.14


def outline(camera: ms.CameraModel, center: npt.ArrayLike) -> Floats:
    """Pixels of the cone tangent to the ball."""
    place = np.asarray(center, np.float64)
    distance = float(np.linalg.norm(place))
    axis, alpha = place / distance, math.asin(RADIUS / distance)
    side = np.cross(axis, (0.0, 1.0, 0.0))
    side /= np.linalg.norm(side)
    turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)[:, None]
    around = np.cos(turn) * side + np.sin(turn) * np.cross(axis, side)
    return camera.project(math.cos(alpha) * axis + math.sin(alpha) * around)


def held(camera: ms.CameraModel, taped: tuple[float, ...], seed: int, doubt: float = 1.0) -> list[HeldBall]:
    """The ball at taped distances of its center, with all that may be wrong drawn from what is assumed of it."""
    rng = np.random.default_rng(seed)
    pupil, edge = doubt * rng.normal(0.0, (0.01, 0.25))
    balls = []
    for tape in taped:
        direction = np.append(rng.uniform(-0.15, 0.15, 2), 1.0)
        place = direction / np.linalg.norm(direction) * (tape + pupil + doubt * rng.normal(0.0, 0.004))
        true = outline(camera, place)
        away = true - true.mean(axis=0)
        seen = true + edge * away / np.linalg.norm(away, axis=1, keepdims=True)
        balls.append(HeldBall(tape, [seen + doubt * rng.normal(0.0, 0.3, seen.shape) for _ in range(2)]))
    return balls


def focal(balls: list[HeldBall], radius: float = RADIUS) -> BallFocal:
    return focal_from_ball(balls, radius, 640, 480)


CAMERA = ms.CameraModel(width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5)


def test_without_errors_it_is_exact() -> None:
    found = focal(held(CAMERA, (0.6, 1.1, 1.6), 1, doubt=0.0))
    assert found.camera.fx == pytest.approx(450.0, abs=0.01)
    assert found.camera.fy == found.camera.fx
    assert found.pupil == pytest.approx(0.0, abs=1e-4)
    assert found.misfits == pytest.approx([0.0, 0.0, 0.0], abs=1e-4)


def test_its_uncertainty_is_honest() -> None:
    """16 cameras with unknown lens, center and pupil: the focal length's error over its standard deviation."""
    ratios, spreads = [], []
    for seed in range(100, 116):
        rng = np.random.default_rng(seed)
        cx, cy = np.array([319.5, 239.5]) + rng.normal(0.0, 12.8, 2)
        lens = float(rng.normal(0.0, 0.1)), 0.0, 0.0, 0.0, 0.0
        camera = ms.CameraModel(width=640, height=480, fx=450.0, fy=450.0, cx=cx, cy=cy, distortion=lens)
        found = focal(held(camera, (0.64, 1.64) if seed % 2 else (0.64, 1.14, 1.64), seed)).camera
        assert found.covariance is not None
        spreads.append(math.sqrt(found.covariance[0, 0]))
        ratios.append((found.fx - 450.0) / spreads[-1])
    assert 0.5 < np.std(ratios) < 1.5
    assert abs(np.mean(ratios)) < 0.6
    assert np.median(spreads) < 0.02 * 450.0


def test_foreign_points_do_not_count() -> None:
    balls = held(CAMERA, (0.6, 1.2), 2)
    for ball in balls:
        ball.outlines[0][:5] += 8.0
    assert focal(balls).camera.fx == pytest.approx(450.0, rel=0.03)


@pytest.mark.parametrize(
    ("balls", "radius", "words"),
    [
        (held(CAMERA, (0.6, 1.2), 1), 0.0, "radius must be positive"),
        (held(CAMERA, (0.6, 1.2), 1), math.nan, "radius must be positive"),
        (held(CAMERA, (0.6, 1.2), 1), 0.7, "farther away than its radius"),
        (held(CAMERA, (0.6,), 1), RADIUS, "two or more distances"),
        (held(CAMERA, (0.6, 0.7), 1), RADIUS, "two or more distances"),
        ([], RADIUS, "its center was at none"),
        ([HeldBall(0.6, []), HeldBall(1.2, [np.zeros((4, 2))])], RADIUS, "was not seen at 0.60 m"),
        ([HeldBall(1.6 - ball.distance, ball.outlines) for ball in held(CAMERA, (0.4, 1.2), 1)], RADIUS, "do not fit"),
    ],
)
def test_refusals_are_in_words(balls: list[HeldBall], radius: float, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        focal(balls, radius)
