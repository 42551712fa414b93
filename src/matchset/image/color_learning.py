"""From the pixels of the target to the log-odds of a color table.

Chroma and lightness tell what a color keeps and what it loses when the light changes: in them the region of the target
is grown (`click_region`), and densities of both over target and background give the log-odds. A BGR pixel with luma
``y = 0.114 b + 0.587 g + 0.299 r`` becomes three numbers,

    u = (b - y) / (b + g + r + 48),   v = (r - y) / (b + g + r + 48),   l = log2((y + 8) / 64).

Brighter or dimmer light moves l and hardly u and v; the 48 keeps dark, noisy pixels near gray. Densities over (u, v, l)
are histograms, smoothed.
"""

import functools
import itertools
from typing import cast

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.click_discs import BallAtClickParameters

Mask = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

LOW = np.array([-0.45, -0.45, -3.2], np.float32)  # geometry: middle of a histogram's first cell: u, v, l
STEP = np.array([0.02, 0.02, 0.15], np.float32)  # geometry: size of a histogram's cell: u, v, l
CELLS = (62, 62, 37)  # geometry: cells of a histogram along u, v, l
TINY = 1e-9


class RegionParameters(msgspec.Struct, frozen=True):
    """When a circle around the click takes the place of the grown region.

    Chosen by hand on `python -m benchmarks --only real`.

    Parameters
    ----------
    rim : float
        Share of the circle's radius within which its pixels are taken: beyond it blur mixes in the background.
    part, reach : float
        Share of the region in the circle from which it is a part of it, and how many radii a small part may reach.
    leaked : float
        Share of the region in the circle below which it has leaked, if it is ...
    solid : float
        ... less than this share of its convex hull; a solid region is another thing, on which the circle is printed,
        unless the click itself is outside of it and its hull is no disc: then it is the wall behind a small ball.
    far : float
        ... and if its enclosing circle is this many times as large.
    whole, same, large : float
        A region that is this share of its convex hull, of which circle and region together share less than `same`, and
        that covers this share of the circle, is a thing of another shape: a card with a circle around it.
    disc : float
        Share of its enclosing circle from which a region is a disc.
    hue, gray : float
        Difference in hue, rad, up to which a pixel of the circle may be the region in another light, and the chroma
        below which a pixel has no hue: a marker on a ball is another thing than the ball.
    vivid : float
        Share of the region's chroma below which a pixel has no hue either: what hides a ball mixes with it at its
        edges.
    little : float
        Share of the circle's pixels in the region up to which pixels without a hue belong to the target: shade or
        highlight of a ball of which little was grown, else what hides it.
    rarer : float
        Log-odds, circle against background, from which a pixel of the circle belongs to the target.
    contrast, ring : float, tuple of float
        By how much larger the share of pixels of the region's color must be in the circle than in the ring around it,
        between so many radii. On nine real clips it was 0.13 or less in two clicks that gave nothing, and 0.55 or more
        in all others.
    own : float
        Share of all pixels of that color that must lie in the region where it is not; otherwise the circle's color is
        learned first. 0.02 or less in the two clicks.
    """

    rim: float = 0.88
    part: float = 0.75
    reach: float = 1.2
    leaked: float = 0.6
    solid: float = 0.8
    far: float = 3.0
    whole: float = 0.9
    same: float = 0.8
    large: float = 0.5
    disc: float = 0.9
    hue: float = 0.3
    gray: float = 0.03
    vivid: float = 0.4
    little: float = 0.25
    rarer: float = 0.0
    contrast: float = 0.4
    ring: tuple[float, float] = (1.15, 1.6)
    own: float = 0.1


