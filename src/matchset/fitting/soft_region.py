"""The region of a blurred target: what looks more like the inside of a shape than like what is around it.

The rim of a ball that moves while the picture is taken, or that is out of focus, is a ramp many pixels wide. Edges of
the background, which shine through it, are sharper than that, and the sharpest place of a ramp is not where the outline
is. But a ramp is a mixture of target and background, and mixtures are linear. So Fisher's discriminant (1936) of the
pixels inside a disc and around it,

    share = w . (pixel - around) / w . (inside - around),    w = (S_inside + S_around)^-1 (inside - around),

says how much of a pixel is target, whatever pattern the background has. About where it is half, the outline was in the
middle of the exposure; the disc with the center and the area of the region above that is the target's. A sharp rim
needs none of this, and a hand or a tube that cuts the target cuts the region too: `worth` is 0 where even the sharper
part of the rim is sharp.
"""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Mask = npt.NDArray[np.bool_]
Disc = tuple[float, float, float]  # center and half-width, px

FEW = 8  # theorem: pixels that a covariance of three channels needs at least, twice over
ROW = 0.5  # geometry: half the width of a row of cells, cells
ALONG = np.linspace(0.4, 1.6, 49)  # geometry: where a line across the rim is read, in half-widths from the center


class SoftRegionParameters(msgspec.Struct, frozen=True):
    """How the region of a blurred target is found, and what it is worth.

    `level`, `soft`, `softer`, `worth` and `sigma` were chosen on real clips (docs/log.md), the others by hand;
    `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    inner, nearest, farthest : float
        Up to where pixels are of the inside, and from where to where around it, in half-widths.
    window, border : float
        How far the picture is looked at, and the region may reach, in half-widths.
    cells : int
        Most cells of the window in a row; more is finer and takes longer.
    pixel_noise : float
        Standard deviation added to that of the pixels, gray levels: less believes small differences.
    contrast : float
        Least difference of inside and around, in standard deviations along the discriminant.
    level : float
        Share of the target from which a pixel belongs to the region: somewhat below a half, since a ball is darker at
        its rim. 0.3 makes radii 5 to 10 % too large, 0.5 as much too small.
    rounds : int
        How often the region is found anew around the one before, ...
    still : float
        ... unless it has moved and grown by less than this, in cells.
    move, growth : float
        How far the region may be from where it is expected, in half-widths, and by which factor its size may differ.
    lines : int
        How many lines across the rim are read for its width.
    high, low : float
        Shares of the target between which the rim lies.
    sharper : float
        Share of the lines that are sharper than the width that counts: a streak is sharp at its sides.
    soft, softer : float
        Width of the rim, in half-widths, from which a region is worth something, and from which all.
    agreement, agrees : float
        Intersection over union of the region and the disc from which it is worth something, and from which all.
    worth : float
        What a region is worth that is soft and a disc; less than that says how sure it is.
    sure : float
        Share of that from which a detection is fitted anew from its region, and which weighs beside the network's disc.
    sigma : float
        Standard deviation of its center and half-width there, in half-widths: less believes the region more, whose size
        is up to a tenth too large where a streak is long. It counts beside the network's covariance, inflated as
        `NetworkParameters.inflation` says; 0.05 beside that believes streaks too little (docs/log.md). It is that of a
        region with all of its worth, and grows with the inverse square of the share of it.
    round : float
        Agreement below which a region with a sharp rim is no disc: that of a square is 0.83, of other cards less.
    least_way : float
        Way from picture to picture, in half-widths, below which no region is looked for while a target is followed: a
        streak is no longer than that.
    min_half_width : float
        Half-width below which no region is looked for, px: a rim of a pixel or two is wide there.
    """

    inner: float = 0.6
    nearest: float = 1.4
    farthest: float = 1.9
    window: float = 2.0
    border: float = 1.6
    cells: int = 48
    pixel_noise: float = 2.0
    contrast: float = 1.0
    level: float = 0.4
    rounds: int = 3
    still: float = 1.0
    move: float = 0.5
    growth: float = 1.5
    lines: int = 48
    high: float = 0.7
    low: float = 0.2
    sharper: float = 0.25
    soft: float = 0.18
    softer: float = 0.25
    agreement: float = 0.8
    agrees: float = 0.88
    worth: float = 0.3
    sure: float = 0.5
    sigma: float = 0.03
    round: float = 0.85
    least_way: float = 0.25
    min_half_width: float = 5.0

    def __post_init__(self) -> None:
        for low, high in (("soft", "softer"), ("agreement", "agrees")):
            if not getattr(self, low) < getattr(self, high):
                raise ValueError(f"{low} must be less than {high}, got {getattr(self, low)} and {getattr(self, high)}")
        for name in ("cells", "lines", "pixel_noise"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")


class SoftRegion(NamedTuple):
    """A region, as the disc of its center and area.

    Attributes
    ----------
    x, y, half_width : float
        The disc, px.
    agreement : float
        Intersection over union of region and disc.
    swept : float
        The same with the disc that has the region's moments, swept along its longer axis.
    rim : float
        Width of its rim where that is sharper, in half-widths.
    """

    x: float
    y: float
    half_width: float
    agreement: float
    swept: float
    rim: float

    def worth(self, limits: SoftRegionParameters) -> float:
        """Say what the region adds to the score of its outline: nothing where its rim is sharp, or it is no disc."""
        softness = (self.rim - limits.soft) / (limits.softer - limits.soft)
        roundness = (max(self.agreement, self.swept) - limits.agreement) / (limits.agrees - limits.agreement)
        return limits.worth * min(max(softness, 0.0), 1.0) * min(max(roundness, 0.0), 1.0)

    def is_other(self, limits: SoftRegionParameters) -> bool:
        """Say whether it is seen that this is no disc: its rim is sharp, and the region another shape."""
        return self.rim < limits.soft and self.agreement < limits.round


class _Window(NamedTuple):
    """The picture around a disc in cells: their pixels, how far they lie from its center, px, and their size."""

    pixels: Floats
    across: Floats
    down: Floats
    step: float


class _Discriminant(NamedTuple):
    """Tells how much of a pixel is target."""

    weights: Floats
    around: Floats

    def shares(self, pixels: Floats) -> Floats:
        return np.asarray((pixels - self.around) @ self.weights)


def find_soft_region(image: Image, disc: Disc, limits: SoftRegionParameters) -> SoftRegion | None:
    """Find the region of the target around a disc, and measure its rim.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    disc : tuple of three floats
        About where the target is: center and half-width, px.
    limits : SoftRegionParameters

    Returns
    -------
    SoftRegion or None
        None where nothing tells the inside from what is around it, or the region is not where it was expected.
    """
    found, told, agreement, swept = disc, None, 0.0, 0.0
    if disc[2] < limits.min_half_width:
        return None
    for _ in range(limits.rounds):
        window = _read(image, found, limits)
        away = np.hypot(window.across, window.down[:, np.newaxis]) / found[2] if window else np.zeros(0)
        told = _discriminant(window.pixels, away, limits) if window else None
        if window is None or told is None:
            return None
        region = _main_region((told.shares(window.pixels) > limits.level) & (away < limits.border))
        if region is None:
            return None
        before, (found, agreement) = found, _disc_of(region, window, found)
        swept = _swept_agreement(region)
        if math.dist(before, found) < limits.still * window.step:
            break
    assert told is not None
    ratio, away_from = found[2] / disc[2], math.dist(found[:2], disc[:2]) / disc[2]
    if not 1.0 / limits.growth < ratio < limits.growth or away_from > limits.move:
        return None
    return SoftRegion(*found, agreement, swept, _rim(image, told, found, limits))


def _read(image: Image, disc: Disc, limits: SoftRegionParameters) -> _Window | None:
    """Read the window around a disc; None where the disc is not wholly in the picture."""
    (x, y, size), (height, width) = disc, image.shape[:2]
    if x < size or y < size or x > width - 1 - size or y > height - 1 - size:
        return None
    half = limits.window * size
    left, top = round(x - half), round(y - half)
    side = max(round(2.0 * half), 2)
    cut = image[max(top, 0) : top + side, max(left, 0) : left + side]
    rows, columns = cut.shape[:2]
    if (rows, columns) != (side, side):
        above, before = max(-top, 0), max(-left, 0)
        edges = above, side - rows - above, before, side - columns - before
        cut = np.asarray(cv2.copyMakeBorder(cut, *edges, cv2.BORDER_REPLICATE), np.uint8)
    cells = min(limits.cells, side)
    step = side / cells
    pixels = cv2.resize(cut, (cells, cells), interpolation=cv2.INTER_AREA).reshape(cells, cells, -1)
    places = (np.arange(cells) + 0.5) * step - 0.5
    across, down = np.asarray(places + left - x, np.float64), np.asarray(places + top - y, np.float64)
    return _Window(pixels.astype(np.float64), across, down, step)


def _discriminant(pixels: Floats, away: Floats, limits: SoftRegionParameters) -> _Discriminant | None:
    """Fisher's discriminant of the pixels inside and around; None where they hardly differ."""
    inside, around = pixels[away < limits.inner], pixels[(away > limits.nearest) & (away < limits.farthest)]
    if min(len(inside), len(around)) < FEW:
        return None
    here, there, channels = np.median(inside, axis=0), np.median(around, axis=0), pixels.shape[2]
    spread = limits.pixel_noise**2 * np.eye(channels)
    spread += 0.5 * (np.cov(inside.T) + np.cov(around.T)).reshape(channels, channels)
    weights = np.linalg.solve(spread, here - there)
    apart = float(weights @ (here - there))
    return (
        _Discriminant(np.asarray(weights / apart), np.asarray(there, np.float64))
        if apart > limits.contrast**2
        else None
    )


def _main_region(mask: Mask) -> Mask | None:
    """Largest connected region of a mask, its holes filled; None where there is none."""
    count, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8))
    if count < 2:
        return None
    largest = (labels == 1 + int(np.argmax(statistics[1:, cv2.CC_STAT_AREA]))).astype(np.uint8)
    outlines, _ = cv2.findContours(largest, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(largest, outlines, -1, 1, cv2.FILLED)
    return np.asarray(largest > 0)


def _disc_of(region: Mask, window: _Window, seen_from: Disc) -> tuple[Disc, float]:
    """Disc of a region's center and area, and how far both agree."""
    area = float(region.sum())
    dx, dy = float(region.sum(axis=0) @ window.across) / area, float(region.sum(axis=1) @ window.down) / area
    size = math.sqrt(area / math.pi) * window.step
    disc = np.hypot(window.across - dx, window.down[:, np.newaxis] - dy) <= size
    return (seen_from[0] + dx, seen_from[1] + dy, size), float((disc & region).sum() / (disc | region).sum())


def _swept_agreement(region: Mask) -> float:
    """Intersection over union of a region and the swept disc that has its area and moments.

    A disc of radius r swept along 2 a has the area A = pi r^2 + 4 a r, and across its way the variance
    V = r^2 / 3 - pi r^4 / (12 A): a quadratic equation of r^2. Cells count as points, so V is 0 of a single row of them
    (rounded: a little below), which is half a cell to each side all the same.
    """
    rows, columns = np.nonzero(region)
    area, places = float(len(rows)), np.vstack((columns - columns.mean(), rows - rows.mean()))
    variances, axes = np.linalg.eigh(places @ places.T / area)
    root = 1.0 / 9.0 - math.pi * float(variances[0]) / (3.0 * area)
    squared = 6.0 * area / math.pi * (1.0 / 3.0 - math.sqrt(max(root, 0.0)))
    size = min(max(math.sqrt(max(squared, 0.0)), ROW), math.sqrt(area / math.pi))
    half = max(area - math.pi * size**2, 0.0) / (4.0 * size)
    down, across = np.indices(region.shape)
    across, down = across - columns.mean(), down - rows.mean()
    along = np.clip(across * axes[0, 1] + down * axes[1, 1], -half, half)
    swept = np.hypot(across - along * axes[0, 1], down - along * axes[1, 1]) <= size
    return float((swept & region).sum() / (swept | region).sum())


def _rim(image: Image, told: _Discriminant, disc: Disc, limits: SoftRegionParameters) -> float:
    """Width of the rim where it is sharper, in half-widths; 0 where few lines show one."""
    (x, y, size), turns = disc, 2.0 * math.pi * np.arange(limits.lines) / limits.lines
    columns = (x + size * ALONG[:, np.newaxis] * np.cos(turns)).astype(np.float32)
    rows = (y + size * ALONG[:, np.newaxis] * np.sin(turns)).astype(np.float32)
    read = np.asarray(cv2.remap(image, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.float64)
    shares = told.shares(read.reshape(*columns.shape, -1))
    place, n = np.arange(len(ALONG))[:, np.newaxis], np.arange(limits.lines)
    end = np.argmax(shares < limits.level, axis=0)  # 0 where the line begins or stays beyond it
    high = np.where((shares > limits.high) & (place < end), place, -1).max(axis=0)
    low = np.where((shares < limits.low) & (place > end), place, len(ALONG)).min(axis=0)
    crossed = (end > 0) & (shares[0, n] > limits.level)
    whole = (high >= 0) & (low < len(ALONG))
    widths = np.where(whole, (low - high) * (ALONG[1] - ALONG[0]), 1.0)[crossed]
    return float(np.quantile(widths, limits.sharper)) if 2 * len(widths) >= limits.lines else 0.0
