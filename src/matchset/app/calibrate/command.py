"""The command `matchset calibrate`: whether a board, a ball, or a board's picture is asked for.

This module is loaded for every `matchset --help`; the functions import what they need.
"""

from matchset.app.calibrate.options import BoardOptions, CalibrateOptions, MountOptions
from matchset.app.cli_options import LARGE_BALL, LARGE_SQUARE, TargetOptions, unit_note

CALIBRATE_EPILOG = """
[bold]Examples[/bold]

  matchset calibrate --board 9x6 --square 0.025 --board-picture board.pdf --paper letter

  matchset calibrate pictures/ --board 9x6 --square 0.025 -o camera.toml

  matchset calibrate 0 --board 9x6 --square 0.025 --charuco 0.018

  matchset calibrate ball.mp4 --ball-diameter 0.28 --at 0.5,1.0,1.5 --color ball.npz

  matchset calibrate 0 --mount --place 0,0.19,1.5 --place 0.5,0,1.2 --camera-file camera.toml --color ball.npz

The board is moved all over the picture and tilted, 20 to 40 degrees, each time differently. Distances of the ball are
from the lens to its nearest point; give one video in which it is held still at all of them in turn, or one for each.
For --mount the vehicle stands level; with --marker-color the ball is on its own vehicle, level, its back to the camera.

Exit codes: 0 done, 1 no board or ball found or the views do not suffice, 2 bad input or options, 3 camera or stream
broke, 130 stopped by Ctrl-C.
"""


def calibrate(options: CalibrateOptions) -> int:
    """Find a camera's focal length and lens distortion, from a board or from the ball itself; or its mount."""
    if options.mount != MountOptions():
        return _with_mount(options)
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

    inputs = [*(options.sources or ()), *(options.target.color or ()), *(options.mount.marker_color or ())]
    drawn, out = options.printed_board.board_picture, options.out
    if drawn is not None:
        check_outputs([drawn], inputs, options.force)
        return
    if out is not None and out.suffix.lower() != ".toml":
        raise ValueError(f"the file's name must end in .toml, got {str(out)!r}")
    board = options.printed_board.board is not None
    coverage = out.with_name(out.stem + "-coverage.png") if out is not None and board else None
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
    return calibrate_board(sources[0], board, options)


def _with_mount(options: CalibrateOptions) -> int:
    """Check the options of a mount, and measure it."""
    mount, count = options.mount, len(options.sources or ())
    if not mount.mount:
        raise ValueError("--place, --camera-file and --marker-color belong to --mount")
    if options.printed_board != BoardOptions() or options.at is not None:
        raise ValueError("--mount takes neither a board nor --at")
    if mount.camera_file is None:
        raise ValueError("--mount needs --camera-file camera.toml, made by 'matchset calibrate --board ...'")
    if not mount.place:
        raise ValueError("--mount needs --place RIGHT,UP,AHEAD: the ball's center from the lens, m; one for each place")
    if options.target != TargetOptions(color=options.target.color) or not options.target.color:
        raise ValueError("--mount needs --color ball.npz, made by 'matchset learn', and takes no other way to say it")
    if count not in (1, len(mount.place)):
        raise ValueError(f"give a camera, or one video for each of the {len(mount.place)} places, got {count} sources")
    _check_outputs(options)
    unit_note("--ball-diameter", options.ball_diameter, LARGE_BALL)
    from matchset.app.calibrate.mount_command import calibrate_mount

    return calibrate_mount(options)