class ColorParameters(msgspec.Struct, frozen=True):
    """How a color is learned from a click or a box.

    Chosen by hand on real footage; `tests/image/test_color_learning.py` and ``python -m benchmarks --only real`` would
    show a change.

    Parameters
    ----------
    smoothing_px : float
        Standard deviation of the Gaussian by which the picture is smoothed before regions are grown, px. Larger
        averages noise and compression away, and joins what lies close together.
    seed_radius_px, seed_search_px : float
        Radius of the disc from which a click's region grows, and how far from the click its center may lie, px: people
        click near rims, stripes and highlights too.
    seed_distance_cost : float
        Standard deviation of the color, in units of chroma, that one px of distance from the click is worth.
    lightness_weight : float
        Chroma distance that an octave of lightness counts as: light may vary over the target.
    gray_levels_per_unit : float
        Gray levels of a gray picture that count as one unit of chroma.
    first_tolerance, tolerance_ratio, tolerances
        Chroma distances that are tried: the first, the ratio from each to the next, and how many.
    largest_share : float
        Share of the picture beyond which a region has leaked into the background.
    stable_growth : float
        Growth of the area from one tolerance to the next that still counts as standing still.
    background_ratio, background_margin_px : float
        The background begins outside the circle around the region, its radius times this ratio and this many px more.
    unknown_target, unknown_background : float
        Share of target and background that may have any color at all: no color is impossible.
    narrowest, widest : float
        Limits of the smoothing of the target's density along u and v; between them it follows Silverman's rule.
    target_octaves, background_octaves : float
        Smoothing along lightness, octaves: wide for the target, since light changes lightness first.
    background_width : float
        Smoothing of the background's density along u and v.
    gray_width : float
        Smoothing of the densities of gray pictures, gray levels.
    surroundings : float
        Where the color is all over the picture, only what is within so many radii of the clicked circle is background.
    least_hits, most_false : float
        A color is refused if less than this share of the region looks like the target, or if the background has more
        than this many times that share.
    region : RegionParameters
        When a circle around a click takes the place of the grown region.
    ball : BallAtClickParameters
        How the network of discs looks for a ball around a click.
    """

    smoothing_px: float = 2.0
    seed_radius_px: float = 3.0
    seed_search_px: float = 7.0
    seed_distance_cost: float = 0.002
    lightness_weight: float = 0.06
    gray_levels_per_unit: float = 400.0
    first_tolerance: float = 0.012
    tolerance_ratio: float = 1.2
    tolerances: int = 19
    largest_share: float = 0.4
    stable_growth: float = 1.12
    background_ratio: float = 1.4
    background_margin_px: int = 4
    unknown_target: float = 0.06
    unknown_background: float = 0.12
    narrowest: float = 0.018
    widest: float = 0.06
    target_octaves: float = 0.9
    background_octaves: float = 0.3
    background_width: float = 0.02
    gray_width: float = 6.0
    surroundings: float = 3.0
    least_hits: float = 0.5
    most_false: float = 0.5
    region: RegionParameters = RegionParameters()
    ball: BallAtClickParameters = BallAtClickParameters()

    def without_balls(self) -> "ColorParameters":
        """Return the same, with which no click means a ball."""
        return msgspec.structs.replace(self, ball=msgspec.structs.replace(self.ball, used=False))


DEFAULT = ColorParameters()


