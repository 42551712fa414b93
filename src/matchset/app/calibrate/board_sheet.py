"""A board on a sheet of paper, at true scale with a ruler and its name, as PDF or SVG: `board_sheet`."""

import math
from collections.abc import Sequence

import cv2
import msgspec
import numpy as np

from matchset.camera.board import DICTIONARIES, Board

PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}  # format: ISO 216 and ANSI Y14.1, mm
# format: mm; what printers leave white, the strip with ruler and name, the ruler, letters, and steps of a fitted square
EDGE, STRIP, RULER, LETTERS, STEP = 5.0, 14.0, 100.0, 3.4, 0.5
QUIET = 0.5  # format: least white around the board, squares
MM, POINTS = 1000.0, 72.0 / 25.4  # theorem: millimeters in a meter, points in a millimeter
UNPRINTABLE = "\\()"

Rectangle = tuple[float, float, float, float]


class SheetText(msgspec.Struct, frozen=True):
    """A line of text: where it begins, mm from the upper left, and whether it runs down the sheet."""

    text: str
    x: float
    y: float
    down: bool


class Sheet(msgspec.Struct, frozen=True):
    """A sheet to print.

    Parameters
    ----------
    board : Board
        As it was fitted: its square is what is drawn.
    size : tuple of two floats
        Width and height of the paper, mm.
    black : tuple of rectangles
        x and y of the upper left corner, width and height, mm.
    words : tuple of SheetText
    """

    board: Board
    size: tuple[float, float]
    black: tuple[Rectangle, ...]
    words: tuple[SheetText, ...]


class _Layout(msgspec.Struct, frozen=True):
    """Paper's width and height, mm; whether the strip is at the right (or below); the largest square that fits, mm."""

    width: float
    height: float
    right: bool
    most: float


def board_sheet(board: Board, paper: str) -> Sheet:
    """Lay a board out on a sheet.

    Parameters
    ----------
    board : Board
        Where its squares are too large for the paper, they are drawn smaller, in steps of 0.5 mm, the markers in
        proportion.
    paper : str
        "a4" or "letter".

    Returns
    -------
    Sheet

    Raises
    ------
    ValueError
        If even squares of 5 mm do not fit.
    """
    layouts = [_layout(board, *sides, right) for sides in _turned(PAPERS[paper]) for right in (True, False)]
    wanted = board.square * MM
    layout = next((each for each in layouts if each.most >= wanted - 1e-9), max(layouts, key=lambda each: each.most))
    square = min(wanted, math.floor(layout.most / STEP) * STEP)
    if square < 10 * STEP:
        raise ValueError(f"{board} does not fit on {paper}: its squares would be smaller than {10 * STEP:g} mm")
    if square < wanted - 1e-9:
        marker = None if board.marker is None else board.marker * square / wanted
        board = msgspec.structs.replace(board, square=square / MM, marker=marker)
    return _drawn(board, layout)


def _turned(sides: tuple[float, float]) -> list[tuple[float, float]]:
    return [sides[::-1], sides]


def _layout(board: Board, width: float, height: float, right: bool) -> _Layout:
    free = (width - STRIP * right - EDGE, height - STRIP * (not right) - EDGE)
    squares = board.columns + 1, board.rows + 1
    # The white around the board may be the paper's edge, but printers leave `EDGE` white in any case.
    most = min(min(side / (n + 2 * QUIET), (side - EDGE) / n) for side, n in zip(free, squares, strict=True))
    return _Layout(width, height, right, most)


def _drawn(board: Board, layout: _Layout) -> Sheet:
    side = board.square * MM
    wide, high = (board.columns + 1) * side, (board.rows + 1) * side
    left = (layout.width - STRIP * layout.right - wide) / 2.0
    top = (layout.height - STRIP * (not layout.right) - high) / 2.0
    black = [
        (left + column * side, top + row * side, side, side)
        for row in range(board.rows + 1)
        for column in range(board.columns + 1)
        if (row + column) % 2 == 0
    ]
    black += _markers(board, left, top)
    bars, words = _strip(board, layout)
    return Sheet(board, (layout.width, layout.height), (*black, *bars), tuple(words))


def _markers(board: Board, left: float, top: float) -> list[Rectangle]:
    """Draw the markers of a ChArUco board module by module."""
    if board.marker is None:
        return []
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, DICTIONARIES[board.dictionary]))
    modules = int(dictionary.markerSize) + 2
    side, cell = board.square * MM, board.marker * MM / modules
    inset, found = (side - board.marker * MM) / 2.0, []
    white = [(r, c) for r in range(board.rows + 1) for c in range(board.columns + 1) if (r + c) % 2]
    for number, (row, column) in enumerate(white):
        dark = np.argwhere(cv2.aruco.generateImageMarker(dictionary, number, modules) < 128)
        x, y = left + column * side + inset, top + row * side + inset
        found += [(x + int(k) * cell, y + int(n) * cell, cell, cell) for n, k in dark]
    return found


