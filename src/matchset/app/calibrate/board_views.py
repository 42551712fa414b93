"""Views of the board in a video, a folder of pictures or from a camera, until there are enough: `look_for_board`."""

import math
from collections import deque
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.exit_codes import StopRequest
from matchset.app.progress import InstructionLine, progress_bar
from matchset.camera.board import Board, BoardFinder, BoardView
from matchset.camera.calibration_report import covered_cells, unseen_corners
from matchset.camera.view_selection import select_views
from matchset.media.video import Video
from matchset.tracking.track import Lost


class ViewParameters(msgspec.Struct, frozen=True):
    """How many views of a board are collected.

    Parameters
    ----------
    max_frames : int
        Frames of a file that are searched, spread over it: a calibration needs a few dozen; more take longer. Chosen
        by hand; `tests/app/calibrate/test_calibrate_command.py` shows a change.
    min_views : int
        Different views after which a camera may stop. Chosen by hand, above the 12 of the report's grade "good".
    min_coverage : float
        Share of the picture that they must cover by then, 0 ... 1: the report's limit of the grade "good".
    kept_each : int
        Of so many frames without the board one is kept, to see what is there in its place.
    kept : int
        How many of these at most, the last ones: each is a whole picture in memory. Chosen by hand.
    """

    max_frames: int = 240
    min_views: int = 20
    min_coverage: float = 0.6
    kept_each: int = 60
    kept: int = 4


PARAMETERS = ViewParameters()


class BoardViews(msgspec.Struct):
    """The views of a board in a source.

    Parameters
    ----------
    frames : int
        Frames that were searched.
    views : list of BoardView
        The board in those that show it.
    picture : ndarray of shape (h, w, 3) or (h, w), uint8, or None
        The last of these frames.
    without : deque of ndarray
        Some of the others.
    """

    frames: int = 0
    views: list[BoardView] = msgspec.field(default_factory=list)
    picture: npt.NDArray[np.uint8] | None = None
    without: deque[npt.NDArray[np.uint8]] = msgspec.field(default_factory=lambda: deque(maxlen=PARAMETERS.kept))


def look_for_board(video: Video, board: Board, stop: StopRequest) -> BoardViews:
    """Find the board in frames spread over a file, or in frames of a camera until there are enough views, or Ctrl-C.

    Parameters
    ----------
    video : Video
        Not yet read.
    board : Board
    stop : StopRequest
        Checked after each frame.

    Returns
    -------
    BoardViews
    """
    finder, seen = BoardFinder(board), BoardViews()
    step = 1 if video.live else max(1, math.ceil((video.length or 0) / PARAMETERS.max_frames))
    display = InstructionLine() if video.live else progress_bar("looking for the board", video.length)
    with display:
        for frame in video:
            if frame.index % step == 0 or video.live:
                view = finder.find(frame)
                if isinstance(view, Lost) and seen.frames % PARAMETERS.kept_each == 0:
                    seen.without.append(frame.image)
                seen.frames += 1
                if isinstance(view, BoardView):
                    seen.views.append(view)
                    seen.picture = frame.image
            if isinstance(display, InstructionLine):
                words, enough = instruction(seen.views, video.width, video.height)
                display.show(words)
                if enough:
                    break
            else:
                display.advance()
            if stop:
                break
    return seen


class Advice(NamedTuple):
    """What is still missing.

    Attributes
    ----------
    different : list of BoardView
        The views that a calibration would use.
    share : float
        Of the picture that they cover, 0 ... 1.
    words : str
        What to do next.
    enough : bool
    """

    different: list[BoardView]
    share: float
    words: str
    enough: bool


def advise(views: list[BoardView], width: int, height: int) -> Advice:
    """Say which views are still missing.

    Parameters
    ----------
    views : list of BoardView
        All so far.
    width, height : int
        Size of the picture, px.

    Returns
    -------
    Advice
    """
    different = select_views(views, width)
    share = float(covered_cells(different, width, height).mean())
    unseen = unseen_corners(different, width, height)
    if unseen and views:
        return Advice(different, share, f"hold the board at the {unseen[0]}", False)
    if len(different) < PARAMETERS.min_views or share < PARAMETERS.min_coverage:
        words = "tilt it differently, hold it still; near and far" if views else "hold the board before the camera"
        return Advice(different, share, words, False)
    return Advice(different, share, "enough", True)


def instruction(views: list[BoardView], width: int, height: int) -> tuple[str, bool]:
    """Return one line for the display, and whether it is enough; see `advise`."""
    advice = advise(views, width, height)
    if advice.enough:
        return advice.words, True
    seen = f"{len(advice.different)} views   {100.0 * advice.share:.0f} % covered"
    return f"{seen}   {advice.words}   (Ctrl-C: that is all)", False
