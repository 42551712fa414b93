"""Pictures of a shaded ball that something may hide in part: for the tests of the network's outlines."""

import cv2
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.uint8]


def picture(x: float, hidden: float = 0.0, seed: int = 0) -> Picture:
    """A green ball before a wall; what hides it from the left up to so many px from its center has sharper edges."""
    rows, columns = np.indices((180, 320), np.float64)
    away = np.hypot(columns - x, rows - 90.0)
    share = np.clip(26.0 - away + 0.5, 0.0, 1.0)[..., np.newaxis]
    shade = (1.0 - 0.35 * np.clip((rows - 90.0) / 26.0, -1.0, 1.0))[..., np.newaxis]
    wall, green = np.full((180, 320, 3), (150.0, 155.0, 165.0)), np.array((80.0, 150.0, 90.0))
    image = np.array(cv2.GaussianBlur(wall * (1.0 - share) + green * shade * share, (0, 0), 1.5), np.float64)
    if hidden:
        image[(columns < x - hidden) & (np.abs(rows - 95.0) < 22.0)] = (90.0, 120.0, 190.0)
    return np.asarray(np.clip(image + np.random.default_rng(seed).normal(0.0, 3.0, image.shape), 0, 255), np.uint8)
