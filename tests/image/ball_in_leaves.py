"""A picture of a ball, for the tests of the network of discs."""

import cv2
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.uint8]
HEIGHT, WIDTH = 240, 320


def scene(radius: float, seed: int = 0) -> Picture:
    """A ball in the middle, before leaves, a board and noise, BGR."""
    rng = np.random.default_rng(seed)
    rows, columns = np.indices((HEIGHT, WIDTH), np.float64)
    image = np.array(cv2.GaussianBlur(rng.normal(0.0, 1.0, (HEIGHT, WIDTH, 3)), (0, 0), 6.0) * 300.0 + 130.0)
    image[:, 200:230] = (60.0, 70.0, 120.0)
    inside = np.hypot(columns - 160.0, rows - 120.0) < radius
    shade = 1.0 - 0.3 * np.clip((rows - 120.0) / radius, -1.0, 1.0)
    image[inside] = (np.array((60.0, 160.0, 90.0)) * shade[..., np.newaxis])[inside]
    soft = cv2.GaussianBlur(image, (0, 0), 1.0) + rng.normal(0.0, 3.0, image.shape)
    return np.asarray(np.clip(soft, 0, 255), np.uint8)
