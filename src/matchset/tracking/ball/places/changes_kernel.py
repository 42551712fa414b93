"""Comparison of two coarse pictures in compiled code: `differences`, `shares_of_ball`, `count_before`."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Singles = npt.NDArray[np.float32]
Image = npt.NDArray[np.uint8]
Counts = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

LEVELS = 256  # format: gray levels of a channel


class MixtureLimits(NamedTuple):
    """See `ChangeParameters`; `most_alpha`, `weak`: `changes.MOST_ALPHA`, `changes.WEAK`."""

    contrast: float
    least_alpha: float
    residual: float
    residual_share: float
    most_alpha: float
    weak: float


class Surroundings(NamedTuple):
    """What `count_before` needs of a disc, px of the whole picture, and of gray levels.

    Attributes
    ----------
    x, y, radius : float
        The disc.
    own_x, own_y, own_radius : float
        Around the ball in the reference, where its color is its own.
    left, top : float
        First pixel of the cut out.
    across, down : float
        Pixels of the picture for one of the coarse one.
    threshold, contrast : float
        By how much a pixel must differ to have changed, and the ball from what was there.
    """

    x: float
    y: float
    radius: float
    own_x: float
    own_y: float
    own_radius: float
    left: float
    top: float
    across: float
    down: float
    threshold: float
    contrast: float


@kernel(refcount=False)
def differences(now: Image, before: Image, away: Image, counts: Counts) -> float:
    """Write the largest difference of the channels of each pixel, and how many pixels have which; their median.

    Parameters
    ----------
    now, before : (rows, columns, channels), uint8
    away : (rows, columns), uint8, written
    counts : (256,), int64, written
    """
    counts[:] = 0
    for row in range(away.shape[0]):
        for column in range(away.shape[1]):
            most = np.int64(0)
            for k in range(now.shape[2]):
                apart = abs(np.int64(now[row, column, k]) - np.int64(before[row, column, k]))
                most = apart if apart > most else most
            away[row, column] = most
            counts[most] += 1
    return _median(counts, away.size)


@kernel(refcount=False)
def shares_of_ball(
    pictures: tuple[Image, Image], changed: Mask, pixel: Singles, limits: MixtureLimits, alphas: Singles
) -> int:
    """Write how much of each pixel that has changed is the ball now, as a share; 0 where it is no such mixture.

    Parameters
    ----------
    pictures : (Image, Image)
        Of shape (rows, columns, channels), now and before.
    changed : (rows, columns), bool
    pixel : (channels,), float32
        Color of the ball.
    limits : MixtureLimits
    alphas : (rows, columns), float32, written
        0 ... 1.

    Returns
    -------
    int
        How many pixels are mixtures with it.
    """
    (now, before), count = pictures, 0
    for row in range(changed.shape[0]):
        for column in range(changed.shape[1]):
            alphas[row, column] = 0.0
            if not changed[row, column]:
                continue
            along = toward = change = 0.0
            most = 0.0
            for k in range(now.shape[2]):
                was = np.float64(before[row, column, k])
                moved, way = now[row, column, k] - was, pixel[k] - was
                along += moved * way
                toward += way * way
                change += moved * moved
                most = max(most, abs(way))
            alpha = along / (toward + limits.weak)
            left = math.sqrt(max(change - 2.0 * alpha * along + alpha * alpha * toward, 0.0))
            allowed = limits.residual + limits.residual_share * math.sqrt(change)
            if most > limits.contrast and limits.least_alpha < alpha < limits.most_alpha and left < allowed:
                alphas[row, column] = min(alpha, 1.0)
                count += 1
    return count


@kernel(refcount=False)
def count_before(
    before: Image, changed: Mask, alike: Mask, pixel: Singles, disc: Surroundings, moved: bool, counts: Counts
) -> float:
    """Say how much of a disc was there before the ball was, see `changes.share_before`, as a share of its area.

    It has seven parameters: each is an array or a record of another kind.

    Parameters
    ----------
    before : (rows, columns, channels), uint8
        Cut out around the disc.
    changed, alike : (rows, columns), bool
        What has changed, and what had the ball's color; `alike` has no rows where only the pixel tells.
    pixel : (channels,), float32
        Color of the ball.
    disc : Surroundings
    moved : bool
        Whether look-alikes that have moved count too.
    counts : (256,), int64, written
        How many pixels around differ how much from the ball.
    """
    counts[:] = 0
    around = within = counted = 0
    for row in range(before.shape[0]):
        py = disc.top + disc.down * row
        for column in range(before.shape[1]):
            px = disc.left + disc.across * column
            apart = 0.0
            for k in range(before.shape[2]):
                apart = max(apart, abs(np.float64(before[row, column, k]) - pixel[k]))
            own = (px - disc.own_x) ** 2 + (py - disc.own_y) ** 2 <= disc.own_radius**2
            has_changed = changed[row, column]
            is_alike = alike[row, column] if alike.shape[0] > 0 else apart < disc.threshold
            tells = apart > disc.threshold + disc.contrast
            if (px - disc.x) ** 2 + (py - disc.y) ** 2 < disc.radius**2:
                within += 1
                there = is_alike or (tells and not has_changed) if moved else not has_changed and (is_alike or tells)
                counted += there and not own
            else:
                counted += is_alike and has_changed and moved and not own
                if not has_changed and not own:
                    around += 1
                    counts[min(int(apart), LEVELS - 1)] += 1
    if around == 0 or _median(counts, around) < disc.contrast:
        return 0.0
    return counted / max(within, 1)


@kernel(refcount=False, entry=False)
def _median(counts: Counts, total: int) -> float:
    """Median of whole numbers of which it is known how many there are of each."""
    seen = 0
    for value in range(counts.shape[0]):
        seen += counts[value]
        if 2 * seen > total:
            return float(value)
    return float(counts.shape[0])
