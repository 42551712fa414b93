"""What happens to a color where the light of a whole picture changes: `gains_between`, `relit`.

Where exposure or white balance jump, all pixels of the picture are multiplied by the gain of their channel: the median
ratio of pixels to those of the same places before says by how much, and the table is moved along. Where the camera has
moved meanwhile, the same places are elsewhere in the picture; phase correlation of both says where (Kuglin & Hines,
1975).
"""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image import color

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

BINS, LEVELS = 32, 256  # format: of a channel of a color table, and of gray levels
WHITE = np.float32(color.WHITE)


class RelightingParameters(msgspec.Struct, frozen=True):
    """When the light of a picture has changed as a whole.

    `spread` and `least` were chosen on worse copies of real clips, `side`, `averaged`, `alike` and `plain` on random
    videos 300-329 with steps of the light in each, the others by hand (docs/log/network.md#light-while-moving);
    `python -m benchmarks --only real_copies,false_locks` would show a change.

    Parameters
    ----------
    used : bool
        Whether that is looked for, where the target was not confirmed.
    side : int
        Pixels that are compared along the longer side of a picture, about: more follow finer motion, and cost time.
    averaged : int
        Side of the square of these that is averaged first: more are compared where a camera has moved by a part of
        their distance, and fewer details are left to say by how much.
    overlap : float
        Least share of each side of the picture that must still be seen where the camera has moved.
    darkest, brightest : float
        Gray levels between which a channel must be in both pictures: beyond, it is cut off.
    share : float
        Share of the pixels in which it must be so. A channel with fewer takes the mean change of the others.
    spread : float
        Largest median deviation of the logarithm of the ratios from their median: with more the view has changed, not
        the light. More finds changes of the light before a camera that moves, and some that are none.
    alike, plain : float
        Least correlation of the logarithms of brightness of both pictures, for the view to be the same, unless their
        ratios deviate by less than the second: plain pictures have nothing to compare. Of 1,140 pairs of pictures of
        different videos 208 were taken for a change of the light without this, 16 with it.
    least : float
        Least change of a channel, as a logarithm: less is left to the slow learning.
    """

    used: bool = True
    side: int = 64
    averaged: int = 3
    overlap: float = 0.4
    darkest: float = 16.0
    brightest: float = 240.0
    share: float = 0.2
    spread: float = 0.25
    alike: float = 0.6
    plain: float = 0.05
    least: float = 0.1


class LightChange(NamedTuple):
    """From one picture to another, laid over it.

    Attributes
    ----------
    logarithms : ndarray of shape (channels,), float64
        Of the gain of each channel.
    spread : float
        Largest median deviation of the pixels of a channel from it.
    correlation : float
        Of the logarithms of brightness, -1 ... 1: of the same view it is large, whatever the gains.
    """

    logarithms: Floats
    spread: float
    correlation: float

    def is_of_light(self, limits: RelightingParameters) -> bool:
        """Whether the light has changed, not the view."""
        same = self.spread < limits.plain or self.correlation > limits.alike
        return same and self.spread < limits.spread and bool((np.abs(self.logarithms) > limits.least).any())


