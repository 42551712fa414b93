import numpy as np
import pytest

from balls import BARREL, PINHOLE
from matchset.camera.camera_model import CameraModel
from matchset.sim.clips.balloon import Balloon
from matchset.sim.rendering.background import FastScene, packed
from matchset.sim.rendering.coverage import Pinhole
from matchset.sim.rendering.surface import Surface
from matchset.sim.vehicle import VehiclePose
from matchset.sim.vehicle_camera import Appearance, VehicleCamera

NOWHERE, LEVEL = np.zeros(3), np.eye(3)
GRAY = np.array([[(90, 90, 90, 255)]], np.uint8)


def wall(depth: float, half: float, color: tuple[int, int, int], alpha: int = 255) -> Surface:
    return Surface(
        origin=np.array((-half, -half, depth)),
        u=np.array((2.0 * half, 0.0, 0.0)),
        v=np.array((0.0, 2.0 * half, 0.0)),
        texture=np.array([[(*color, alpha)]], np.uint8),
    )


def test_a_surface_fills_the_pixels_it_projects_to_and_the_nearer_hides_the_farther() -> None:
    picture = np.zeros((120, 160, 4), np.uint8)
    window = Pinhole(100.0, 100.0, 79.5, 59.5)
    room = FastScene([wall(4.0, 4.0, (10, 20, 30)), wall(2.0, 0.5, (200, 0, 0)), wall(1.0, 0.1, (0, 0, 200), 0)])
    room.draw(packed(picture), window, LEVEL, NOWHERE)
    y, x = np.indices((120, 160))
    inside = (np.abs(x - 79.5) <= 25.0) & (np.abs(y - 59.5) <= 25.0)
    np.testing.assert_array_equal(picture[..., 0], np.where(inside, 200, 10))


def test_a_surface_moves_as_the_camera_does() -> None:
    picture = np.zeros((120, 160, 4), np.uint8)
    FastScene([wall(2.0, 0.5, (200, 0, 0))]).draw(
        packed(picture), Pinhole(100.0, 100.0, 79.5, 59.5), LEVEL, np.array((0.4, 0.0, 0.0))
    )
    columns = np.flatnonzero(picture[60, :, 0])
    assert columns.mean() == pytest.approx(79.5 + 100.0 * 0.4 / 2.0)


@pytest.mark.parametrize("camera", [PINHOLE, BARREL])
def test_a_ball_is_where_the_camera_model_projects_it(camera: CameraModel) -> None:
    white = Balloon(color=(255.0, 255.0, 255.0), marker_radius=0.0)
    eye = VehicleCamera(camera, FastScene([wall(5.0, 20.0, (0, 0, 0))]), white, interlaced=True)
    place = np.array((0.35, -0.2, 1.6))
    sight = VehiclePose(place + np.array((0.0, 0.19, 0.0)), LEVEL, place)
    picture = eye.frame()
    for field in (0, 1):
        eye.expose(field, NOWHERE, LEVEL, [(sight, Appearance())], picture)
    frame = picture[..., 0]
    rows, columns = np.indices((480, 640))
    bright = frame > 60.0
    circle = np.linspace(0.0, 2.0 * np.pi, 400)
    # the ball's rim: where lines of sight touch it
    far = float(np.linalg.norm(place))
    out = place / far
    across = np.cross(out, (0.0, 1.0, 0.0))
    across /= np.linalg.norm(across)
    middle, radius = out * (far - 0.14**2 / far), 0.14 * np.sqrt(1.0 - (0.14 / far) ** 2)
    rim = middle + radius * (np.outer(np.cos(circle), across) + np.outer(np.sin(circle), np.cross(out, across)))
    edge = camera.project(rim)
    x, y = columns[bright], rows[bright]
    assert x.mean() == pytest.approx(0.5 * (edge[:, 0].min() + edge[:, 0].max()), abs=1.0)
    assert y.mean() == pytest.approx(0.5 * (edge[:, 1].min() + edge[:, 1].max()), abs=1.0)
    assert np.ptp(x) == pytest.approx(np.ptp(edge[:, 0]), abs=2.5)
    assert np.ptp(y) == pytest.approx(np.ptp(edge[:, 1]), abs=3.0)


def test_fields_are_exposed_at_their_own_times() -> None:
    eye = VehicleCamera(PINHOLE, FastScene([wall(5.0, 20.0, (0, 0, 0))]), Balloon(), interlaced=True)
    frame = eye.frame()
    for field, x in enumerate((-0.02, 0.02)):
        place = np.array((x, 0.0, 1.5))
        eye.expose(field, NOWHERE, LEVEL, [(VehiclePose(place, LEVEL, place), Appearance())], frame)
    frame = frame[..., 0]
    columns = np.indices(frame.shape)[1]
    means = [columns[k::2][frame[k::2] > 100.0].mean() for k in (0, 1)]
    assert means[1] - means[0] == pytest.approx(PINHOLE.fx * 0.04 / 1.5, rel=0.1)


def test_what_is_nearer_hides_the_ball_and_who_is_behind_is_not_drawn() -> None:
    eye = VehicleCamera(PINHOLE, FastScene([wall(5.0, 20.0, (0, 0, 0))]), Balloon(), interlaced=False)
    ball = VehiclePose(np.array((0.0, 0.0, 1.6)), LEVEL, np.array((0.0, 0.0, 1.6)))
    board = Appearance(FastScene([wall(0.0, 0.3, (90, 90, 90))]), below=0.5, ball=False)
    held = VehiclePose(np.array((0.0, 0.0, 0.8)), LEVEL, np.array((0.0, 0.0, 0.8)))
    behind = VehiclePose(np.array((0.0, 0.0, -1.0)), LEVEL, np.array((0.0, 0.0, -1.0)))
    shown = eye.frame()
    eye.expose(0, NOWHERE, LEVEL, [(ball, Appearance()), (held, board), (behind, Appearance())], shown)
    assert set(np.unique(shown[..., 0])) <= set(range(91))
    assert shown[shown.shape[0] // 2, shown.shape[1] // 2, 0] == 90
