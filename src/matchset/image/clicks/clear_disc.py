"""The disc around a click that stands out most from the ring around it: `clearest_disc`.

A ball of some pixels that a codec has smeared, or that lies in noise, has no outline that a threshold or edges would
close. Its mean color still differs from that of the ring around it by more than the ring differs from place to place:

    d = |mean of the disc - mean of the ring| / (spread of the ring's sectors + `even`),

in CIE Lab, where a slope across the ring does not count. Means over sectors, not pixels, are compared: noise averages
out in both, and texture does not. (A sensitivity index as in Green & Swets, "Signal detection theory and
psychophysics", 1966, with the ring for the noise.)
"""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.circle_score import SCORE, CircleTuple

Picture = npt.NDArray[np.uint8]
Singles = npt.NDArray[np.float32]
Mask = npt.NDArray[np.bool_]
SLOPE_TERMS = 3  # theorem: mean and the two of a slope, which are taken out of the spread of a ring
TINY = 1e-9  # theorem: no step is that small but none
NEXT_TO_RIM = 2  # geometry: of the radii inside, the last two show whether there is a step at the rim


class NearParameters(msgspec.Struct, frozen=True):
    """Which discs around a point are compared where no region has a closed outline, and when one is the target.

    Chosen on clicks on a thrown ball of r = 3 to 7 px, 424 px wide and coded (docs/log.md).

    Parameters
    ----------
    radii : tuple of float
        Least and largest radius, px: larger balls have regions, for smaller ones no ring can be told.
    sizes : int
        Radii between them, in equal ratios.
    offset, step : float
        How far from the center the point may be, and the distance of the centers that are compared, in radii.
    directions, rays : int
        Sectors of a ring, and places in each that are read at a radius.
    inside, outside : tuple of float
        Where the disc and the ring are read, radii. A wider ring takes in other things, a narrower one the soft rim.
    smoothing, least_smoothing : float
        Standard deviation of the Gaussian by which the picture is smoothed, radii, and at least px: what is read stands
        for an area.
    lightness : float
        Weight of lightness beside chroma: more sees gray balls, and shadows. A gray picture has weight 1.
    even : float
        What is added to the spread of a ring, Lab units: steps of less are not seen before an even background.
    steep : float
        Step across the rim, as a share of that between disc and ring, from which it is there in a direction.
    min_rim : float
        Least share of the directions with that: less takes corners and bars, more refuses balls behind a finger or
        before their own color.
    full_size : float
        Radius from which a disc is not taken to be chance because it is small, px.
    sure, weak, larger : float
        Clearness from which a disc takes the place of a circle that was found, if that has a lower score than this and
        is so many times as large: then it is of the room, and the disc a thing in it. On 189 clicks on real clips
        circles of such scores were as large as the disc.
    least : float
        Least clearness: ``d``, times the share of directions with a rim, times the square root of the share of the full
        size. In white noise it was 1.24 at most, 2.2 in the median on balls that were coded at all, and about 1 where a
        codec had left them out.
    alone : float
        The same where nothing else is seen at a click, which is refused otherwise. Less begins at noise.
    """

    radii: tuple[float, float] = (3.0, 24.0)
    sizes: int = 11
    offset: float = 0.8
    step: float = 0.2
    directions: int = 16
    rays: int = 3
    inside: tuple[float, ...] = (0.25, 0.5, 0.7, 0.85)
    outside: tuple[float, ...] = (1.2, 1.4, 1.6)
    smoothing: float = 0.12
    least_smoothing: float = 0.5
    lightness: float = 0.6
    even: float = 1.0
    steep: float = 0.5
    min_rim: float = 0.4
    full_size: float = 6.0
    sure: float = 3.0
    weak: float = 0.1
    larger: float = 3.0
    least: float = 2.0
    alone: float = 1.4

    def __post_init__(self) -> None:
        if not 0.0 < self.radii[0] < self.radii[1] < math.inf:
            raise ValueError(f"radii must be positive, the smaller one first, got {self.radii}")


