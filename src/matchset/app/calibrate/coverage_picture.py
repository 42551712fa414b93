"""The picture of a calibration: where the board was seen, with the report below: `coverage_picture`."""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.text import draw_text, text_width
from matchset.camera.board import View
from matchset.camera.calibration_report import CalibrationReport, covered_cells

Picture = npt.NDArray[np.uint8]

# geometry: colors, BGR
_GREEN, _ORANGE, _RED = (90, 200, 60), (0, 160, 255), (70, 70, 240)
_GRADES = {"good": _GREEN, "usable": _ORANGE, "poor": _RED}
# geometry: colors, BGR
_WHITE, _PALE, _PAPER = (255, 255, 255), (170, 170, 170), (32, 32, 32)
# geometry: height of a line of text; least width and largest side of the picture, px
_LINE_PX, _MIN_WIDTH_PX, _MAX_SIDE_PX = 22, 900, 1280


def coverage_picture(
    picture: Picture, views: list[View], report: CalibrationReport | None, refused: str = ""
) -> Picture:
    """Draw the board's corners over a darkened picture, with the report below.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3) or (h, w), uint8
        One of the pictures.
    views : list of View
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
    height, width = picture.shape[:2]
    scale = min(_MAX_SIDE_PX / max(width, height), max(_MIN_WIDTH_PX / width, 1.0))
    size = round(width * scale), round(height * scale)
    gray = picture if picture.ndim == 2 else np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY))
    back = cv2.cvtColor(cv2.resize(gray, size, interpolation=cv2.INTER_AREA), cv2.COLOR_GRAY2BGR)
    shade = cv2.resize(covered_cells(views, width, height).astype(np.float32), size, interpolation=cv2.INTER_NEAREST)
    drawn = 0.25 * back.astype(np.float32) + shade[..., None] * np.array((28.0, 60.0, 20.0))
    image = np.ascontiguousarray(np.clip(drawn, 0, 255).astype(np.uint8))
    for number, view in enumerate(views):
        hue = np.array([[[180 * number // max(len(views), 1), 150, 255]]], np.uint8)
        color = tuple(int(part) for part in cv2.cvtColor(hue, cv2.COLOR_HSV2BGR)[0, 0])
        for x, y in (view.pixels + 0.5) * scale - 0.5:
            cv2.circle(image, (round(x * 16), round(y * 16)), 40, color, cv2.FILLED, cv2.LINE_AA, 4)
    return np.vstack((image, _report_lines(size[0], len(views), report, refused)))


def _report_lines(width: int, views: int, report: CalibrationReport | None, refused: str) -> Picture:
    """Draw the lines of text below the picture, each marked with the color of its grade."""
    lines = [("", f"Corners of the board in {views} view{'s' * (views != 1)}; shaded: where it was", _WHITE)]
    if report is None:
        lines += [("refused", refused, _RED)]
    else:
        lines += [(finding.name, finding.words, _GRADES[finding.grade]) for finding in report.findings]
    wrapped: list[tuple[str, str, tuple[int, int, int]]] = []
    for name, words, color in lines:
        for part in _wrap(words, width - 130):
            wrapped.append((name, part, color))
            name = ""
    strip = np.full((_LINE_PX * len(wrapped) + 18, width, 3), _PAPER, np.uint8)
    for row, (name, part, color) in enumerate(wrapped):
        y = 9 + _LINE_PX * (row + 0.5)
        draw_text(strip, name, (16, y), 14, color)
        draw_text(strip, part, (112 if row else 16, y), 14, _PALE if row else _WHITE)
    return strip


def _wrap(words: str, width: int) -> list[str]:
    lines = [""]
    for word in words.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and text_width(longer) > width:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
