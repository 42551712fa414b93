from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import matchset as ms
from boards import BoardCamera, poses, seen_corners
from matchset.camera.board import Board, BoardFinder, BoardView, blur_at

CAMERA = ms.CameraModel(
    width=640, height=480, fx=450.0, fy=452.0, cx=323.0, cy=236.0, distortion=(-0.3, 0.11, 0.001, -0.0005, -0.01)
)
CHESS = Board(columns=9, rows=6, square=0.025)
CHARUCO = Board(columns=9, rows=6, square=0.025, marker=0.018)
FACING = Rotation.identity()


def found(board: Board, image: Any) -> BoardView:
    view = BoardFinder(board).find(ms.Frame(image, 0.0, 7))
    assert isinstance(view, BoardView)
    return view


@pytest.mark.parametrize(("board", "rms"), [(CHESS, 0.08), (CHARUCO, 0.3)])
def test_corners_to_a_fraction_of_a_pixel(board: Board, rms: float) -> None:
    """Through a barrel lens, tilted, with noise and blur."""
    camera = BoardCamera(CAMERA, board)
    for seed, pose in enumerate(poses(CAMERA, board, 4, seed=3)):
        view = found(board, camera.picture(*pose, seed=seed))
        truth = seen_corners(CAMERA, board, *pose)[view.corners]
        error = min(np.sqrt(((view.pixels[::way] - truth) ** 2).sum(axis=1).mean()) for way in (1, -1))
        assert error < rms
        assert view.index == 7


def test_a_charuco_board_may_be_half_hidden() -> None:
    image = BoardCamera(CAMERA, CHARUCO).picture(FACING, (0.0, 0.0, 0.3))
    image[:, :320] = 0
    view = found(CHARUCO, image)
    assert 8 <= len(view.corners) <= 27
    truth = seen_corners(CAMERA, CHARUCO, FACING, (0.0, 0.0, 0.3))[view.corners]
    assert np.abs(view.pixels - truth).max() < 1.0
    assert view.points[:, :2] == pytest.approx(np.column_stack((view.corners % 9, view.corners // 9)) * 0.025)


def test_a_color_picture_will_do() -> None:
    image = BoardCamera(CAMERA, CHESS).picture(FACING, (0.0, 0.0, 0.4))
    colored = np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), np.uint8)
    assert found(CHESS, colored).pixels == pytest.approx(found(CHESS, image).pixels, abs=0.01)


@pytest.mark.parametrize("board", [CHESS, CHARUCO])
@pytest.mark.parametrize("shape", [(1, 1, 3), (5, 400), (120, 160), (240, 320, 3)])
def test_no_board_is_said(board: Board, shape: tuple[int, ...]) -> None:
    noise = np.random.default_rng(0).integers(0, 255, shape, np.uint8)
    for image in (np.zeros(shape, np.uint8), noise):
        lost = BoardFinder(board).find(ms.Frame(image, 0.5))
        assert not lost
        assert isinstance(lost, ms.Lost)
        assert lost.reason == f"no {board} in the picture"


def test_blur_is_measured() -> None:
    board = BoardCamera(CAMERA, CHESS)
    sharp = board.picture(FACING, (0.0, 0.0, 0.3), noise=0.5, blur=0.3)
    corners = seen_corners(CAMERA, CHESS, FACING, (0.0, 0.0, 0.3))
    values = [blur_at(np.asarray(cv2.GaussianBlur(sharp, (0, 0), s), np.uint8), corners) for s in (0.5, 1.5, 3.0)]
    assert values == sorted(values)
    assert values[1] == pytest.approx(1.5, rel=0.25)


def test_the_picture_to_print_is_found() -> None:
    for board in (CHESS, CHARUCO, Board(columns=8, rows=5, square=0.03, marker=0.022, dictionary="4X4_50")):
        view = found(board, board.picture(40))
        assert len(view.corners) == board.columns * board.rows
        assert board.picture(40).shape == ((board.rows + 3) * 40, (board.columns + 3) * 40)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"columns": 2}, "got 2 x 6"),
        ({"rows": 0}, "got 9 x 0"),
        ({"columns": 1000}, "got 1000 x 6"),
        ({"square": 0.0}, "got 0.0"),
        ({"square": float("nan")}, "got nan"),
        ({"marker": 0.03}, "got 0.03 m"),
        ({"marker": -1.0}, "got -1.0 m"),
        ({"marker": 0.01, "dictionary": "7Y7"}, "no marker dictionary '7Y7'"),
        ({"marker": 0.01, "columns": 20, "rows": 20}, "needs 220 markers, 5X5_100 has 100"),
    ],
)
def test_impossible_boards(change: dict[str, Any], words: str) -> None:
    good: dict[str, Any] = {"columns": 9, "rows": 6, "square": 0.025}
    with pytest.raises(ValueError, match=words):
        Board(**(good | change))
