import cv2
import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from matchset.camera.camera_model import CameraModel
from matchset.sim.rendering.surface import Surface
from matchset.sim.scene.scene import Scene, viewpoint

CAMERA = CameraModel.from_fov(160, 120, 1.07)


def blueness(picture: npt.NDArray[np.float32]) -> float:
    """Share of pixels as saturated and blue as the balloon."""
    hsv = cv2.cvtColor(np.clip(picture, 0, 255).astype(np.uint8), cv2.COLOR_BGR2HSV)
    hue, saturation, value = np.moveaxis(hsv.astype(int), 2, 0)
    return float(((hue > 100) & (hue < 160) & (saturation > 120) & (value > 50)).mean())


@pytest.mark.parametrize("seed", range(6))
def test_only_clutter_is_blue(seed: int) -> None:
    plain, cluttered = (Scene.room(seed, clutter=c).render(CAMERA) for c in (False, True))
    assert blueness(plain) == 0.0
    assert blueness(cluttered) > 0.005
    assert plain.min() >= 0.0
    assert plain.max() < 255.01
    assert (plain.sum(axis=2) > 0.0).all()


def test_rooms_follow_from_their_seeds() -> None:
    first, again, other = (Scene.room(seed).render(CAMERA, samples=1) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).mean() > 10.0


def test_the_camera_can_move() -> None:
    scene = Scene.room(3)
    pictures = [scene.render(CAMERA, *viewpoint(seed), samples=1) for seed in (1, 2)]
    assert np.abs(pictures[0] - pictures[1]).mean() > 10.0
    rotation, _ = viewpoint(1)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    behind = scene.render(CAMERA, np.diag([-1.0, 1.0, -1.0]), samples=1)
    assert (behind.sum(axis=2) > 0.0).all()


@pytest.mark.parametrize("seed", range(4))
def test_a_viewpoint_turns_to_the_side_and_nods_as_scipy_says(seed: int) -> None:
    rotation, _ = viewpoint(seed)
    yaw, pitch, roll = Rotation.from_matrix(rotation).as_euler("YXZ")
    assert abs(yaw) <= 0.3
    assert abs(pitch) <= 0.06
    assert roll == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(rotation, Rotation.from_euler("YX", (yaw, pitch)).as_matrix(), atol=1e-12)


def test_a_surface_lands_where_the_camera_projects_it() -> None:
    texture = np.full((4, 4, 4), 255, np.uint8)
    card = Surface(origin=np.array([0.1, -0.2, 2.0]), u=np.array([0.5, 0, 0]), v=np.array([0, 0.4, 0]), texture=texture)
    covered = Scene([card]).render(CAMERA, samples=4)[..., 0] / 255.0
    y, x = np.mgrid[: CAMERA.height, : CAMERA.width]
    scale = CAMERA.fx / 2.0
    assert covered.sum() == pytest.approx(0.5 * 0.4 * scale**2, rel=0.02)
    assert (covered * x).sum() / covered.sum() == pytest.approx(CAMERA.cx + 0.35 * scale, abs=0.1)
    assert (covered * y).sum() / covered.sum() == pytest.approx(CAMERA.cy, abs=0.1)


def test_the_nearer_surface_hides_the_farther_in_any_order() -> None:
    def card(depth: float, level: int) -> Surface:
        texture = np.full((2, 2, 4), level, np.uint8)
        texture[..., 3] = 255
        corner = np.array([-1.0, -1.0, depth])
        return Surface(origin=corner, u=np.array([2.0, 0, 0]), v=np.array([0, 2.0, 0]), texture=texture)

    near, far = card(1.5, 200), card(1.8, 50)
    for surfaces in ([near, far], [far, near]):
        assert Scene(surfaces).render(CAMERA, samples=1)[60, 80, 0] == pytest.approx(200.0)


def test_misuse() -> None:
    scene = Scene([])
    with pytest.raises(ValueError, match="0"):
        scene.render(CAMERA, samples=0)
    with pytest.raises(ValueError, match=r"\(2, 2\)"):
        scene.render(CAMERA, np.eye(2))
