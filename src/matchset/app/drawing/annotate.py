"""The answer of a tracker, drawn into its frame: `annotate`; of a whole run, with its trail: `TrackPainter`."""

import math
from collections.abc import Sequence
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.status_strip import StatusStrip
from matchset.app.drawing.text import draw_text, text_width
from matchset.app.drawing.trail import Trail
from matchset.app.track.rows import TrackRow
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.shapes.shape import outline
from matchset.tracking.track import Lost, Track

Picture = npt.NDArray[np.uint8]
Color = tuple[int, int, int]

OUTLINE = (190, 40, 255)  # geometry: color of what was found, BGR: a pink that balls and rooms do not have
POINT = (255, 255, 255)  # geometry: color of the match-set, BGR
PREDICTED = (60, 190, 255)  # geometry: color of a predicted outline and of a loss, BGR
_LEAST_SIZE, _LARGEST_SIZE = 11, 28  # geometry: of the letters below a picture, px
_SHIFT = 4  # format: OpenCV draws at 1/16 px
_BETWEEN = "   "  # format: what separates the parts of a line


class Caption(msgspec.Struct, frozen=True):
    """What is written below a picture: at the left, at the right, and whether it is about a loss (another color)."""

    left: str
    right: str = ""
    bad: bool = False


class TrackPainter:
    """Draws the answers of a run, with the way that the shape has come, above a strip of text.

    Parameters
    ----------
    size : tuple of two ints
        Width and height of the frames, px.
    parameters : sequence of str
        Names of the shape's parameters.

    Attributes
    ----------
    size : tuple of two ints
        Width and height of the pictures, px.
    """

    def __init__(self, size: tuple[int, int], parameters: Sequence[str]) -> None:
        numbers = (f"{name} 8888.8 ±88.88" for name in parameters)
        longest = _BETWEEN.join([*numbers]) + " px   support 100 %"
        self._strip = StatusStrip(*size, [(longest, "frame 88888   8888.88 s")])
        self._trail = Trail()
        self.size = size[0], size[1] + self._strip.height

    def paint(self, frame: Frame, answer: Track[Any] | Lost[Any], row: TrackRow) -> Picture:
        """Draw the next answer into a copy of its frame, see `annotate`; (h + strip, w, 3), BGR."""
        image = as_color(frame.image)
        self._trail.append(center_of(answer))
        self._trail.draw(image)
        draw_answer(image, answer)
        texts = [(describe(row), f"frame {row.frame}   {row.time:.2f} s")]
        return self._strip.below(image, texts, OUTLINE if row.found else PREDICTED)


def center_of(answer: Track[Any] | Lost[Any]) -> tuple[float, float] | None:
    """Return the center of an answer's shape, px; None where there is none."""
    return answer.shape.center if isinstance(answer, Track) else None


def annotate(frame: Frame, answer: Track[Any] | Lost[Any], row: TrackRow) -> Picture:
    """Draw the answer into a copy of its frame.

    Parameters
    ----------
    frame : Frame
        The frame.
    answer : Track or Lost
        The tracker's answer.
    row : TrackRow
        The same as a row of the table; the caption is made from it.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR, with the outline and its match-set (or, dashed, the predicted outline of a lost shape), and a caption.
    """
    image = as_color(frame.image)
    draw_answer(image, answer)
    write_captions(image, Caption(describe(row), f"frame {row.frame}   {row.time:.2f} s", bad=not row.found))
    return image


def draw_answer(image: Picture, answer: Track[Any] | Lost[Any], color: Color | None = None) -> None:
    """Draw an outline with its match-set or, dashed, a predicted one; in one color, or each in its own."""
    if isinstance(answer, Track):
        draw_points(image, answer.match_set)
        draw_shape(image, answer.shape, color or OUTLINE)
    elif answer.predicted is not None:
        draw_shape(image, answer.predicted, color or PREDICTED, dashed=True)


def as_color(image: Picture) -> Picture:
    """Copy a picture, gray or color, to BGR."""
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), np.uint8) if image.ndim == 2 else image.copy()


def draw_circle(
    image: Picture, shape: Any, color: tuple[int, int, int] = OUTLINE, dashed: bool = False, thickness: int = 0
) -> None:
    """Draw a circle's outline, to a sixteenth of a pixel.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
        The picture, changed in place.
    shape : Circle
        The circle.
    color : tuple of three ints
        BGR.
    dashed : bool
        Whether to draw dashes, for a prediction.
    thickness : int
        Of the line, px; 0: as it suits the picture's size.
    """
    thickness = thickness or (2 if min(image.shape[:2]) > 900 else 1)
    if math.hypot(shape.x, shape.y) + shape.radius > 2**20:
        return
    center, radius = (_fixed(shape.x), _fixed(shape.y)), max(_fixed(shape.radius), 1)
    if not dashed:
        cv2.circle(image, center, radius, color, thickness, cv2.LINE_AA, _SHIFT)
        return
    for start in range(0, 360, 20):
        cv2.ellipse(image, center, (radius, radius), 0.0, start, start + 11, color, thickness, cv2.LINE_AA, _SHIFT)


