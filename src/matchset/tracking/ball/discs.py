"""Which circles are the same, and the pixels of a disc's middle: `are_same`, `middle_pixels`."""

import math

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.patch_format import Circle3

Image = npt.NDArray[np.uint8]

SIDE = 14  # format: pixels of a disc's middle along a side, at most


def are_same(first: Circle3, second: Circle3, share: float) -> bool:
    """Say whether two circles are so near to each other that the network is led to the same disc from both."""
    larger, smaller = max(first[2], second[2]), min(first[2], second[2])
    return math.dist(first[:2], second[:2]) < share * larger and larger < (1.0 + share) * smaller


def middle_pixels(image: Image, circle: Circle3, share: float) -> Image:
    """Pixels within a share of a disc's radius, evenly spread, at most some 150; of shape (n, channels)."""
    x, y, radius = circle
    count = int(min(SIDE, max(2.0 * share * radius, 1.0)))
    along = (np.arange(count) + 0.5) * (2.0 / count) - 1.0
    within = along[np.newaxis, :] ** 2 + along[:, np.newaxis] ** 2 <= 1.0
    across = np.broadcast_to(along[np.newaxis, :], within.shape)[within]
    down = np.broadcast_to(along[:, np.newaxis], within.shape)[within]
    columns = np.rint(x + share * radius * across).astype(np.int64)
    rows = np.rint(y + share * radius * down).astype(np.int64)
    height, width = image.shape[:2]
    seen = (columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)
    return np.asarray(image[rows[seen], columns[seen]], np.uint8)
