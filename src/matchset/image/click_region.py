"""From a click to the pixels of the target: `regions_at_click`.

Two ways see different things. A region grown in color stops at a stripe or a shadow of the target and leaks where the
background is alike; the network of discs sees round things only (`disc_network.at_click`). Both give readings of the
click (`clicks.reading`), of which the likeliest counts. Where that is a disc and the region agrees, the target is what
either shows; where the region leaks or holds a part of the disc, the disc decides.
"""

import itertools
import math
from collections.abc import Sequence
from typing import Protocol

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.circle_score import median
from matchset.image.clicks.reading import REGION, Reading, readings_of
from matchset.image.color_learning import (
    DEFAULT,
    Bytes,
    ColorParameters,
    Floats,
    Mask,
    RegionParameters,
    cells_of,
    features,
    log_odds_between,
)
from matchset.image.disc_network.click_discs import WeighedDisc, discs_at

Circle3 = tuple[float, float, float]


class ColorTable(Protocol):
    """What tells pixels of the target: a `ColorModel`."""

    def scores(self, pixels: Bytes) -> npt.NDArray[np.int8]:
        """Positive where a pixel looks like the target."""


Points = npt.NDArray[np.int32]


def uniform_seed(values: Floats, x: float, y: float, parameters: ColorParameters = DEFAULT) -> Mask:
    """Small disc near a click where the color hardly varies.

    Parameters
    ----------
    values : ndarray of shape (h, w, 3), float32
        See `features`.
    x, y : float
        The click, px.
    parameters : ColorParameters

    Returns
    -------
    ndarray of shape (h, w), bool
        A disc of `seed_radius_px` at most `seed_search_px` from the click.
    """
    height, width = values.shape[:2]
    size = 2 * int(parameters.seed_radius_px) + 1
    far = int(parameters.seed_search_px) + size  # what the search sees, and a border that its means need
    left, top = max(round(x) - far, 0), max(round(y) - far, 0)
    near = values[top : round(y) + far + 1, left : round(x) + far + 1].copy()
    near[..., 2] *= parameters.lightness_weight
    mean, square = cv2.blur(near, (size, size)), cv2.blur(near**2, (size, size))
    deviation = np.sqrt(np.maximum(square - mean**2, 0.0).sum(axis=-1))
    rows, columns = np.indices(deviation.shape)
    away = np.hypot(columns + left - x, rows + top - y)
    allowed = away <= parameters.seed_search_px
    best = np.argmin(np.where(allowed, deviation + parameters.seed_distance_cost * away, np.inf))
    row, column = np.unravel_index(best, deviation.shape)
    rows, columns = np.ogrid[:height, :width]
    squared = (columns - (column + left)) ** 2 + (rows - (row + top)) ** 2
    return np.asarray(squared <= parameters.seed_radius_px**2)


def grow_region(values: Floats, seed: Mask, parameters: ColorParameters = DEFAULT) -> Mask:
    """Grow the connected region around the seed that is set off from what surrounds it.

    The tolerance is not chosen by hand: the region is grown with rising tolerances, and the one is taken around which
    its area stands still longest, since that is where it has met the target's own edge (as maximally stable extremal
    regions do, Matas et al. 2002).

    Parameters
    ----------
    values : ndarray of shape (h, w, 3), float32
        See `features`.
    seed : ndarray of shape (h, w), bool
        Pixels known to be target.
    parameters : ColorParameters

    Returns
    -------
    ndarray of shape (h, w), bool
        The seed and what grew from it.
    """
    levels = _tolerance_needed(values, seed, parameters)
    starts = [(int(x), int(y), int(levels[y, x])) for y, x in np.argwhere(seed).tolist()]
    areas = []
    for level in range(parameters.tolerances):
        area, _ = _flood(levels, starts, level)
        if area > parameters.largest_share * seed.size:
            break
        areas.append(area)
    return seed | _flood(levels, starts, most_stable(areas, parameters.stable_growth))[1] if areas else seed


def _tolerance_needed(values: Floats, seed: Mask, parameters: ColorParameters) -> Bytes:
    """Index of the first tolerance within which a pixel is like the seed, (h, w); their number where none is."""
    typical = median(values[seed])
    u, v, lightness = (values[..., k] - typical[k] for k in range(3))
    lightness *= parameters.lightness_weight
    distance = np.sqrt(u**2 + v**2 + lightness**2)
    levels = np.zeros(distance.shape, np.uint8)
    for tolerance in parameters.first_tolerance * parameters.tolerance_ratio ** np.arange(parameters.tolerances):
        single = np.float32(tolerance)  # the smallest number of single precision that is not below it
        levels += distance >= (single if single >= tolerance else np.nextafter(single, np.float32(np.inf)))
    return levels


