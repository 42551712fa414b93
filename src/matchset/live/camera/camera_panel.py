"""The camera in the page (`CameraPanel`): what is known of it, and the ways to know more."""

import math
import threading
from collections.abc import Callable
from pathlib import Path

import msgspec

from matchset.app.cli_options import UPRIGHT, TurnOptions
from matchset.camera.board import Board
from matchset.camera.camera_model import CameraModel
from matchset.live.camera.ball_distance import BallDistance
from matchset.live.camera.board_calibration import BoardCalibration, BoardState
from matchset.live.camera.camera_files import CameraFile, find_camera_files, read_camera_file
from matchset.live.camera.camera_source import CameraSource
from matchset.live.camera.messages import MESSAGES, BallAt, CalibrateBoard, CameraWish, EndBoard, UseCamera
from matchset.live.camera.printed_boards import PrintedBoard, PrintedBoards
from matchset.live.feed import Panel
from matchset.media.closing import Closing


class FileEntry(msgspec.Struct, frozen=True):
    """A camera file of the menu: its key, its name, and what it says."""

    key: str
    name: str
    words: str


class CameraState(msgspec.Struct, frozen=True, omit_defaults=True):
    """What the page shows of the camera.

    Parameters
    ----------
    words : str
        The model in use; empty: none is known.
    fov : float or None
        Horizontal field of view, degrees.
    fov_sigma : float
        Its standard deviation, as far as it comes from the focal length, degrees; 0: taken as exact.
    files : list of FileEntry
        Camera files that can be used.
    board : BoardState or None
        A calibration with a board.
    ball : str
        What to do for the ball at a known distance.
    sheets : list of PrintedBoard
        Boards to print.
    """

    words: str = ""
    fov: float | None = None
    fov_sigma: float = 0.0
    files: list[FileEntry] = []
    board: BoardState | None = None
    ball: str = ""
    sheets: list[PrintedBoard] = []


class CameraPanel(Panel, Closing):
    """Takes what a person knows of the camera of a source.

    Parameters
    ----------
    shown : CameraSource
    note : callable
        Told what a person should know.
    folder : Path, optional
        Whose camera files are offered.
    mounted : TurnOptions, optional
        How the pictures are turned. Files are for pictures as the camera delivers them: they are turned, too.
    """

    name = "camera"
    messages = MESSAGES
    uploads = ("camera",)

    def __init__(
        self,
        shown: CameraSource,
        note: Callable[[str], None],
        folder: Path | None = None,
        mounted: TurnOptions = UPRIGHT,
    ) -> None:
        self._shown, self._note, self._folder, self._mounted = shown, note, folder or Path(), mounted
        self._files: dict[str, CameraFile] = {}
        self._numbers = 0
        self._printed = PrintedBoards()
        self._board: BoardCalibration | None = None
        self._ball: BallDistance | None = None
        self.look()

    def look(self) -> None:
        """Look for camera files."""
        known = {file.path: key for key, file in self._files.items()}
        files = {}
        for file in find_camera_files(self._folder):
            self._numbers += 1
            files[known.get(file.path, f"camera-{self._numbers}")] = file
        self._files = files

    def take(self, message: CameraWish, page: str) -> None:  # noqa: ARG002
        """Do what a page asks for.

        Raises
        ------
        ValueError
            If it cannot be done; says why.
        """
        if isinstance(message, UseCamera):
            if message.key not in self._files:
                raise ValueError("this camera file is not there any more: look again")
            self._shown.use(self._files[message.key].camera.turned(**self._mounted.arguments))
        elif isinstance(message, CalibrateBoard):
            self._begin_board(message)
        elif isinstance(message, EndBoard):
            self._end_board(message.use)
        elif isinstance(message, BallAt):
            self._begin_ball(message)
        else:
            threading.Thread(target=self.look, name="matchset camera files", daemon=True).start()

    def put(self, upload: str, name: str, data: bytes) -> None:  # noqa: ARG002
        """Use a camera file that a page sends.

        Raises
        ------
        ValueError
            If it is none.
        """
        self._shown.use(read_camera_file(name, data).turned(**self._mounted.arguments))

    def state(self) -> CameraState:
        """Return what the page shows."""
        camera = self._shown.seen.camera
        ball = "" if self._ball is None else self._ball.words
        return CameraState(
            words="" if camera is None else describe(camera),
            fov=None if camera is None else fov(camera),
            fov_sigma=0.0 if camera is None else fov_sigma(camera),
            files=[FileEntry(key, _shown(file.path), describe(file.camera)) for key, file in self._files.items()],
            board=None if self._board is None else self._board.state,
            ball=ball,
            sheets=self._printed.sheets,
        )

    def downloads(self) -> dict[str, Path]:
        """Return the boards to print, and the pictures and files of the calibration."""
        return self._printed.downloads() | ({} if self._board is None else self._board.downloads())

    def close(self) -> None:
        """End what runs."""
        for running in (self._board, self._ball):
            if running is not None:
                running.close()
        self._printed.close()

    def _begin_board(self, wish: CalibrateBoard) -> None:
        board = Board(
            columns=wish.columns,
            rows=wish.rows,
            square=wish.square,
            marker=wish.marker,
            dictionary=wish.dictionary.upper(),
        )
        if self._board is not None:
            self._board.cancel()
        self._board = BoardCalibration(self._shown, board, self._note, self._mounted)

    def _end_board(self, use: bool) -> None:
        if self._board is None:
            raise ValueError("no calibration is under way")
        if use:
            self._board.end()
        else:
            self._board.cancel()
            self._board = None

    def _begin_ball(self, wish: BallAt) -> None:
        if self._ball is not None and self._ball.words:
            raise ValueError("the ball is being measured already")
        if all(each.id != wish.target for each in self._shown.seen.state.targets):
            raise ValueError("there is no such target any more")
        self._ball = BallDistance(self._shown, wish.target, wish.meters, self._note)


def describe(camera: CameraModel) -> str:
    """Say in words what a camera model is."""
    covariance = camera.covariance
    sigma = "" if covariance is None else f" ± {math.sqrt(covariance[0, 0]):.1f}"
    lens = "with lens distortion" if any(camera.distortion) else "no lens distortion"
    return f"{fov(camera):.1f}° wide, focal length {camera.fx:.1f}{sigma} px, {camera.width} x {camera.height}, {lens}"


def fov(camera: CameraModel) -> float:
    """Return the horizontal field of view, degrees, without distortion."""
    return 2.0 * math.degrees(math.atan2(0.5 * camera.width, camera.fx))


def fov_sigma(camera: CameraModel) -> float:
    """Return the standard deviation of `fov` that follows from that of the focal length, to first order, degrees."""
    return math.degrees(camera.focal_sigma * math.sin(math.radians(fov(camera))))


def _shown(path: Path) -> str:
    """Write a path so that it is valid text, whatever bytes it is made of."""
    return str(path).encode(errors="replace").decode()
