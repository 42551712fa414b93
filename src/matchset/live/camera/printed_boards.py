"""Boards to print, which a page may load: `PrintedBoards`."""

import shutil
import tempfile
import weakref
from pathlib import Path

import msgspec

from matchset.app.calibrate.board_sheet import PAPERS, as_pdf, board_sheet
from matchset.camera.board import Board


class PrintedParameters(msgspec.Struct, frozen=True, kw_only=True):
    """The board that is offered.

    Parameters
    ----------
    columns, rows : int
        Inner corners. More: more corners a view, and smaller squares. Chosen by hand: the board of docs/camera.md.
    square : float
        Side of a square, m; less on paper where so many do not fit.
    """

    columns: int = 9
    rows: int = 6
    square: float = 0.025


class PrintedBoard(msgspec.Struct, frozen=True):
    """A sheet: its name among the downloads, the paper, and the side of its squares, m."""

    name: str
    paper: str
    columns: int
    rows: int
    square: float


class PrintedBoards:
    """Sheets of a board on each paper, in a folder that goes with this.

    Parameters
    ----------
    parameters : PrintedParameters, optional

    Attributes
    ----------
    sheets : list of PrintedBoard
    """

    def __init__(self, parameters: PrintedParameters | None = None) -> None:
        wanted = parameters or PrintedParameters()
        self._folder = Path(tempfile.mkdtemp(prefix="matchset-"))
        self.close = weakref.finalize(self, shutil.rmtree, self._folder, ignore_errors=True)
        self.sheets = []
        for paper in PAPERS:
            sheet = board_sheet(Board(columns=wanted.columns, rows=wanted.rows, square=wanted.square), paper)
            name, board = f"board-{paper}.pdf", sheet.board
            (self._folder / name).write_bytes(as_pdf(sheet))
            self.sheets.append(PrintedBoard(name, paper, board.columns, board.rows, board.square))

    def downloads(self) -> dict[str, Path]:
        """Return the sheets by name."""
        return {sheet.name: self._folder / sheet.name for sheet in self.sheets}