def _flood(levels: Bytes, starts: list[tuple[int, int, int]], most: int) -> tuple[int, Mask]:
    """Area and mask of the pixels up to a level that are connected (4 neighbors) with starts up to that level."""
    mask, area = np.zeros((levels.shape[0] + 2, levels.shape[1] + 2), np.uint8), 0
    how = 4 | cv2.FLOODFILL_FIXED_RANGE | cv2.FLOODFILL_MASK_ONLY | 1 << 8
    for x, y, level in starts:
        if level <= most and not mask[y + 1, x + 1]:
            area += cv2.floodFill(levels, mask, (x, y), 0, level, most - level, how)[0]
    return area, np.asarray(mask[1:-1, 1:-1] == 1)


def most_stable(areas: list[int], stable_growth: float) -> int:
    """Index in the middle of the longest run over which the area hardly grows; of equal runs, the larger area's."""
    best, run = (0, 0), 0
    growth = [later / max(sooner, 1) for sooner, later in itertools.pairwise(areas)]
    for k, factor in enumerate(growth):
        run = run + 1 if factor < stable_growth and areas[k] > 0 else 0
        if run and run >= best[0]:
            best = (run, k + 1 - (run + 1) // 2)
    if best[0]:
        return best[1]
    return growth.index(min(growth)) if growth else 0


def points_of(region: Mask) -> Points:
    """Column and row of each pixel of a region, (n, 2)."""
    rows, columns = np.nonzero(region)
    return np.column_stack((columns, rows)).astype(np.int32)


def background_mask(region: Mask, parameters: ColorParameters = DEFAULT) -> Mask:
    """Pixels that are surely not target: outside a circle larger than the one that encloses the region.

    Parameters
    ----------
    region : ndarray of shape (h, w), bool
    parameters : ColorParameters

    Returns
    -------
    ndarray of shape (h, w), bool
    """
    (x, y), radius = cv2.minEnclosingCircle(points_of(region))
    outside = np.ones(region.shape, np.uint8)
    reach = int(parameters.background_ratio * radius) + parameters.background_margin_px
    cv2.circle(outside, (round(x), round(y)), reach, 0, -1)
    return outside.astype(bool)


def regions_at_click(
    image: Bytes, x: float, y: float, parameters: ColorParameters = DEFAULT, reading: int = 1
) -> tuple[list[Mask], tuple[Reading, ...]]:
    """Find what a click may mean, and what may be the pixels of one of these things.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    x, y : float
        The click, px.
    parameters : ColorParameters
    reading : int
        Which one: 1 for the likeliest.

    Returns
    -------
    regions : list of ndarray of shape (h, w), bool
        Likeliest first.
    readings : tuple of Reading
        Likeliest first, at least one.

    Raises
    ------
    ValueError
        If there is no such reading.
    """
    values = features(image, parameters)
    region = grow_region(values, uniform_seed(values, x, y, parameters), parameters)
    points = points_of(region)
    extent = circle_around(region)
    found = discs_at(image, x, y, (extent, _same_area(points)), parameters.ball)
    shares = _shares_with(region, found)
    readings = readings_of(found, shares, extent, parameters.ball)
    if not 1 <= reading <= len(readings):
        raise ValueError(f"reading {reading} of the click ({x:g}, {y:g}): there are {len(readings)}")
    taken = readings[reading - 1]
    if taken.name == REGION:
        return [region], readings
    grown = max(zip(shares, found, strict=True), key=lambda each: each[0])[1].circle
    if grown != taken.circle and any(each.circle == grown for each in readings):  # what grew is another reading
        region = disc_mask(region.shape, taken.circle, parameters.region.rim)
        return [_target_of(image, region, region, parameters), region], readings
    return _pixels_of(image, values, region, taken.circle, (x, y), parameters), readings


def _pixels_of(
    image: Bytes, values: Floats, region: Mask, circle: Circle3, click: tuple[float, float], parameters: ColorParameters
) -> list[Mask]:
    """Pixels of a target whose circle is known, likeliest first, from what grew around a click.

    The region alone stops at a stripe or a shadow and leaks where the background is alike; the circle takes in what is
    before it. Six arguments, since these are what is known of a click.
    """
    limits, points = parameters.region, points_of(region)
    extent = float(cv2.minEnclosingCircle(points)[1])
    disc = disc_mask(region.shape, circle, limits.rim)
    if not disc.any():
        return [region]
    both, union = float((region & disc).sum()), float((region | disc).sum())
    reach = limits.reach if float(region.sum()) < limits.large * float(disc.sum()) else 1.0
    shared = float((region & disc_mask(region.shape, circle, reach)).sum()) / float(region.sum())
    solid = _solidity(points)
    if solid >= limits.whole and both / union < limits.same and both > limits.large * float(disc.sum()):
        return [region, disc]
    if shared >= limits.part:
        small = both <= limits.little * float(disc.sum())
        part = _target_of(image, disc, region, parameters) & _alike(values, region, limits, gray_too=small)
        return [region | part, disc]
    is_disc = len(points) > limits.disc * math.pi * extent**2 * solid  # its hull is, whatever is printed on it
    beside = not region[round(click[1]), round(click[0])] and not is_disc
    if shared < limits.leaked and (solid < limits.solid or beside) and extent > limits.far * circle[2]:
        return [_target_of(image, disc, disc, parameters), disc]
    return [region, disc]


def disc_mask(shape: tuple[int, ...], circle: Circle3, share: float) -> Mask:
    """Pixels within a share of a circle's radius.

    Parameters
    ----------
    shape : tuple of int
        Rows and columns.
    circle : (x, y, radius)
        px.
    share : float

    Returns
    -------
    ndarray of shape (h, w), bool
    """
    rows, columns = np.ogrid[: shape[0], : shape[1]]
    return np.asarray((columns - circle[0]) ** 2 + (rows - circle[1]) ** 2 < (share * circle[2]) ** 2)


def _target_of(image: Bytes, disc: Mask, region: Mask, parameters: ColorParameters) -> Mask:
    """Pixels of a disc whose color is rarer in the background than in the disc: a finger before it is not."""
    outside = background_mask(disc | region, parameters)
    if not outside.any():
        return disc
    odds = log_odds_between(image, disc, outside, parameters)
    found = np.zeros(disc.shape, bool)
    found[disc] = odds[cells_of(image[disc], len(odds))] > parameters.region.rarer
    return found if found.any() else disc


def tells(model: ColorTable, image: Bytes, target: Mask, circle: Circle3, limits: RegionParameters) -> bool:
    """Whether the color of a region tells the circle that it is a part of, or is rare enough to be a thing of its own.

    A pale or shaded part of a ball may have the color of the wall: that color is hardly more frequent in the circle
    than around it, and all over the picture. A marker on a ball is neither.

    Parameters
    ----------
    model : ColorModel
        Learned from the region.
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    target : ndarray of shape (h, w), bool
        The region.
    circle : (x, y, radius)
        The most ball-like circle around the click, px.
    limits : RegionParameters
    """
    x, y, radius = circle
    reach = limits.ring[1] * radius
    left, top = max(math.floor(x - reach), 0), max(math.floor(y - reach), 0)
    near = image[top : math.ceil(y + reach) + 1, left : math.ceil(x + reach) + 1]
    place = (x - left, y - top, radius)
    disc, inner, outer = (disc_mask(near.shape[:2], place, share) for share in (limits.rim, *limits.ring))
    ring, alike = outer & ~inner, model.scores(near) > 0
    if not (disc.any() and ring.any()) or alike[disc].mean() - alike[ring].mean() > limits.contrast:
        return True
    everywhere = model.scores(image) > 0
    return bool((everywhere & target).sum() > limits.own * everywhere.sum())


def circle_around(region: Mask) -> Circle3:
    """Smallest circle around a region, px."""
    (x, y), radius = cv2.minEnclosingCircle(points_of(region))
    return float(x), float(y), float(radius)


def _same_area(points: Points) -> Circle3:
    """Circle about the center of a region with its area, px."""
    x, y = points.mean(axis=0).tolist()
    return x, y, math.sqrt(len(points) / math.pi)


def _shares_with(region: Mask, discs: Sequence[WeighedDisc]) -> list[float]:
    """Share of the pixels of a region and a disc together that are in both, for each disc."""
    masks = [disc_mask(region.shape, disc.circle, 1.0) for disc in discs]
    return [float((mask & region).sum()) / float((mask | region).sum()) for mask in masks]


def _solidity(points: Points) -> float:
    """Area of a region over the area of its convex hull."""
    return len(points) / max(float(cv2.contourArea(cv2.convexHull(points))), 1.0)


def _alike(values: Floats, region: Mask, limits: RegionParameters, gray_too: bool) -> Mask:
    """Pixels of about the hue of a region, and maybe those without one; all of them where the region has none."""
    u, v = values[..., 0], values[..., 1]
    typical = complex(float(u[region].mean()), float(v[region].mean()))
    if abs(typical) < limits.gray:
        return np.ones(region.shape, bool)
    along = u * (typical.real / abs(typical)) + v * (typical.imag / abs(typical))
    chroma = np.hypot(u, v)
    colored = chroma >= max(limits.gray, limits.vivid * abs(typical))
    return np.asarray(colored & (along > math.cos(limits.hue) * chroma) | ~colored & gray_too)
