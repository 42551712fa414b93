"""Kernels that place a marker on the ball to a fraction of a pixel.

All pixels near it are compared with the ellipse that it must show there, softened by the blur of the image and shaded
as the ball is around it, along the one direction of color that separates marker from ball:
``s = level + contrast * light * softened ellipse``. Blur that is the same on all sides moves nothing; highlights have
little weight.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.localization.markers.marker_patch import Patch, measure_shading, new_patch, read_patch
from matchset.localization.markers.marker_shape import SoftEllipse, coverage, ellipse_axes
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import factor_cholesky, solve_cholesky

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

BLOCK = 512  # geometry: pixels that are worked on at a time, so that their numbers stay in the cache
WIDTH = BLOCK + 1  # geometry: numbers of each kind in a table, that of the pixel before the block first
# geometry: where each kind begins. All in one table: with one address per kind the compiler would not work on several
# pixels at a time, since any of them might be the same.
WEIGHT, COUNTS, RESIDUAL, BY_X, BY_Y, BY_CONTRAST = (np.uintp(k * WIDTH) for k in range(6))
FIRST = np.uintp(1)  # geometry: place of the block's first pixel
ZERO, ONE = np.float32(0.0), np.float32(1.0)  # theorem: neutral elements, in single precision
TINY = 1e-12  # of sums of squares, by which is divided


class FitArrays(NamedTuple):
    """Working arrays of a fit, float32."""

    table: Singles  # (6 * WIDTH,), of a block: weight, 1 if it counts, residual, its derivatives to x, y, contrast
    residual: Singles  # (n,), of all pixels, less what their left neighbors have in common with them
    weighted: Singles  # (n,), the same, weighted


@kernel
def new_rows(count: int) -> FitArrays:
    """Make the working arrays for so many pixels."""
    return FitArrays(np.empty(6 * WIDTH, np.float32), np.empty(count, np.float32), np.empty(count, np.float32))


@kernel(refcount=False, reassociate=True)
def _compare_block(patch: Patch, work: Any, table: Singles) -> None:
    """Residuals of the pixels of a block, and their derivatives."""
    values, lights, weights, xs, ys = patch.value, patch.light, patch.weight, patch.x, patch.y
    window, sums = work.window, work.sums
    x0, y0, softness = np.float32(window.x), np.float32(window.y), np.float32(work.limits.fit.softness_px)
    axis_x, axis_y, ratio = np.float32(window.axis_x), np.float32(window.axis_y), np.float32(window.ratio)
    shape = SoftEllipse(axis_x, axis_y, ratio, np.float32(window.semi_axis), softness)
    contrast, level, farthest = np.float32(window.contrast), np.float32(window.level), np.float32(window.reach**2)
    total = mean = power = rest = ZERO
    for place in range(values.shape[0]):
        p = np.uintp(place)
        k = p + FIRST
        dx, dy = xs[p] - x0, ys[p] - y0
        cover, right, under = coverage(dx, dy, shape)
        counts = np.float32((dx * dx + dy * dy <= farthest) & (weights[p] > ZERO))
        weight, s, lit = weights[p] * counts, values[p], lights[p] * counts
        e = (s - level) * counts - contrast * lit * cover
        table[k + WEIGHT], table[k + COUNTS], table[k + RESIDUAL] = weight, counts, e
        table[k + BY_X], table[k + BY_Y] = contrast * lit * right, contrast * lit * under
        table[k + BY_CONTRAST] = lit * cover
        total, mean, power, rest = total + weight, mean + weight * s, power + weight * s * s, rest + weight * e * e
    sums.weight += total
    sums.value += mean
    sums.value_square += power
    sums.raw_square += rest


@kernel(refcount=False, reassociate=True)
def _add_block(table: Singles, correlation: float, rows: FitArrays, sums: Any) -> None:
    """Add a block to the normal equations.

    Noise that has been through a filter is correlated between neighbors in a row: of every pixel `correlation` times
    its left neighbor is taken away, in the image and in the model, which leaves it independent.
    """
    past, alone = np.float32(correlation), np.float32(math.sqrt(1.0 - correlation * correlation))
    joined, residual, weighted = ONE - alone, rows.residual, rows.weighted
    xx = xy = yy = xc = yc = cc = xl = yl = cl = ll = xf = yf = cf = lf = ff = along = ZERO
    for place in range(residual.shape[0]):
        p = np.uintp(place)
        k = p + FIRST
        weight, here, before = table[k], alone + joined * table[p + COUNTS], table[p + RESIDUAL]
        f = here * table[k + RESIDUAL] - past * before
        x, y = here * table[k + BY_X] - past * table[p + BY_X], here * table[k + BY_Y] - past * table[p + BY_Y]
        c, one = here * table[k + BY_CONTRAST] - past * table[p + BY_CONTRAST], here - past * table[p + COUNTS]
        wx, wy, wc, wl, wf = weight * x, weight * y, weight * c, weight * one, weight * f
        xx, xy, yy, xc, yc = xx + wx * x, xy + wx * y, yy + wy * y, xc + wx * c, yc + wy * c
        cc, xl, yl, cl, ll = cc + wc * c, xl + wx * one, yl + wy * one, cl + wc * one, ll + wl * one
        xf, yf, cf, lf, ff = xf + wx * f, yf + wy * f, cf + wc * f, lf + wl * f, ff + wf * f
        along += weight * table[k + RESIDUAL] * before
        residual[p], weighted[p] = f * table[k + COUNTS], wf
    normal = xx, xy, yy, xc, yc, cc, xl, yl, cl, ll
    for place in range(10):
        sums.normal[place] += normal[place]
    right_side = xf, yf, cf, lf
    for place in range(4):
        sums.right_side[place] += right_side[place]
    sums.residual_square += ff
    sums.row_product += along


@kernel(refcount=False, reassociate=True)
def _dot(one: Singles, other: Singles) -> float:
    """Sum of products."""
    total = ZERO
    for place in range(one.shape[0]):
        total += one[np.uintp(place)] * other[np.uintp(place)]
    return float(total)


@kernel(refcount=False)
def sum_equations(patch: Patch, work: Any, rows: FitArrays) -> None:
    """Sum up the normal equations of one Gauss-Newton step, and what noise and explained variance are computed from.

    Parameters
    ----------
    patch : Patch
        See `read_patch`.
    work : record of `MarkerWork`
        `window` is read, `sums` are written.
    rows : FitArrays, written
    """
    sums, table, count, stride = work.sums, rows.table, rows.residual.shape[0], work.window.span + 1
    for k in range(10):
        sums.normal[k] = 0.0
    for k in range(4):
        sums.right_side[k] = 0.0
    sums.residual_square = sums.weight = sums.value = sums.value_square = sums.raw_square = sums.row_product = 0.0
    for k in range(6):
        table[k * WIDTH] = ZERO
    for begin in range(0, count, BLOCK):
        end = min(begin + BLOCK, count)
        part = Patch(
            patch.value[begin:end],
            patch.light[begin:end],
            patch.weight[begin:end],
            patch.x[begin:end],
            patch.y[begin:end],
            patch.brightness[begin:end],
        )
        _compare_block(part, work, table)
        here = FitArrays(table, rows.residual[begin:end], rows.weighted[begin:end])
        _add_block(table, work.noise_correlation, here, sums)
        for k in range(6):
            table[k * WIDTH] = table[k * WIDTH + end - begin]
    sums.column_product = _dot(rows.residual[: count - stride], rows.weighted[stride:])


@kernel(refcount=False)
def _solve(work: Any) -> bool:
    """Solve the normal equations for the step in x, y, contrast, level; False where they have no solution."""
    sums, matrix, place, size = work.sums, work.matrix[:], 0, work.step.shape[0]
    for p in range(4):
        for q in range(p + 1):
            matrix[4 * p + q] = sums.normal[place]
            place += 1
        matrix[5 * p] += work.limits.fit.ridge * sums.weight
    if not factor_cholesky(matrix, size, 0.0):
        return False
    solve_cholesky(matrix, sums.right_side[:], work.step[:], size)
    return True


@kernel
def _write_result(work: Any) -> None:
    """Covariance of the place, noise and explained variance, from the sums and the factor of the normal matrix."""
    sums, result, limits, column = work.sums, work.result, work.limits.fit, np.zeros(4)
    variance = sums.residual_square / sums.weight
    down = min(max(sums.column_product / max(sums.residual_square, TINY), 0.0), limits.max_row_correlation)
    grain = (1.0 + down) / (1.0 - down)
    for p in range(2):
        column[:] = 0.0
        column[p] = 1.0
        solve_cholesky(work.matrix[:], column, column, column.shape[0])
        for q in range(2):
            result.covariance[q, p] = grain * variance * column[q]
    spread = sums.value_square - sums.value * sums.value / sums.weight
    result.contrast, result.noise = work.window.contrast, math.sqrt(variance)
    result.explained = 1.0 - sums.raw_square / max(spread, TINY)


@kernel
def _place_window(image: Bytes, work: Any, which: int, patch: Patch, first: bool) -> None:
    """Describe the ellipse at the marker's place; read the pixels if it has moved far from the window's middle."""
    window, ball, limits = work.window, work.ball, work.limits.fit
    x, y, half = work.places[which, 0], work.places[which, 1], window.span // 2
    axes = ellipse_axes(x - ball.x, y - ball.y, ball.radius * work.rim_distance, limits.min_axis_ratio)
    window.axis_x, window.axis_y, window.ratio = axes
    if first or abs(x - window.left - half) + abs(y - window.top - half) > limits.margin_px:
        window.left, window.top = math.floor(x + 0.5) - half, math.floor(y + 0.5) - half
        measure_shading(image, work, which)
        read_patch(image, work, which, patch)
    window.x, window.y = x - window.left, y - window.top


@kernel(refcount=False)
def _move(work: Any, which: int) -> bool:
    """Take the step; False if the marker has left the ball or has no contrast."""
    window, ball, step, limits, place = work.window, work.ball, work.step, work.limits.fit, work.places[which]
    longest = max(abs(step[0]), abs(step[1]))
    shrink = min(1.0, limits.max_step * window.semi_axis / longest) if longest > 0.0 else 1.0
    place[0] += shrink * step[0]
    place[1] += shrink * step[1]
    window.contrast += step[2]
    window.level += step[3]
    near = abs(place[0] - ball.x) < ball.radius and abs(place[1] - ball.y) < ball.radius
    return bool(near and window.contrast > limits.min_contrast)


@kernel
def fit_marker(image: Bytes, work: Any, which: int) -> None:
    """Place one marker: Gauss-Newton for x, y, contrast and level, from where it is believed to be.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    work : record of `MarkerWork`
        `places[which]`, `result` and `noise_correlation` are written; a contrast of 0 says that nothing was found.
    which : int
        The marker.
    """
    window, sums, limits, result = work.window, work.sums, work.limits.fit, work.result
    window.semi_axis, window.contrast, window.level = work.patch_radius * work.ball.radius, 1.0, 0.0
    window.reach = (1.0 + limits.around) * window.semi_axis + limits.margin_px
    apart = 0.5 * max(abs(work.ball.field_x), abs(work.ball.field_y))  # px, by which a field is beside the middle
    window.span = 2 * int(window.reach + limits.margin_px + apart) + 1
    patch, rows = new_patch(window.span), new_rows(window.span * (window.span + 1))
    least = 0 if work.noise_correlation > 0.0 else 1
    result.contrast = result.noise = result.explained = 0.0
    for turn in range(limits.iterations):
        _place_window(image, work, which, patch, turn == 0)
        sum_equations(patch, work, rows)
        if sums.weight < limits.min_weight or not _solve(work):
            result.contrast = 0.0
            return
        _write_result(work)
        if turn < 2:
            share = sums.row_product / max(sums.raw_square, TINY)
            work.noise_correlation = min(max(share, 0.0), limits.max_correlation)
        if not _move(work, which):
            result.contrast = 0.0
            return
        if turn > least and max(abs(work.step[0]), abs(work.step[1])) < limits.tolerance_px:
            break
