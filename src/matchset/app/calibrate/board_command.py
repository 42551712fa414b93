"""`matchset calibrate --board`: from pictures of a board to a camera file, and the board itself to print."""

import io
import sys
from pathlib import Path

from PIL import Image

from matchset.app.calibrate.board_sheet import PAPERS, as_pdf, as_svg, board_sheet
from matchset.app.calibrate.board_views import BoardViews, look_for_board
from matchset.app.calibrate.coverage_picture import coverage_picture
from matchset.app.calibrate.options import BoardOptions, CalibrateOptions
from matchset.app.cli_options import TurnOptions
from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest, print_error, print_note, print_warnings
from matchset.app.run_folder import output_file, output_folder
from matchset.camera.board import Board, markers_seen
from matchset.camera.calibrate import Calibration, calibrate
from matchset.camera.calibration_report import CalibrationReport, grade_calibration
from matchset.camera.view_selection import select_views
from matchset.image.files.whole_file import write_whole
from matchset.media.video import Video

_DPI = 300.0  # format: resolution of the printed board, pixels per inch
_INCH = 0.0254  # theorem: meters in an inch, by definition
_MAX_PX = 2e8  # format: pixels of a picture; A0 at 300 pixels per inch has 1.4e8


def parse_board(text: str) -> tuple[int, int]:
    """Read ``COLUMNSxROWS``, inner corners."""
    columns, cross, rows = text.lower().partition("x")
    if not (cross and columns.strip().isdecimal() and rows.strip().isdecimal()):
        raise ValueError(f"--board is COLUMNSxROWS of inner corners, as in 9x6, got {text!r}")
    return int(columns), int(rows)


def board_of(options: BoardOptions) -> Board:
    """Return the board that the options describe; ValueError if there is none such."""
    columns, rows = parse_board(options.board or "")
    dictionary = options.dictionary.upper()
    return Board(
        columns=columns, rows=rows, square=options.square or 0.0, marker=options.charuco, dictionary=dictionary
    )


def calibrated_file(options: CalibrateOptions, name: str = "camera.toml", source: str | None = None) -> Path:
    """Return the file to write the camera to: the one asked for, or one in a new folder."""
    if options.out is None:
        return output_folder(None, "calibrate") / name
    return output_file(options.out, options.force, source)


def calibrate_board(source: str, board: Board, options: CalibrateOptions) -> int:
    """Calibrate with a board.

    Parameters
    ----------
    source : str
        A video, a folder of pictures, a bag, or a camera.
    board : Board
    options : CalibrateOptions
        The file to write, and how the camera is mounted.

    Returns
    -------
    int
        The exit code.
    """
    mounted = options.mounted
    with (
        StopRequest() as stop,
        Video(source, topic=options.topic, note=print_note, **mounted.arguments) as video,
    ):
        path = calibrated_file(options, source=source)
        picture = output_file(path.with_name(path.stem + "-coverage.png"), options.force, source)
        seen = look_for_board(video, board, stop)
        print_warnings(video.warnings)
    if stop and not video.live:
        print("note: stopped; nothing was calibrated", file=sys.stderr)
        return stop.code
    if seen.picture is None:
        print_error(f"no {board} in {seen.frames} frames. {_hint(board, seen)}")
        return NOT_FOUND
    return _finish(seen, board, (video.width, video.height), (path, picture), mounted.undone)


def _hint(board: Board, seen: BoardViews) -> str:
    """Say what may be wrong where no board was found: markers of another dictionary, or the number of corners."""
    name = next(filter(None, map(markers_seen, seen.without)), "")
    if name and (board.marker is None or name.rpartition("_")[0] != board.dictionary.rpartition("_")[0]):
        words = f"--charuco MARKER --dictionary {name}" if board.marker is None else f"--dictionary {name}"
        return f"Markers of {name} are in the pictures: {words}"
    return (
        "Inner corners are counted, not squares: a board of 10 x 7 squares is --board 9x6; all of a chessboard must be "
        "in the picture, with a white margin"
    )


