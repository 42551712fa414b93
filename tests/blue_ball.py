"""A blue ball before a gray wall: what the tests of the command line look at."""

from collections.abc import Callable

import cv2
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.uint8]
Matchset = Callable[..., int]

SIZE = 160, 120
CENTERS = [(50.0 + 2.0 * index, 60.0) for index in range(30)]
RADIUS = 22.0


def ball_picture(center: tuple[float, float] | None) -> Picture:
    """A blue disc, or none, before a gray wall with some noise."""
    image = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
    if center is not None:
        spot = round(center[0] * 16), round(center[1] * 16)
        cv2.circle(image, spot, round(RADIUS * 16), (190, 70, 30), cv2.FILLED, cv2.LINE_AA, 4)
    image = cv2.GaussianBlur(image, (0, 0), 0.8).astype(np.uint8)
    noise = np.random.default_rng(0).integers(-3, 4, image.shape)
    return (image.astype(int) + noise).clip(0, 255).astype(np.uint8)
