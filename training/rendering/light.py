"""The light that falls on a ball: `lit`.

Light of one direction and of the surroundings, shade below, a dark rim, a highlight, and light of the ground.
"""

import msgspec
import numpy as np

from training.rendering.layers import FULL, Floats, Offsets, Random, Range, Singles, happens, unit, within

TOWARD_CAMERA = np.array((0.0, 0.0, 1.0))


class LightParameters(msgspec.Struct, frozen=True):
    """How light falls on a ball; chosen by hand.

    Parameters
    ----------
    above : float
        By how much the light comes from above rather than from anywhere: length added to a random vector whose
        components have a standard deviation of 1.
    front : float
        The same for light from the camera's side, from which all light comes.
    ambient : (float, float)
        Share of light from all around.
    shades : float
        Share of balls with more shade on their lower part.
    shade : (float, float)
        How dark that is, as a share.
    shade_slope : (float, float)
        How fast it grows downward, per radius.
    shade_start : (float, float)
        How much there is of it at the center, as a share.
    rims : float
        Share of balls that are darker at the rim.
    rim : (float, float)
        How much darker, as a share.
    highlights : float
        Share of balls with a highlight.
    gloss : (float, float)
        Exponent of the highlight (Blinn 1977): more makes it smaller.
    highlight : (float, float)
        Its brightness, of 255.
    grounds : float
        Share of balls that the ground throws light on from below.
    ground : (float, float)
        Brightness of that, of 255; less than none is a darker ground.
    ground_tint : (float, float, float)
        Its color, BGR.
    """

    above: float = 0.9
    front: float = 0.2
    ambient: Range = (0.25, 1.0)
    shades: float = 0.4
    shade: Range = (0.2, 0.8)
    shade_slope: Range = (0.5, 1.5)
    shade_start: Range = (-0.5, 0.2)
    rims: float = 0.5
    rim: Range = (0.0, 0.6)
    highlights: float = 0.4
    gloss: Range = (5.0, 80.0)
    highlight: Range = (40.0, 230.0)
    grounds: float = 0.3
    ground: Range = (-10.0, 60.0)
    ground_tint: tuple[float, float, float] = (0.9, 1.0, 1.1)


def lit(random: Random, colors: Singles, normal: tuple[Offsets, Singles], limits: LightParameters) -> Singles:
    """Let light fall on a ball.

    Parameters
    ----------
    random : Generator
    colors : ndarray of shape (h, w, 3), float32
        Of the ball, over a whole picture.
    normal : (Offsets, ndarray of shape (h, w), float32)
        Direction of its surface at each pixel, x and y, and z toward the camera.
    limits : LightParameters

    Returns
    -------
    ndarray of shape (h, w, 3), float32
        0 ... 255.
    """
    light = random.normal(size=3)
    light[1] -= limits.above
    light[2] = abs(light[2]) + limits.front
    light = unit(light)
    below = normal[0].y
    seen = colors * _shading(random, light, normal, limits)[..., np.newaxis]
    if happens(random, limits.highlights):
        shine = _along(unit(light + TOWARD_CAMERA), normal) ** np.float32(within(random, limits.gloss))
        seen = seen + np.float32(within(random, limits.highlight)) * shine[..., np.newaxis]
    if happens(random, limits.grounds):
        ground = np.float32(within(random, limits.ground)) * np.asarray(limits.ground_tint, np.float32)
        seen = seen + np.clip(below, 0.0, 1.0)[..., np.newaxis] ** 2 * ground
    return np.asarray(np.clip(seen, 0.0, FULL), np.float32)


def _along(direction: Floats, normal: tuple[Offsets, Singles]) -> Singles:
    """Cosine between a direction and the surface's, where it is positive."""
    (x, y), z = normal
    along = direction.astype(np.float32)
    return np.asarray(np.clip(along[0] * x + along[1] * y + along[2] * z, 0.0, 1.0), np.float32)


def _shading(random: Random, light: Floats, normal: tuple[Offsets, Singles], limits: LightParameters) -> Singles:
    """Share of its color that each place of a ball shows."""
    ambient = np.float32(within(random, limits.ambient))
    shading = ambient + (1.0 - ambient) * _along(light, normal)
    if happens(random, limits.shades):
        depth = np.float32(within(random, limits.shade))
        slope, start = within(random, limits.shade_slope), within(random, limits.shade_start)
        shading = shading * (1.0 - depth * np.clip(normal[0].y * np.float32(slope) + np.float32(start), 0.0, 1.0))
    if happens(random, limits.rims):
        shading = shading * (1.0 - np.float32(within(random, limits.rim)) * (1.0 - normal[1]) ** 2)
    return np.asarray(shading, np.float32)
