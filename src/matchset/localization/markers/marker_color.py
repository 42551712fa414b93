"""Kernels that find patches of the marker's color on the ball, and learn how the two colors differ."""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.markers.marker_shape import ellipse
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import apply, invert

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Index = np.uintp | int

LEAST_INSIDE, LEAST_OUTSIDE = 1.0, 8.0  # pixels of a marker and of the ball from which something is learned
TEACH_INSIDE, TEACH_OUTSIDE, TEACH_RIM = 0.75, 1.7, 0.9  # radii: of the marker, of the marker, of the ball


@kernel
def _cell(image: Bytes, row: int, column: int) -> int:
    """Color cell of a pixel."""
    if image.shape[2] == 1:
        return int(image[row, column, 0])
    b, g, r = int(image[row, column, 0]), int(image[row, column, 1]), int(image[row, column, 2])
    return (b >> 3) << 10 | (g >> 3) << 5 | r >> 3


@kernel
def look(
    image: Bytes, table: npt.NDArray[np.int8], x: float, y: float, radius: float, step: int, mask: Bytes
) -> tuple[int, int]:
    """Mark the pixels of a color inside a circle, on a grid of every `step`-th pixel.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    table : (32768,) or (256,) int8
        See `ColorModel`.
    x, y, radius : float
        The circle, px.
    step : int
    mask : (n, n) uint8, written
        1 where the mean score over the cell's 3 x 3 pixels is positive.

    Returns
    -------
    tuple of int
        Column and row of the pixel at mask[0, 0].
    """
    left, top = math.floor(x - radius), math.floor(y - radius)
    height, width = image.shape[0], image.shape[1]
    for i in range(mask.shape[0]):
        for j in range(mask.shape[1]):
            row, column = top + i * step, left + j * step
            mask[i, j] = 0
            if (column - x) ** 2 + (row - y) ** 2 > radius * radius:
                continue
            if row < 1 or column < 1 or row >= height - 1 or column >= width - 1:
                continue
            score = 0
            for a in range(row - 1, row + 2):
                for b in range(column - 1, column + 2):
                    score += table[_cell(image, a, b)]
            mask[i, j] = score > 0
    return left, top


@kernel
def _add(b: float, g: float, r: float, first: Index, sums: Floats) -> None:
    """Add a color to the count, the sums and the products of a row of `teach`, which begins at a place in `sums`."""
    sums[first] += 1.0
    sums[first + np.uintp(1)] += b
    sums[first + np.uintp(2)] += g
    sums[first + np.uintp(3)] += r
    sums[first + np.uintp(4)] += b * b
    sums[first + np.uintp(5)] += g * b
    sums[first + np.uintp(6)] += g * g
    sums[first + np.uintp(7)] += r * b
    sums[first + np.uintp(8)] += r * g
    sums[first + np.uintp(9)] += r * r


@kernel
def teach(
    image: Bytes,
    ball: Floats,
    places: Floats,
    count: int,
    size: float,
    depth: float,
    step: int,
    sums: Floats,
) -> None:
    """Sum up colors of markers and of the ball between them: rows of count, 3 means, 6 products.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    ball : (3,)
        x, y, radius, px.
    places : (k, 2)
        Middles of markers, px; the first `count` count.
    count : int
    size, depth : float
        m and k, see `marker_shape.py`.
    step : int
        Every so many-th pixel is read.
    sums : (2, 10), written
        First row: markers; second: ball.
    """
    for place in range(sums.size):
        sums[place // 10, place % 10] = 0.0
    a, reach, both, axes = size * ball[2], TEACH_RIM * ball[2], sums.reshape(-1), np.empty((count, 4))
    inside, outside = (TEACH_INSIDE * a) ** 2, (TEACH_OUTSIDE * a) ** 2
    height, width, channels = image.shape
    flat, left = image.reshape(-1), max(int(ball[0] - reach), 0)
    for marker in range(count):
        ux, uy, ratio = ellipse(places[marker], ball, depth)
        axes[marker, 0], axes[marker, 1], axes[marker, 2], axes[marker, 3] = ux / ratio, uy / ratio, ux, uy
    for row in range(max(int(ball[1] - reach), 0), min(int(ball[1] + reach) + 1, height), step):
        half = math.sqrt(max(reach * reach - (row - ball[1]) ** 2, 0.0))
        first = left + step * max(math.ceil((ball[0] - half - left) / step), 0)
        for column in range(first, min(math.floor(ball[0] + half) + 1, width), step):
            nearest = math.inf
            for marker in range(count):
                k = np.uintp(marker)
                dx, dy = column - places[k, 0], row - places[k, 1]
                along, across = dx * axes[k, 0] + dy * axes[k, 1], dy * axes[k, 2] - dx * axes[k, 3]
                nearest = min(nearest, along * along + across * across)
            if nearest < inside or nearest > outside:
                at = np.uintp((row * width + column) * channels)
                b, g, r = float(flat[at]), 0.0, 0.0
                if channels == 3:
                    g, r = float(flat[at + np.uintp(1)]), float(flat[at + np.uintp(2)])
                _add(b, g, r, np.uintp(0 if nearest < inside else 10), both)


@kernel
def blend(known: Floats, fresh: Floats, memory: float) -> bool:
    """Take what `teach` summed up into what is known: means, of which the last frames count most.

    Parameters
    ----------
    known : (2, 10), written
        Zeros at first.
    fresh : (2, 10)
        Sums.
    memory : float
        Share of what is known that one frame leaves.

    Returns
    -------
    bool
        False where too few pixels were seen; then nothing is written.
    """
    if fresh[0, 0] < LEAST_INSIDE or fresh[1, 0] < LEAST_OUTSIDE:
        return False
    kept = memory if known[0, 0] > 0.0 else 0.0
    for row in range(2):
        for place in range(fresh.shape[1]):
            known[row, place] = kept * known[row, place] + (1.0 - kept) * (fresh[row, place] / fresh[row, 0])
    return True


@kernel
def tell_apart(sums: Floats, axis: Floats, ground: Floats) -> bool:
    """Direction of color that tells marker from ball best: Fisher's linear discriminant.

    Parameters
    ----------
    sums : (2, 10)
        See `teach`, divided by the counts.
    axis, ground : (4,), (3,), written
        See `fit_marker`.

    Returns
    -------
    bool
        False where the two have the same color; then nothing is written.
    """
    within, inverse, gap, direction = np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty(3)
    m, apart, square = 4, 0.0, 0.0
    for c in range(3):
        gap[c] = sums[0, 1 + c] - sums[1, 1 + c]
        for d in range(c + 1):
            within[c, d] = within[d, c] = sums[1, m] - sums[1, 1 + c] * sums[1, 1 + d]
            m += 1
        within[c, c] += 1.0  # gray levels squared: rounding
    if not invert(within, inverse):
        return False
    apply(inverse, gap, direction)
    for c in range(3):
        apart += direction[c] * gap[c]
        square += sums[1, 1 + c] ** 2
    if not apart > 1e-9:
        return False
    axis[3] = 0.0
    for c in range(3):
        axis[c] = direction[c] / apart
        axis[3] -= axis[c] * sums[1, 1 + c]
        ground[c] = sums[1, 1 + c] / max(square, 1e-9)
    return True