def _finish(
    seen: BoardViews, board: Board, size: tuple[int, int], files: tuple[Path, Path], delivered: TurnOptions
) -> int:
    """Calibrate, and write the camera of the pictures as they are delivered, and a picture of where the board was."""
    path, picture = files
    views = select_views(seen.views, size[0])
    print(f"{board} in {len(seen.views)} of {seen.frames} frames, {len(views)} of them sharp and different")
    assert seen.picture is not None
    try:
        calibration = calibrate(views, *size)
    except ValueError as error:
        write_picture(picture, coverage_picture(seen.picture, views, None, str(error)))
        print_error(f"not calibrated: {error}")
        print(f"  {picture}")
        return NOT_FOUND
    report = grade_calibration(calibration)
    calibration.camera.turned(**delivered.arguments).save(path)
    write_picture(picture, coverage_picture(seen.picture, calibration.views, report))
    _print_report(calibration, report)
    print(f"  {path}\n  {picture}")
    return FOUND


def _print_report(calibration: Calibration, report: CalibrationReport) -> None:
    camera = calibration.camera
    print(f"\nThe calibration is {report.grade}, for pictures of {camera.width} x {camera.height} px.")
    for finding in report.findings:
        print(f"  {finding.grade:7s} {finding.name + ':':10s} {finding.words}")
    print()


def draw_board(board: Board, path: Path, paper: str | None, force: bool) -> int:
    """Draw a board to print: on a sheet of paper (.pdf, .svg), or as a picture without one (.png).

    Parameters
    ----------
    board : Board
    path : Path
    paper : str or None
        "a4" or "letter"; None: "a4", where there is paper.
    force : bool
        Whether the file may be overwritten.

    Returns
    -------
    int
        The exit code.
    """
    ending = path.suffix.lower()
    if ending not in (".pdf", ".svg", ".png"):
        raise ValueError(f"the board's picture must end in .pdf, .svg or .png, got {str(path)!r}")
    if ending == ".png":
        if paper is not None:
            raise ValueError("a .png has no paper: --paper needs a --board-picture that ends in .pdf or .svg")
        return _draw_png(board, path, force)
    name = (paper or "a4").lower()
    if name not in PAPERS:
        raise ValueError(f"--paper is {' or '.join(PAPERS)}, got {paper!r}")
    sheet = board_sheet(board, name)
    write_whole(output_file(path, force), as_pdf(sheet) if ending == ".pdf" else as_svg(sheet))
    print(f"  {path}")
    wanted, drawn = (1000.0 * each.square for each in (board, sheet.board))
    if drawn != wanted:
        print(f"Squares of {wanted:.1f} mm do not fit on {name}: they are {drawn:.1f} mm.")
    width, height = sheet.size
    print(f"Print it on {name} ({width:g} x {height:g} mm) at 100 %: its ruler must be 100 mm long.")
    print("Glue it to something flat.")
    marker = "" if sheet.board.marker is None else f" --charuco {sheet.board.marker:.4g}"
    words = f"--board {board.columns}x{board.rows} --square {sheet.board.square:.4g}{marker}"
    print(f"then:  matchset calibrate 0 {words} -o camera.toml")
    return FOUND


def _draw_png(board: Board, path: Path, force: bool) -> int:
    square_px = max(round(board.square / _INCH * _DPI), 20)
    if (board.columns + 3) * (board.rows + 3) * square_px**2 > _MAX_PX:
        raise ValueError(f"{board} with squares of {board.square} m is too large to draw; --square is in meters")
    image = board.picture(square_px)
    dpi = square_px * _INCH / board.square
    png = io.BytesIO()
    Image.fromarray(image).save(png, "png", dpi=(dpi, dpi))
    write_whole(output_file(path, force), png.getvalue())
    width, height = (side / square_px * board.square * 1000.0 for side in image.shape[1::-1])
    print(f"  {path}\nPrint it at 100 % ({width:.0f} x {height:.0f} mm with its margin) and glue it to something flat.")
    print(f"Measure a square: it should be {board.square * 1000.0:.1f} mm; otherwise give --square what it is.")
    return FOUND
