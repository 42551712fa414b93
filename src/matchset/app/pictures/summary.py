"""The summary of a run in one picture: some frames with what was found, and its course in curves: `Summary`."""

from typing import Any, Protocol

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.course.log import Course
from matchset.app.drawing.annotate import PREDICTED, as_color, draw_shape
from matchset.app.drawing.text import draw_text, text_width, wrapped
from matchset.app.progress import announce_if_slow
from matchset.image.frame import Frame
from matchset.tracking.track import Track

Picture = npt.NDArray[np.uint8]

# geometry: px: width of the sheet, gap, sizes of text
_WIDTH_PX, _GAP_PX, _TITLE_PX, _TEXT_PX = 1480, 16, 26, 14
_TALLEST_PX = 380  # geometry: height of a tile, px, so that portrait pictures leave a sheet that fits a screen
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
    """Collects some frames of a run, reduced, evenly spread whatever its length, and counts those found."""

    def __init__(self) -> None:
        self._tiles: list[_Tile] = []
        self._step, self._offered, self._frames, self._found = 1, 0, 0, 0

    def append(self, frame: Frame | None, answer: Any, row: SummaryRow) -> None:
        """Note the next frame; None: it could not be decoded."""
        self._frames += 1
        self._found += row.found
        if frame is None:
            return
        if self._offered % self._step == 0:
            if len(self._tiles) == 4 * _MOST_ACROSS:
                del self._tiles[1::2]
                self._step *= 2
            if self._offered % self._step == 0:
                self._tiles.append(self._tile(frame, answer, row))
        self._offered += 1

    def _tile(self, frame: Frame, answer: Any, row: SummaryRow) -> _Tile:
        """Reduce a frame, with what was found in it."""
        height, width = frame.image.shape[:2]
        wide = (_WIDTH_PX - (_ACROSS + 1) * _GAP_PX) // _ACROSS
        scale = min(wide / width, _TALLEST_PX / height)
        size = max(round(width * scale), 1), max(round(height * scale), 1)
        small = np.asarray(cv2.resize(as_color(frame.image), size, interpolation=cv2.INTER_AREA), np.uint8)
        self.draw(small, answer, scale)
        words = f"frame {frame.index}   {row.time:.2f} s"
        return _Tile(small, words if row.found else f"{words}   Lost: {row.reason}")

    def draw(self, small: Picture, answer: Any, scale: float) -> None:
        """Draw an answer into a frame that was reduced by a scale: its outline, or dashed the predicted one."""
        if isinstance(answer, Track):
            draw_shape(small, answer.shape, scale=scale, thickness=2)
        elif answer.predicted is not None:
            draw_shape(small, answer.predicted, PREDICTED, dashed=True, scale=scale, thickness=2)

    @property
    def is_empty(self) -> bool:
        """Whether there was no frame."""
        return not self._tiles

    @property
    def words(self) -> str:
        """In how many frames it was found."""
        return f"found in {self._found} of {self._frames} frames ({100.0 * self._found / self._frames:.1f} %)"

    def picture(self, title: str, course: Course | None = None) -> Picture:
        """Put the sheet together.

        Parameters
        ----------
        title : str
            What was followed: the video's name.
        course : Course, optional
            Drawn below, if it was found at all.

        Returns
        -------
        ndarray of shape (h, w, 3), uint8
            BGR.
        """
        across = _across(self._tiles[0].picture)
        count = min(len(self._tiles), 2 * across)
        chosen = [self._tiles[round(place)] for place in np.linspace(0, len(self._tiles) - 1, count)]
        head = np.full((92, _WIDTH_PX, 3), _PAPER, np.uint8)
        size = _TITLE_PX
        while size > 12 and text_width(title, size) > _WIDTH_PX - 2 * _GAP_PX:
            size -= 1
        draw_text(head, title, (_GAP_PX, 34), size, _INK)
        draw_text(head, self.words, (_GAP_PX, 70), _TEXT_PX + 2, _PALE)
        rows = [_row(chosen[first : first + across], across) for first in range(0, count, across)]
        curves = [] if course is None or not course.found.any() else [_curves(course)]
        return np.vstack([head, *rows, *curves])


def _curves(course: Course) -> Picture:
    """Draw the course as wide as the sheet."""
    with announce_if_slow("drawing the curves ..."):
        from matchset.app.course.figure import course_picture

        return course_picture(course, _WIDTH_PX)


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
