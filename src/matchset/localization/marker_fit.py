"""Kernels that place a marker on the ball to a fraction of a pixel.

All pixels near it are compared with the ellipse that it must show there, softened by the blur of the picture and shaded
as the ball is around it, along the one direction of color that tells marker from ball: ``s = level + height * light *
softened ellipse``. Blur that is the same on all sides moves nothing; highlights count little.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.marker_shape import coverage, ellipse
from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

ROUNDS = 8
AROUND = 0.5  # how far beyond the rim pixels are compared, in radii of the marker, and
MARGIN = 3.0  # px more
SHADED = 1.0  # how much farther the ball's shading is looked at, in radii of the marker
GLINT = 1.15  # brightness, in that of the ball around, from which a pixel is taken for a highlight
THIN = 10.0  # px of reach for each of which one pixel in a row more is left out there
ENOUGH = 0.05  # px: a smaller step is the last
TIED = 0.8  # largest correlation of neighbors on a line
STILL = 20.0  # weight that holds the shading flat where few pixels tell, px^2
LIMB = 0.5  # px inside the ball's outline from which pixels count, fully from
FULL = 3.5


@kernel
def _shading(image: Bytes, ball: Floats, window: Floats, reach: float, ground: Floats, shade: Floats) -> None:
    """Brightness of the ball around a marker, a plane without highlights: there, and per px right and down."""
    x0, y0, ux, uy, ratio, a = window[0], window[1], window[2], window[3], window[4], window[5]
    edge, inner, outer = (ball[2] - FULL) ** 2, (a + 3.0) ** 2, reach * reach
    shade[0], shade[1], shade[2] = 0.0, 0.0, 0.0
    thin = 1 + int(reach / THIN)
    n, b = np.empty((3, 3)), np.empty(3)
    for turn in range(2):
        count = sx = sy = sxx = sxy = syy = t = tx = ty = 0.0  # numbers, not arrays: they stay in registers
        for row in range(max(int(y0 - reach), 0), min(int(y0 + reach) + 1, image.shape[0]), thin):
            for column in range(max(int(x0 - reach), 0), min(int(x0 + reach) + 1, image.shape[1]), thin):
                dx, dy = column - x0, row - y0
                along, across = (dx * ux + dy * uy) / ratio, dy * ux - dx * uy
                if along * along + across * across < inner or dx * dx + dy * dy > outer:
                    continue
                if (column - ball[0]) ** 2 + (row - ball[1]) ** 2 > edge:
                    continue
                value = 0.0
                for c in range(image.shape[2]):
                    value += ground[c] * image[row, column, c]
                if turn > 0 and value > GLINT * (shade[0] + shade[1] * dx + shade[2] * dy):
                    continue
                count, sx, sy = count + 1.0, sx + dx, sy + dy
                sxx, sxy, syy = sxx + dx * dx, sxy + dx * dy, syy + dy * dy
                t, tx, ty = t + value, tx + value * dx, ty + value * dy
        if count < 20.0:
            return
        n[0, 0], n[0, 1], n[0, 2] = count, sx, sy
        n[1, 0], n[1, 1], n[1, 2] = sx, sxx + STILL, sxy
        n[2, 0], n[2, 1], n[2, 2] = sy, sxy, syy + STILL
        b[0], b[1], b[2] = t, tx, ty
        shade[:] = np.linalg.solve(n, b)
    most = 0.5 * max(shade[0], 0.0) / reach
    shade[1], shade[2] = min(max(shade[1], -most), most), min(max(shade[2], -most), most)


@kernel
def _gather(
    image: Bytes,
    ball: Floats,
    places: Floats,
    count: int,
    which: int,
    left: int,
    top: int,
    axis: Floats,
    ground: Floats,
    shade: Floats,
    values: Floats,
) -> None:
    """Read the pixels around a marker: how much of it is in them, the light there, and the weight they have."""
    x0, y0, farthest = places[which, 0], places[which, 1], (0.5 * values.shape[0]) ** 2
    whole = max(ball[2] - FULL, 0.0) ** 2
    for i in range(values.shape[0]):
        for j in range(values.shape[1]):
            row, column = top + i, left + j
            values[i, j, 2] = 0.0
            dx, dy = column - x0, row - y0
            if row < 0 or column < 0 or row >= image.shape[0] or column >= image.shape[1]:
                continue
            if dx * dx + dy * dy > farthest:
                continue
            far = (column - ball[0]) ** 2 + (row - ball[1]) ** 2
            weight = 1.0 if far < whole else (ball[2] - math.sqrt(far) - LIMB) / (FULL - LIMB)
            for k in range(count):
                if k != which and (column - places[k, 0]) ** 2 + (row - places[k, 1]) ** 2 < dx * dx + dy * dy:
                    weight = 0.0
            if weight <= 0.0:
                continue
            s, bright, light = axis[3], 0.0, 1.0
            for c in range(image.shape[2]):
                value = float(image[row, column, c])
                s += axis[c] * value
                bright += ground[c] * value
            if shade[0] > 0.0:
                light = 1.0 + (shade[1] * dx + shade[2] * dy) / shade[0]
                glint = bright / (shade[0] * light)
                weight *= min(max((2.0 * GLINT - 1.0 - glint) / (GLINT - 1.0), 0.0), 1.0)
            values[i, j, 0], values[i, j, 1], values[i, j, 2] = s, light, weight


@kernel
def _compare(
    values: Floats,
    window: Floats,
    reach: float,
    soft: float,
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
    x0, y0, ux, uy, ratio, a = window[0], window[1], window[2], window[3], window[4], window[5]
    height, level, alone, farthest = model[0], model[1], math.sqrt(1.0 - tie * tie), reach * reach
    old_x = old_y = old_c = before = 0.0
    bx = by = bc = bl = xx = xy = yy = xc = yc = cc = xl = yl = cl = ll = 0.0  # in registers, unlike arrays
    total = square = mean = power = rest = along = down = 0.0
    above = np.zeros(values.shape[1])
    for i in range(values.shape[0]):
        joined, dy = False, i - y0
        for j in range(values.shape[1]):
            weight, dx = values[i, j, 2], j - x0
            if weight <= 0.0 or dx * dx + dy * dy > farthest:
                above[j], joined = 0.0, False
                continue
            light = values[i, j, 1]
            cover, right, under = coverage(dx, dy, ux, uy, a, ratio, soft)
            jx, jy, jc = height * light * right, height * light * under, light * cover
            s = values[i, j, 0]
            e = s - level - height * jc
            past = tie if joined else 0.0
            here = 1.0 if joined else alone
            fresh = here * e - past * before
            gx, gy, gc, gl = here * jx - past * old_x, here * jy - past * old_y, here * jc - past * old_c, here - past
            wx, wy, wc, wl, wf = weight * gx, weight * gy, weight * gc, weight * gl, weight * fresh
            bx, by, bc, bl = bx + gx * wf, by + gy * wf, bc + gc * wf, bl + gl * wf
            xx, xy, yy, xc, yc = xx + wx * gx, xy + wx * gy, yy + wy * gy, xc + wx * gc, yc + wy * gc
            cc, xl, yl, cl, ll = cc + wc * gc, xl + wx * gl, yl + wy * gl, cl + wc * gl, ll + wl * gl
            total, square, rest = total + weight, square + wf * fresh, rest + weight * e * e
            mean, power, down = mean + weight * s, power + weight * s * s, down + wf * above[j]
            along += weight * e * before if joined else 0.0
            above[j], before, joined = fresh, e, True
            old_x, old_y, old_c = jx, jy, jc
    n[0, 0], n[1, 0], n[1, 1], n[2, 0], n[2, 1], n[2, 2] = xx, xy, yy, xc, yc, cc
    n[3, 0], n[3, 1], n[3, 2], n[3, 3] = xl, yl, cl, ll
    b[0], b[1], b[2], b[3] = bx, by, bc, bl
    sums[0], sums[1], sums[2], sums[3] = total, square, mean, power
    sums[4], sums[5], sums[6] = rest, along, down


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
    count, which : int
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
    n, b, sums = np.zeros((4, 4)), np.zeros(4), np.zeros(7)
    shade, window, model = np.zeros(3), np.zeros(6), np.array((1.0, 0.0))
    result, least = (0.0, 0.0, 0.0), 0 if tied[0] > 0.0 else 1
    span = 2 * int(reach + MARGIN) + 1
    values, left, top = np.empty((span, span, 3)), 0, 0
    for turn in range(ROUNDS):
        window[0], window[1], window[5] = place[0], place[1], a
        window[2], window[3], window[4] = ellipse(place, ball, depth)
        if turn == 0 or abs(place[0] - left - span // 2) + abs(place[1] - top - span // 2) > MARGIN:
            left, top = math.floor(place[0] + 0.5) - span // 2, math.floor(place[1] + 0.5) - span // 2
            _shading(image, ball, window, reach + SHADED * a, ground, shade)
            _gather(image, ball, places, count, which, left, top, axis, ground, shade, values)
        window[0], window[1] = place[0] - left, place[1] - top
        _compare(values, window, reach, soft, model, tied[0], n, b, sums)
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
            tied[0] = min(max(sums[5] / max(sums[4], 1e-12), 0.0), TIED)
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
        if turn > least and longest < ENOUGH:
            break
    return result
