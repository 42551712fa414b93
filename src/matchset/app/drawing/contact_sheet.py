"""The contact sheet of a run: frames with what was found, enlarged rims, and a plot: `contact_sheet`."""

from collections.abc import Sequence
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import OUTLINE, POINT, as_color, draw_circle
from matchset.app.drawing.text import draw_text
from matchset.image.frame import Frame
from matchset.tracking.track import Lost, Track

Picture = npt.NDArray[np.uint8]

WIDTH_PX = 1480  # geometry: width of the sheet
_GAP_PX = 16  # geometry: between tiles
_PAPER, _INK, _PALE = (255, 255, 255), (60, 60, 60), (140, 140, 140)  # geometry: colors, BGR
_SHIFT = 4  # format: OpenCV draws at 1/16 px


class SheetFrame(msgspec.Struct, frozen=True):
    """One frame for the sheet: the frame, its answer, and its error (Eq. 10), px, if it is known."""

    frame: Frame
    answer: Track[Any] | Lost[Any]
    error_px: float | None = None


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
    head = np.full((104, WIDTH_PX, 3), _PAPER, np.uint8)
    draw_text(head, title, (_GAP_PX, 38), 30, _INK)
    draw_text(head, subtitle, (_GAP_PX, 78), 16, _PALE)
    rows = [head]
    for first in range(0, len(frames), 4):
        four = frames[first : first + 4]
        rows.append(_row([whole_tile(shown, _tile_width()) for shown in four]))
        rows.append(_row([rim_tile(shown, _tile_width()) for shown in four]))
    return np.vstack([*rows, plot])


def whole_tile(shown: SheetFrame, width: int) -> Picture:
    """Show a whole frame, `width` px wide, with its circle and a line of text below."""
    image = as_color(shown.frame.image)
    scale = width / image.shape[1]
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA).astype(np.uint8)
    circle = _scaled(shown, (-0.5, -0.5), scale)
    if circle is not None:
        draw_circle(small, circle)
    words = f"frame {shown.frame.index}"
    if shown.error_px is not None:
        words += f"   error {shown.error_px:.2f} px"
    if isinstance(shown.answer, Lost):
        words += f"   Lost: {shown.answer.reason}"
    return np.vstack([small, _label(words, width)])


def rim_tile(shown: SheetFrame, width: int) -> Picture:
    """Show the ball enlarged, with its match-set."""
    if isinstance(shown.answer, Lost):
        return np.full((width + 28, width, 3), 245, np.uint8)
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
    center = [(value - low) * zoom - 0.5 for value, low in zip((shape.x, shape.y), corner, strict=True)]
    center_16 = round(center[0] * 16), round(center[1] * 16)
    cv2.circle(tile, center_16, round(shape.radius * zoom * 16), OUTLINE, 1, cv2.LINE_AA, _SHIFT)
    words = f"{len(points)} points   {zoom:.1f} times enlarged"
    return np.vstack([tile, _label(words, width)])


def _draw_rings(tile: Picture, points: npt.NDArray[np.float64]) -> None:
    for x, y in np.round(points * 16).astype(int).tolist():
        cv2.circle(tile, (x, y), round(4.2 * 16), (40, 40, 40), 1, cv2.LINE_AA, _SHIFT)
        cv2.circle(tile, (x, y), round(3.2 * 16), POINT, 1, cv2.LINE_AA, _SHIFT)


def _scaled(shown: SheetFrame, corner: tuple[float, float], scale: float) -> Any:
    if isinstance(shown.answer, Lost):
        return None
    shape = shown.answer.shape
    x, y = ((value - low) * scale - 0.5 for value, low in zip((shape.x, shape.y), corner, strict=True))
    return msgspec.structs.replace(shape, x=x, y=y, radius=shape.radius * scale)


def _row(tiles: Sequence[Picture]) -> Picture:
    height = max(tile.shape[0] for tile in tiles)
    row = np.full((height + _GAP_PX // 2, WIDTH_PX, 3), _PAPER, np.uint8)
    for index, tile in enumerate(tiles):
        left = _GAP_PX + index * (_tile_width() + _GAP_PX)
        row[: tile.shape[0], left : left + tile.shape[1]] = tile
    return row


def _label(words: str, width: int) -> Picture:
    label = np.full((28, width, 3), _PAPER, np.uint8)
    draw_text(label, words, (0, 14), 14, _INK)
    return label


def _tile_width() -> int:
    return (WIDTH_PX - 5 * _GAP_PX) // 4
