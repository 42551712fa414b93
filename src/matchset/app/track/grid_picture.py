"""A frame with a pixel grid and numbered candidates, to read coordinates from: `grid_picture`."""

import math
from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import OUTLINE, as_color
from matchset.app.drawing.text import draw_text, text_width
from matchset.image.candidates import Candidate

Picture = npt.NDArray[np.uint8]

_PAPER = (250, 250, 250)  # geometry: color of the margin, BGR
_INK = (51, 51, 51)  # geometry: color of the labels, BGR
_BADGE_PX, _OTHER_BADGE_PX = 22, 16  # geometry: size of the first candidate's number, and of the others
_LEAST_PX = 11  # geometry: least size of letters
_LONGEST_PX = 1300  # geometry: longer side of a frame that is drawn in its own size
_SHIFT = 4  # format: OpenCV draws at 1/16 px


def grid_picture(image: Picture, candidates: Sequence[Candidate]) -> Picture:
    """Draw a grid over a frame, label it in the frame's pixels, and number the candidates.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        The frame.
    candidates : sequence of Candidate
        Ball-like circles, best first.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR, with a margin that holds the labels; small frames are enlarged and large ones reduced, but labels
        count the frame's pixels.
    """
    side = max(image.shape[:2])
    zoom = float(min(max(1, 1300 // side), 4)) if side <= _LONGEST_PX else _LONGEST_PX / side
    canvas, at = _framed(image, zoom)
    step = _grid_step(max(image.shape[:2]))
    _draw_lines(canvas, image, at, zoom, step)
    height, width = _drawn_size(image, zoom)
    inside = canvas[at[1] : at[1] + height, at[0] : at[0] + width]
    _name_crossings(inside, image, zoom, _strong_step(step))
    _draw_candidates(inside, candidates, zoom)
    return canvas


def _framed(image: Picture, zoom: float) -> tuple[Picture, tuple[int, int]]:
    height, width = _drawn_size(image, zoom)
    size = _font_size(image, zoom)
    left, top = text_width("0000", size) + size, 2 * size
    canvas = np.full((height + top + size, width + left + size, 3), _PAPER, np.uint8)
    how = cv2.INTER_CUBIC if zoom >= 1.0 else cv2.INTER_AREA
    canvas[top : top + height, left : left + width] = cv2.resize(as_color(image), (width, height), interpolation=how)
    return canvas, (left, top)


def _draw_lines(canvas: Picture, image: Picture, at: tuple[int, int], zoom: float, step: int) -> None:
    height, width = image.shape[:2]
    left, top = at
    size = _font_size(image, zoom)
    drawn_height, drawn_width = _drawn_size(image, zoom)
    inside = canvas[top : top + drawn_height, left : left + drawn_width]
    for value in range(0, width, step):
        column = _line_position(value, zoom)
        _shade(inside[:, column], strong=value % _strong_step(step) == 0)
        label = str(value)
        draw_text(canvas, label, (left + column - text_width(label, size) / 2, top - 0.8 * size), size, _INK)
    for value in range(0, height, step):
        row = _line_position(value, zoom)
        _shade(inside[row], strong=value % _strong_step(step) == 0)
        label = str(value)
        draw_text(canvas, label, (left - text_width(label, size) - 0.4 * size, top + row), size, _INK)


def _shade(line: Picture, strong: bool) -> None:
    """Draw a visible line of pixels: darken them on a light background, lighten them on a dark one."""
    share = 0.32 if strong else 0.14
    toward = np.where(line.mean(axis=-1, keepdims=True) > 110.0, 0.0, 255.0)
    line[:] = np.round(line + (toward - line) * share).astype(np.uint8)


def _name_crossings(inside: Picture, image: Picture, zoom: float, step: int) -> None:
    """Write x,y where the stronger lines cross, so that no line must be followed to the margin."""
    size = max(round(0.75 * _font_size(image, zoom)), _LEAST_PX)
    for y in range(step, image.shape[0], step):
        for x in range(step, image.shape[1], step):
            words = f"{x},{y}"
            at = _line_position(x, zoom) + 3.0, _line_position(y, zoom) + 0.7 * size
            if at[0] + text_width(words, size) > inside.shape[1] or at[1] + 0.7 * size > inside.shape[0]:
                continue
            draw_text(inside, words, (at[0] + 1.0, at[1] + 1.0), size, (0, 0, 0))
            draw_text(inside, words, at, size)


def _draw_candidates(inside: Picture, candidates: Sequence[Candidate], zoom: float) -> None:
    """Draw circles with their numbers, the first one strong; what lies outside the frame is cut off."""
    badges: list[tuple[float, float]] = []
    for number, candidate in enumerate(candidates):
        x, y = (zoom * (value + 0.5) - 0.5 for value in (candidate.x, candidate.y))
        center, radius = (round(x * 16), round(y * 16)), round(candidate.radius * zoom * 16)
        rim, wide = (7, 4) if number == 0 else (3, 1)
        cv2.circle(inside, center, radius, (255, 255, 255), rim, cv2.LINE_AA, _SHIFT)
        cv2.circle(inside, center, radius, OUTLINE, wide, cv2.LINE_AA, _SHIFT)
        badges.append(_badge_position(inside, (x, y, candidate.radius * zoom), badges))
    for number, (x, y) in enumerate(badges, start=1):
        spot, size = (round(x * 16), round(y * 16)), _BADGE_PX if number == 1 else _OTHER_BADGE_PX
        cv2.circle(inside, spot, round(0.78 * size * 16), (255, 255, 255), cv2.FILLED, cv2.LINE_AA, _SHIFT)
        cv2.circle(inside, spot, round(0.66 * size * 16), OUTLINE, cv2.FILLED, cv2.LINE_AA, _SHIFT)
        label = str(number)
        draw_text(inside, label, (x - text_width(label, size) / 2 + 1, y), size)


def _badge_position(
    canvas: Picture, circle: tuple[float, float, float], taken: Sequence[tuple[float, float]]
) -> tuple[float, float]:
    """Choose a position beside a circle, inside the picture, that overlaps no other badge if possible."""
    x, y, radius = circle
    height, width = canvas.shape[:2]
    positions = []
    for turn in (-0.125, 0.125, -0.375, 0.375, 0.0, -0.25, 0.25, 0.5):
        angle = 2.0 * math.pi * turn
        distance = radius + 0.9 * _BADGE_PX
        position = (
            min(max(x + distance * math.cos(angle), _BADGE_PX), width - _BADGE_PX),
            min(max(y + distance * math.sin(angle), _BADGE_PX), height - _BADGE_PX),
        )
        positions.append((min((math.dist(position, other) for other in taken), default=math.inf), position))
    free = [position for gap, position in positions if gap > 1.5 * _BADGE_PX]
    return free[0] if free else max(positions)[1]


def _grid_step(side: int) -> int:
    """Distance of the grid's lines, px: about twenty to the longer side, in round numbers."""
    for step in (5, 10, 20, 25, 50, 100, 200):
        if side <= 26 * step:
            return step
    return 500


def _strong_step(step: int) -> int:
    """Distance of the stronger lines, px."""
    return 4 * step if step == 25 else 5 * step


def _font_size(image: Picture, zoom: float) -> int:
    return int(min(max(12, round(zoom * max(image.shape[:2]) / 85)), 20))


def _line_position(value: int, zoom: float) -> int:
    return int((value + 0.5) * zoom)


def _drawn_size(image: Picture, zoom: float) -> tuple[int, int]:
    """Height and width of a frame on the canvas, px."""
    height, width = image.shape[:2]
    return max(round(height * zoom), 1), max(round(width * zoom), 1)
