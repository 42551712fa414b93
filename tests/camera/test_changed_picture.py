"""A camera whose pictures are turned or resampled sees the same world, elsewhere in the picture."""

import numpy as np
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.media.upright.orientation import Orientation

COVARIANCE = tuple(map(tuple, np.diag([4.0, 5.0, 1.0, 2.0, 1e-4, 2e-4, 1e-6, 3e-6, 1e-4]).tolist()))
CAMERA = CameraModel(
    width=640,
    height=480,
    fx=610.0,
    fy=590.0,
    cx=305.0,
    cy=250.0,
    distortion=(-0.3, 0.12, 0.004, -0.007, -0.02),
    intrinsics_covariance=COVARIANCE,
)
POINTS = np.array([[0.1, 0.2, 1.0], [-0.3, 0.15, 1.2], [0.05, -0.25, 0.8], [0.4, 0.3, 1.5]])
WAYS = [(turn, mirror) for turn in (0, 90, 180, 270) for mirror in (False, True)]


def in_picture(turn: int, mirror: bool) -> tuple[np.ndarray, np.ndarray]:
    """Matrix and shift by which a pixel of the picture moves."""
    a, b, c, d = Orientation.of_turn(turn, mirror)
    matrix = np.array([[a, c], [b, d]], float)
    corners = matrix @ np.array([[0, 639, 0, 639], [0, 0, 479, 479]], float)
    return matrix, -corners.min(axis=1)


@pytest.mark.parametrize(("turn", "mirror"), WAYS)
def test_a_point_of_the_turned_world_is_where_its_pixel_comes_to(turn: int, mirror: bool) -> None:
    matrix, shift = in_picture(turn, mirror)
    turned = CAMERA.turned(turn, mirror)
    moved = np.column_stack([POINTS[:, :2] @ matrix.T, POINTS[:, 2]])
    np.testing.assert_allclose(turned.project(moved), CAMERA.project(POINTS) @ matrix.T + shift, atol=1e-9)
    assert (turned.width, turned.height) == ((480, 640) if turn % 180 else (640, 480))


@pytest.mark.parametrize(("turn", "mirror"), WAYS)
def test_what_undoes_a_turn_gives_the_camera_back(turn: int, mirror: bool) -> None:
    back = CAMERA.turned(turn, mirror).turned(turn if mirror else -turn % 360, mirror)
    np.testing.assert_allclose(back.intrinsics, CAMERA.intrinsics)
    assert back.covariance is not None
    assert CAMERA.covariance is not None
    np.testing.assert_allclose(back.covariance, CAMERA.covariance)
    assert (back.width, back.height) == (CAMERA.width, CAMERA.height)


@pytest.mark.parametrize("change", ["turned", "mirrored", "resized"])
def test_the_covariance_is_that_of_the_changed_numbers(change: str) -> None:
    def changed(camera: CameraModel) -> CameraModel:
        if change == "resized":
            return camera.resized(1280, 720)
        return camera.turned(270) if change == "turned" else camera.turned(90, mirror=True)

    random = np.random.default_rng(1)
    root = np.sqrt(np.diag(np.array(COVARIANCE)))
    drawn = []
    for _ in range(4000):
        fx, fy, cx, cy, *distortion = CAMERA.intrinsics + root * random.normal(size=9)
        lens = tuple(map(float, distortion))
        drawn.append(
            changed(
                CameraModel(width=640, height=480, fx=fx, fy=fy, cx=cx, cy=cy, distortion=lens)  # type: ignore[arg-type]
            ).intrinsics
        )
    covariance = changed(CAMERA).covariance
    assert covariance is not None
    scale = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(np.cov(np.array(drawn).T) / np.outer(scale, scale), np.eye(9), atol=0.1)


def test_a_resized_camera_sees_the_resampled_picture() -> None:
    resized = CAMERA.resized(1280, 720)
    pixels = CAMERA.project(POINTS)
    np.testing.assert_allclose(resized.project(POINTS), (pixels + 0.5) * [2.0, 1.5] - 0.5, atol=1e-9)
    assert (resized.width, resized.height) == (1280, 720)
    resized.check((1280, 720))


def test_a_camera_is_never_resized_silently() -> None:
    with pytest.raises(ValueError, match=r"the camera's are 640 x 480 px: .* use camera.resized\(320, 240\)"):
        CAMERA.check((320, 240))


@pytest.mark.parametrize("size", [(0, 480), (640, -1), (640.5, 480), (True, 480), (2_000_000, 480)])
def test_sizes_that_are_none(size: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="must be a whole number of px"):
        CAMERA.resized(*size)


def test_a_turn_that_is_none() -> None:
    with pytest.raises(ValueError, match="turn must be 0, 90, 180 or 270 degrees, clockwise, got 45"):
        CAMERA.turned(45)
