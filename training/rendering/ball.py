"""The colors of a ball before light falls on it: `ball_colors`.

A ball has a color of its own, or that of its surroundings, and is plain, mottled, marbled or has seams or spots.
"""

import cv2
import msgspec
import numpy as np

from matchset.image.disc_network.patch_format import Circle3
from training.rendering.layers import (
    FULL,
    Counts,
    Floats,
    Offsets,
    Random,
    Range,
    Singles,
    any_angle,
    away,
    count_within,
    happens,
    pixel_at,
    smooth_noise,
    unit,
    which,
    within,
)


class BallColorParameters(msgspec.Struct, frozen=True):
    """Which color a ball has; chosen by hand.

    Parameters
    ----------
    shares : (float, float)
        Of balls with the color of their surroundings, and of those with a vivid one; the others are gray.
    beside : (float, float)
        How far from the ball's center its surroundings are looked at, radii.
    differs : float
        Standard deviation of a channel of a ball's color from that of its surroundings, of 255.
    hues : int
        Hues to choose from, as OpenCV counts them.
    saturation, value : (int, int)
        Of a vivid color, of 255.
    grays : tuple of (float, float)
        Light, dark and middle grays, of 255, each as likely.
    tint : float
        Standard deviation of a channel of a gray ball, of 255.
    limits : (float, float)
        Darkest and lightest channel, of 255.
    """

    shares: tuple[float, float] = (0.3, 0.5)
    beside: Range = (1.1, 2.0)
    differs: float = 18.0
    hues: int = 180
    saturation: Counts = (90, 255)
    value: Counts = (50, 255)
    grays: tuple[Range, ...] = ((170.0, 250.0), (8.0, 60.0), (60.0, 190.0))
    tint: float = 6.0
    limits: Range = (3.0, 250.0)


class PatternParameters(msgspec.Struct, frozen=True):
    """What is on a ball; chosen by hand.

    Parameters
    ----------
    shares : (float, float, float, float)
        Of mottled and marbled balls, and of those with seams and with spots; the others are plain.
    mottle : (float, float)
        Standard deviation of the brightness of a mottled ball, as a share.
    mottle_size : (float, float)
        Distance over which that changes, radii.
    second : float
        Standard deviation of a channel of the second color of a marbled ball from the first, of 255.
    marble_size : (float, float)
        Distance over which these change, radii.
    marble_slope : (float, float)
        How suddenly they do: slope of a logistic function of smooth noise.
    marble_level : (float, float)
        From which value of that noise the second color prevails, standard deviations.
    seams : (int, int)
        Least and largest number of seams: circles on the ball.
    dark_seams : float
        Share of balls with dark seams; the others' are light.
    seam_dark : (float, float)
        Color of dark seams as a share of the ball's.
    seam_light : float
        By how much light seams are lighter, of 255.
    seam_offset : (float, float)
        Distance of a seam's plane from the ball's center, radii.
    seam_width : (float, float)
        Half the width of a seam, radii.
    spots : (int, int)
        Least and largest number of spots: a logo, a marker.
    spot_differs : float
        Standard deviation of a channel of their color from the ball's, of 255.
    spot_size : (float, float)
        Half the angle of a spot, seen from the ball's center, rad.
    spot_faces : float
        Share of spots that face the camera, about.
    spot_turned : float
        Standard deviation of the direction of those, along x and y.
    """

    shares: tuple[float, float, float, float] = (0.22, 0.13, 0.1, 0.15)
    mottle: Range = (0.03, 0.2)
    mottle_size: Range = (0.08, 0.6)
    second: float = 50.0
    marble_size: Range = (0.3, 1.2)
    marble_slope: Range = (2.0, 8.0)
    marble_level: Range = (-0.3, 1.0)
    seams: Counts = (1, 3)
    dark_seams: float = 0.6
    seam_dark: Range = (0.1, 0.6)
    seam_light: float = 90.0
    seam_offset: Range = (-0.5, 0.5)
    seam_width: Range = (0.03, 0.1)
    spots: Counts = (1, 3)
    spot_differs: float = 70.0
    spot_size: Range = (0.12, 0.6)
    spot_faces: float = 0.6
    spot_turned: float = 0.25


class BallParameters(msgspec.Struct, frozen=True):
    """How a ball looks before light falls on it.

    Parameters
    ----------
    color : BallColorParameters
    pattern : PatternParameters
    """

    color: BallColorParameters = BallColorParameters()
    pattern: PatternParameters = PatternParameters()


