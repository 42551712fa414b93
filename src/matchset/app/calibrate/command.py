"""`matchset calibrate`: from pictures of a board, or of the ball at known distances, to a camera file."""

import sys
from pathlib import Path

import msgspec
from PIL import Image

from matchset.app import exit_codes as ending
from matchset.app.calibrate.board_views import Seen, look_for_board
from matchset.app.calibrate.coverage_picture import coverage_picture
from matchset.app.exit_codes import StopRequest, say_error
from matchset.app.run_folder import output_file, output_folder
from matchset.app.track.learn_command import write_picture
from matchset.camera.board import Board
from matchset.camera.calibrate import Calibration, calibrate
from matchset.camera.calibration_report import Verdict, judge_calibration
from matchset.camera.view_selection import select_views
from matchset.image.video import Video

_DPI = 300.0
_INCH = 0.0254  # m
_LARGEST_PX = 2e8  # A0 at 300 dpi has 1.4e8


class CalibrateOptions(msgspec.Struct, frozen=True):
    """The options of `matchset calibrate` with a board, as typed."""

    source: str
    board: Board
    out: Path | None = None
    force: bool = False


def parse_board(text: str) -> tuple[int, int]:
    """Read ``COLUMNSxROWS``, inner corners."""
    columns, cross, rows = text.lower().partition("x")
    if not (cross and columns.strip().isdecimal() and rows.strip().isdecimal()):
        raise ValueError(f"--board is COLUMNSxROWS of inner corners, as in 9x6, got {text!r}")
    return int(columns), int(rows)


def camera_file(out: Path | None, force: bool) -> Path:
    """Return where the camera goes: the file asked for, or one in a new folder."""
    if out is None:
        return output_folder(None, "calibrate") / "camera.toml"
    if out.suffix.lower() != ".toml":
        raise ValueError(f"a camera file's name must end in .toml, got {str(out)!r}")
    return output_file(out, force)


def calibrate_board(options: CalibrateOptions) -> int:
    """Run the command with a board.

    Returns
    -------
    int
        The exit code.
    """
    with StopRequest() as stop, Video(options.source) as video:
        path = camera_file(options.out, options.force)
        picture = output_file(path.with_name(path.stem + "-coverage.png"), options.force)
        seen = look_for_board(video, options.board, stop)
        for warning in video.warnings:
            print("note: " + warning, file=sys.stderr)
    if stop and not video.live:
        print("note: stopped; nothing was calibrated", file=sys.stderr)
        return stop.code
    if seen.picture is None:
        say_error(
            f"no {options.board} in {seen.looks} frames. Inner corners are counted, not squares: a board of 10 x 7 "
            "squares is --board 9x6; all of a chessboard must be in the picture, with a white margin"
        )
        return ending.NOT_FOUND
    return _finish(seen, options.board, (video.width, video.height), path, picture)


def _finish(seen: Seen, board: Board, size: tuple[int, int], path: Path, picture: Path) -> int:
    views = select_views(seen.views, size[0])
    print(f"{board} in {len(seen.views)} of {seen.looks} frames, {len(views)} of them sharp and different")
    assert seen.picture is not None
    try:
        calibration = calibrate(views, *size)
    except ValueError as error:
        write_picture(picture, coverage_picture(seen.picture, views, None, str(error)))
        say_error(f"not calibrated: {error}")
        print(f"  {picture}")
        return ending.NOT_FOUND
    verdict = judge_calibration(calibration)
    calibration.camera.save(path)
    write_picture(picture, coverage_picture(seen.picture, calibration.views, verdict))
    _say(calibration, verdict)
    print(f"  {path}\n  {picture}")
    return ending.FOUND


def _say(calibration: Calibration, verdict: Verdict) -> None:
    camera = calibration.camera
    print(f"\nThe calibration is {verdict.grade}, for pictures of {camera.width} x {camera.height} px.")
    for finding in verdict.findings:
        print(f"  {finding.grade:7s} {finding.name + ':':10s} {finding.words}")
    print()


def draw_board(board: Board, path: Path, force: bool) -> int:
    """Write a board to print.

    Returns
    -------
    int
        The exit code.
    """
    if path.suffix.lower() != ".png":
        raise ValueError(f"the board's picture must end in .png, got {str(path)!r}")
    square_px = max(round(board.square / _INCH * _DPI), 20)
    if (board.columns + 3) * (board.rows + 3) * square_px**2 > _LARGEST_PX:
        raise ValueError(f"{board} with squares of {board.square} m is too large to draw; --square is in meters")
    image = board.picture(square_px)
    dpi = square_px * _INCH / board.square
    Image.fromarray(image).save(output_file(path, force), dpi=(dpi, dpi))
    width, height = (side / square_px * board.square * 1000.0 for side in image.shape[1::-1])
    print(f"  {path}\nPrint it at 100 % ({width:.0f} x {height:.0f} mm with its margin) and glue it to something flat.")
    print(f"Measure a square: it should be {board.square * 1000.0:.1f} mm; otherwise give --square what it is.")
    return ending.FOUND
