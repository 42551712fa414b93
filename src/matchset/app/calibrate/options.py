"""Which kind of calibration the options of `matchset calibrate` ask for."""

from pathlib import Path

from matchset.app.calibrate.ball_command import BallOptions, calibrate_ball
from matchset.app.calibrate.command import CalibrateOptions, calibrate_board, draw_board, parse_board
from matchset.app.track.target_options import Wish
from matchset.camera.board import Board

BoardWords = tuple[str | None, float | None, float | None, str, Path | None]
BallWords = tuple[float | None, str | None, Wish]


def run(sources: tuple[str, ...], board: BoardWords, ball: BallWords, out: Path | None, force: bool) -> int:
    """Calibrate with a board or a ball, or draw a board.

    Parameters
    ----------
    sources : tuple of str
        Videos, pictures or a camera.
    board : tuple
        ``--board``, ``--square``, ``--charuco``, ``--dictionary``, ``--board-picture``.
    ball : tuple
        ``--ball-diameter``, ``--at``, what to follow.
    out : Path or None
        The camera file asked for.
    force : bool
        Whether it may be overwritten.

    Returns
    -------
    int
        The exit code.

    Raises
    ------
    ValueError
        If the options belong to neither, to both, or are not complete.
    """
    size, square, marker, dictionary, picture = board
    diameter, at, wish = ball
    if (size is None) == (diameter is None):
        raise ValueError("give --board 9x6 --square 0.025, or --ball-diameter 0.28 --at 0.5,1.0,1.5, and not both")
    if diameter is not None:
        if at is None:
            raise ValueError("--ball-diameter needs --at: the distances from the lens to the ball's nearest point, m")
        if not sources:
            raise ValueError("give a video of the ball")
        return calibrate_ball(BallOptions(sources, diameter, at, wish, out, force))
    if square is None or size is None:
        raise ValueError("--board needs --square: the side of a square in m")
    if at is not None or wish != Wish():
        raise ValueError("--at, --pick, --candidate, --color and --hsv belong to --ball-diameter, not to --board")
    columns, rows = parse_board(size)
    wanted = Board(columns=columns, rows=rows, square=square, marker=marker, dictionary=dictionary.upper())
    if picture is not None:
        if sources:
            raise ValueError("--board-picture draws a board and takes no video")
        return draw_board(wanted, picture, force)
    if len(sources) != 1:
        raise ValueError(f"give one video, folder of pictures or camera that sees the board, got {len(sources)}")
    return calibrate_board(CalibrateOptions(sources[0], wanted, out, force))
