"""Things in front of a ball that are no hand: sticks (or lone fingers), straight edges and blobs."""

import msgspec
import numpy as np

from matchset.image.disc_network.patch_format import Circle3
from training.rendering.hands import Colors, skin_color
from training.rendering.layers import (
    BlobParameters,
    Counts,
    MaterialParameters,
    Random,
    Range,
    Singles,
    Size,
    any_angle,
    away,
    band,
    blob,
    blurred,
    count_within,
    darkened,
    happens,
    line,
    over,
    surface,
    which,
    within,
)
from training.rendering.photographs import Photographs

ENDLESS = 1e9  # px: width of what has one edge only


class CoverParameters(msgspec.Struct, frozen=True):
    """How things look that hide a ball, and where they are; chosen by hand.

    Parameters
    ----------
    counts : (float, float)
        Share of balls with nothing before them, and with one thing.
    many : (int, int)
        Least and largest number of things before the others.
    kinds : (float, float)
        Shares of sticks and of straight edges; the others are blobs.
    tip : (float, float)
        How far from the ball's center a stick ends, radii, toward where it comes from.
    stick_width : (float, float)
        Half its width, radii.
    stick_length : (float, float)
        Radii.
    stick_turn : float
        Standard deviation of its direction from that toward the ball's center, rad.
    stick_bend : float
        Standard deviation of its middle from the straight line, radii.
    edge : (float, float)
        Distance of a straight edge from the ball's center, radii.
    bars : float
        Share of edges that have another one behind them.
    bar_width : (float, float)
        Distance of the two, radii.
    blob : BlobParameters
    skins : float
        Share of things of the color of skin.
    skin : tuple of (float, float)
        Least and largest blue, green and red of that, of 255.
    light : (float, float)
        How much light falls on it, as a share.
    material : MaterialParameters
        Of skin.
    photographs : float
        Share of the others that show a part of a photograph; the rest have one color.
    color : (float, float)
        Least and largest channel of that, of 255.
    shadows : float
        Share of things with a shadow on the ball.
    shadow : (float, float)
        How dark that is, as a share.
    soft_shadow, least_soft : float
        Standard deviation by which it is blurred, radii, and at least px.
    """

    counts: tuple[float, float] = (0.35, 0.25)
    many: Counts = (2, 5)
    kinds: tuple[float, float] = (0.6, 0.2)
    tip: Range = (-0.3, 1.0)
    stick_width: Range = (0.12, 0.5)
    stick_length: Range = (1.8, 3.5)
    stick_turn: float = 0.5
    stick_bend: float = 0.15
    edge: Range = (0.1, 1.3)
    bars: float = 0.5
    bar_width: Range = (0.1, 0.6)
    blob: BlobParameters = BlobParameters()
    skins: float = 0.5
    skin: Colors = ((90.0, 160.0), (120.0, 180.0), (170.0, 235.0))
    light: Range = (0.45, 1.05)
    material: MaterialParameters = MaterialParameters(mottle=0.12, mottle_size=(0.2, 0.8), dark_rim=(0.0, 0.4))
    photographs: float = 0.6
    color: Range = (5.0, 250.0)
    shadows: float = 0.4
    shadow: Range = (0.0, 0.5)
    soft_shadow: float = 0.12
    least_soft: float = 0.5


def with_covers(
    random: Random, picture: Singles, circle: Circle3, photographs: Photographs, limits: CoverParameters
) -> Singles:
    """Hide a part of a ball, or nothing of it.

    Parameters
    ----------
    random : Generator
    picture : ndarray of shape (h, w, 3), float32
        With the ball.
    circle : (x, y, radius)
        Of the ball, px.
    photographs : Photographs
        What some of the things look like.
    limits : CoverParameters

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    kind = which(random, limits.counts)
    for _ in range(kind if kind < len(limits.counts) else count_within(random, limits.many)):
        mask = _shape(random, picture.shape[:2], circle, limits)
        colors = _colors(random, mask, circle[2], photographs, limits)
        if happens(random, limits.shadows):
            shadow = blurred(mask, max(limits.soft_shadow * circle[2], limits.least_soft))
            picture = darkened(picture, shadow, within(random, limits.shadow))
        picture = over(picture, mask, colors)
    return picture


def _shape(random: Random, size: Size, circle: Circle3, limits: CoverParameters) -> Singles:
    """Mask of a thing before a ball."""
    kind = which(random, limits.kinds)
    if kind == 0:
        return _stick(random, size, circle, limits)
    if kind == 1:
        start = within(random, limits.edge) * circle[2]
        width = within(random, limits.bar_width) * circle[2] if happens(random, limits.bars) else ENDLESS
        return band(size, circle, any_angle(random), (start, start + width))
    return blob(random, size, circle, limits.blob)


def _stick(random: Random, size: Size, circle: Circle3, limits: CoverParameters) -> Singles:
    """Mask of a stick, bent in its middle."""
    radius, angle = circle[2], any_angle(random)
    tip = away(circle[:2], angle, within(random, limits.tip) * radius)
    end = away(tip, angle + random.normal(0.0, limits.stick_turn), within(random, limits.stick_length) * radius)
    bend = random.normal(0.0, limits.stick_bend, 2) * radius
    middle = 0.5 * (tip[0] + end[0]) + float(bend[0]), 0.5 * (tip[1] + end[1]) + float(bend[1])
    return line(size, (tip, middle, end), within(random, limits.stick_width) * radius)


def _colors(random: Random, mask: Singles, radius: float, photographs: Photographs, limits: CoverParameters) -> Singles:
    """Colors of a thing before a ball: skin, a part of a photograph, or one color."""
    if happens(random, limits.skins):
        return surface(random, mask, skin_color(random, limits.skin, limits.light), radius, limits.material)
    if happens(random, limits.photographs):
        return photographs.crop(random, mask.shape[:2])
    return random.uniform(*limits.color, 3).astype(np.float32)
