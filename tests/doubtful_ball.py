"""Equal balls that stand, and something flat of their color, which a search takes for doubtful."""

import cv2
import numpy as np
import numpy.typing as npt

RADIUS, SIZE = 14, (320, 240)
BALLS = ((40, 60), (100, 60), (160, 60))
FLAT = (220, 150)  # where the flat one is
_COLOR, _SHARE = (210, 90, 30), 0.68  # how high it is, in its width


def picture(number: int, flat: bool = True) -> npt.NDArray[np.uint8]:
    """A picture; noise alone tells it from others."""
    image = np.random.default_rng(number).normal(90.0, 2.0, (SIZE[1], SIZE[0], 3))
    for x, y in BALLS:
        cv2.circle(image, (16 * x, 16 * y), 16 * RADIUS, _COLOR, cv2.FILLED, cv2.LINE_AA, 4)
    if flat:
        cv2.ellipse(image, FLAT, (RADIUS, int(_SHARE * RADIUS)), 20.0, 0.0, 360.0, _COLOR, cv2.FILLED, cv2.LINE_AA)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7).astype(np.uint8)