def thinned(image: Bytes, side: int) -> Bytes:
    """Copy every so manieth pixel of a picture: about so many along its longer side."""
    step = max(max(image.shape[:2]) // side, 1)
    return image[step // 2 :: step, step // 2 :: step].copy()


def gains_between(before: Bytes, now: Bytes, limits: RelightingParameters) -> Floats | None:
    """Gain of each channel from one picture of a view to a later one; None where the light did not change as a whole.

    Parameters
    ----------
    before, now : ndarray of shape (h, w, channels), uint8
        See `thinned`.
    limits : RelightingParameters

    Returns
    -------
    ndarray of shape (channels,), float64, or None
    """
    if before.shape != now.shape or not _differs(before, now, limits):
        return None
    smooth = _averaged(before, limits), _averaged(now, limits)
    changes = [
        found
        for right, down in {(0, 0), displacement(before, now, limits)}
        if (found := _change(*_overlapping(*smooth, right, down), limits)) is not None
    ]
    if not changes:
        return None
    best = min(changes, key=lambda change: change.spread)
    return np.exp(best.logarithms) if best.is_of_light(limits) else None


def _differs(before: Bytes, now: Bytes, limits: RelightingParameters) -> bool:
    """Whether the mean of a channel has changed by half of the least change, so that comparing pixels is worth it."""
    means = [each.mean(axis=(0, 1), dtype=np.float32) + np.float32(1.0) for each in (before, now)]
    return bool((np.abs(np.log(means[1] / means[0])) > 0.5 * limits.least).any())


def displacement(before: Bytes, now: Bytes, limits: RelightingParameters) -> tuple[int, int]:
    """By how much a picture was moved since another, in whole pixels of both, right and down; (0, 0) where too far.

    Of the logarithms of brightness, in which a gain is a constant, and no part of the phase correlation.

    Parameters
    ----------
    before, now : ndarray of shape (h, w, channels), uint8
    limits : RelightingParameters

    Returns
    -------
    tuple of 2 int
    """
    height, width = before.shape[:2]
    if min(height, width) < 2:  # theorem: a window has at least two pixels
        return 0, 0
    first, second = (np.log(each.mean(axis=2, dtype=np.float32) + np.float32(limits.darkest)) for each in (before, now))
    window = cv2.createHanningWindow((width, height), cv2.CV_32F)
    (right, down), _ = cv2.phaseCorrelate(first - first.mean(), second - second.mean(), window)
    far = abs(right) > (1.0 - limits.overlap) * width or abs(down) > (1.0 - limits.overlap) * height
    return (0, 0) if far else (round(right), round(down))


def _averaged(image: Bytes, limits: RelightingParameters) -> Bytes:
    """Average a picture a little."""
    return np.asarray(cv2.blur(image, (limits.averaged, limits.averaged)), np.uint8).reshape(image.shape)


def _overlapping(before: Bytes, now: Bytes, right: int, down: int) -> tuple[Bytes, Bytes]:
    """Cut out what both pictures show, if one was moved."""
    height, width = before.shape[:2]
    rows, columns = slice(max(-down, 0), height - max(down, 0)), slice(max(-right, 0), width - max(right, 0))
    moved_rows, moved_columns = (
        slice(each.start + way, each.stop + way) for each, way in ((rows, down), (columns, right))
    )
    return before[rows, columns], now[moved_rows, moved_columns]


def _change(before: Bytes, now: Bytes, limits: RelightingParameters) -> LightChange | None:
    """Median change of each channel over the pixels that are cut off in neither picture."""
    pixels = np.stack((before, now)).reshape(2, -1, before.shape[2]).astype(np.float64)
    whole = np.logical_and.reduce((pixels > limits.darkest) & (pixels < limits.brightest))
    known = np.flatnonzero(whole.mean(axis=0) >= limits.share)
    if not known.size:
        return None
    logarithms, spread = np.full(whole.shape[1], np.nan), 0.0
    for channel in known:
        first, second = pixels[:, :, channel][:, whole[:, channel]]
        ratios = np.log(second / first)
        logarithms[channel] = np.median(ratios)
        spread = max(spread, float(np.median(np.abs(ratios - logarithms[channel]))))
    logarithms[np.isnan(logarithms)] = logarithms[known].mean()
    return LightChange(logarithms, spread, _correlation(*pixels.clip(limits.darkest, limits.brightest)))


def _correlation(first: Floats, second: Floats) -> float:
    """Correlation of the logarithms of the brightness of pixels, (k, channels) each; 0 where one does not vary."""
    one, other = (np.log(each.mean(axis=1)) for each in (first, second))
    deviations = one - one.mean(), other - other.mean()
    norm = math.prod(float(np.linalg.norm(each)) for each in deviations)
    return float(np.dot(*deviations)) / norm if norm > 0.0 else 0.0


def relit(model: color.ColorModel, log_odds: Singles, gains: Floats) -> color.ColorModel:
    """Model of the same target in another light: a pixel is what it was before its channels were multiplied.

    Parameters
    ----------
    model : ColorModel
        A color; one of brightness finds its level in each picture.
    log_odds : ndarray of shape (32768,) or (256,), float32
        As they were in the light before.
    gains : ndarray of shape (channels,), float64
    """
    bins = BINS if model.channels == 3 else LEVELS
    table = log_odds.reshape((bins,) * len(gains))
    for axis, gain in enumerate(gains):
        size = LEVELS / bins
        values = size * (np.arange(bins) + 0.5) - 0.5
        before = np.clip((values / gain + 0.5) / size - 0.5, 0.0, bins - 1.0)
        low = np.minimum(before.astype(int), bins - 2)
        share = (before - low).reshape([-1 if each == axis else 1 for each in range(len(gains))])
        table = (1.0 - share) * table.take(low, axis) + share * table.take(low + 1, axis)
    changed = model.copy()
    changed.log_odds[:] = table.ravel()
    changed.table[:] = np.rint(WHITE * np.tanh(0.5 * changed.log_odds))
    return changed
