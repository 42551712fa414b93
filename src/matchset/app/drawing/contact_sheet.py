"""The contact sheet of a run: frames with what was found, enlarged rims, and a plot: `contact_sheet`."""

from collections.abc import Sequence
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import OUTLINE, POINT, as_color, draw_circle
from matchset.app.drawing.text import draw_text, text_width, wrapped
from matchset.image.frame import Frame
from matchset.tracking.track import Lost, Track

Picture = npt.NDArray[np.uint8]

WIDTH_PX = 1480  # geometry: width of the sheet
_GAP_PX = 16  # geometry: between tiles
_PAPER, _INK, _QUIET = (255, 255, 255), (51, 51, 51), (107, 107, 107)  # geometry: colors, BGR
TRUTH = (60, 240, 255)  # geometry: color of the true outline, BGR
_SAMPLE = (150, 70, 30)  # geometry: color behind a sample, BGR
LETTERS_PX = 17  # geometry: size of the words below a tile
FOUND, EDGES, TRUE = "what was found", "edge points that decided it", "the truth"
_SHIFT = 4  # format: OpenCV draws at 1/16 px


class SheetFrame(msgspec.Struct, frozen=True):
    """One frame for the sheet.

    Parameters
    ----------
    frame : Frame
    answer : Track or Lost
    error_px : float, optional
        Eq. 10, px, if it is known.
    truth : Circle, optional
        The true outline, if it is known.
    remark : str
        Why this frame is shown.
    """

    frame: Frame
    answer: Track[Any] | Lost[Any]
    error_px: float | None = None
    truth: Any = None
    remark: str = ""


def contact_sheet(title: str, subtitle: str, frames: Sequence[SheetFrame], plot: Picture) -> Picture:
    """Put a sheet together.

    Parameters
    ----------
    title, subtitle : str
        Title lines.
    frames : sequence of SheetFrame
        The frames to show, best four or eight: each whole, and its ball enlarged.
    plot : ndarray of shape (h, WIDTH_PX, 3), uint8
        The plot at the bottom.

    Returns
    -------
    ndarray of shape (h, WIDTH_PX, 3), uint8
        BGR.
    """
    head = np.full((142, WIDTH_PX, 3), _PAPER, np.uint8)
    draw_text(head, title, (_GAP_PX, 36), 32, _INK)
    draw_text(head, subtitle, (_GAP_PX, 80), 18, _QUIET)
    _draw_legend(head, (_GAP_PX, 114), truth=any(each.truth is not None for each in frames))
    rows = [head]
    for first in range(0, len(frames), 4):
        four = frames[first : first + 4]
        rows.append(_row([whole_tile(shown, _tile_width()) for shown in four]))
        rows.append(_row([rim_tile(shown, _tile_width()) for shown in four]))
    return np.vstack([*rows, plot])


def _draw_legend(head: Picture, at: tuple[int, int], truth: bool) -> None:
    """Say what the outlines and rings are, each with a sample on the color of a ball."""
    x, y = at
    for name in (FOUND, EDGES, TRUE)[: 3 if truth else 2]:
        sample = head[y - 10 : y + 11, x : x + 36]
        sample[:] = _SAMPLE
        if name == EDGES:
            _draw_rings(sample, np.array([[each, 10.0] for each in (7.0, 18.0, 29.0)]))
        elif name == TRUE:
            for left in (2, 14, 26):
                cv2.line(sample, (left, 10), (left + 7, 10), TRUTH, 2, cv2.LINE_AA)
        else:
            cv2.line(sample, (0, 10), (36, 10), OUTLINE, 2, cv2.LINE_AA)
        draw_text(head, name, (x + 46, y), LETTERS_PX, _INK)
        x += 46 + text_width(name, LETTERS_PX) + 36


