"""Why nothing was found, as a picture: a frame beside the mask of the color, and the words: `why_picture`."""

from collections.abc import Sequence
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import OUTLINE, PREDICTED, as_color, draw_shape
from matchset.app.drawing.text import draw_text, text_width, wrapped
from matchset.image.color import ColorModel

Picture = npt.NDArray[np.uint8]

# geometry: px: the sides of a picture on the sheet, the space between, and the sizes of the text
_LEAST_PX, _MOST_PX, _GAP_PX, _TITLE_PX, _TEXT_PX = 420, 760, 16, 17, 16
_PAPER, _INK, _PALE = (255, 255, 255), (60, 60, 60), (120, 120, 120)  # geometry: colors, BGR
_SHIFT = 4  # format: OpenCV draws at 1/16 px


class DrawnEvidence(msgspec.Struct, frozen=True):
    """What is drawn into both pictures.

    Parameters
    ----------
    outline : Shape or None
        The best outline that was rejected.
    click : tuple of float or None
        Where somebody clicked, px.
    """

    outline: Any = None
    click: tuple[float, float] | None = None


def why_picture(
    title: str, image: Picture, color: ColorModel | None, shown: DrawnEvidence, words: Sequence[str]
) -> Picture:
    """Put a picture of a failure together.

    Parameters
    ----------
    title : str
        Above the picture: "frame 0".
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        The frame.
    color : ColorModel or None
        What was looked for; None where no color could be learned, then there is no mask.
    shown : DrawnEvidence
        What is drawn into it.
    words : sequence of str
        Sentences, below the pictures; long ones are wrapped.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR.
    """
    tiles = [_tile(title, as_color(image), shown)]
    if color is not None:
        share = 100.0 * covered(image, color)
        tiles.append(_tile(f"what counts as the ball: {percent(share)} of it", masked(image, color), shown))
    gap = np.full((tiles[0].shape[0], _GAP_PX, 3), _PAPER, np.uint8)
    row = np.hstack([gap, *(part for tile in tiles for part in (tile, gap))])
    return np.vstack([row, _text_below(row.shape[1], words)])


def covered(image: Picture, color: ColorModel) -> float:
    """Return the share of a picture that has the target's color, 0 ... 1."""
    return float(np.mean(color.mask(image) > 0))


def percent(share: float) -> str:
    """Format a percentage: two digits that count, but 0 only where it is 0."""
    if 0.0 < share < 0.1:
        return "< 0.1 %"
    return f"{share:.1f} %" if share < 10.0 else f"{share:.0f} %"


def masked(image: Picture, color: ColorModel) -> Picture:
    """Darken the pixels of a picture that do not have the target's color; (h, w, 3), BGR."""
    plain = as_color(image)
    return np.where(color.mask(image)[..., None] > 0, plain, plain // 6).astype(np.uint8)


def _tile(title: str, picture: Picture, shown: DrawnEvidence) -> Picture:
    """Scale a picture, draw into it, and write its title above."""
    height, width = picture.shape[:2]
    scale = min(_MOST_PX / max(height, width), max(_LEAST_PX / width, 1.0))
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
    size = max(round(width * scale), 1), max(round(height * scale), 1)
    large = cv2.resize(picture, size, interpolation=how).astype(np.uint8)
    if shown.outline is not None:
        draw_shape(large, shown.outline, (30, 30, 30), dashed=True, scale=scale, thickness=5)
        draw_shape(large, shown.outline, PREDICTED, dashed=True, scale=scale, thickness=3)
    if shown.click is not None:
        _draw_cross(large, ((shown.click[0] + 0.5) * scale - 0.5, (shown.click[1] + 0.5) * scale - 0.5))
    head = np.full((2 * _TITLE_PX, large.shape[1], 3), _PAPER, np.uint8)
    font = _TITLE_PX
    while font > 9 and text_width(title, font) > large.shape[1]:
        font -= 1
    draw_text(head, title, (0, 1.1 * _TITLE_PX), font, _INK)
    return np.vstack([head, large])


def _draw_cross(image: Picture, at: tuple[float, float]) -> None:
    x, y = (round(value * 16) for value in at)
    for color, thickness in (((255, 255, 255), 4), (OUTLINE, 2)):
        for dx, dy in ((1, 0), (0, 1)):
            for begin, end in ((-14, -5), (5, 14)):
                first, second = ((x + 16 * part * dx, y + 16 * part * dy) for part in (begin, end))
                cv2.line(image, first, second, color, thickness, cv2.LINE_AA, _SHIFT)


def _text_below(width: int, words: Sequence[str]) -> Picture:
    room = width - 2 * _GAP_PX
    lines = [(line, number == 0) for each in words for number, line in enumerate(wrapped(each, room, _TEXT_PX))]
    step = round(1.5 * _TEXT_PX)
    text = np.full((len(lines) * step + 2 * _GAP_PX, width, 3), _PAPER, np.uint8)
    for row, (line, first) in enumerate(lines):
        draw_text(text, line, (_GAP_PX, _GAP_PX + (row + 0.5) * step), _TEXT_PX, _INK if first else _PALE)
    return text