class ClearDisc(NamedTuple):
    """A disc, px of the picture, and how clear it is."""

    clearness: float
    circle: CircleTuple


NO_DISC = ClearDisc(0.0, (0.0, 0.0, 0.0))


def disc_in_place_of(
    found: tuple[float, CircleTuple] | None, image: Picture, x: float, y: float, limits: NearParameters
) -> CircleTuple | None:
    """Find the disc that a click means rather than the most ball-like circle around it.

    Parameters
    ----------
    found : tuple of float and (x, y, radius), or None
        The score of that circle, 0 ... 1, and where it is, px, if there is one.
    image, x, y, limits
        See `clearest_disc`.

    Returns
    -------
    (x, y, radius) or None
        In px; None where the circle counts, or nothing stands out.
    """
    if found is not None and found[0] >= limits.weak:
        return None
    disc = clearest_disc(image, x, y, limits, limits.least)
    if disc is None or found is None:
        return disc and disc.circle
    inside = limits.larger * disc.circle[2] < found[1][2]
    return disc.circle if inside and disc.clearness >= limits.sure else None


def disc_alone(image: Picture, x: float, y: float, limits: NearParameters) -> CircleTuple | None:
    """Find the disc that a click means where nothing else is seen: (x, y, radius), px, or None; see `clearest_disc`."""
    disc = clearest_disc(image, x, y, limits, limits.alone)
    return disc and disc.circle


def clearest_disc(image: Picture, x: float, y: float, limits: NearParameters, least: float) -> ClearDisc | None:
    """Find the disc around a point that stands out most from the ring around it.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.
    x, y : float
        The point, px.
    limits : NearParameters
    least : float
        Least clearness.

    Returns
    -------
    ClearDisc or None
        None where none stands out enough.
    """
    best = NO_DISC
    for radius in np.geomspace(*limits.radii, limits.sizes).tolist():
        best = max(best, _clearest(image, (x, y, radius), limits.offset, limits.step, limits))
    if best.clearness < least:
        return None
    growth = (limits.radii[1] / limits.radii[0]) ** (0.5 / (limits.sizes - 1))
    for factor in (1.0 / growth, 1.0, growth):  # between those that were compared
        near = (*best.circle[:2], best.circle[2] * factor)
        best = max(best, _clearest(image, near, 0.75 * limits.step, 0.5 * limits.step, limits))
    return best


def is_outlined(image: Picture, circle: CircleTuple, limits: NearParameters) -> bool:
    """Whether there is a step across the outline of a circle in enough directions.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.
    circle : (x, y, radius)
        px.
    limits : NearParameters
    """
    x, y, radius = circle
    lab, left, top = _around(image, circle, 0.0, limits)
    _, share = _clearness(lab, np.array([[x - left, y - top]], np.float32), radius, limits)
    return bool(share[0] >= limits.min_rim)


def _clearest(image: Picture, about: CircleTuple, offset: float, step: float, limits: NearParameters) -> ClearDisc:
    """Clearest disc of a radius whose center is at most so many radii from a place."""
    x, y, radius = about
    lab, left, top = _around(image, about, offset, limits)
    reach = int(offset / step)
    grid = np.arange(-reach, reach + 1) * step
    away = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
    away = away[np.hypot(*away.T) <= offset + TINY]
    centers = (np.array((x - left, y - top)) + radius * away).astype(np.float32)
    clear, share = _clearness(lab, centers, radius, limits)
    found = np.where(share >= limits.min_rim, clear, 0.0)
    best = int(found.argmax())
    across, down = centers[best].tolist()
    return ClearDisc(float(found[best]), (across + left, down + top, radius))