def whole_tile(shown: SheetFrame, width: int) -> Picture:
    """Show a whole frame, `width` px wide, with its circle and a line of text below."""
    image = as_color(shown.frame.image)
    scale = width / image.shape[1]
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA).astype(np.uint8)
    if not isinstance(shown.answer, Lost):
        draw_circle(small, _scaled(shown.answer.shape, (-0.5, -0.5), scale))
    words = [f"frame {shown.frame.index}"]
    if shown.error_px is not None:
        words.append(f"error {shown.error_px:.2f} px")
    if shown.remark:
        words.append(shown.remark)
    return np.vstack([small, label("   ".join(words), width)])


def rim_tile(shown: SheetFrame, width: int) -> Picture:
    """Show the ball enlarged, with its match-set and, if it is known, the true outline; or the reason of a loss."""
    if isinstance(shown.answer, Lost):
        return _lost_tile(shown.answer.reason, width)
    shape = shown.answer.shape
    side = 2.0 * 1.22 * shape.radius
    corner = shape.x - side / 2, shape.y - side / 2
    zoom = width / side
    # Pixel centers lie at integers in both: the tile's pixel u shows the frame at corner + (u + 0.5) / zoom.
    inverse = np.array([[1 / zoom, 0, corner[0] + 0.5 / zoom], [0, 1 / zoom, corner[1] + 0.5 / zoom]])
    tile = cv2.warpAffine(
        as_color(shown.frame.image),
        inverse,
        (width, width),
        flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP,
        borderValue=(245, 245, 245),
    ).astype(np.uint8)
    points = (shown.answer.match_set - corner) * zoom - 0.5
    _draw_rings(tile, points)
    if shown.truth is not None:
        draw_circle(tile, _scaled(shown.truth, corner, zoom), TRUTH, dashed=True)
    draw_circle(tile, _scaled(shape, corner, zoom))
    words = f"{len(points)} points   {zoom:.1f} times enlarged"
    return np.vstack([tile, label(words, width)])


def _lost_tile(reason: str, width: int) -> Picture:
    """Say why nothing was found, in the place of an enlarged ball."""
    tile = np.full((width, width, 3), 245, np.uint8)
    letters = LETTERS_PX
    for number, line in enumerate(wrapped(f"Lost: {reason}", width - 2 * letters, letters)):
        draw_text(tile, line, (letters, (2.0 + 1.5 * number) * letters), letters, _INK)
    return np.vstack([tile, label("", width)])


def _draw_rings(tile: Picture, points: npt.NDArray[np.float64]) -> None:
    for x, y in np.round(points * 16).astype(int).tolist():
        cv2.circle(tile, (x, y), round(4.2 * 16), (40, 40, 40), 1, cv2.LINE_AA, _SHIFT)
        cv2.circle(tile, (x, y), round(3.2 * 16), POINT, 1, cv2.LINE_AA, _SHIFT)


def _scaled(shape: Any, corner: tuple[float, float], scale: float) -> Any:
    x, y = ((value - low) * scale - 0.5 for value, low in zip((shape.x, shape.y), corner, strict=True))
    return msgspec.structs.replace(shape, x=x, y=y, radius=shape.radius * scale)


def _row(tiles: Sequence[Picture]) -> Picture:
    height = max(tile.shape[0] for tile in tiles)
    row = np.full((height + _GAP_PX // 2, WIDTH_PX, 3), _PAPER, np.uint8)
    for index, tile in enumerate(tiles):
        left = _GAP_PX + index * (_tile_width() + _GAP_PX)
        row[: tile.shape[0], left : left + tile.shape[1]] = tile
    return row


def label(words: str, width: int, letters: int = LETTERS_PX) -> Picture:
    """Write a line below a tile, on two heights of its letters."""
    line = np.full((2 * letters, width, 3), _PAPER, np.uint8)
    draw_text(line, words, (0, letters), letters, _INK)
    return line


def _tile_width() -> int:
    return (WIDTH_PX - 5 * _GAP_PX) // 4
