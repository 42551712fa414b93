"""What is drawn in two ways, exactly for clips and fast for flights, is the same to what the fast way leaves out."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from balls import BARREL, PINHOLE
from matchset.camera.camera_model import CameraModel
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.truth import sphere_outline
from matchset.sim.rendering.background import FastScene, packed
from matchset.sim.rendering.coverage import FINE, SHADING, Pinhole, draw_polygon, draw_sphere_fast
from matchset.sim.rendering.lens_warp import ExactLensWarp, FastLensWarp
from matchset.sim.rendering.renderer import Light, ball_shading, draw_balloon
from matchset.sim.scene.scene import Scene, viewpoint

Floats = npt.NDArray[np.float64]

CENTER = np.array((0.21, -0.13, 1.4))


def bgr(words: npt.NDArray[np.uint32]) -> Floats:
    return words.view(np.uint8).reshape(*words.shape, 4)[..., :3].astype(np.float64)


def exact_ball(camera: CameraModel, balloon: Balloon) -> Floats:
    picture = np.full((camera.height, camera.width, 3), 60.0, np.float32)
    draw_balloon(picture, camera, balloon, [CENTER])
    return picture.astype(np.float64)


@pytest.mark.parametrize("seed", [1, 2])
def test_both_renderers_draw_the_same_room(seed: int) -> None:
    camera, scene = CameraModel.from_fov(320, 240, 1.07), Scene.room(seed)
    rotation, position = viewpoint(seed)
    exact = scene.render(camera, rotation, position, samples=1).astype(np.float64)
    picture = np.zeros((camera.height, camera.width, 4), np.uint8)
    pinhole = Pinhole(camera.fx, camera.fy, camera.cx, camera.cy)
    FastScene(scene.surfaces).draw(packed(picture), pinhole, rotation.T, -rotation.T @ position)
    difference = np.abs(picture[..., :3] - exact).max(axis=2)
    assert np.median(difference) <= 2.0  # interpolation between texels
    assert (difference > 40.0).mean() < 0.04  # edges of texels
    assert abs((picture[..., :3] - exact).mean()) < 1.0


def test_both_ways_draw_the_same_ball() -> None:
    marker = tuple((-CENTER / np.linalg.norm(CENTER)).tolist())
    balloon = Balloon(marker=marker)
    exact = exact_ball(PINHOLE, balloon)
    words = np.full((PINHOLE.height, PINHOLE.width), 0xFF3C3C3C, np.uint32)
    pinhole = Pinhole(PINHOLE.fx, PINHOLE.fy, PINHOLE.cx, PINHOLE.cy)
    draw_sphere_fast(words, pinhole, CENTER, ball_shading(balloon, Light(), CENTER).view(SHADING)[0])
    assert np.abs(bgr(words) - exact).max() <= 0.51  # rounding to bytes


def test_a_sphere_and_the_polygon_of_its_outline_cover_the_same() -> None:
    flat = Balloon(color=(0.0, 0.0, 0.0), marker_radius=0.0)
    picture = np.full((PINHOLE.height, PINHOLE.width, 3), 255.0, np.float32)
    covered = np.zeros_like(picture)
    draw_polygon(covered, [sphere_outline(PINHOLE, CENTER, 0.14).points(1440)], (1.0, 1.0, 1.0))
    black, white = picture.copy(), np.zeros_like(picture)
    draw_balloon(black, PINHOLE, flat, [CENTER])
    draw_balloon(white, PINHOLE, flat, [CENTER])
    sphere = 1.0 - (black - white)[..., 0] / 255.0  # what shows of the background is what the sphere leaves free
    assert np.abs(sphere - covered[..., 0]).max() < 0.5 / FINE  # half a line, where the outline is level
    assert abs(float(sphere.sum()) - float(covered[..., 0].sum())) < 1.0


@pytest.mark.parametrize("camera", [PINHOLE, BARREL])
def test_both_lenses_warp_a_picture_alike(camera: CameraModel) -> None:
    y, x = np.indices((camera.height, camera.width))

    def wave(u: npt.NDArray[Any], v: npt.NDArray[Any]) -> Floats:
        return np.asarray(127.0 + 60.0 * np.sin(6.0 * u) + 50.0 * np.cos(5.0 * v))

    exact = ExactLensWarp(camera)
    pinhole = exact.pinhole
    rows, columns = np.indices((pinhole.height, pinhole.width))
    finer = wave((columns - pinhole.cx) / pinhole.fx, (rows - pinhole.cy) / pinhole.fy)
    shown = exact.warp(np.repeat(finer[..., None], 3, axis=2).astype(np.float32)).astype(np.float64)
    fast = FastLensWarp(camera, 1, 0)
    rows, columns = np.indices((fast.height, fast.width // 2))
    level = np.rint(wave((columns - fast.half.cx) / fast.half.fx, (rows - fast.half.cy) / fast.half.fy)).astype(
        np.uint32
    )
    room = level | level << np.uint32(8) | level << np.uint32(16)
    frame = np.zeros((camera.height, camera.width, 4), np.uint8)
    fast.warp(np.ascontiguousarray(room), packed(frame))
    middle = np.hypot(x - camera.cx, y - camera.cy) < 200.0  # the exact one leaves out what is too far aside
    assert np.abs(frame[middle, :3].astype(np.float64) - shown[middle]).max() < 2.0