def features(image: Bytes, parameters: ColorParameters = DEFAULT) -> Floats:
    """Smoothed features of every pixel, (h, w, 3): chroma of a color picture, the gray value repeated otherwise.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    parameters : ColorParameters

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    smooth = np.asarray(cv2.GaussianBlur(image, (0, 0), parameters.smoothing_px), np.uint8)
    if smooth.ndim == 3:
        return chroma(smooth)
    level = smooth.astype(np.float32) / parameters.gray_levels_per_unit
    return np.stack((level, level, np.zeros_like(level)), axis=-1)


def bin_centers() -> Floats:
    """BGR value in the middle of each of the 32 x 32 x 32 cells, (32768, 3)."""
    level = np.arange(32, dtype=np.float32) * 8.0 + 3.5
    return np.stack(np.meshgrid(level, level, level, indexing="ij"), axis=-1).reshape(-1, 3)


def color_log_odds(target: Bytes, background: Bytes, parameters: ColorParameters = DEFAULT) -> Floats:
    """Log-odds of the BGR cells: chroma counts, lightness only where the background says so.

    Parameters
    ----------
    target, background : ndarray of shape (n, 3), uint8
        Pixels of each.
    parameters : ColorParameters

    Returns
    -------
    ndarray of shape (32768,), float32
    """
    inside = chroma(target)
    spread = inside[:, :2].std(axis=0) * len(inside) ** (-1 / 6)  # theorem: Silverman's rule in two dimensions
    width = np.clip(spread, parameters.narrowest, parameters.widest)
    wanted = density(inside, (float(width[0]), float(width[1]), parameters.target_octaves))
    blur = parameters.background_width, parameters.background_width, parameters.background_octaves
    other = density(chroma(background), blur)
    uniform = 1.0 / (0.25 * wanted.size)  # a quarter of the cells holds all colors that there are
    shares = parameters.unknown_target, parameters.unknown_background
    likely, unlikely = (
        look_up(grid) * (1 - unknown) + unknown * uniform for grid, unknown in zip((wanted, other), shares, strict=True)
    )
    return np.asarray(np.log(likely / unlikely), np.float32)


def gray_log_odds(target: Bytes, background: Bytes, parameters: ColorParameters = DEFAULT) -> Floats:
    """Log-odds of the 256 gray values, see `color_log_odds`."""
    densities, unknowns = [], (parameters.unknown_target, parameters.unknown_background)
    for pixels, unknown in zip((target, background), unknowns, strict=True):
        counts = np.bincount(pixels.ravel(), minlength=256).astype(np.float32).reshape(1, -1)
        smooth = cv2.GaussianBlur(counts, (0, 0), parameters.gray_width, borderType=cv2.BORDER_REPLICATE).ravel()
        densities.append(smooth / smooth.sum() * (1 - unknown) + unknown / 256.0)
    return np.asarray(np.log(densities[0] / densities[1]), np.float32)


def log_odds_between(image: Bytes, target: Mask, background: Mask, parameters: ColorParameters = DEFAULT) -> Floats:
    """Log-odds of the BGR cells of a color picture, or of the values of a gray one, from two regions of it.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    target, background : ndarray of shape (h, w), bool
    parameters : ColorParameters

    Returns
    -------
    ndarray of shape (32768,) or (256,), float32
    """
    learn = color_log_odds if image.ndim == 3 else gray_log_odds
    return learn(image[target], image[background], parameters)


def cells_of(pixels: Bytes, cells: int) -> npt.NDArray[np.uint16] | Bytes:
    """Places of pixels in a table: BGR cells ``(b >> 3) << 10 | (g >> 3) << 5 | r >> 3``, or gray values.

    Parameters
    ----------
    pixels : ndarray, uint8
        B, G and R along the last axis, or gray values.
    cells : int
        Size of the table: 32768, or 256 for gray.
    """
    if cells == 256:
        return pixels
    blue, green, red = ((pixels[..., k] >> 3).astype(np.uint16) for k in range(3))
    return np.asarray(blue << 10 | green << 5 | red)


def chroma(pixels: Bytes | Floats) -> Floats:
    """Chroma and lightness of pixels.

    Parameters
    ----------
    pixels : ndarray of shape (..., 3)
        Blue, green, red, 0 ... 255.

    Returns
    -------
    ndarray of shape (..., 3), float32
        u, v, l of the module's equation.
    """
    values = np.asarray(pixels, np.float32)
    b, g, r = values[..., 0], values[..., 1], values[..., 2]
    y = 0.114 * b + 0.587 * g + 0.299 * r
    whole = b + g + r + 48.0
    found = np.empty(values.shape, np.float32)
    np.divide(b - y, whole, out=found[..., 0])
    np.divide(r - y, whole, out=found[..., 1])
    np.log2((y + 8.0) / 64.0, out=found[..., 2])
    return found


def density(points: Floats, blur: tuple[float, float, float]) -> Floats:
    """Smoothed histogram of chroma points that sums to 1.

    Parameters
    ----------
    points : ndarray of shape (n, 3), float32
        u, v, l.
    blur : tuple of float
        Standard deviation of the smoothing along u, v and l, in their own units.

    Returns
    -------
    ndarray of shape `CELLS`, float32
    """
    flat = np.zeros(len(points), np.int32)
    for axis, cells in enumerate(CELLS):
        flat *= cells
        flat += np.clip(np.round((points[:, axis] - LOW[axis]) / STEP[axis]), 0, cells - 1).astype(np.int32)
    counts = np.bincount(flat, minlength=CELLS[0] * CELLS[1] * CELLS[2])
    grid = counts.reshape(CELLS).astype(np.float32)
    for axis, sigma in enumerate(blur):
        grid = _blur(grid, sigma / float(STEP[axis]), axis)
    return cast(Floats, grid / max(float(grid.sum()), TINY))


def look_up(grid: Floats) -> Floats:
    """Value of a density at the middle of each BGR cell, linear between the cells of the density.

    Parameters
    ----------
    grid : ndarray of shape `CELLS`, float32

    Returns
    -------
    ndarray of shape (32768,), float32
    """
    found, flat = np.zeros(len(bin_centers()), np.float32), grid.ravel()
    for places, weights in _corners():
        found += weights * flat[places]
    return found


@functools.cache
def _corners() -> list[tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]]:
    """Eight cells of a density around each BGR cell: places in the flat density, and weights."""
    places = np.clip((chroma(bin_centers()) - LOW) / STEP, 0.0, np.array(CELLS, np.float32) - 1.0)
    lower = np.minimum(places.astype(np.int64), np.array(CELLS) - 2)
    share = places - lower
    found = []
    for corner in itertools.product((0, 1), repeat=3):
        u, v, lightness = (share[:, k] if corner[k] else 1.0 - share[:, k] for k in range(3))
        cells = (lower + corner).T
        flat = (cells[0] * CELLS[1] + cells[1]) * CELLS[2] + cells[2]
        found.append((flat.astype(np.int32), u * v * lightness))
    return found


def _blur(grid: Floats, sigma: float, axis: int) -> Floats:
    """Smooth along one axis with a Gaussian, in cells; nothing lies outside the grid."""
    rows = np.ascontiguousarray(np.moveaxis(grid, axis, 2))
    size = 2 * int(4.0 * sigma + 0.5) + 1
    weights = cv2.getGaussianKernel(size, sigma)
    flat = cv2.sepFilter2D(rows.reshape(-1, rows.shape[2]), -1, weights, np.ones(1), borderType=cv2.BORDER_CONSTANT)
    return cast(Floats, np.moveaxis(np.asarray(flat).reshape(rows.shape), 2, axis))
