"""`matchset calibrate` and `matchset locate` of a camera that hangs turned, or looks into a mirror: one camera file."""

import math
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from blue_ball import Matchset
from boards import BoardCamera, poses
from matchset.app.locate.rows import read_poses
from matchset.camera.board import Board

CAMERA = ms.CameraModel(width=480, height=360, fx=340.0, fy=340.0, cx=252.0, cy=168.0, distortion=(-0.2, 0.05, 0, 0, 0))
BOARD = Board(columns=7, rows=5, square=0.03)
PLACE, DIAMETER = (0.2, -0.13, 0.9), 0.28  # m, in the frame of the upright picture


def ball() -> npt.NDArray[np.uint8]:
    """A blue ball at `PLACE`, as `CAMERA` sees it."""
    x, y = np.meshgrid(np.arange(480.0), np.arange(360.0))
    rays = CAMERA.rays(np.column_stack((x.ravel(), y.ravel()))).reshape(360, 480, 3)
    distance = math.hypot(*PLACE)
    angle = np.arccos(np.clip(rays @ (np.array(PLACE) / distance), -1.0, 1.0))
    cover = np.clip((math.asin(0.5 * DIAMETER / distance) - angle) * CAMERA.fx + 0.5, 0.0, 1.0)[..., None]
    image = cv2.GaussianBlur(150.0 + cover * (np.array((190.0, 70.0, 30.0)) - 150.0), (0, 0), 0.8)
    return np.asarray(np.clip(image + np.random.default_rng(0).normal(0.0, 2.0, image.shape), 0.0, 255.0), np.uint8)


def stored(upright: npt.NDArray[np.uint8], turn: int, mirror: bool) -> npt.NDArray[np.uint8]:
    """The picture that is upright after it was turned clockwise, then mirrored."""
    return np.ascontiguousarray(np.rot90(upright[:, ::-1] if mirror else upright, turn // 90))


@pytest.mark.parametrize(("turn", "mirror"), [(90, False), (180, True)])
def test_meters_are_right_with_the_file_that_the_same_options_made(
    matchset: Matchset, tmp_path: Path, turn: int, mirror: bool
) -> None:
    for name, pictures in (
        (
            "board",
            [
                BoardCamera(CAMERA, BOARD).picture(*each, seed=k)
                for k, each in enumerate(poses(CAMERA, BOARD, 14, seed=103))
            ],
        ),
        ("ball", [ball()] * 3),
    ):
        (tmp_path / name).mkdir()
        for index, each in enumerate(pictures):
            cv2.imwrite(str(tmp_path / name / f"{index}.png"), stored(each, turn, mirror))
    words = ["--turn", turn, *(["--mirror"] if mirror else [])]
    assert matchset("calibrate", "board", "--board", "7x5", "--square", 0.03, *words, "-o", "camera.toml") == 0
    delivered = ms.CameraModel.load("camera.toml")
    assert (delivered.height, delivered.width) == stored(ball(), turn, mirror).shape[:2]
    known = "--camera", "camera.toml", "--diameter", DIAMETER, "--hsv", "100,80,60:130,255,255", "--no-video"
    assert matchset("locate", "ball", *words, *known, "-o", "out") == 0
    for row in read_poses("out/poses.csv"):
        assert row.values is not None
        assert [row.values[name] for name in "xyz"] == pytest.approx(PLACE, abs=0.01)
