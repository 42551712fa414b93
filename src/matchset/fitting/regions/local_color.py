"""Colors inside a fit and around it, in the picture at hand: `learn_local_color`.

The color model of a click knows the pixels that were clicked and the background of that time. A ball's shaded rim, its
pale cap, or leaves of about its color are told apart better by what is inside and around it now: with histograms of
both, p and q, each smoothed, and n the pixels of the smaller one, the log-odds of a color are

    ln((p + floor / n) / (q + floor / n)),

as in region-based tracking (Prisacariu & Reid, 2012; Stoiber et al., 2022). They are bounded, so that a color that is
rare in both decides nothing.
"""

from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Integers = npt.NDArray[np.int32]
Table = npt.NDArray[np.float32]

BINS = 32  # geometry: of a channel of CIE Lab
SHIFT = 3  # geometry: bits of a channel within a bin
CHANNELS = 3  # format: of a color
KERNEL = (0.05, 0.25, 0.4, 0.25, 0.05)  # geometry: weights of neighboring bins, a Gauss filter of one bin
SMOOTHING = sum(w * np.eye(BINS, k=k - 2, dtype=np.float32) for k, w in enumerate(KERNEL))
"""Smooths one channel of a histogram."""


class LocalColorParameters(msgspec.Struct, frozen=True):
    """How the colors inside a fit and around it are learned, and what they count.

    All numbers but `weight` were chosen by hand, before anything was measured; `weight` of 0, 0.5 and 1 on real clips
    (docs/log.md). `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    inner : float
        Up to where pixels are of the inside, in half-widths: the more, the more of the rim's shade is known, and the
        more of the background where the fit is wrong.
    nearest, farthest : float
        From where to where they are around it, in half-widths.
    cells : int
        Most cells of the window in a row; more is finer and takes longer.
    fewest : int
        Cells of each that are needed.
    floor : float
        Cells that are added to each color: more believes colors that were seen once or twice less. With 0.006, balls in
        noise were seen where none were.
    most : float
        Largest log-odds, which count as a full score.
    weight : float
        What they count beside the color model, 0 ... 1.
    """

    inner: float = 0.85
    nearest: float = 1.2
    farthest: float = 1.9
    cells: int = 64
    fewest: int = 8
    floor: float = 0.1
    most: float = 4.0
    weight: float = 0.5


class LocalColor(NamedTuple):
    """Scores of all colors, -1 (around) ... 1 (inside).

    Attributes
    ----------
    table : ndarray of shape (32 ** 3,), float32
    """

    table: Table

    def scores(self, pixels: Image) -> Floats:
        """Score pixels of any shape (..., 3), BGR; of shape (...)."""
        return np.asarray(self.table[_bins(pixels)].reshape(pixels.shape[:-1]), np.float64)


def learn_local_color(
    image: Image, center: tuple[float, float], half_width: float, limits: LocalColorParameters
) -> LocalColor | None:
    """Learn the colors inside a disc and around it.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    center : tuple of two floats
        Of the disc, px.
    half_width : float
        Its radius, px.
    limits : LocalColorParameters

    Returns
    -------
    LocalColor or None
        None of a gray picture, and where hardly anything of one of the two is in the picture.
    """
    if image.shape[2] != CHANNELS or not limits.weight > 0.0:
        return None
    (x, y), half = center, limits.farthest * half_width
    left, top = max(int(x - half), 0), max(int(y - half), 0)
    cut = image[top : max(int(y + half) + 1, 0), left : max(int(x + half) + 1, 0)]
    if 0 in cut.shape:
        return None
    height, width = cut.shape[:2]
    scale = min(limits.cells / max(height, width), 1.0)
    columns, rows = max(round(scale * width), 1), max(round(scale * height), 1)
    small = np.asarray(cv2.resize(cut, (columns, rows), interpolation=cv2.INTER_AREA), np.uint8)
    across = (np.arange(columns) + 0.5) * (width / columns) - 0.5 + left - x
    down = (np.arange(rows) + 0.5) * (height / rows) - 0.5 + top - y
    away = np.hypot(across, down[:, np.newaxis]).ravel() / half_width
    bins, inside = _bins(small), away < limits.inner
    around = (away > limits.nearest) & (away < limits.farthest)
    if min(np.count_nonzero(inside), np.count_nonzero(around)) < limits.fewest:
        return None
    here, there = _histogram(bins[inside]), _histogram(bins[around])
    seen, table = np.flatnonzero(here + there), np.zeros(len(here), np.float32)
    floor = np.float32(limits.floor / min(np.count_nonzero(inside), np.count_nonzero(around)))
    odds = np.log((here[seen] + floor) / (there[seen] + floor))
    table[seen] = np.clip(odds / np.float32(limits.most), -1.0, 1.0)
    return LocalColor(table)


def _bins(pixels: Image) -> Integers:
    """Bin of each pixel, in order."""
    lab = np.asarray(cv2.cvtColor(np.ascontiguousarray(pixels).reshape(-1, 1, CHANNELS), cv2.COLOR_BGR2Lab), np.uint8)
    which = (lab.reshape(-1, CHANNELS) >> SHIFT).astype(np.int32)
    return np.asarray((which[:, 0] * BINS + which[:, 1]) * BINS + which[:, 2])


def _histogram(bins: Integers) -> Table:
    """Share of each bin, smoothed along all three channels."""
    shares = (np.bincount(bins, minlength=BINS**CHANNELS) / len(bins)).astype(np.float32)
    for _ in range(CHANNELS):  # smooths along the first channel, which becomes the last one
        shares = np.ascontiguousarray((SMOOTHING @ shares.reshape(BINS, BINS * BINS)).T)
    return shares.ravel()
