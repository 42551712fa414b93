"""The command `matchset calibrate`: its options, and whether they ask for a board, a ball, or a board's picture.

This module is loaded for every `matchset --help`; the functions import what they need.
"""

from pathlib import Path
from typing import Annotated

import msgspec
import typer

from matchset.app.cli_options import LARGE_BALL, LARGE_SQUARE, Force, TargetOptions, Topic, unit_note

CALIBRATE_EPILOG = """
[bold]Examples[/bold]

  matchset calibrate --board 9x6 --square 0.025 --board-picture board.pdf --paper letter

  matchset calibrate pictures/ --board 9x6 --square 0.025 -o camera.toml

  matchset calibrate 0 --board 9x6 --square 0.025 --charuco 0.018

  matchset calibrate ball.mp4 --ball-diameter 0.28 --at 0.5,1.0,1.5 --color ball.npz

The board is moved all over the picture and tilted, 20 to 40 degrees, each time differently. Distances of the ball are
from the lens to its nearest point; give one video in which it is held still at all of them in turn, or one for each.

Exit codes: 0 done, 1 no board or ball found or the views do not suffice, 2 bad input or options, 3 camera or stream
broke, 130 stopped by Ctrl-C.
"""


class BoardOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options that describe a board."""

    board: Annotated[
        str | None, typer.Option(metavar="9x6", help="Inner corners of the board: 10 x 7 squares have 9x6.")
    ] = None
    square: Annotated[float | None, typer.Option(metavar="M", help="Side of a square, m.")] = None
    charuco: Annotated[float | None, typer.Option(metavar="M", help="It is a ChArUco board: a marker's side, m.")] = (
        None
    )
    dictionary: Annotated[str, typer.Option(metavar="NAME", help="The markers' dictionary.")] = "5X5_100"
    board_picture: Annotated[
        Path | None,
        typer.Option(metavar="OUT.pdf", help="Draw the board to print, .pdf, .svg or .png; no SOURCE then."),
    ] = None
    paper: Annotated[
        str | None, typer.Option(metavar="a4|letter", help="Paper of a .pdf or .svg; a4 if not given.")
    ] = None


class CalibrateOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset calibrate`."""

    sources: Annotated[
        list[str] | None,
        typer.Argument(metavar="SOURCE...", help="A video, a folder of pictures, a camera's number, or a URL."),
    ] = None
    topic: Topic = None
    printed_board: BoardOptions = BoardOptions()
    ball_diameter: Annotated[
        float | None, typer.Option(metavar="M", help="Use the ball in place of a board: its diameter, m.")
    ] = None
    at: Annotated[
        str | None, typer.Option(metavar="M,M,...", help="From the lens to the ball's nearest point, in turn, m.")
    ] = None
    target: TargetOptions = TargetOptions()
    out: Annotated[Path | None, typer.Option("-o", metavar="FILE.toml", help="The camera file.")] = None
    force: Force = False


def calibrate(options: CalibrateOptions) -> int:
    """Find a camera's focal length and lens distortion, from a board or from the ball itself."""
    if (options.printed_board.board is None) == (options.ball_diameter is None):
        raise ValueError("give --board 9x6 --square 0.025, or --ball-diameter 0.28 --at 0.5,1.0,1.5, and not both")
    _check_outputs(options)
    unit_note("--ball-diameter", options.ball_diameter, LARGE_BALL)
    unit_note("--square", options.printed_board.square, LARGE_SQUARE)
    unit_note("--charuco", options.printed_board.charuco, LARGE_SQUARE)
    if options.ball_diameter is None:
        return _with_board(options)
    if options.at is None:
        raise ValueError("--ball-diameter needs --at: the distances from the lens to the ball's nearest point, m")
    if not options.sources:
        raise ValueError("give a video of the ball")
    from matchset.app.calibrate.ball_command import calibrate_ball

    return calibrate_ball(options)


def _check_outputs(options: CalibrateOptions) -> None:
    """Check the outputs before anything is opened or loaded."""
    from matchset.app.run_folder import check_outputs, check_run

    inputs = [*(options.sources or ()), *(options.target.color or ())]
    drawn, out = options.printed_board.board_picture, options.out
    if drawn is not None:
        check_outputs([drawn], inputs, options.force)
        return
    if out is not None and out.suffix.lower() != ".toml":
        raise ValueError(f"a camera file's name must end in .toml, got {str(out)!r}")
    coverage = out.with_name(out.stem + "-coverage.png") if out is not None and options.ball_diameter is None else None
    check_run(None, (), [out, coverage], inputs, options.force)


def _with_board(options: CalibrateOptions) -> int:
    from matchset.app.calibrate.board_command import board_of, calibrate_board, draw_board

    if options.printed_board.square is None:
        raise ValueError("--board needs --square: the side of a square in m")
    if options.at is not None or options.target != TargetOptions():
        raise ValueError("--at, --pick, --candidate, --color and --hsv belong to --ball-diameter, not to --board")
    board, sources = board_of(options.printed_board), options.sources or []
    if options.printed_board.board_picture is not None:
        if sources:
            raise ValueError("--board-picture draws a board and takes no video")
        return draw_board(board, options.printed_board.board_picture, options.printed_board.paper, options.force)
    if options.printed_board.paper is not None:
        raise ValueError("--paper belongs to --board-picture")
    if len(sources) != 1:
        raise ValueError(f"give one video, folder of pictures or camera that sees the board, got {len(sources)}")
    return calibrate_board(sources[0], board, options.out, options.force, options.topic)
