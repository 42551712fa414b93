"""Which BGR cells lie in a range of OpenCV's HSV: `hsv_share`."""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.color_learning import bin_centers

CORNERS = 27  # geometry: places of a cell that are looked at, three along each channel


def hsv_share(low: tuple[int, int, int], high: tuple[int, int, int]) -> npt.NDArray[np.float32]:
    """Share of each BGR cell that lies in a range; a low hue above the high one wraps around red.

    Parameters
    ----------
    low, high : tuple of int
        Hue 0 ... 179, saturation and value 0 ... 255, both ends included.

    Returns
    -------
    ndarray of shape (32768,), float32

    Raises
    ------
    ValueError
        If a number is out of its range, or a low saturation or value lies above the high one.
    """
    top = (179, 255, 255)
    for bound in (low, high):
        try:
            sound = len(bound) == 3 and all(0 <= value <= limit for value, limit in zip(bound, top, strict=True))
        except TypeError:  # no three numbers
            sound = False
        if not sound:
            raise ValueError(f"HSV values run from (0, 0, 0) to (179, 255, 255), got {bound!r:.60}")
    if low[1] > high[1] or low[2] > high[2]:
        raise ValueError(f"low {tuple(low)} lies above high {tuple(high)} in saturation or value")
    share = np.zeros(32768, np.float32)
    for corner in np.ndindex(3, 3, 3):
        inner = bin_centers() - 2.5 + 2.5 * np.array(corner, np.float32)
        pixels = np.round(inner).astype(np.uint8).reshape(-1, 1, 3)
        h, s, v = cv2.split(cv2.cvtColor(pixels, cv2.COLOR_BGR2HSV))
        hue = (h >= low[0]) & (h <= high[0]) if low[0] <= high[0] else (h >= low[0]) | (h <= high[0])
        share += (hue & (s >= low[1]) & (s <= high[1]) & (v >= low[2]) & (v <= high[2])).ravel()
    return share / np.float32(CORNERS)
