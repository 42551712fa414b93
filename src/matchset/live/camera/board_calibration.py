"""A calibration with a board that is held before the camera, in a thread of its own: `BoardCalibration`."""

import shutil
import tempfile
import threading
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import msgspec

from matchset.app.calibrate.board_views import Advice, advise
from matchset.app.calibrate.coverage_picture import coverage_map, coverage_picture
from matchset.app.cli_options import UPRIGHT, TurnOptions
from matchset.app.drawing.picture_file import write_picture
from matchset.app.run_folder import output_folder
from matchset.camera.board import Board, BoardFinder, BoardView
from matchset.camera.calibrate import Calibration, calibrate
from matchset.camera.calibration_report import CalibrationReport, grade_calibration
from matchset.camera.camera_model import CameraModel
from matchset.camera.view_selection import select_views
from matchset.image.frame import Frame
from matchset.live.camera.camera_source import CameraSource, newest_pictures
from matchset.media.closing import Closing

Phase = Literal["looking", "computing", "done", "refused"]


class BoardCalibrationParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How views are collected.

    Parameters
    ----------
    kept : int
        Views after which those that are blurred or like another are forgotten. More: the choice among more, and longer
        between two pictures. Chosen by hand: 120 take 0.1 s.
    """

    kept: int = 120


class VerdictLine(msgspec.Struct, frozen=True):
    """A line of the verdict: its grade, what it is of, and in words."""

    grade: str
    name: str
    words: str


class BoardState(msgspec.Struct, frozen=True, omit_defaults=True):
    """How far a calibration is.

    Parameters
    ----------
    phase : str
        "looking", "computing", "done", "refused".
    words : str
        What to do next, or the verdict.
    views : int
        Sharp and different ones.
    share : float
        Of the picture in which the board was seen, 0 ... 1.
    picture : str
        Download: where the board was seen.
    file : str
        Download: the camera file.
    grade : str
        "good", "usable", "poor".
    lines : list of VerdictLine
        The verdict, property by property.
    """

    phase: Phase
    words: str
    views: int = 0
    share: float = 0.0
    picture: str = ""
    file: str = ""
    grade: str = ""
    lines: list[VerdictLine] = []


class BoardCalibration(Closing):
    """Looks for a board in the pictures of a source until there are enough views, then calibrates.

    Parameters
    ----------
    shown : CameraSource
        Its pictures are read, and its camera is set at the end.
    board : Board
    note : callable
        Told where the file is.
    mounted : TurnOptions, optional
        How its pictures are turned; the file is for pictures as the camera delivers them.
    parameters : BoardCalibrationParameters, optional

    Attributes
    ----------
    state : BoardState
    """

    def __init__(
        self,
        shown: CameraSource,
        board: Board,
        note: Callable[[str], None],
        mounted: TurnOptions = UPRIGHT,
        parameters: BoardCalibrationParameters | None = None,
    ) -> None:
        self._shown, self._board, self._note, self._mounted = shown, board, note, mounted
        self._parameters = parameters or BoardCalibrationParameters()
        self._folder = Path(tempfile.mkdtemp(prefix="matchset-"))
        self._forget = weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        self._views: list[BoardView] = []
        self._picture: Frame | None = None
        self._size: tuple[int, int] | None = None
        self._drawn, self._files = 0, dict[str, Path]()
        self.state = BoardState("looking", "hold the board before the camera")
        self._stop, self._use = threading.Event(), True
        self._thread = threading.Thread(target=self._run, name="matchset board", daemon=True)
        self._thread.start()

    def end(self) -> None:
        """Calibrate with the views so far; does not wait."""
        self._stop.set()

    def cancel(self) -> None:
        """End it without a result; does not wait."""
        self._use = False
        self._stop.set()

    def close(self) -> None:
        """End it without a result, if it has none yet, and forget its pictures."""
        self.cancel()
        self._thread.join()
        self._forget()

    def downloads(self) -> dict[str, Path]:
        """Return the files of `state`, by name."""
        return dict(self._files)

    def _run(self) -> None:
        finder = BoardFinder(self._board)
        try:
            for seen in newest_pictures(self._shown, self._stop):
                assert seen.frame is not None
                view = finder.find(seen.frame)
                if isinstance(view, BoardView) and self._take(view, seen.frame):
                    break
            if self._use:
                self._finish()
        except ValueError as error:
            self._refuse(str(error))

    def _take(self, view: BoardView, frame: Frame) -> bool:
        """Keep a view; returns whether there are enough."""
        height, width = frame.image.shape[:2]
        if self._size not in (None, (width, height)):
            raise ValueError("the pictures have another size now: begin again")
        self._size, self._picture = (width, height), frame
        self._views.append(view)
        advice = advise(self._views, width, height)
        if len(self._views) > self._parameters.kept:
            self._views = list(advice.different)
        if len(advice.different) != self.state.views:
            self._draw(coverage_map(frame.image, advice.different))
        self._tell(advice)
        return advice.enough

    def _tell(self, advice: Advice) -> None:
        picture = next(reversed(self._files), "")
        self.state = BoardState("looking", advice.words, len(advice.different), advice.share, picture)

    def _draw(self, image: object) -> None:
        """Leave a picture for the page; the one before stays, a page may be loading it."""
        self._drawn += 1
        name = f"coverage-{self._drawn}.png"
        path = self._folder / name
        write_picture(path, image)  # type: ignore[arg-type]
        self._files[name] = path
        while len(self._files) > 2:  # format: the newest, and the one before
            self._files.pop(next(iter(self._files))).unlink()

    def _finish(self) -> None:
        self.state = msgspec.structs.replace(self.state, phase="computing", words="computing …")
        if self._size is None or self._picture is None:
            raise ValueError(
                f"no {self._board} was seen. Inner corners are counted, not squares: a board of 10 x 7 squares has "
                "9 x 6; all of a chessboard must be in the picture, with a white margin"
            )
        calibration = calibrate(select_views(self._views, self._size[0]), *self._size)
        self._save(calibration, grade_calibration(calibration))

    def _save(self, calibration: Calibration, report: CalibrationReport) -> None:
        assert self._picture is not None
        folder = output_folder(None, "calibrate")
        file, picture = folder / "camera.toml", folder / "camera-coverage.png"
        calibration.camera.turned(**self._mounted.undone.arguments).save(file)
        write_picture(picture, coverage_picture(self._picture.image, calibration.views, report))
        self._draw(coverage_map(self._picture.image, calibration.views))
        shown = next(reversed(self._files))
        self._files |= {file.name: file, picture.name: picture}
        camera = CameraModel.load(file).turned(**self._mounted.arguments)
        self._shown.use(camera)  # as any run after this one will read it
        self._note(f"the camera is saved as {file}, and used")
        self.state = BoardState(
            phase="done",
            words=f"The calibration is {report.grade}.",
            views=len(calibration.views),
            share=self.state.share,
            picture=shown,
            file=file.name,
            grade=report.grade,
            lines=[VerdictLine(finding.grade, finding.name, finding.words) for finding in report.findings],
        )

    def _refuse(self, words: str) -> None:
        self.state = msgspec.structs.replace(self.state, phase="refused", words=f"Not calibrated: {words}")
