"""Kernels that find a marker on the ball and place it to a fraction of a pixel.

A marker is a patch of the sphere: at offset o from the middle of the ball (radius r, in the picture) its rim is an
ellipse with semi-axes ``a = r m`` across and ``a sqrt(1 - |o|^2 / (r k)^2)`` along o; m and k are the radius of the patch
and the distance of its rim's middle from the ball's center, in ball radii. All pixels near it are compared with that
ellipse, softened by the blur of the picture, along the one direction of color that tells marker from ball:
``s = level + height * softened ellipse``. Blur that is the same on all sides moves nothing.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

ROUNDS = 8
AROUND = 0.5  # how far beyond the rim pixels are compared, in radii of the marker, and
MARGIN = 3.0  # px more
SHADED = 1.0  # how much farther the ball's shading is looked at, in radii of the marker
GLINT = 1.15  # brightness, in that of the ball around, from which a pixel is taken for a highlight
THIN = 16.0  # px of reach for each of which one pixel in a row more is left out there
ENOUGH = 0.05  # px: a smaller step is the last
TIED = 0.8  # largest correlation of neighbors on a line
STILL = 20.0  # weight that holds the shading flat where few pixels tell, px^2
LIMB = 0.5  # px inside the ball's outline from which pixels count, fully from
FULL = 3.5
EDGE_ON = 0.25  # least ratio of the ellipse's axes that is drawn
TEACH_INSIDE, TEACH_OUTSIDE, TEACH_RIM = 0.75, 1.7, 0.9


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
    left, top = int(math.floor(x - radius)), int(math.floor(y - radius))
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
def _ellipse(place: Floats, ball: Floats, size: float, depth: float) -> tuple[float, float, float]:
    """Direction of the short axis and the ratio of the axes for a marker at (x, y)."""
    ox, oy = place[0] - ball[0], place[1] - ball[1]
    far = math.sqrt(ox * ox + oy * oy)
    share = far / (ball[2] * depth)
    ratio = math.sqrt(max(1.0 - share * share, EDGE_ON * EDGE_ON))
    if far < 1e-6:
        return 1.0, 0.0, ratio
    return ox / far, oy / far, ratio


@kernel
def _coverage(
    dx: float, dy: float, ux: float, uy: float, a: float, ratio: float, soft: float
) -> tuple[float, float, float]:
    """Softened ellipse at (dx, dy) from its middle: share of marker, and how that grows as the ellipse moves."""
    along, across = (dx * ux + dy * uy) / ratio, dy * ux - dx * uy
    far = math.sqrt(along * along + across * across)
    if far < 1e-9:
        return 1.0, 0.0, 0.0
    nx, ny = (along * ux / ratio - across * uy) / far, (along * uy / ratio + across * ux) / far
    slope = math.sqrt(nx * nx + ny * ny)
    z = (a - far) / (slope * soft)
    if z * z > 36.0:
        return (1.0 if z > 0.0 else 0.0), 0.0, 0.0
    share = 1.0 / (1.0 + math.exp(-z))
    steep = share * (1.0 - share) / (soft * slope)
    return share, steep * nx, steep * ny


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
        m and k of the file's docstring.
    step : int
        Every so many-th pixel is read.
    sums : (2, 10), written
        First row: markers; second: ball.
    """
    sums[:] = 0.0
    a, reach = size * ball[2], TEACH_RIM * ball[2]
    value = np.zeros(3)
    for row in range(max(int(ball[1] - reach), 0), min(int(ball[1] + reach) + 1, image.shape[0]), step):
        for column in range(max(int(ball[0] - reach), 0), min(int(ball[0] + reach) + 1, image.shape[1]), step):
            if (column - ball[0]) ** 2 + (row - ball[1]) ** 2 > reach * reach:
                continue
            nearest = math.inf
            for k in range(count):
                ux, uy, ratio = _ellipse(places[k], ball, size, depth)
                dx, dy = column - places[k, 0], row - places[k, 1]
                along, across = (dx * ux + dy * uy) / ratio, dy * ux - dx * uy
                nearest = min(nearest, math.sqrt(along * along + across * across) / a)
            kind = 0 if nearest < TEACH_INSIDE else 1 if nearest > TEACH_OUTSIDE else 2
            if kind == 2:
                continue
            for c in range(image.shape[2]):
                value[c] = image[row, column, c]
            sums[kind, 0] += 1.0
            m = 4
            for c in range(3):
                sums[kind, 1 + c] += value[c]
                for d in range(c + 1):
                    sums[kind, m] += value[c] * value[d]
                    m += 1


