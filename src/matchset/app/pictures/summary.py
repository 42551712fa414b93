"""The summary of a run in one picture: some frames with what was found, and when it was found: `Summary`."""

from typing import Any, Protocol

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import OUTLINE, PREDICTED, as_color, draw_shape
from matchset.app.drawing.text import draw_text, text_width, wrapped
from matchset.image.frame import Frame
from matchset.tracking.track import Lost, Track

Picture = npt.NDArray[np.uint8]

# geometry: px: width of the sheet, gap, sizes of text, height of the band of time; tiles in a row and at most
_WIDTH_PX, _GAP_PX, _TITLE_PX, _TEXT_PX, _BAND_PX = 1480, 16, 26, 14, 34
_TALLEST_PX = 460  # geometry: height of a tile, px, so that portrait pictures leave a sheet that fits a screen
_ACROSS, _MOST_ACROSS = 4, 6  # geometry: tiles in a row: of wide pictures, and of the tallest; there are two rows
_PAPER, _INK, _PALE = (255, 255, 255), (60, 60, 60), (140, 140, 140)  # geometry: colors, BGR


class SummaryRow(Protocol):
    """What a summary needs to know of a row."""

    @property
    def time(self) -> float:
        """When the frame was taken, s."""
        ...

    @property
    def found(self) -> bool:
        """Whether there is an answer."""
        ...

    @property
    def reason(self) -> str:
        """Why there is none."""
        ...


class _Tile(msgspec.Struct, frozen=True):
    picture: Picture
    words: str


class Summary:
    """Collects some frames of a run, reduced, evenly spread whatever its length, and whether each one was found."""

    def __init__(self) -> None:
        self._tiles: list[_Tile] = []
        self._step, self._seen = 1, 0
        self._found: list[bool] = []
        self._times: list[float] = []

    def append(self, frame: Frame, answer: Track[Any] | Lost[Any], row: SummaryRow) -> None:
        """Note the next frame."""
        self._found.append(row.found)
        self._times.append(row.time)
        if self._seen % self._step == 0:
            if len(self._tiles) == 4 * _MOST_ACROSS:
                del self._tiles[1::2]
                self._step *= 2
            if self._seen % self._step == 0:
                self._tiles.append(_tile(frame, answer, row))
        self._seen += 1

    @property
    def is_empty(self) -> bool:
        """Whether there was no frame."""
        return not self._tiles

    def picture(self, title: str) -> Picture:
        """Put the sheet together.

        Parameters
        ----------
        title : str
            What was followed: the video's name.

        Returns
        -------
        ndarray of shape (h, w, 3), uint8
            BGR.
        """
        across = _across(self._tiles[0].picture)
        count = min(len(self._tiles), 2 * across)
        chosen = [self._tiles[round(place)] for place in np.linspace(0, len(self._tiles) - 1, count)]
        words = f"found in {sum(self._found)} of {self._seen} frames ({100.0 * np.mean(self._found):.1f} %)"
        head = np.full((92, _WIDTH_PX, 3), _PAPER, np.uint8)
        size = _TITLE_PX
        while size > 12 and text_width(title, size) > _WIDTH_PX - 2 * _GAP_PX:
            size -= 1
        draw_text(head, title, (_GAP_PX, 34), size, _INK)
        draw_text(head, words, (_GAP_PX, 70), _TEXT_PX + 2, _PALE)
        rows = [_row(chosen[first : first + across], across) for first in range(0, count, across)]
        return np.vstack([head, *rows, self._band()])

    def _band(self) -> Picture:
        """Draw when it was found: a column of pixels for each moment."""
        band = np.full((_BAND_PX + 74, _WIDTH_PX, 3), _PAPER, np.uint8)
        width = _WIDTH_PX - 2 * _GAP_PX
        edges = np.linspace(0, len(self._found), width + 1)
        known = np.concatenate(([0], np.cumsum(self._found)))
        low, high = edges[:-1].astype(int), np.maximum(np.ceil(edges[1:]).astype(int), edges[:-1].astype(int) + 1)
        high = np.minimum(high, len(self._found))
        share = (known[high] - known[low]) / np.maximum(high - low, 1)
        colors = share[:, None] * np.array(OUTLINE) + (1.0 - share[:, None]) * np.array(PREDICTED)
        band[30 : 30 + _BAND_PX, _GAP_PX : _GAP_PX + width] = np.round(colors).astype(np.uint8)
        left = float(_GAP_PX)
        for color, words in ((OUTLINE, "found"), (PREDICTED, "not found")):
            cv2.rectangle(band, (round(left), 8), (round(left) + 14, 22), color, cv2.FILLED)
            draw_text(band, words, (left + 20, 15), _TEXT_PX, _INK)
            left += 40 + text_width(words, _TEXT_PX)
        last = f"{self._times[-1]:.2f} s"
        draw_text(band, f"{self._times[0]:.2f} s", (_GAP_PX, _BAND_PX + 46), _TEXT_PX, _PALE)
        draw_text(band, last, (_WIDTH_PX - _GAP_PX - text_width(last, _TEXT_PX), _BAND_PX + 46), _TEXT_PX, _PALE)
        return band


def _tile(frame: Frame, answer: Track[Any] | Lost[Any], row: SummaryRow) -> _Tile:
    """Reduce a frame, with its outline, or dashed the predicted one."""
    height, width = frame.image.shape[:2]
    wide = (_WIDTH_PX - (_ACROSS + 1) * _GAP_PX) // _ACROSS
    scale = min(wide / width, _TALLEST_PX / height)
    size = max(round(width * scale), 1), max(round(height * scale), 1)
    small = np.asarray(cv2.resize(as_color(frame.image), size, interpolation=cv2.INTER_AREA), np.uint8)
    if isinstance(answer, Track):
        draw_shape(small, answer.shape, scale=scale, thickness=2)
    elif answer.predicted is not None:
        draw_shape(small, answer.predicted, PREDICTED, dashed=True, scale=scale, thickness=2)
    words = f"frame {frame.index}   {row.time:.2f} s"
    return _Tile(small, words if row.found else f"{words}   Lost: {row.reason}")


def _across(picture: Picture) -> int:
    """How many tiles stand in a row: more where they are narrow."""
    width = int(picture.shape[1])
    return min(max((_WIDTH_PX - _GAP_PX) // (width + _GAP_PX), _ACROSS), _MOST_ACROSS)


def _row(tiles: list[_Tile], across: int) -> Picture:
    """Put tiles side by side, each with its words below."""
    wide = (_WIDTH_PX - (across + 1) * _GAP_PX) // across
    lines = [wrapped(tile.words, wide, _TEXT_PX) for tile in tiles]
    step = round(1.4 * _TEXT_PX)
    high = max(tile.picture.shape[0] for tile in tiles)
    row = np.full((high + max(map(len, lines)) * step + _GAP_PX, _WIDTH_PX, 3), _PAPER, np.uint8)
    for place, (tile, words) in enumerate(zip(tiles, lines, strict=True)):
        left = _GAP_PX + place * (wide + _GAP_PX)
        height, width = tile.picture.shape[:2]
        row[:height, left : left + width] = tile.picture
        for number, line in enumerate(words):
            draw_text(row, line, (left, high + (number + 0.6) * step), _TEXT_PX, _INK)
    return row