def _strip(board: Board, layout: _Layout) -> tuple[list[Rectangle], list[SheetText]]:
    """Draw name and ruler along the right or the lower edge of the sheet."""
    along = layout.height if layout.right else layout.width
    begin = (along - RULER) / 2.0
    bars = [(begin, 8.2, RULER, 0.3)]
    bars += [
        (begin + mm - 0.1, 8.2 - (2.4 if mm % 10 == 0 else 1.2), 0.2, 2.4 if mm % 10 == 0 else 1.2) for mm in _ticks()
    ]
    marker = "" if board.marker is None else f", markers {board.marker * MM:.1f} mm {board.dictionary}"
    name = f"{board.columns}x{board.rows}, {board.square * MM:.1f} mm{marker}; print at 100 %, then measure: 100 mm"
    texts = [(name, begin, 3.6), ("0", begin - 1.0, 12.2), ("100 mm", begin + RULER - 4.0, 12.2)]
    if not layout.right:
        at = layout.height - EDGE - STRIP + 1.0
        return [(u, v + at, a, b) for u, v, a, b in bars], [
            SheetText(text, u, v + at, down=False) for text, u, v in texts
        ]
    at = layout.width - EDGE - 2.0  # a strip that runs down: its right is the strip's up
    return [(at - v - b, u, b, a) for u, v, a, b in bars], [
        SheetText(text, at - v, u, down=True) for text, u, v in texts
    ]


def _ticks() -> Sequence[int]:
    return range(0, int(RULER) + 1, 5)


def as_svg(sheet: Sheet) -> bytes:
    """Write a sheet as SVG whose unit is the millimeter."""
    width, height = sheet.size
    path = "".join(f"M{x:.4f} {y:.4f}h{w:.4f}v{h:.4f}h{-w:.4f}z" for x, y, w, h in sheet.black)
    texts = "".join(
        f'<text transform="translate({each.x:.3f} {each.y:.3f}){" rotate(90)" if each.down else ""}">{each.text}</text>'
        for each in sheet.words
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">'
        f'<rect width="{width}" height="{height}" fill="#fff"/><path d="{path}"/>'
        f'<g font-family="Helvetica, Arial, sans-serif" font-size="{LETTERS}">{texts}</g></svg>\n'
    ).encode()


def as_pdf(sheet: Sheet) -> bytes:
    """Write a sheet as PDF 1.4: one page, its size that of the paper, printed without scaling."""
    width, height = (POINTS * side for side in sheet.size)
    # A PDF counts from the lower left, in points: the first operator turns that into mm from the upper left.
    lines = [f"{POINTS:.8f} 0 0 {-POINTS:.8f} 0 {height:.4f} cm 0 g"]
    lines += [f"{x:.4f} {y:.4f} {w:.4f} {h:.4f} re" for x, y, w, h in sheet.black]
    lines.append("f BT")
    for each in sheet.words:
        turn = "0 1 1 0" if each.down else "1 0 0 -1"  # letters stand upright though y points down
        text = "".join("\\" + letter if letter in UNPRINTABLE else letter for letter in each.text)
        lines.append(f"/F1 {LETTERS} Tf {turn} {each.x:.3f} {each.y:.3f} Tm ({text}) Tj")
    stream = "\n".join([*lines, "ET"]).encode("latin-1")
    parts = [
        b"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width:.4f} {height:.4f}] /Contents 4 0 R /Resources "
        "<< /Font << /F1 << /Type /Font /Subtype /Type1 /BaseFont /Helvetica >> >> >> >>".encode(),
        b"<< /Length %d >>\nstream\n%s\nendstream" % (len(stream), stream),
    ]
    return _assembled(parts)


def _assembled(parts: Sequence[bytes]) -> bytes:
    """Join the numbered objects of a PDF, and write the table of where each begins."""
    text, begins = b"%PDF-1.4\n", []
    for number, part in enumerate(parts, 1):
        begins.append(len(text))
        text += b"%d 0 obj\n%s\nendobj\n" % (number, part)
    table = b"".join(b"%010d 00000 n \n" % begin for begin in begins)
    count = len(parts) + 1
    trailer = b"trailer\n<< /Size %d /Root 1 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (count, len(text))
    return text + b"xref\n0 %d\n0000000000 65535 f \n" % count + table + trailer
