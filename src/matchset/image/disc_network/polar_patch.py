"""The picture around a circle along rays from its center, whatever its size and color: `read_patch`.

64 rays are read in 32 places each, from 0.3 to 1.7 radii. A picture of a large circle is reduced before, so that a
place is about a pixel wide. Of each place there are six numbers: its color in CIE Lab, less the median color of the
middle and in units of the spread of all; the log-odds of that color inside the circle against around it, from smoothed
histograms of both; whether it is in the picture; and, of a ball whose colors are known from another picture
(`colors_of`), the log-odds of its color in those against around the circle.
"""

import math

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.lab import lab_of

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Patch = npt.NDArray[np.float32]
Colors = npt.NDArray[np.float32]
Circle3 = tuple[float, float, float]

# All of these are a part of what the weights were learned for: training reads its pictures by this file.
RAYS, PLACES, NUMBERS = 64, 32, 6  # format: of a patch
SIZE = 20.0  # format: radius to which larger circles are reduced, px
NEAREST, FARTHEST = 0.3, 1.7  # format: first and last place of a ray, radii
MIDDLE, INSIDE, AROUND = 0.7, 0.85, 1.2  # format: places of the median color and of the two histograms, radii
BINS = np.array((16, 24, 24))  # format: of the histograms, for L, a and b
LAB_LOW = np.array((0.0, -64.0, -64.0), np.float32)  # format: first color of them
LAB_RANGE = np.array((100.0, 128.0, 128.0), np.float32)  # format: what they span
PER_UNIT = (BINS / LAB_RANGE).astype(np.float32)  # format: bins for each unit of CIE Lab
LAST = (BINS - 1).astype(np.float32)  # format: last bin of each
FLOOR, MOST = 5e-4, 4.0  # format: share added to each color, and the log-odds that count as 1
LAB_UNIT, LEAST_SPREAD, SPREAD = 0.02, 0.08, 0.7  # format: of the colors
ROOM = 1.8  # geometry: how far the picture is cut out around the circle, radii
LEAST_SIDE = 4  # format: of that, px

ANGLES = 2.0 * np.pi * np.arange(RAYS) / RAYS  # geometry: of the rays, rad
DIRECTIONS = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
RADII = np.linspace(NEAREST, FARTHEST, PLACES)


def _ring_blur(count: int) -> Patch:
    """Matrix that gives each number of a ring half of its own and a quarter of each of its neighbors'."""
    own = np.eye(count, dtype=np.float32)
    return 0.5 * own + 0.25 * (np.roll(own, 1, axis=0) + np.roll(own, -1, axis=0))


BLURS = tuple(_ring_blur(int(count)) for count in BINS)  # theorem: of the histograms, along L, a and b
KNOWN_ROUNDS = 4, 2, 2  # format: how often colors from another picture are blurred so, since its light was another
KNOWN_BLURS = tuple(np.linalg.matrix_power(blur, n) for blur, n in zip(BLURS, KNOWN_ROUNDS, strict=True))


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
    read = _read(image, circle)
    if read is None:
        return None
    colors, seen = read
    patch = np.empty((RAYS, PLACES, NUMBERS), np.float32)
    patch[..., :3] = _normalized(colors * np.float32(LAB_UNIT))
    patch[..., 3], patch[..., 5] = _log_odds(colors, seen, known)
    patch[..., 4] = seen
    return patch


def colors_of(image: Image, circle: Circle3) -> Colors | None:
    """Shares of the colors inside a circle; None where nothing of that is in the picture.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
        BGR or gray.
    circle : (x, y, radius)
        px.

    Returns
    -------
    ndarray of shape (9216,), float32, or None
        By bin of CIE Lab, smoothed.
    """
    read = _read(image, circle)
    if read is None:
        return None
    colors, seen = read
    part = RADII < INSIDE
    if not seen[:, part].any():
        return None
    counts = _counts(_bins(colors)[:, part], (RADII * seen)[:, part])
    return np.asarray(_smoothed(counts[np.newaxis], KNOWN_BLURS)[0])