@kernel
def _brightness(image: Bytes, row: int, column: int, ground: Floats) -> float:
    """Brightness of a pixel along the color of the ball."""
    value = 0.0
    for c in range(image.shape[2]):
        value += ground[c] * image[row, column, c]
    return value


@kernel
def _shading(image: Bytes, ball: Floats, window: Floats, reach: float, ground: Floats, shade: Floats) -> None:
    """Brightness of the ball around a marker: a plane (at the marker, per px right, per px down), highlights left out."""
    x0, y0, ux, uy, ratio, a = window[0], window[1], window[2], window[3], window[4], window[5]
    n, b = np.zeros((3, 3)), np.zeros(3)
    edge = ball[2] - FULL
    shade[0], shade[1], shade[2] = 0.0, 0.0, 0.0
    thin = 1 + int(reach / THIN)
    for turn in range(2):
        n[:], b[:] = 0.0, 0.0
        for row in range(max(int(y0 - reach), 0), min(int(y0 + reach) + 1, image.shape[0]), thin):
            for column in range(max(int(x0 - reach), 0), min(int(x0 + reach) + 1, image.shape[1]), thin):
                dx, dy = column - x0, row - y0
                along, across = (dx * ux + dy * uy) / ratio, dy * ux - dx * uy
                if along * along + across * across < (a + 3.0) ** 2 or dx * dx + dy * dy > reach * reach:
                    continue
                if (column - ball[0]) ** 2 + (row - ball[1]) ** 2 > edge * edge:
                    continue
                value = _brightness(image, row, column, ground)
                if turn > 0 and value > GLINT * (shade[0] + shade[1] * dx + shade[2] * dy):
                    continue
                n[0, 0] += 1.0
                n[1, 0] += dx
                n[2, 0] += dy
                n[1, 1] += dx * dx
                n[2, 1] += dx * dy
                n[2, 2] += dy * dy
                b[0] += value
                b[1] += value * dx
                b[2] += value * dy
        if n[0, 0] < 20.0:
            return
        n[1, 1], n[2, 2] = n[1, 1] + STILL, n[2, 2] + STILL
        n[0, 1], n[0, 2], n[1, 2] = n[1, 0], n[2, 0], n[2, 1]
        shade[:] = np.linalg.solve(n, b)
    most = 0.5 * max(shade[0], 0.0) / reach
    shade[1], shade[2] = min(max(shade[1], -most), most), min(max(shade[2], -most), most)


@kernel
def _compare(
    image: Bytes,
    ball: Floats,
    places: Floats,
    count: int,
    which: int,
    window: Floats,
    reach: float,
    soft: float,
    axis: Floats,
    ground: Floats,
    shade: Floats,
    model: Floats,
    tie: float,
    n: Floats,
    b: Floats,
    sums: Floats,
) -> None:
    """Sum up the normal equations of one Gauss-Newton step, and what tells how good the fit is.

    Noise that has been through a filter is alike in neighbors on a line: of every pixel `tie` times its left neighbor
    is taken away, in the picture and in the model, which leaves it independent.
    """
    n[:], b[:], sums[:] = 0.0, 0.0, 0.0
    old, alone = np.zeros(4), math.sqrt(1.0 - tie * tie)
    x0, y0, ux, uy, ratio, a = window[0], window[1], window[2], window[3], window[4], window[5]
    height, level, radius, j, g = model[0], model[1], ball[2], np.empty(4), np.empty(4)
    first, last = max(int(x0 - reach), 0), min(int(x0 + reach) + 1, image.shape[1])
    above = np.zeros(max(last - first, 1))
    for row in range(max(int(y0 - reach), 0), min(int(y0 + reach) + 1, image.shape[0])):
        before, joined = 0.0, False
        for column in range(first, last):
            dx, dy = column - x0, row - y0
            mine = dx * dx + dy * dy
            inside = radius - math.sqrt((column - ball[0]) ** 2 + (row - ball[1]) ** 2)
            weight = min((inside - LIMB) / (FULL - LIMB), 1.0) if mine < reach * reach else 0.0
            for k in range(count):
                if k != which and (column - places[k, 0]) ** 2 + (row - places[k, 1]) ** 2 < mine:
                    weight = 0.0
            if weight <= 0.0:
                above[column - first], joined = 0.0, False
                continue
            s, light = axis[3], 1.0
            for c in range(image.shape[2]):
                s += axis[c] * image[row, column, c]
            if shade[0] > 0.0:
                light = 1.0 + (shade[1] * dx + shade[2] * dy) / shade[0]
                glint = _brightness(image, row, column, ground) / (shade[0] * light)
                weight *= min(max((2.0 * GLINT - 1.0 - glint) / (GLINT - 1.0), 0.0), 1.0)
            bright = height * light
            cover, right, down = _coverage(dx, dy, ux, uy, a, ratio, soft)
            j[0], j[1], j[2], j[3] = bright * right, bright * down, cover * bright / height, 1.0
            e = s - level - bright * cover
            fresh = e - tie * before if joined else alone * e
            for p in range(4):
                g[p] = j[p] - tie * old[p] if joined else alone * j[p]
                old[p] = j[p]
            for p in range(4):
                b[p] += weight * g[p] * fresh
                for q in range(p + 1):
                    n[p, q] += weight * g[p] * g[q]
            sums[0] += weight
            sums[1] += weight * fresh * fresh
            sums[2] += weight * s
            sums[3] += weight * s * s
            sums[4] += weight * e * e
            sums[5] += weight * e * before if joined else 0.0
            sums[6] += weight * fresh * above[column - first]
            above[column - first], before, joined = fresh, e, True


