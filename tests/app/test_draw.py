"""`ms.draw` and `ms.draw_pose`: copies with what was found; a loss says why; nothing else is accepted."""

import math
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.app.drawing.annotate import OUTLINE, PREDICTED
from matchset.app.drawing.draw import TARGETS

IMAGE = np.full((240, 320, 3), 90, np.uint8)
cv2.circle(IMAGE, (140, 100), 40, (200, 60, 30), -1, cv2.LINE_AA)
TURNS = np.arange(64) / 64 * 2.0 * math.pi


def track_at(x: float, y: float, radius: float) -> ms.Track[ms.Circle]:
    points = np.column_stack((x + radius * np.cos(TURNS), y + radius * np.sin(TURNS)))
    return ms.Track(ms.Circle(x, y, radius), np.eye(3) * 0.01, 1.0, points, 0.0)


TRACK = track_at(140.0, 100.0, 40.0)
CAMERA = ms.CameraModel.from_fov(320, 240, 1.07)
DISTANCE = 0.14 / math.sin(math.atan(40.0 / CAMERA.fx))
POSE = ms.Pose(
    position=DISTANCE * np.array(((140.0 - CAMERA.cx) / CAMERA.fx, (100.0 - CAMERA.cy) / CAMERA.fy, 1.0)),
    rotation_matrix=None,
    covariance=np.eye(6) * 1e-4,
    observed="position",
    time=0.0,
)
LOST: ms.Lost[ms.Circle] = ms.Lost("behind a tree", 0.0, ms.Circle(140.0, 100.0, 40.0))


def near(image: np.ndarray, color: tuple[int, int, int]) -> np.ndarray:
    """Pixels (x, y) of about this color, above the captions."""
    rows, columns = np.nonzero((np.abs(image[:190].astype(int) - color) < 60).all(axis=2))
    return np.column_stack((columns, rows))


def radii(points: np.ndarray) -> np.ndarray:
    return np.asarray(np.hypot(*(points - (TRACK.shape.x, TRACK.shape.y)).T))


@pytest.mark.parametrize("given", [IMAGE, ms.Frame(IMAGE), IMAGE[..., 0]], ids=["array", "frame", "gray"])
def test_a_track_is_drawn_into_a_copy(given: Any) -> None:
    before = IMAGE.copy()
    drawn = ms.draw(given, TRACK)
    assert np.array_equal(IMAGE, before)
    assert drawn.shape == IMAGE.shape
    assert drawn.dtype == np.uint8
    pink = near(drawn, OUTLINE)
    assert len(pink) > 50
    assert np.abs(radii(pink) - TRACK.shape.radius).max() < 2.5
    assert (drawn[225:] != as_bgr(given)[225:]).any()  # the caption


def as_bgr(given: Any) -> np.ndarray:
    image = given.image if isinstance(given, ms.Frame) else given
    return np.asarray(image if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR))


def test_a_loss_is_dashed_and_says_why() -> None:
    drawn = ms.draw(IMAGE, LOST)
    assert len(near(drawn, OUTLINE)) == 0
    dashes = near(drawn, PREDICTED)
    assert 20 < len(dashes) < 260
    assert (ms.draw(IMAGE, ms.Lost("another reason", 0.0))[225:] != drawn[225:]).any()
    assert np.array_equal(ms.draw(IMAGE, ms.Lost("gone", 0.0), words=False), IMAGE)


def test_all_detections_are_drawn_at_once() -> None:
    drawn = ms.draw(IMAGE, [TRACK, track_at(260.0, 100.0, 25.0)])
    first, second = (near(drawn, color) for color in TARGETS[:2])
    assert len(first) > 50
    assert np.abs(radii(first) - TRACK.shape.radius).max() < 2.5
    assert len(second) > 50
    assert (second[:, 0] > 230).all()
    assert np.array_equal(ms.draw(IMAGE, [], words=False), IMAGE)


def test_what_is_drawn_is_an_array_that_a_notebook_shows() -> None:
    drawn = ms.draw(IMAGE, TRACK)
    shown = cv2.imdecode(np.frombuffer(drawn._repr_png_() or b"", np.uint8), cv2.IMREAD_COLOR)
    assert np.array_equal(np.asarray(shown), drawn)
    assert drawn[5]._repr_png_() is None
    assert (drawn / 2.0)._repr_png_() is None  # type: ignore[attr-defined]
    assert np.asarray(cv2.resize(drawn, (32, 24))).shape == (24, 32, 3)


def test_a_pose_shows_the_outline_that_it_implies() -> None:
    pink = near(ms.draw_pose(ms.Frame(IMAGE), POSE, CAMERA, diameter=0.28), OUTLINE)
    assert len(pink) > 50
    assert np.abs(radii(pink) - TRACK.shape.radius).max() < 3.0


def test_without_a_diameter_the_center_has_a_cross() -> None:
    pink = near(ms.draw_pose(IMAGE, POSE, CAMERA, words=False), OUTLINE)
    assert 10 < len(pink) < 60
    assert radii(pink).max() < 13.0


def test_axes_are_drawn_where_the_rotation_is_observed() -> None:
    turned = ms.Pose(
        position=POSE.position,
        rotation_matrix=Rotation.from_euler("xyz", (0.4, 3.6, 0.1)).as_matrix(),
        covariance=np.eye(6) * 1e-4,
        observed="full",
        time=0.0,
    )
    plain, axes = (ms.draw_pose(IMAGE, pose, CAMERA, 0.28, words=False) for pose in (POSE, turned))
    assert (plain != axes).any(axis=2).sum() > 100
    assert (ms.draw_pose(IMAGE, turned, CAMERA, 0.28) != axes)[200:].any()


def test_a_ball_behind_the_camera_or_a_lost_one_leaves_the_picture() -> None:
    behind = ms.Pose(
        position=np.array((0.0, 0.0, -2.0)), rotation_matrix=None, covariance=np.eye(6), observed="position", time=0.0
    )
    assert np.array_equal(ms.draw_pose(IMAGE, behind, CAMERA, words=False), IMAGE)
    lost = ms.draw_pose(IMAGE, ms.Lost("gone", 0.0), CAMERA)
    assert np.array_equal(lost[:200], IMAGE[:200])
    assert (lost[225:] != IMAGE[225:]).any()


make: Any = ms
MISUSE: dict[str, tuple[Callable[[], object], type[Exception], str]] = {
    "no track": (lambda: make.draw(IMAGE, [POSE]), TypeError, "must be a Track or Lost, got Pose"),
    "no picture": (lambda: make.draw("a.png", TRACK), ValueError, "a picture must be an array of uint8, got str"),
    "no pose": (lambda: make.draw_pose(IMAGE, TRACK, CAMERA), TypeError, "pose must be a Pose or Lost, got Track"),
    "no camera": (lambda: make.draw_pose(IMAGE, POSE, 1.0), TypeError, "camera must be a CameraModel"),
    "other size": (lambda: make.draw_pose(IMAGE[:100], POSE, CAMERA), ValueError, "320 x 100"),
    "diameter": (lambda: make.draw_pose(IMAGE, POSE, CAMERA, -1.0), ValueError, "must be positive, m, got -1.0"),
    "a nan": (lambda: make.draw_pose(IMAGE, POSE, CAMERA, math.nan), ValueError, "must be positive, m, got nan"),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_refused_in_words(name: str) -> None:
    call, error, words = MISUSE[name]
    with pytest.raises(error, match=words):
        call()
