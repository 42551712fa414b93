"""The way that a shape has come, as a fading line: `Trail`."""

import itertools
from collections import deque

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.uint8]

_COLOR = (255, 220, 80)  # geometry: of the line, BGR: a light blue, neither that of an outline nor of a prediction
_SHIFT = 4  # format: OpenCV draws at 1/16 px
_FARTHEST = 2.0**20  # geometry: px; farther out nothing is drawn


class TrailParameters(msgspec.Struct, frozen=True):
    """How long a trail is.

    Parameters
    ----------
    frames : int
        Frames that it reaches back: longer shows more of the way and hides more of the picture. Chosen by hand.
    """

    frames: int = 40


class Trail:
    """Centers of the last frames; a frame in which nothing was found interrupts the line.

    Parameters
    ----------
    parameters : TrailParameters, optional
    """

    def __init__(self, parameters: TrailParameters | None = None) -> None:
        self._centers: deque[tuple[float, float] | None] = deque(maxlen=(parameters or TrailParameters()).frames)

    def append(self, center: tuple[float, float] | None) -> None:
        """Note the center in the newest frame, px; None if nothing was found."""
        self._centers.append(center)

    def draw(self, image: Picture, color: tuple[int, int, int] = _COLOR) -> None:
        """Draw the line into a picture, the oldest part faintest; the color is BGR."""
        thickness = max(1, round(min(image.shape[:2]) / 400))
        places = list(self._centers)
        for number, (begin, end) in enumerate(itertools.pairwise(places), start=1):
            if begin is None or end is None or max(map(abs, (*begin, *end))) > _FARTHEST:
                continue
            first, second = ((round(x * 16), round(y * 16)) for x, y in (begin, end))
            self._draw_part(image, first, second, (number / len(places), thickness, color))

    def _draw_part(
        self,
        image: Picture,
        first: tuple[int, int],
        second: tuple[int, int],
        look: tuple[float, int, tuple[int, int, int]],
    ) -> None:
        """Draw a part of the line, mixed with what is below it, within the box around it."""
        opacity, thickness, color = look
        room = thickness + 2
        low = [max((min(a, b) >> _SHIFT) - room, 0) for a, b in zip(first, second, strict=True)]
        high = [(max(a, b) >> _SHIFT) + room + 1 for a, b in zip(first, second, strict=True)]
        box = image[low[1] : high[1], low[0] : high[0]]
        if box.size == 0:
            return
        drawn = box.copy()
        moved = [(x - (low[0] << _SHIFT), y - (low[1] << _SHIFT)) for x, y in (first, second)]
        cv2.line(drawn, moved[0], moved[1], color, thickness, cv2.LINE_AA, _SHIFT)
        cv2.addWeighted(drawn, opacity, box, 1.0 - opacity, 0.0, dst=box)
