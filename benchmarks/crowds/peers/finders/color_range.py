"""The range of colors that is learned at a click, as every tutorial has it: `Range`."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

import matchset as ms

Bytes = npt.NDArray[np.uint8]
HALF_TURN = 180  # hues in OpenCV
WHITE = 255


class Range:
    """Hue, saturation and value near those at a click; in gray pictures half way to the gray of most pixels.

    Parameters
    ----------
    image : ndarray
    circle : Circle
        What was clicked; the color is the median of the middle of it.
    parameters : dict
        `blur`, px; `hue`, `saturation` and `value`: how far each may be off, both ways; `opened`: how often the mask is
        eroded and dilated again.
    """

    def __init__(self, image: Bytes, circle: ms.Circle, parameters: dict[str, Any]) -> None:
        self._parameters = parameters
        half = max(2, round(0.3 * circle.radius))
        x, y = round(circle.x), round(circle.y)
        patch = self._blurred(image)[max(y - half, 0) : y + half + 1, max(x - half, 0) : x + half + 1]
        self._turn = 0
        if image.ndim == 3:
            hues = cv2.cvtColor(patch, cv2.COLOR_BGR2HSV)[..., 0].astype(float) * (2.0 * np.pi / HALF_TURN)
            middle = np.arctan2(np.sin(hues).mean(), np.cos(hues).mean()) * HALF_TURN / (2.0 * np.pi)
            self._turn = round(HALF_TURN / 2 - float(middle))
        middles = np.median(self._channels(patch).reshape(-1, 3 if image.ndim == 3 else 1), axis=0)
        off = np.array([parameters[name] for name in ("hue", "saturation", "value")], float)
        if image.ndim == 2:
            off = np.abs(middles - np.median(image)) / 2.0
        self._low = np.clip(middles - off, 0, WHITE).astype(np.uint8)
        self._high = np.clip(middles + off, 0, WHITE).astype(np.uint8)

    def mask(self, image: Bytes) -> Bytes:
        """Return 255 where the color is in the range."""
        mask = cv2.inRange(self._channels(self._blurred(image)), self._low, self._high)
        times = self._parameters["opened"]
        if times:
            mask = cv2.dilate(cv2.erode(mask, None, iterations=times), None, iterations=times)  # type: ignore[call-overload]
        return np.asarray(mask, np.uint8)

    def _blurred(self, image: Bytes) -> Bytes:
        size = self._parameters["blur"]
        return np.asarray(cv2.GaussianBlur(image, (size, size), 0), np.uint8) if size > 1 else image

    def _channels(self, image: Bytes) -> Bytes:
        """Turn the circle of hues so that the clicked one is in the middle: red ends at none of its ends."""
        if image.ndim == 2:
            return image
        channels = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2HSV), np.uint8)
        channels[..., 0] = (channels[..., 0].astype(int) + self._turn) % HALF_TURN
        return channels
