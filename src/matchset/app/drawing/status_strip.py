"""The strip of text below a picture: `StatusStrip`. It hides nothing of the picture, and no text is cut off."""

from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.text import draw_text, text_width, wrapped

Picture = npt.NDArray[np.uint8]

_SMALLEST_PX, _LEAST_PX, _MOST_PX = 7, 11, 28  # geometry: sizes of the text: at worst, and between which it follows
_PER_PX = 34  # geometry: height of a picture of 4:3 or wider, in sizes of the text
_DARK, _WHITE, _PALE = (28, 28, 28), (255, 255, 255), (190, 190, 190)  # geometry: colors, BGR
_BETWEEN = "   "  # format: what separates the parts of a text; a line ends there first


class StatusStrip:
    """A strip for pictures of one size, of one height whatever is written.

    Parameters
    ----------
    width, height : int
        Size of the pictures, px.
    longest : sequence of (str, str)
        The longest texts that are expected in each paragraph, see `below`: the strip has room for them.

    Attributes
    ----------
    height : int
        Of the strip, px, even.
    """

    def __init__(self, width: int, height: int, longest: Sequence[tuple[str, str]]) -> None:
        self._size = min(max(_LEAST_PX, round(min(height, 0.75 * width) / _PER_PX)), _MOST_PX)
        self._width = width
        self._lines = len(self._broken(longest, self._size))
        self.height = 2 * round(0.5 * self._lines * 1.55 * self._size + 0.25 * self._size)

    def below(self, image: Picture, paragraphs: Sequence[tuple[str, str]], color: tuple[int, int, int]) -> Picture:
        """Put a picture together from an image and the strip.

        Parameters
        ----------
        image : ndarray of shape (h, w, 3), uint8
        paragraphs : sequence of (str, str)
            Texts; the second one of a pair stands at the right, in a line of its own where there is no room.
        color : tuple of three ints
            Of the bar at the left, BGR.

        Returns
        -------
        ndarray of shape (h + height, w, 3), uint8
        """
        strip = np.full((self.height, self._width, 3), _DARK, np.uint8)
        size, lines = self._size, self._broken(paragraphs, self._size)
        while len(lines) > self._lines and size > _SMALLEST_PX:
            size -= 1
            lines = self._broken(paragraphs, size)
        missing = self._lines - len(lines)
        if missing > 0:  # what stands at the right keeps its place, the lowest line
            left, right = lines[-1] if lines else ("", "")
            lines = [*lines[:-1], (left, ""), *[("", "")] * (missing - 1), ("", right)]
        cv2.rectangle(strip, (0, 0), (max(1, self._size // 4), self.height), color, cv2.FILLED)
        step = self.height / max(len(lines), self._lines)
        for row, (left, right) in enumerate(lines):
            middle = (row + 0.5) * step
            draw_text(strip, left, (self._indent(size), middle), size, _WHITE)
            if right:
                draw_text(strip, right, (self._width - text_width(right, size) - 0.5 * size, middle), size, _PALE)
        return np.vstack([image, strip])

    def _broken(self, paragraphs: Sequence[tuple[str, str]], size: int) -> list[tuple[str, str]]:
        """Lines of all paragraphs, each with what stands at its right."""
        lines: list[tuple[str, str]] = []
        for left, right in paragraphs:
            *above, last = self._flow(left, size)
            lines += [(line, "") for line in above]
            room = self._width - self._indent(size) - text_width(last, size) - text_width(right, size) - 1.5 * size
            lines += [(last, right)] if not right or room > 0 else [(last, ""), ("", right)]
        return lines

    def _flow(self, text: str, size: int) -> list[str]:
        """Break a text between its parts, and between words where a part is longer than a line."""
        room = round(self._width - self._indent(size) - 0.5 * size)
        lines = [""]
        for part in text.split(_BETWEEN):
            longer = lines[-1] + _BETWEEN + part if lines[-1] else part
            if text_width(longer, size) <= room:
                lines[-1] = longer
                continue
            broken = wrapped(part, max(room, size), size)
            lines = [*lines, *broken] if lines[-1] else broken if len(lines) == 1 else [*lines[:-1], *broken]
        return lines

    def _indent(self, size: int) -> float:
        return 0.5 * self._size + 0.4 * size
