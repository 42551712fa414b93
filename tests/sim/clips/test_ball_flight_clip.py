import math
import zlib

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import matchset as ms
from balls import BARREL, PINHOLE, Floats, rim
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.clip import Clip
from matchset.sim.rendering.lens_warp import ExactLensWarp
from matchset.sim.rendering.renderer import draw_balloon

HERE = np.array((0.35, -0.15, 1.3))
BACK = Rotation.from_matrix(np.diag((-1.0, 1.0, -1.0)))


def white_ball(camera: ms.CameraModel, place: Floats) -> Floats:
    """A ball drawn through a lens on black: how much of each pixel it covers."""
    view = ExactLensWarp(camera)
    picture = np.zeros((view.pinhole.height, view.pinhole.width, 3), np.float32)
    plain = Balloon(color=(0.0, 0.0, 0.0), marker_radius=0.0)
    picture[:] = 255.0
    draw_balloon(picture, view.pinhole, plain, [place])
    return np.asarray(view.warp(picture)[..., 0], np.float64)


def test_a_lens_puts_the_outline_where_the_camera_model_projects_it() -> None:
    picture = white_ball(BARREL, HERE)
    outline = BARREL.project(rim(HERE, count=360))
    middle = outline.mean(axis=0)
    outward = (outline - middle) / np.hypot(*(outline - middle).T)[:, np.newaxis]
    for shift, low, high in ((-2.0, 0.0, 60.0), (2.0, 250.0, 256.0)):
        x, y = np.rint(outline + shift * outward).astype(int).T
        assert low <= picture[y, x].min()
        assert picture[y, x].max() <= high


def test_a_pinhole_camera_bends_nothing() -> None:
    view = ExactLensWarp(PINHOLE)
    picture = np.random.default_rng(0).random((480, 640, 3)).astype(np.float32)
    assert view.pinhole is PINHOLE
    assert view.warp(picture) is picture


def test_the_same_flight_gives_the_same_bytes() -> None:
    flight = BallFlightClip(
        camera=PINHOLE, place=lambda t: HERE + np.array((0.1 * t, 0.0, 0.0)), frames=2, seed=3, preset="typical"
    )
    sums = [[zlib.crc32(frame.image.tobytes()) for frame in flight] for _ in range(2)]
    assert sums[0] == sums[1]
    assert len(set(sums[0])) == len(flight) == 2


@pytest.mark.parametrize("camera", [PINHOLE, BARREL])
def test_markers_are_where_the_rotation_puts_them(camera: ms.CameraModel) -> None:
    markers = ((0.0, 0.0, 1.0), (math.sin(0.8), 0.0, math.cos(0.8)))
    flight = BallFlightClip(camera=camera, place=lambda _: HERE, turn=lambda _: BACK, markers=markers, frames=1)
    image = next(iter(flight)).image.astype(int)
    for direction in BACK.apply(np.array(markers)):
        x, y = np.rint(camera.project((HERE + 0.137 * direction)[np.newaxis])[0]).astype(int)
        blue, green, red = image[y, x]
        assert red > 2 * green
        assert blue > green
    x, y = np.rint(camera.project((HERE + np.array((0.0, 0.09, -0.1)))[np.newaxis])[0]).astype(int)
    assert image[y, x, 0] > 3 * image[y, x, 2]  # blue elsewhere


def test_the_fields_of_an_interlaced_flight_are_half_a_frame_apart() -> None:
    flight = BallFlightClip(
        camera=PINHOLE, place=lambda t: HERE + np.array((3.0 * t, 0.0, 0.0)), frames=1, preset="typical"
    )
    image = next(iter(flight)).image.astype(float)
    blue = image[..., 0] - image[..., 2] > 60.0
    centers = []
    for parity in (0, 1):
        rows, columns = np.nonzero(blue[parity::2])
        centers.append(columns.mean())
        assert len(rows) > 300
    step = 450.0 * 3.0 / 30.0 / 1.3 / 2.0
    assert centers[1] - centers[0] == pytest.approx(step, abs=2.0)


def test_directions_of_markers_are_unit_vectors() -> None:
    with pytest.raises(ValueError, match="length 1"):
        Balloon(more_markers=((0.0, 0.0, 2.0),))


def test_clips_are_what_they_were() -> None:
    """The renderer was extended; the bytes of clips must not change with that."""
    frames = [frame.image for frame, _ in Clip(preset="clean", seed=3, frames=2)]
    assert [zlib.crc32(image.tobytes()) for image in frames] == [520130384, 912624394]