def _around(image: Picture, circle: CircleTuple, offset: float, limits: NearParameters) -> tuple[Singles, int, int]:
    """Smoothed CIE Lab of the picture about a circle, with lightness weighted, and its left and top edge, px."""
    x, y, radius = circle
    half = (limits.outside[-1] + offset) * radius + 1.0
    left, top = max(int(x - half), 0), max(int(y - half), 0)
    window = image[top : int(y + half) + 2, left : int(x + half) + 2]
    color = window if window.ndim == 3 else cv2.cvtColor(window, cv2.COLOR_GRAY2BGR)
    sigma = max(limits.smoothing * radius, limits.least_smoothing)
    smooth = cv2.GaussianBlur(color.astype(np.float32) / 255.0, (0, 0), sigma)
    lab = np.asarray(cv2.cvtColor(smooth, cv2.COLOR_BGR2LAB), np.float32)
    gray = float(np.percentile(np.abs(lab[..., 1:]), 99.0)) < SCORE.gray_chroma
    lab[..., 0] *= 1.0 if gray else limits.lightness
    return lab, left, top


def _clearness(lab: Singles, centers: Singles, radius: float, limits: NearParameters) -> tuple[Singles, Singles]:
    """How clear the discs about some centers are, and the share of the directions with a rim, (n,) each."""
    inside = len(limits.inside)
    colors, seen = _read(lab, centers, radius, limits)
    weights = np.array(limits.inside, np.float32) / sum(limits.inside)  # the area that a circle stands for
    disc = np.einsum("ncdk,c->nk", colors[:, :inside], weights) / limits.directions
    ring = colors[:, inside:].mean(axis=1)
    step = disc - ring.mean(axis=1)
    size = np.linalg.norm(step, axis=1)
    rim = colors[:, inside - NEXT_TO_RIM : inside].mean(axis=1) - ring
    along = np.einsum("ndk,nk->nd", rim, step) / np.maximum(size, TINY)[:, np.newaxis] ** 2
    share = ((along > limits.steep) & seen).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)
    clear = size / (_spread(ring) + limits.even) * share * min(radius / limits.full_size, 1.0) ** 0.5
    return clear, np.where(seen.mean(axis=1) >= SCORE.min_visible, share, 0.0)


def _read(lab: Singles, centers: Singles, radius: float, limits: NearParameters) -> tuple[Singles, Mask]:
    """Read sectors about some centers, (n, circles, directions, 3), and which directions are in the picture."""
    angles = 2.0 * np.pi * (np.arange(limits.directions * limits.rays) + 0.5) / (limits.directions * limits.rays)
    circles = radius * np.array((*limits.inside, *limits.outside), np.float32)[:, np.newaxis]
    ways = np.stack((circles * np.cos(angles), circles * np.sin(angles))).astype(np.float32)
    x, y = ((centers[:, k, np.newaxis] + ways[k].reshape(1, -1)).astype(np.float32) for k in range(2))
    colors = cv2.remap(lab, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    sectors = colors.reshape(len(centers), len(circles), limits.directions, limits.rays, 3).mean(axis=3)
    seen = (x >= 0.0) & (x <= lab.shape[1] - 1) & (y >= 0.0) & (y <= lab.shape[0] - 1)
    farthest = seen.reshape(len(centers), len(circles), limits.directions, limits.rays)[:, -1]
    return sectors, farthest.all(axis=2)


def _spread(ring: Singles) -> Singles:
    """Measure the standard deviation of the sectors of rings, (n, directions, 3), but for a slope across them, (n,)."""
    count = ring.shape[1]
    angles = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    waves = np.stack((np.cos(angles), np.sin(angles))).astype(np.float32)
    rest = ring - ring.mean(axis=1, keepdims=True)
    slopes = 2.0 / count * np.einsum("ndk,wd->nwk", rest, waves)
    rest = rest - np.einsum("nwk,wd->ndk", slopes, waves)
    return np.asarray(np.sqrt((rest**2).sum(axis=(1, 2)) / (count - SLOPE_TERMS)), np.float32)
