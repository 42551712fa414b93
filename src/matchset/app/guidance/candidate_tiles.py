"""What the colors of candidates cover, as tiles beside the grid: `candidate_tiles`; of one color: `mask_picture`."""

from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import OUTLINE, as_color
from matchset.app.drawing.text import draw_text, text_width
from matchset.app.guidance.why_picture import covered, masked, percent
from matchset.image.candidates import Candidate
from matchset.image.color import ColorModel

Picture = npt.NDArray[np.uint8]

_WIDTH_PX, _LEAST_PX, _GAP_PX, _TITLE_PX = 300, 150, 12, 15  # geometry: width of a tile, the least, gaps, text
_PAPER, _INK = (250, 250, 250), (70, 70, 70)  # geometry: colors, BGR
_SHIFT = 4  # format: OpenCV draws at 1/16 px


def candidate_tiles(
    image: Picture, candidates: Sequence[Candidate], colors: Sequence[ColorModel | None], height: int
) -> Picture:
    """Show what the color of each candidate covers, in columns.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        The frame.
    candidates : sequence of Candidate
    colors : sequence of ColorModel or None
        Of each; None where none could be learned.
    height : int
        Of the grid beside which they stand, px: the tiles are made to fit.

    Returns
    -------
    ndarray of shape (height, w, 3), uint8
        BGR.
    """
    rows, columns = image.shape[:2]
    width = _WIDTH_PX if len(candidates) < 3 else _LEAST_PX + 60
    while width > _LEAST_PX and height // _tile_height(width, rows, columns) < 3 <= len(candidates):
        width -= 10
    high = _tile_height(width, rows, columns)
    per_column = max(height // high, 1)
    count = -(-len(candidates) // per_column)
    sheet = np.full((max(height, high), count * (width + _GAP_PX) + _GAP_PX, 3), _PAPER, np.uint8)
    for number, (candidate, color) in enumerate(zip(candidates, colors, strict=True)):
        left = _GAP_PX + number // per_column * (width + _GAP_PX)
        top = number % per_column * high
        tile = _tile(image, candidate, color, (number + 1, width))
        sheet[top : top + tile.shape[0], left : left + width] = tile
    return sheet


def mask_picture(image: Picture, color: ColorModel) -> Picture:
    """Show a picture, and beside it the same with only the target bright, both with a title.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    color : ColorModel
        The target's color.

    Returns
    -------
    ndarray of shape (h + title, 2 w + gap, 3), uint8
        BGR; small pictures are enlarged.
    """
    zoom = min(max(1, 480 // max(image.shape[:2])), 4)
    share = percent(100.0 * covered(image, color))
    parts = []
    for title, part in (("your picture", as_color(image)), (f"what counts as the ball: {share}", masked(image, color))):
        large = cv2.resize(part, None, fx=zoom, fy=zoom, interpolation=cv2.INTER_CUBIC).astype(np.uint8)
        parts.append(np.vstack([_title(title, large.shape[1], max(14, large.shape[0] // 40)), large]))
    gap = np.full((parts[0].shape[0], _GAP_PX, 3), _PAPER, np.uint8)
    return np.hstack([parts[0], gap, parts[1]])


def _tile_height(width: int, rows: int, columns: int) -> int:
    return max(round(width * rows / columns), 1) + 2 * _TITLE_PX + _GAP_PX


def _tile(image: Picture, candidate: Candidate, color: ColorModel | None, look: tuple[int, int]) -> Picture:
    """Show the mask of one color, its candidate circled, under its number and the share that it covers."""
    number, width = look
    if color is None:
        title, shown = f"{number}: no color", as_color(image) // 6
    else:
        title, shown = f"{number}: covers {percent(100.0 * covered(image, color))}", masked(image, color)
    scale = width / image.shape[1]
    size = width, max(round(image.shape[0] * scale), 1)
    small = cv2.resize(shown, size, interpolation=cv2.INTER_AREA).astype(np.uint8)
    x, y = (round(((value + 0.5) * scale - 0.5) * 16) for value in (candidate.x, candidate.y))
    cv2.circle(small, (x, y), max(round(candidate.radius * scale * 16), 32), OUTLINE, 1, cv2.LINE_AA, _SHIFT)
    return np.vstack([_title(title, width, _TITLE_PX), small])


def _title(words: str, width: int, size: int) -> Picture:
    """Write a line; smaller where it would not fit."""
    head = np.full((2 * size, width, 3), _PAPER, np.uint8)
    font = size
    while font > 8 and text_width(words, font) > width:
        font -= 1
    draw_text(head, words, (0, size), font, _INK)
    return head