@kernel
def fit_marker(
    image: Bytes,
    ball: Floats,
    places: Floats,
    count: int,
    which: int,
    size: float,
    depth: float,
    soft: float,
    axis: Floats,
    ground: Floats,
    covariance: Floats,
) -> tuple[float, float, float]:
    """Place one marker: Gauss-Newton for x, y, height and level, from where it is believed to be.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    ball : (3,)
        x, y, radius, px.
    places : (k, 2)
        Middles of the markers, px; row `which` is written, the others are kept out of the way.
    count, which : int
    size, depth : float
        m and k of the file's docstring.
    soft : float
        Softness of the rim, px.
    axis : (4,)
        Direction of color, per gray level, and offset: 0 on the ball, 1 on a marker.
    ground : (3,)
        Color of the ball: along it brightness is measured.
    covariance : (2, 2), written
        px^2.

    Returns
    -------
    height : float
        Contrast of the marker, of 1; 0 where there was nothing to fit.
    noise : float
        Standard deviation of what is left, of 1.
    explained : float
        Share of the variance that the marker explains.
    """
    place, a, radius = places[which], size * ball[2], ball[2]
    reach = (1.0 + AROUND) * a + MARGIN
    n, b, sums = np.zeros((4, 4)), np.zeros(4), np.zeros(7)
    shade, window, model = np.zeros(3), np.zeros(6), np.array((1.0, 0.0))
    result, tie = (0.0, 0.0, 0.0), 0.0
    for turn in range(ROUNDS):
        window[0], window[1], window[5] = place[0], place[1], a
        window[2], window[3], window[4] = _ellipse(place, ball, size, depth)
        if turn == 0:
            _shading(image, ball, window, reach + SHADED * a, ground, shade)
        _compare(image, ball, places, count, which, window, reach, soft, axis, ground, shade, model, tie, n, b, sums)
        if sums[0] < 12.0:
            return 0.0, 0.0, 0.0
        for p in range(4):
            n[p, p] += 1e-9 * sums[0]
            for q in range(p):
                n[q, p] = n[p, q]
        inverse = np.linalg.inv(n)
        variance = sums[1] / sums[0]
        down = min(max(sums[6] / max(sums[1], 1e-12), 0.0), 0.8)
        grain = (1.0 + down) / (1.0 - down)
        spread = sums[3] - sums[2] * sums[2] / sums[0]
        result = (model[0], math.sqrt(variance), 1.0 - sums[4] / max(spread, 1e-12))
        if turn < 2:
            tie = min(max(sums[5] / max(sums[4], 1e-12), 0.0), TIED)
        for p in range(2):
            for q in range(2):
                covariance[p, q] = grain * variance * inverse[p, q]
        step = inverse @ b
        longest = max(abs(step[0]), abs(step[1]))
        shrink = min(1.0, 0.5 * a / longest) if longest > 0.0 else 1.0
        place[0] += shrink * step[0]
        place[1] += shrink * step[1]
        model[0] += step[2]
        model[1] += step[3]
        near = abs(place[0] - ball[0]) < radius and abs(place[1] - ball[1]) < radius
        if not (near and model[0] > 0.05):
            return 0.0, 0.0, 0.0
        if turn > 1 and longest < ENOUGH:
            break
    return result
