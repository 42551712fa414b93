"""The picture around a circle along rays from its center, whatever its size and color: `read_patch`.

64 rays are read in 32 places each, from 0.3 to 1.7 radii. A picture of a large circle is reduced before, so that a
place is about a pixel wide. Of each place there are six numbers: its color in CIE Lab, less the median color of the
middle and in units of the spread of all; the log-odds of that color inside the circle against around it, from smoothed
histograms of both; whether it is in the picture; and, of a ball whose colors are known from another picture
(`colors_of`), the log-odds of its color in those against around the circle.
"""

import numpy as np

from matchset.image.disc_network.patch_format import (
    BINS_AB,
    BINS_L,
    COLORS,
    KNOWN_ROUNDS,
    NUMBERS,
    PLACES,
    RADII,
    RAYS,
    Circle3,
    Colors,
    Image,
    Patch,
)
from matchset.image.disc_network.patch_kernel import INSIDE_PLACES, PATCH_MEMORY, read_patch_kernel, read_places_kernel
from matchset.image.frame import channels_last
from matchset.numeric.record import ThreadBlock, fields

NOTHING = np.empty(0, np.float32)  # format: colors known, where none are


_BLOCKS = ThreadBlock(PATCH_MEMORY)


def read_patch(image: Image, circle: Circle3, known: Colors | None = None) -> Patch | None:
    """Read a picture around a circle.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
        BGR or gray.
    circle : (x, y, radius)
        px.
    known : Colors, optional
        Colors of the ball that is looked for, from another picture: see `colors_of`.

    Returns
    -------
    ndarray of shape (64, 32, 6), float32, or None
        By ray, place and number; None where hardly anything of it is in the picture.
    """
    patch = np.empty((RAYS, PLACES, NUMBERS), np.float32)
    colors = NOTHING if known is None else known
    read = read_patch_kernel(channels_last(image), np.array(circle, np.float64), colors, _BLOCKS.numbers, patch)
    return patch if read else None


def colors_of(image: Image, circle: Circle3) -> Colors | None:
    """Shares of the colors inside a circle; None where nothing of that is in the picture. See `read_patch`.

    Returns
    -------
    ndarray of shape (9216,), float32, or None
        By bin of CIE Lab, smoothed.
    """
    if not read_places_kernel(channels_last(image), np.array(circle, np.float64), _BLOCKS.numbers):
        return None
    memory = fields(_BLOCKS.numbers, PATCH_MEMORY)
    which, seen = memory.which[:, :INSIDE_PLACES], memory.seen[:, :INSIDE_PLACES]
    if not seen.any():
        return None
    weights = RADII[:INSIDE_PLACES] * seen
    counts = np.bincount(which.ravel(), weights.ravel(), minlength=COLORS).reshape(BINS_L, BINS_AB, BINS_AB)
    for axis, rounds in enumerate(KNOWN_ROUNDS):
        for _ in range(rounds):
            counts = 0.5 * counts + 0.25 * (np.roll(counts, 1, axis) + np.roll(counts, -1, axis))
    return np.asarray(counts.ravel() / max(float(counts.sum()), 1e-6), np.float32)
