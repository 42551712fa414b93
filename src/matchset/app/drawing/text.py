"""Text in pictures: `draw_text` with a TrueType font (it has ± and °), anti-aliased; `wrapped` breaks it into lines."""

import functools
import importlib.util
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

Color = tuple[int, int, int]


class Glyph(msgspec.Struct, frozen=True):
    """One letter: its opacity 0 ... 1 as (h, w), the left edge of its picture, and its advance width, px."""

    opacity: npt.NDArray[np.float32]
    left: int
    advance: float


def draw_text(
    image: npt.NDArray[np.uint8],
    text: str,
    at: tuple[float, float],
    size: int = 14,
    color: Color = (255, 255, 255),
) -> None:
    """Write one line of text into a picture.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
        The picture, changed in place; what lies outside is cut off.
    text : str
        The text.
    at : tuple of two floats
        Left end and vertical middle of the line, px.
    size : int
        Size of the font, px.
    color : tuple of three ints
        BGR.
    """
    line = _line(text, size)
    left, top = round(at[0]), round(at[1] - line.shape[0] / 2.0)
    height, width = image.shape[:2]
    rows, columns = slice(max(top, 0), top + line.shape[0]), slice(max(left, 0), left + line.shape[1])
    if rows.start >= min(rows.stop, height) or columns.start >= min(columns.stop, width):
        return
    under = image[rows, columns]
    opacity = line[rows.start - top :, columns.start - left :][: under.shape[0], : under.shape[1], None]
    under += ((np.array(color, np.float32) - under) * opacity).round().astype(np.int16).astype(np.uint8)


def text_width(text: str, size: int = 14) -> int:
    """Return the width of a line of text, px."""
    return int(_line(text, size).shape[1])


def wrapped(text: str, width: int, size: int = 14) -> list[str]:
    """Break a text into lines between its words; a word that is wider than a line is broken itself.

    Parameters
    ----------
    text : str
    width : int
        Of a line, px.
    size : int
        Size of the font, px.
    """
    lines = [""]
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}" if lines[-1] else word
        if text_width(longer, size) <= width:
            lines[-1] = longer
            continue
        if lines[-1]:
            lines.append("")
        for letter in word:
            if lines[-1] and text_width(lines[-1] + letter, size) > width:
                lines.append("")
            lines[-1] += letter
    return [line.strip() for line in lines]


@functools.lru_cache(maxsize=256)
def _line(text: str, size: int) -> npt.NDArray[np.float32]:
    glyphs = [_glyph(letter, size) for letter in text]
    height = _line_height(size)
    pen, placed = 0.0, []
    for glyph in glyphs:
        placed.append((round(pen) + glyph.left + 1, glyph))
        pen += glyph.advance
    line = np.zeros((height, round(pen) + size // 2 + 2), np.float32)
    for left, glyph in placed:
        target = line[:, max(left, 0) : left + glyph.opacity.shape[1]]
        np.maximum(target, glyph.opacity[:, : target.shape[1]], out=target)
    return line[:, : max(round(pen) + 2, 1)]


@functools.lru_cache(maxsize=1024)
def _glyph(letter: str, size: int) -> Glyph:
    font = _font(size)
    left, _, right, _ = font.getbbox(letter)
    picture = Image.new("L", (max(1, round(right) - round(left) + 2), _line_height(size)))
    # Anchored at the baseline, so that letters of one line stand on it.
    ImageDraw.Draw(picture).text((1 - left, _baseline(size)), letter, fill=255, font=font, anchor="ls")
    opacity = np.asarray(picture, np.float32) / 255.0
    return Glyph(opacity, round(left) - 1, float(font.getlength(letter)))


def _line_height(size: int) -> int:
    return round(1.3 * size)


def _baseline(size: int) -> int:
    return round(1.0 * size)


@functools.lru_cache(maxsize=32)
def _font(size: int) -> Any:
    # Matplotlib contains DejaVu Sans; its folder is found without importing Matplotlib, which takes 0.3 s.
    found = importlib.util.find_spec("matplotlib")
    if found is not None and found.origin is not None:
        path = Path(found.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
        if path.is_file():
            return ImageFont.truetype(str(path), size)
    return ImageFont.load_default(size)
