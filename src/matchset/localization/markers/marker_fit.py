"""Kernels that place a marker on the ball to a fraction of a pixel.

All pixels near it are compared with the ellipse that it must show there, softened by the blur of the picture and shaded
as the ball is around it, along the one direction of color that tells marker from ball: ``s = level + height * light *
softened ellipse``. Blur that is the same on all sides moves nothing; highlights count little.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.markers.marker_patch import KINDS, LIGHT, VALUE, WEIGHT, X, Y, gather, lay_out, shading
from matchset.localization.markers.marker_shape import coverage, ellipse
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

ROUNDS = 8
AROUND = 0.5  # how far beyond the rim pixels are compared, in radii of the marker, and
MARGIN = 3.0  # px more
SHADED = 1.0  # how much farther the ball's shading is looked at, in radii of the marker
ENOUGH = 0.05  # px: a smaller step is the last
TIED = 0.8  # largest correlation of neighbors on a line
MOST_DOWN = 0.8  # the same between lines, as it is believed

BLOCK = 512  # pixels that are worked on at a time, so that what is known of them stays in the cache
WIDTH = BLOCK + 1  # numbers of each kind: that of the pixel before the block comes first
# Where each kind begins: the weight, 1 for a pixel that counts, what the model leaves of it, and how the model changes
# with x, y and the height.
W0, W1, W2, W3, W4, W5 = (np.uintp(k * WIDTH) for k in range(6))
BEFORE = np.uintp(1)
ZERO, ONE = np.float32(0.0), np.float32(1.0)
# places in `sums`: the sums of products of x, y, height, level and what is left, row by row up to the diagonal: those
# with what is left begin at LEFT, its squares are at MISFIT
LEFT, MISFIT = 10, 14
# and after them the sums of weights, values, their squares and what is left, and what neighbors have in common
WEIGHTS, VALUES, SQUARES, REST, ALONG, DOWN, SUMS = range(15, 22)


@kernel(refcount=False, reassociate=True)
def _expect(
    pixels: tuple[Singles, Singles, Singles, Singles, Singles],
    window: Floats,
    reach: float,
    soft: float,
    model: Floats,
    work: Singles,
    sums: Floats,
) -> None:
    """Compare the pixels of a block with what is expected there."""
    values, lights, weights, xs, ys = pixels
    x0, y0, ux, uy = np.float32(window[0]), np.float32(window[1]), np.float32(window[2]), np.float32(window[3])
    ratio, a, blur = np.float32(window[4]), np.float32(window[5]), np.float32(soft)
    height, level, farthest = np.float32(model[0]), np.float32(model[1]), np.float32(reach * reach)
    total = mean = power = rest = ZERO
    for place in range(values.shape[0]):
        p = np.uintp(place)
        k = p + BEFORE
        dx, dy = xs[p] - x0, ys[p] - y0
        cover, right, under = coverage(dx, dy, ux, uy, a, ratio, blur)
        counts = np.float32((dx * dx + dy * dy <= farthest) & (weights[p] > ZERO))
        weight, s, lit = weights[p] * counts, values[p], lights[p] * counts
        e = (s - level) * counts - height * lit * cover
        work[k], work[k + W1], work[k + W2] = weight, counts, e
        work[k + W3], work[k + W4], work[k + W5] = height * lit * right, height * lit * under, lit * cover
        total, mean, power, rest = total + weight, mean + weight * s, power + weight * s * s, rest + weight * e * e
    sums[WEIGHTS] += total
    sums[VALUES] += mean
    sums[SQUARES] += power
    sums[REST] += rest


@kernel(refcount=False, reassociate=True)
def _add(work: Singles, tie: float, fresh: Singles, weighted: Singles, sums: Floats) -> None:
    """Add a block to the normal equations.

    Noise that has been through a filter is alike in neighbors on a line: of every pixel `tie` times its left neighbor
    is taken away, in the picture and in the model, which leaves it independent.
    """
    past, alone = np.float32(tie), np.float32(math.sqrt(1.0 - tie * tie))
    joined = ONE - alone
    xx = xy = yy = xc = yc = cc = xl = yl = cl = ll = xf = yf = cf = lf = ff = along = ZERO
    for place in range(fresh.shape[0]):
        p = np.uintp(place)
        k = p + BEFORE
        weight, here, before = work[k], alone + joined * work[p + W1], work[p + W2]
        f = here * work[k + W2] - past * before
        x, y = here * work[k + W3] - past * work[p + W3], here * work[k + W4] - past * work[p + W4]
        c, one = here * work[k + W5] - past * work[p + W5], here - past * work[p + W1]
        wx, wy, wc, wl, wf = weight * x, weight * y, weight * c, weight * one, weight * f
        xx, xy, yy, xc, yc = xx + wx * x, xy + wx * y, yy + wy * y, xc + wx * c, yc + wy * c
        cc, xl, yl, cl, ll = cc + wc * c, xl + wx * one, yl + wy * one, cl + wc * one, ll + wl * one
        xf, yf, cf, lf, ff = xf + wx * f, yf + wy * f, cf + wc * f, lf + wl * f, ff + wf * f
        along += weight * work[k + W2] * before
        fresh[p], weighted[p] = f * work[k + W1], wf
    new = xx, xy, yy, xc, yc, cc, xl, yl, cl, ll, xf, yf, cf, lf, ff
    for place in range(WEIGHTS):
        sums[place] += new[place]
    sums[ALONG] += along


@kernel(refcount=False, reassociate=True)
def _down(fresh: Singles, weighted: Singles) -> float:
    """How much alike what is left is on neighboring lines."""
    total = ZERO
    for place in range(fresh.shape[0]):
        total += fresh[np.uintp(place)] * weighted[np.uintp(place)]
    return float(total)


@kernel
def _compare(
    pixels: Singles,
    stride: int,
    window: Floats,
    reach: float,
    soft: float,
    model: Floats,
    tie: float,
    work: Singles,
    left: tuple[Singles, Singles],
    sums: Floats,
) -> None:
    """Sum up the normal equations of one Gauss-Newton step, and what tells how good the fit is."""
    fresh, weighted = left
    count = fresh.shape[0]
    for k in range(sums.shape[0]):
        sums[k] = 0.0
    for k in range(6):
        work[k * WIDTH] = ZERO
    for begin in range(0, count, BLOCK):
        end = min(begin + BLOCK, count)
        rows = (
            pixels[VALUE, begin:end],
            pixels[LIGHT, begin:end],
            pixels[WEIGHT, begin:end],
            pixels[X, begin:end],
            pixels[Y, begin:end],
        )
        _expect(rows, window, reach, soft, model, work, sums)
        _add(work, tie, fresh[begin:end], weighted[begin:end], sums)
        for k in range(6):
            work[k * WIDTH] = work[k * WIDTH + end - begin]
    sums[DOWN] = _down(fresh[: count - stride], weighted[stride:])


@kernel
def _invert(n: Floats, inverse: Floats) -> bool:
    """Inverse of a symmetric positive matrix by Gauss and Jordan, which destroys it; False if it has none."""
    size = n.shape[0]
    for p in range(size):
        for q in range(size):
            inverse[p, q] = 1.0 if p == q else 0.0
    for p in range(size):
        if not n[p, p] > 0.0:
            return False
        unit = 1.0 / n[p, p]
        for q in range(size):
            n[p, q] *= unit
            inverse[p, q] *= unit
        for r in range(size):
            share = n[r, p]
            if r != p and share != 0.0:
                for q in range(size):
                    n[r, q] -= share * n[p, q]
                    inverse[r, q] -= share * inverse[p, q]
    return True


@kernel
def _step(sums: Floats, n: Floats, inverse: Floats, step: Floats) -> bool:
    """Solve the normal equations for x, y, height and level; False where they have no solution."""
    place = 0
    for p in range(4):
        for q in range(p + 1):
            n[p, q] = n[q, p] = sums[place]
            place += 1
        n[p, p] += 1e-9 * sums[WEIGHTS]
    if not _invert(n, inverse):
        return False
    for p in range(4):
        step[p] = 0.0
        for q in range(4):
            step[p] += inverse[p, q] * sums[LEFT + q]
    return True


@kernel
def _noise(sums: Floats, inverse: Floats, covariance: Floats) -> float:
    """Write the covariance of the place; returns the variance of what is left."""
    variance = sums[MISFIT] / sums[WEIGHTS]
    down = min(max(sums[DOWN] / max(sums[MISFIT], 1e-12), 0.0), MOST_DOWN)
    grain = (1.0 + down) / (1.0 - down)
    for p in range(2):
        for q in range(2):
            covariance[p, q] = grain * variance * inverse[p, q]
    return float(variance)


@kernel
def fit_marker(
    image: Bytes,
    ball: Floats,
    places: Floats,
    which: int,
    size: float,
    depth: float,
    soft: float,
    axis: Floats,
    ground: Floats,
    tied: Floats,
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
    which : int
    size, depth : float
        m and k, see `marker_shape.py`.
    soft : float
        Softness of the rim, px.
    axis : (4,)
        Direction of color, per gray level, and offset: 0 on the ball, 1 on a marker.
    ground : (3,)
        Color of the ball: along it brightness is measured.
    tied : (1,), written
        Correlation of the noise of neighbors on a line, as it was in the last fit; 0 where that is not known.
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
    n, inverse, step, sums = np.empty((4, 4)), np.empty((4, 4)), np.empty(4), np.empty(SUMS)
    shade, window, model = np.zeros(3), np.zeros(6), np.array((1.0, 0.0))
    result, least = (0.0, 0.0, 0.0), 0 if tied[0] > 0.0 else 1
    span = 2 * int(reach + MARGIN) + 1
    count, left, top = span * (span + 1), 0, 0
    pixels, work = np.zeros((KINDS, count), np.float32), np.empty(6 * WIDTH, np.float32)
    rest = np.empty(count, np.float32), np.empty(count, np.float32)
    lay_out(span, pixels)
    for turn in range(ROUNDS):
        window[0], window[1], window[5] = place[0], place[1], a
        window[2], window[3], window[4] = ellipse(place, ball, depth)
        if turn == 0 or abs(place[0] - left - span // 2) + abs(place[1] - top - span // 2) > MARGIN:
            left, top = math.floor(place[0] + 0.5) - span // 2, math.floor(place[1] + 0.5) - span // 2
            shading(image, ball, window, reach + SHADED * a, ground, shade)
            gather(image, ball, places, which, left, top, axis, ground, shade, pixels)
        window[0], window[1] = place[0] - left, place[1] - top
        _compare(pixels, span + 1, window, reach, soft, model, tied[0], work, rest, sums)
        if sums[WEIGHTS] < 12.0 or not _step(sums, n, inverse, step):
            return 0.0, 0.0, 0.0
        variance = _noise(sums, inverse, covariance)
        spread = sums[SQUARES] - sums[VALUES] * sums[VALUES] / sums[WEIGHTS]
        result = (model[0], math.sqrt(variance), 1.0 - sums[REST] / max(spread, 1e-12))
        if turn < 2:
            tied[0] = min(max(sums[ALONG] / max(sums[REST], 1e-12), 0.0), TIED)
        longest = max(abs(step[0]), abs(step[1]))
        shrink = min(1.0, 0.5 * a / longest) if longest > 0.0 else 1.0
        place[0] += shrink * step[0]
        place[1] += shrink * step[1]
        model[0] += step[2]
        model[1] += step[3]
        near = abs(place[0] - ball[0]) < radius and abs(place[1] - ball[1]) < radius
        if not (near and model[0] > 0.05):
            return 0.0, 0.0, 0.0
        if turn > least and longest < ENOUGH:
            break
    return result
