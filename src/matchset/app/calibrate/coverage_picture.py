"""The picture of a calibration: where the board was seen, with the report below: `coverage_picture`."""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.text import draw_text, text_width, wrapped
from matchset.camera.board import BoardView
from matchset.camera.calibration_report import CalibrationReport, covered_cells
from matchset.image.brightness import as_gray

Picture = npt.NDArray[np.uint8]

_DOT, _UNSEEN = (178, 114, 0), (0, 94, 213)  # format: of corners, and where the board never was; BGR
# format: of letters, of lesser ones, of the picture's border, of the background, BGR
_INK, _QUIET, _BORDER, _PAPER = (51, 51, 51), (107, 107, 107), (120, 120, 120), (255, 255, 255)
# format: by grade, BGR
_GRADES = {"good": (115, 158, 0), "usable": (0, 140, 200), "poor": (0, 60, 200), "refused": (0, 60, 200)}
_LINE_PX, _LETTERS_PX = 26, 16  # format: height of a line of text, size of its letters
_MIN_WIDTH_PX, _MAX_SIDE_PX, _MARGIN_PX = 900, 1280, 24  # format: of the picture
_UNSEEN_SHARE, _PICTURE_SHARE = 0.30, 0.35  # format: how strong the colors of the background are


def coverage_picture(
    picture: Picture, views: list[BoardView], report: CalibrationReport | None, refused: str = ""
) -> Picture:
    """Draw the board's corners over a pale picture, colored where the board never was, with the report below.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3) or (h, w), uint8
        One of the pictures.
    views : list of BoardView
        Those that were used.
    report : CalibrationReport or None
        The report on the calibration; None if it was refused.
    refused : str
        Why, if it was.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR.
    """
    bordered, margin = coverage_map(picture, views), _MARGIN_PX
    framed = cv2.copyMakeBorder(bordered, 8, 8, margin, margin, cv2.BORDER_CONSTANT, value=_PAPER).astype(np.uint8)
    return np.vstack((_title(framed.shape[1], len(views)), framed, _report_lines(framed.shape[1], report, refused)))


def coverage_map(picture: Picture, views: list[BoardView]) -> Picture:
    """Draw the same as `coverage_picture`, without words."""
    height, width = picture.shape[:2]
    scale = min(_MAX_SIDE_PX / max(width, height), max(_MIN_WIDTH_PX / width, 1.0))
    size = round(width * scale), round(height * scale)
    back = cv2.cvtColor(cv2.resize(as_gray(picture), size, interpolation=cv2.INTER_AREA), cv2.COLOR_GRAY2BGR)
    shade = cv2.resize(covered_cells(views, width, height).astype(np.float32), size, interpolation=cv2.INTER_NEAREST)
    paper = np.array(_PAPER) - _PICTURE_SHARE * (255.0 - back.astype(np.float32))
    unseen = _UNSEEN_SHARE * (1.0 - shade[..., None])
    image = np.ascontiguousarray(np.round(paper + unseen * (np.array(_UNSEEN) - paper)).astype(np.uint8))
    for view in views:
        for x, y in (view.pixels + 0.5) * scale - 0.5:
            cv2.circle(image, (round(x * 16), round(y * 16)), 40, _DOT, cv2.FILLED, cv2.LINE_AA, 4)
    bordered = cv2.copyMakeBorder(image, 2, 2, 2, 2, cv2.BORDER_CONSTANT, value=_BORDER)
    return np.asarray(bordered, np.uint8)


def _title(width: int, views: int) -> Picture:
    """Say what the picture shows, with a sample of each mark."""
    strip = np.full((2 * _LINE_PX + 34, width, 3), _PAPER, np.uint8)
    draw_text(strip, f"Where the board was seen, in {views} view{'s' * (views != 1)}", (_MARGIN_PX, 28), 24, _INK)
    y = _LINE_PX + 38
    cv2.circle(strip, (_MARGIN_PX + 8, y), 3, _DOT, cv2.FILLED, cv2.LINE_AA)
    x = _MARGIN_PX + 24
    draw_text(strip, "its corners", (x, y), _LETTERS_PX, _INK)
    x += text_width("its corners", _LETTERS_PX) + 36
    tint = tuple(round(255.0 - _UNSEEN_SHARE * (255 - part)) for part in _UNSEEN)
    cv2.rectangle(strip, (x, y - 9), (x + 26, y + 9), tint, cv2.FILLED)
    draw_text(strip, "where it never was: hold it there too", (x + 36, y), _LETTERS_PX, _INK)
    return strip


def _report_lines(width: int, report: CalibrationReport | None, refused: str) -> Picture:
    """Draw the lines of text below the picture, each with its grade in words, and in its color."""
    if report is None:
        lines = [("refused", "", refused)]
    else:
        lines = [(finding.grade, finding.name, finding.words) for finding in report.findings]
    at = _MARGIN_PX, _MARGIN_PX + 100, _MARGIN_PX + (100 if report is None else 220)
    rows: list[tuple[str, str, str]] = []
    for grade, name, words in lines:
        parts = wrapped(words, width - at[2] - _MARGIN_PX, _LETTERS_PX)
        rows += [(grade, name, parts[0]), *(("", "", part) for part in parts[1:])]
    strip = np.full((_LINE_PX * len(rows) + 24, width, 3), _PAPER, np.uint8)
    for row, (grade, name, words) in enumerate(rows):
        y = 8 + _LINE_PX * (row + 0.5)
        if grade:
            color, middle = _GRADES[grade], round(y)
            cv2.rectangle(strip, (at[0], middle - 7), (at[0] + 14, middle + 7), color, cv2.FILLED)
        draw_text(strip, grade, (at[0] + 24, y), _LETTERS_PX, _INK)
        draw_text(strip, name, (at[1], y), _LETTERS_PX, _INK)
        draw_text(strip, words, (at[2], y), _LETTERS_PX, _QUIET)
    return strip