def draw_shape(
    image: Picture,
    shape: Any,
    color: tuple[int, int, int] = OUTLINE,
    dashed: bool = False,
    scale: float = 1.0,
    thickness: int = 0,
) -> None:
    """Draw the outline of any shape, as `draw_circle` does; into a frame that was resized by a scale."""
    if isinstance(shape, Circle):
        x, y = ((value + 0.5) * scale - 0.5 for value in (shape.x, shape.y))
        draw_circle(image, Circle(x, y, shape.radius * scale), color, dashed, thickness)
        return
    corners = (outline(shape, 180) + 0.5) * scale - 0.5
    if np.abs(corners).max() > 2**20:
        return
    thickness = thickness or (2 if min(image.shape[:2]) > 900 else 1)
    if not dashed:
        fixed = np.rint(corners * (1 << _SHIFT)).astype(np.int32).reshape(-1, 1, 2)
        cv2.polylines(image, [fixed], True, color, thickness, cv2.LINE_AA, _SHIFT)
        return
    for begin, end in _dashes(corners):
        first, second = ((_fixed(float(x)), _fixed(float(y))) for x, y in (begin, end))
        cv2.line(image, first, second, color, thickness, cv2.LINE_AA, _SHIFT)


def _dashes(corners: npt.NDArray[np.float64]) -> list[npt.NDArray[np.float64]]:
    """Return the ends of 18 dashes along a closed outline, (2, 2) each."""
    closed = np.vstack((corners, corners[:1]))
    length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))))
    at = length[-1] * (np.arange(18)[:, None] + np.array([0.0, 0.55])) / 18
    return list(np.stack([np.interp(at, length, closed[:, k]) for k in range(2)], axis=2))


def draw_points(image: Picture, points: npt.NDArray[np.float64]) -> None:
    """Draw a match-set as small dots, (m, 2) px."""
    radius = _fixed(2.0 if min(image.shape[:2]) > 900 else 1.0)
    for x, y in np.round(points * (1 << _SHIFT)).astype(int).tolist():
        cv2.circle(image, (x, y), radius, POINT, cv2.FILLED, cv2.LINE_AA, _SHIFT)


def describe(row: TrackRow) -> str:
    """Format a row in one line: ``x 426.8 ±0.1   y 145.8 ±0.1   radius 28.8 ±0.1 px   support 93 %``."""
    if row.shape is None:
        return f"Lost: {row.reason}"
    std = row.std or {}
    numbers = [
        f"{name} {value:.1f}" + (f" ±{std[name]:.2f}" if name in std else "") for name, value in row.shape.items()
    ]
    support = "" if row.support is None else f"   support {100.0 * row.support:.0f} %"
    return "   ".join(numbers) + " px" + support


def write_captions(image: Picture, *captions: Caption) -> None:
    """Write captions on the darkened lower edge of a picture; what is too wide takes several lines.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
        The picture, changed in place.
    *captions : Caption
        From above.
    """
    height, width = image.shape[:2]
    largest = round(min(max(_LEAST_SIZE, min(height, 0.75 * width) / 36.0), _LARGEST_SIZE))
    sizes = range(largest, max(_LEAST_SIZE, round(0.8 * largest)) - 1, -1)  # smaller where that saves a line
    broken = {size: [line for each in captions for line in _lines(each, width, size)] for size in sizes}
    size = min(sizes, key=lambda each: len(broken[each]))
    lines = broken[size]
    high = round(1.9 * size)
    strip = image[max(height - high * len(lines), 0) :]
    strip //= 3
    for number, line in enumerate(lines):
        bottom = height - high * (len(lines) - 1 - number)
        bar = image[max(bottom - high, 0) : max(bottom, 0), : max(2, size // 4)]
        bar[:] = PREDICTED if line.bad else OUTLINE
        draw_text(image, line.left, (0.9 * size, bottom - 0.95 * size), size)
        if line.right:
            at = width - text_width(line.right, size) - 0.7 * size
            draw_text(image, line.right, (at, bottom - 0.95 * size), size, (190, 190, 190))


def _lines(caption: Caption, width: int, size: int) -> list[Caption]:
    """Break a caption into lines that fit: between its groups, which three spaces part, or else between words."""
    room = width - 1.8 * size
    lines = [""]
    for group in caption.left.split("   "):
        whole = text_width(group, size) <= room
        for number, word in enumerate([group] if whole else group.split(" ")):
            longer = lines[-1] + ("   " if number == 0 else " ") + word
            if lines[-1] and text_width(longer, size) > room:
                lines.append(word)
            else:
                lines[-1] = longer if lines[-1] else word
    right = text_width(caption.right, size) + 1.2 * size if caption.right else 0.0
    if right > room - text_width(lines[-1], size):
        lines.append("")
    broken = [Caption(line, "", caption.bad) for line in lines]
    broken[-1] = Caption(lines[-1], caption.right, caption.bad)
    return broken


def _fixed(value: float) -> int:
    return round(value * (1 << _SHIFT))