def ball_colors(
    random: Random, around: Singles, circle: Circle3, normal: tuple[Offsets, Singles], limits: BallParameters
) -> Singles:
    """Colors of a ball in even light, over a whole picture.

    Parameters
    ----------
    random : Generator
    around : ndarray of shape (h, w, 3), float32
        The picture that the ball will be in.
    circle : (x, y, radius)
        Where it will be, px.
    normal : (Offsets, ndarray of shape (h, w), float32)
        Direction of its surface at each pixel, x and y, and z toward the camera.
    limits : BallParameters

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    color = _color(random, around, circle, limits.color)
    colors = np.empty_like(around)
    colors[:] = np.clip(color, *limits.color.limits)
    pattern, size = limits.pattern, (around.shape[0], around.shape[1])
    kind = which(random, pattern.shares)
    if kind == 0:
        noise = smooth_noise(random, size, within(random, pattern.mottle_size) * circle[2])
        colors *= 1.0 + np.float32(within(random, pattern.mottle)) * noise[..., np.newaxis]
    elif kind == 1:
        second = np.clip(color + random.normal(0.0, pattern.second, 3), 0.0, FULL)
        noise = smooth_noise(random, size, within(random, pattern.marble_size) * circle[2])
        slope, level = within(random, pattern.marble_slope), within(random, pattern.marble_level)
        colors = _mixed(colors, 1.0 / (1.0 + np.exp(-np.float32(slope) * (noise - np.float32(level)))), second)
    elif kind == 2:
        colors = _seamed(random, colors, color, circle[2], normal, pattern)
    elif kind == 3:
        colors = _spotted(random, colors, color, circle[2], normal, pattern)
    return colors


def _color(random: Random, around: Singles, circle: Circle3, limits: BallColorParameters) -> Floats:
    """Color of a ball, BGR, not yet limited."""
    kind = which(random, limits.shares)
    if kind == 0:
        place = away(circle[:2], any_angle(random), within(random, limits.beside) * circle[2])
        return np.asarray(pixel_at(around, *place) + random.normal(0.0, limits.differs, 3))
    if kind == 1:
        hue = int(random.integers(limits.hues))
        hsv = np.array([[[hue, count_within(random, limits.saturation), count_within(random, limits.value)]]], np.uint8)
        return np.asarray(cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)[0, 0], np.float64)
    gray = within(random, limits.grays[int(random.integers(len(limits.grays)))])
    return np.asarray(gray + random.normal(0.0, limits.tint, 3))


def _mixed(colors: Singles, share: Singles, second: Floats) -> Singles:
    """Mix a share of a second color into a ball's."""
    part = share[..., np.newaxis]
    return np.asarray(colors * (1.0 - part) + part * second.astype(np.float32), np.float32)


def _seamed(
    random: Random,
    colors: Singles,
    color: Floats,
    radius: float,
    normal: tuple[Offsets, Singles],
    limits: PatternParameters,
) -> Singles:
    """Draw seams: where planes cut the ball."""
    if happens(random, limits.dark_seams):
        seam = color * within(random, limits.seam_dark)
    else:
        seam = np.clip(color + limits.seam_light, 0.0, FULL)
    (x, y), z = normal
    for _ in range(count_within(random, limits.seams)):
        plane = unit(random.normal(size=3)).astype(np.float32)
        offset = np.float32(within(random, limits.seam_offset))
        distance = np.abs(plane[0] * x + plane[1] * y + plane[2] * z - offset)
        share = np.clip((np.float32(within(random, limits.seam_width)) - distance) * np.float32(radius), 0.0, 1.0)
        colors = _mixed(colors, np.asarray(share, np.float32), seam)
    return colors


def _spotted(
    random: Random,
    colors: Singles,
    color: Floats,
    radius: float,
    normal: tuple[Offsets, Singles],
    limits: PatternParameters,
) -> Singles:
    """Draw spots: where cones from the center cut the ball."""
    (x, y), z = normal
    for _ in range(count_within(random, limits.spots)):
        toward = random.normal(size=3)
        if happens(random, limits.spot_faces):
            toward = np.append(limits.spot_turned * toward[:2], 1.0)
        middle, size = unit(toward).astype(np.float32), within(random, limits.spot_size)
        depth = (middle[0] * x + middle[1] * y + middle[2] * z - np.float32(np.cos(size))) / np.float32(np.sin(size))
        share = np.clip(depth * np.float32(radius) + np.float32(0.5), 0.0, 1.0)
        colors = _mixed(colors, share, np.clip(color + random.normal(0.0, limits.spot_differs, 3), 0.0, FULL))
    return colors


def surface_normal(place: Offsets) -> tuple[Offsets, Singles]:
    """Direction of a ball's surface at each pixel, z toward the camera; beyond the ball it goes on as at its rim."""
    return place, np.asarray(np.sqrt(1.0 - np.minimum(place.x**2 + place.y**2, 1.0)), np.float32)
