"""The board in a video, a folder of pictures or before a camera: looking until enough has been seen."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.exit_codes import StopRequest
from matchset.app.progress import Hint, counting
from matchset.camera.board import Board, BoardFinder, View
from matchset.camera.calibration_report import covered, unseen_corners
from matchset.camera.view_selection import select_views
from matchset.image.video import Video

_LOOKS = 240
"""Frames of a recording that are looked at, spread over it: a calibration needs a few dozen."""
_ENOUGH_VIEWS = 20
_ENOUGH_COVERED = 0.6


class Seen(msgspec.Struct):
    """What was seen.

    Parameters
    ----------
    looks : int
        Frames that were looked at.
    views : list of View
        The board in those that show it.
    picture : ndarray of shape (h, w, 3) or (h, w), uint8, or None
        The last of these.
    """

    looks: int = 0
    views: list[View] = msgspec.field(default_factory=list)
    picture: npt.NDArray[np.uint8] | None = None


def look_for_board(video: Video, board: Board, stop: StopRequest, quiet: bool = False) -> Seen:
    """Look for the board in frames spread over a video; before a camera until there is enough, or until Ctrl-C.

    Parameters
    ----------
    video : Video
        Not yet read.
    board : Board
    stop : StopRequest
        Looked at after each frame.
    quiet : bool
        Whether to show nothing meanwhile.

    Returns
    -------
    Seen
    """
    finder, seen = BoardFinder(board), Seen()
    step = 1 if video.live else max(1, math.ceil((video.length or 0) / _LOOKS))
    screen = Hint(quiet) if video.live else counting("looking for the board", video.length)
    with screen:
        for frame in video:
            if frame.index % step == 0 or video.live:
                view = finder.find(frame)
                seen.looks += 1
                if isinstance(view, View):
                    seen.views.append(view)
                    seen.picture = frame.image
            if isinstance(screen, Hint):
                words, enough = advice(seen.views, video.width, video.height)
                screen.say(words)
                if enough:
                    break
            else:
                screen.advance()
            if stop:
                break
    return seen


def advice(views: list[View], width: int, height: int) -> tuple[str, bool]:
    """Say what is still missing.

    Parameters
    ----------
    views : list of View
        All so far.
    width, height : int
        Size of the picture, px.

    Returns
    -------
    tuple of str and bool
        One line for the screen, and whether it is enough.
    """
    different = select_views(views, width)
    share = float(covered(different, width, height).mean())
    unseen = unseen_corners(different, width, height)
    if unseen and views:
        wish = f"hold the board at the {unseen[0]}"
    elif len(different) < _ENOUGH_VIEWS or share < _ENOUGH_COVERED:
        wish = "tilt it differently, hold it still; near and far" if views else "hold the board before the camera"
    else:
        return "enough", True
    return f"{len(different)} views   {100.0 * share:.0f} % covered   {wish}   (Ctrl-C: that is all)", False