def _read(image: Image, circle: Circle3) -> tuple[Patch, npt.NDArray[np.bool_]] | None:
    """Color of each place, CIE Lab, and whether it is in the picture; None where hardly anything is."""
    x, y, radius = circle
    height, width = image.shape[:2]
    left, top = (max(math.floor(center - ROOM * radius) - 2, 0) for center in (x, y))
    right, bottom = min(math.ceil(x + ROOM * radius) + 3, width), min(math.ceil(y + ROOM * radius) + 3, height)
    if right - left < LEAST_SIDE or bottom - top < LEAST_SIDE:
        return None
    cut, scales = _reduced(image[top:bottom, left:right], min(SIZE / radius, 1.0))
    columns, rows = (center + radius * RADII * DIRECTIONS[:, k, np.newaxis] for k, center in enumerate((x, y)))
    seen = (columns >= 0.0) & (columns <= width - 1.0) & (rows >= 0.0) & (rows <= height - 1.0)
    across, down = (
        ((at - start + 0.5) * scale - 0.5).astype(np.float32)
        for at, start, scale in ((columns, left, scales[0]), (rows, top, scales[1]))
    )
    read = cv2.remap(lab_of(cut), across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(read, np.float32), seen


def _reduced(cut: Image, scale: float) -> tuple[Image, tuple[float, float]]:
    """Reduce a part of a picture; with the scales along both axes that came of it."""
    if scale >= 1.0:
        return cut, (1.0, 1.0)
    height, width = cut.shape[:2]
    columns, rows = max(round(scale * width), 2), max(round(scale * height), 2)
    small = np.asarray(cv2.resize(cut, (columns, rows), interpolation=cv2.INTER_AREA), np.uint8)
    return small, (columns / width, rows / height)


def _normalized(colors: Patch) -> Patch:
    """Colors less the median of the middle, in units of the spread of all."""
    middle = np.median(colors[:, RADII < MIDDLE].reshape(-1, 3), axis=0)
    apart = colors - middle
    return np.asarray(apart * (SPREAD / max(math.sqrt(float(np.mean(apart**2))), LEAST_SPREAD)), np.float32)


def _log_odds(colors: Patch, seen: npt.NDArray[np.bool_], known: Colors | None) -> tuple[Patch, Patch]:
    """Log-odds of each place's color against around: inside, and in the colors known, 0 without; -1 ... 1."""
    which, weights = _bins(colors), RADII * seen
    parts = np.stack([_counts(which[:, part], weights[:, part]) for part in (RADII < INSIDE, RADII > AROUND)])
    inside, around = (shares[which] + np.float32(FLOOR) for shares in _smoothed(parts))
    here = np.clip(np.log(inside / around) / np.float32(MOST), -1.0, 1.0)
    if known is None:
        return here, np.zeros_like(here)
    return here, np.clip(np.log((known[which] + np.float32(FLOOR)) / around) / np.float32(MOST), -1.0, 1.0)


def _bins(colors: Patch) -> npt.NDArray[np.int32]:
    """Bin of each color in the histograms."""
    bins = np.clip((colors - LAB_LOW) * PER_UNIT, np.float32(0.0), LAST).astype(np.int32)
    return np.asarray((bins[..., 0] * BINS[1] + bins[..., 1]) * BINS[2] + bins[..., 2], np.int32)


def _counts(which: npt.NDArray[np.int32], weights: Floats) -> Patch:
    """How much of each color there is, by the area of its places."""
    return np.bincount(which.ravel(), weights.ravel(), minlength=int(np.prod(BINS))).astype(np.float32)


def _smoothed(counts: Patch, blurs: tuple[Patch, ...] = BLURS) -> Patch:
    """Shares of colors, shape (n, colors), blurred by a matrix along each of L, a and b, as if these were rings."""
    along_l, along_a, along_b = blurs
    blurred = along_a @ counts.reshape(-1, *BINS) @ along_b
    blurred = along_l @ blurred.reshape(len(counts), BINS[0], -1)
    shares = blurred.reshape(len(counts), -1)
    return np.asarray(shares / np.maximum(shares.sum(axis=1, keepdims=True), 1e-6), np.float32)
