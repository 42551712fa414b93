"""`matchset calibrate` with a board, in rendered pictures."""

import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

import matchset as ms
from blue_ball import Matchset
from boards import BoardCamera, poses
from matchset.app.calibrate import board_command
from matchset.app.calibrate.board_command import parse_board
from matchset.app.calibrate.board_views import instruction, look_for_board
from matchset.app.exit_codes import StopRequest
from matchset.camera.board import Board
from matchset.camera.calibration_report import unseen_corners

CAMERA = ms.CameraModel(width=480, height=360, fx=340.0, fy=340.0, cx=240.0, cy=178.0, distortion=(-0.3, 0.1, 0, 0, 0))
BOARD = Board(columns=7, rows=5, square=0.03)
WORDS = "--board", "7x5", "--square", "0.03"


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pictures")
    camera = BoardCamera(CAMERA, BOARD)
    for index, pose in enumerate(poses(CAMERA, BOARD, 14, seed=102)):
        cv2.imwrite(str(folder / f"{index}.png"), camera.picture(*pose, seed=index))
    return folder


def test_from_pictures_to_a_camera(matchset: Matchset, pictures: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("calibrate", pictures, *WORDS, "-o", "my/camera.toml") == 0
    camera = ms.CameraModel.load("my/camera.toml")
    assert camera.fx == pytest.approx(340.0, abs=1.0)
    assert camera.distortion[0] == pytest.approx(-0.3, abs=0.02)
    assert camera.covariance is not None
    said = capsys.readouterr().out
    assert "The calibration is" in said
    assert all(f"{name}:" in said for name in ("error", "views", "coverage", "tilt", "numbers"))
    picture = cv2.imread("my/camera-coverage.png")
    assert picture is not None
    assert picture.shape[1] >= 900
    assert matchset("calibrate", pictures, *WORDS, "-o", "my/camera.toml") == 2
    assert "overwrite with --force" in capsys.readouterr().err


def test_without_o_a_new_folder(matchset: Matchset, pictures: Path) -> None:
    assert matchset("calibrate", pictures, *WORDS) == 0
    assert {path.name for path in Path("runs/0001-calibrate").iterdir()} == {"camera.toml", "camera-coverage.png"}


def test_from_a_video_with_pauses_and_blur(matchset: Matchset, pictures: Path, tmp_path: Path) -> None:
    path = tmp_path / "board.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (480, 360))
    for index in range(14):
        image = cv2.imread(str(pictures / f"{index}.png"))
        assert image is not None
        for shift in (0, 12):  # blurred on the way, then still
            smear = np.ones((1, shift + 1)) / (shift + 1)
            writer.write(np.asarray(cv2.filter2D(image, -1, smear), np.uint8))
    writer.release()
    assert matchset("calibrate", path, *WORDS, "-o", "camera.toml") == 0
    assert ms.CameraModel.load("camera.toml").fx == pytest.approx(340.0, abs=1.5)


def test_too_few_views_are_refused_in_words(
    matchset: Matchset, pictures: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = tmp_path / "few"
    few.mkdir()
    for copy in range(8):
        shutil.copy(pictures / f"{copy % 3}.png", few / f"{copy}.png")
    assert matchset("calibrate", few, *WORDS, "-o", "camera.toml") == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: not calibrated: ")
    assert "different views of the board: at least 6 are needed" in line
    assert not Path("camera.toml").exists()
    assert Path("camera-coverage.png").exists()


def test_no_board_is_said_with_a_hint(matchset: Matchset, pictures: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("calibrate", pictures / "0.png", "--board", "8x6", "--square", "0.03") == 1
    assert "Inner corners are counted, not squares" in capsys.readouterr().err


def test_markers_of_another_dictionary_are_named(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    board = Board(columns=7, rows=5, square=0.03, marker=0.022)
    before = BoardCamera(CAMERA, board)
    for index, pose in enumerate(poses(CAMERA, board, 2, seed=5)):
        cv2.imwrite(str(tmp_path / f"{index}.png"), before.picture(*pose, seed=index))
    for words, said in (
        (("--charuco", 0.022, "--dictionary", "4X4_50"), "Markers of 5X5_50 are in the pictures: --dictionary 5X5_50"),
        (("--board", "9x6"), "Markers of 5X5_50 are in the pictures: --charuco MARKER --dictionary 5X5_50"),
    ):
        assert matchset("calibrate", tmp_path, *WORDS, *words, "-o", "camera.toml") == 1
        assert said in capsys.readouterr().err
    assert matchset("calibrate", tmp_path, *WORDS, "--charuco", 0.022, "--dictionary", "5X5_50") == 1
    assert "different view" in capsys.readouterr().err  # it is found: two pictures are too few


def test_a_board_to_print(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("calibrate", *WORDS, "--charuco", "0.022", "--board-picture", "board.png") == 0
    assert "300 x 240 mm" in capsys.readouterr().out
    image = cv2.imread("board.png")
    assert image is not None
    small = cv2.resize(image, None, fx=0.2, fy=0.2, interpolation=cv2.INTER_AREA)
    cv2.imwrite("small.png", small)
    assert matchset("calibrate", "small.png", *WORDS, "--charuco", "0.022") == 1
    assert "1 different view of the board" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "give --board 9x6"),
        (("x.mp4", *WORDS, "--ball-diameter", "0.2"), "and not both"),
        (("x.mp4", "--board", "7x5"), "--board needs --square"),
        (("x.mp4", "--board", "7by5", "--square", "0.03"), "--board is COLUMNSxROWS"),
        (("x.mp4", "--board", "1x5", "--square", "0.03"), "got 1 x 5"),
        (("x.mp4", "--board", "7x5", "--square", "-1"), "must be positive"),
        (("x.mp4", *WORDS, "--charuco", "0.5"), "must fit into its square"),
        (("x.mp4", *WORDS, "--charuco", "0.02", "--dictionary", "no"), "no marker dictionary 'NO'"),
        (("x.mp4", *WORDS, "--at", "1,2"), "belong to --ball-diameter"),
        (("x.mp4", *WORDS, "--board-picture", "a.png"), "takes no video"),
        ((*WORDS, "--board-picture", "a.txt"), "must end in .pdf, .svg or .png"),
        ((*WORDS, "--board-picture", "a.png", "--paper", "a4"), "a .png has no paper"),
        ((*WORDS, "--board-picture", "a.pdf", "--paper", "a3"), "--paper is a4 or letter, got 'a3'"),
        (("x.mp4", *WORDS, "--paper", "a4"), "--paper belongs to --board-picture"),
        ((*WORDS, "--board-picture", "a.png", "--board", "90x90", "--square", "0.5"), "too large to draw"),
        (("a", "b", *WORDS), "give one video"),
        (("gone.mp4", *WORDS), "gone.mp4"),
        (("gone.mp4", *WORDS, "-o", "camera.txt"), "must end in .toml"),
    ],
)
def test_misuse_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    assert matchset("calibrate", *words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert said in line


def test_what_a_person_before_a_camera_is_told(pictures: Path) -> None:
    with StopRequest() as stop, ms.Video(pictures) as video:
        seen = look_for_board(video, BOARD, stop)
    assert seen.frames == 14
    assert instruction([], 480, 360)[0].startswith("0 views")
    words, enough = instruction(seen.views[:3], 480, 360)
    assert not enough
    assert f"hold the board at the {unseen_corners(seen.views[:3], 480, 360)[0]}" in words


class FakeCamera(ms.Video):
    """A camera before which someone shows a board, then presses Ctrl-C."""

    def __init__(self, source: str, **_: object) -> None:
        super().__init__(Path(source))
        self.live, self.length = True, None


def test_before_a_camera(matchset: Matchset, pictures: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(board_command, "Video", FakeCamera)
    assert matchset("calibrate", pictures, *WORDS, "-o", "camera.toml") == 0
    assert ms.CameraModel.load("camera.toml").fx == pytest.approx(340.0, abs=1.0)


def test_board_sizes() -> None:
    assert parse_board("9x6") == parse_board("9X6") == (9, 6)
    for text in ("9", "9x", "x6", "9x6x1", "-9x6", "9.0x6", ""):
        with pytest.raises(ValueError, match="--board is"):
            parse_board(text)
