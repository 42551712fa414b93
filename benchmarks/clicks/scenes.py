"""Pictures that mislead a click, drawn by chance with their truth: `draw`, from a kind and a seed."""

import math
from collections.abc import Callable
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt
from training.rendering.layers import (
    Random,
    Singles,
    any_angle,
    away,
    band,
    blurred,
    disc,
    ellipse,
    log_within,
    offsets,
    over,
    polygon,
    smooth_noise,
    within,
)

Circle3 = tuple[float, float, float]
Color = tuple[float, float, float]
Bytes = npt.NDArray[np.uint8]

SIZE = 480, 640  # geometry: rows and columns of a picture
DEEP, FAINT, DUSK = 0.55, 12.0, 30.0  # format: shade of a ball's rim; spread of a room; darkness of an eye
STRIPE = 0.18  # geometry: half the width of a stripe, radii
CORNERS = 7  # geometry: of a logo
MARGIN = 1.3  # geometry: least distance of a ball from the border, radii
ANYWHERE = 0.45  # geometry: how far from the middle of a ball something is printed, radii


class Drawn(NamedTuple):
    """A picture as a camera would give it, the ball meant, and the spot on it that was drawn, px."""

    image: Bytes
    circle: Circle3
    spot: Circle3 | None = None


def draw(kind: str, seed: int) -> Drawn:
    """Draw a picture.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    seed : int
        Pictures of odd seeds are gray.
    """
    random = np.random.default_rng((seed, *kind.encode()))
    picture, circle, spot = KINDS[kind](random)
    return Drawn(_taken(random, picture, gray=bool(seed % 2)), circle, spot)


def _taken(random: Random, picture: Singles, gray: bool) -> Bytes:
    """Blur a picture, add noise, and code it."""
    soft = blurred(picture, within(random, (0.5, 1.6)))
    noisy = soft + random.normal(0.0, within(random, (1.0, 6.0)), soft.shape)
    image = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    image = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8) if gray else image
    how = cv2.IMREAD_GRAYSCALE if gray else cv2.IMREAD_COLOR
    coded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, int(within(random, (45, 95)))])[1]
    return np.asarray(cv2.imdecode(coded, how), np.uint8)


def _room(random: Random) -> Singles:
    """Paint a wall of some color with large and small spots, and some boards."""
    picture = np.empty((*SIZE, 3), np.float32)
    picture[:] = random.uniform(70.0, 190.0) + random.uniform(-15.0, 15.0, 3)
    for distance in (90.0, 12.0):
        picture += FAINT * random.uniform(0.2, 0.7) * smooth_noise(random, SIZE, distance)[..., np.newaxis]
    for _ in range(4):
        corners = random.uniform((0.0, 0.0), SIZE[::-1]) + random.uniform(-160.0, 160.0, (4, 2))
        hull = np.asarray(cv2.convexHull(corners.astype(np.float32)))[:, 0]
        picture = over(picture, polygon(SIZE, hull), random.uniform(40.0, 210.0) + random.uniform(-20.0, 20.0, 3))
    return picture


def _vivid(random: Random) -> Color:
    """Choose a color far from gray, whose gray value is far from that of a pale thing."""
    hue, value = random.integers(0, 180), random.integers(90, 190)
    pixel = np.array([[[hue, random.integers(150, 255), value]]], np.uint8)
    blue, green, red = cv2.cvtColor(pixel, cv2.COLOR_HSV2BGR)[0, 0].tolist()
    return float(blue), float(green), float(red)


def _lit(random: Random, colors: Singles, circle: Circle3) -> Singles:
    """Shade what is on a ball: light from one side, a darker rim."""
    x, y = offsets(SIZE, circle)
    angle = any_angle(random)
    normal = np.sqrt(np.clip(1.0 - x**2 - y**2, 0.0, 1.0))
    light = (
        DEEP + (1.0 - DEEP) * normal + 0.25 * within(random, (0.0, 1.0)) * (x * math.cos(angle) + y * math.sin(angle))
    )
    return np.asarray(colors * np.clip(light, 0.2, 1.2)[..., np.newaxis], np.float32)


def _plain(color: Color) -> Singles:
    return np.asarray(np.ones((*SIZE, 1), np.float32) * np.asarray(color, np.float32), np.float32)


def _placed(random: Random, radius: float) -> Circle3:
    """Put a circle of a radius somewhere into the picture."""
    margin = MARGIN * radius
    return within(random, (margin, SIZE[1] - margin)), within(random, (margin, SIZE[0] - margin)), radius


def _pale(random: Random) -> Color:
    light = within(random, (190.0, 235.0))
    return light - within(random, (0.0, 25.0)), light, light - within(random, (0.0, 15.0))


def _before_disc(random: Random) -> tuple[Singles, Circle3, None]:
    """Draw a small vivid ball before a large pale disc."""
    large = within(random, (250.0, 390.0)), within(random, (190.0, 290.0)), within(random, (110.0, 205.0))
    picture = over(_room(random), disc(SIZE, large), _lit(random, _plain(_pale(random)), large))
    radius = log_within(random, (9.0, 34.0))
    ball = (*away(large[:2], any_angle(random), within(random, (0.0, 0.9)) * (large[2] - radius)), radius)
    return over(picture, disc(SIZE, ball), _lit(random, _plain(_vivid(random)), ball)), ball, None


def _beside_lamp(random: Random) -> tuple[Singles, Circle3, None]:
    """Draw a ball beside a large lamp with a glow around it."""
    ball = _placed(random, log_within(random, (10.0, 30.0)))
    radius = within(random, (2.0, 4.0)) * ball[2]
    apart = radius + ball[2] * within(random, (1.15, 2.0))
    lamp = (*away(ball[:2], any_angle(random), apart), radius)
    glow = np.exp(-np.maximum(np.hypot(*offsets(SIZE, lamp)) - 1.0, 0.0) * 4.0)[..., np.newaxis]
    picture = 0.6 * _room(random) + 60.0 * glow.astype(np.float32)
    picture = over(picture, disc(SIZE, ball), _lit(random, _plain(_vivid(random)), ball))
    return over(picture, disc(SIZE, lamp), (225.0, 250.0, 254.0)), ball, None


def _pupil(random: Random) -> tuple[Singles, Circle3, None]:
    """Draw a dark pupil in a dark iris in a dim eye, with glints and lids."""
    middle = (0.5 * SIZE[1] + within(random, (-60.0, 60.0)), 0.5 * SIZE[0] + within(random, (-60.0, 60.0)))
    iris = (*middle, within(random, (45.0, 100.0)))
    pupil = (*away(iris[:2], any_angle(random), 0.05 * iris[2]), iris[2] * within(random, (0.25, 0.55)))
    skin = DUSK * (2.0 + 0.4 * smooth_noise(random, SIZE, 120.0) + 0.12 * smooth_noise(random, SIZE, 10.0))
    picture = np.asarray(skin[..., np.newaxis] * np.array((0.9, 1.0, 1.1)), np.float32)
    white = ellipse(SIZE, iris, (2.3, within(random, (0.85, 1.2))), within(random, (-15.0, 15.0)))
    picture = over(picture, blurred(white, 3.0), (70.0, 72.0, 78.0))
    x, y = offsets(SIZE, iris)
    rays = np.sin(random.integers(20, 40) * np.arctan2(y, x) + 6.0 * np.hypot(x, y)) * 3.0
    tint = random.uniform(34.0, 46.0) + rays[..., np.newaxis] + random.uniform(-3.0, 3.0, 3)
    picture = over(picture, blurred(disc(SIZE, iris), 2.0) * white, tint)
    picture = over(picture, disc(SIZE, pupil), random.uniform(14.0, 24.0))
    glint = (*away(pupil[:2], any_angle(random), 0.9 * pupil[2]), 0.22 * pupil[2])
    return over(picture, disc(SIZE, glint), 150.0), pupil, None


def _printed(random: Random) -> tuple[Singles, Singles, Circle3, Color]:
    """Draw a room, the colors of a ball, where it is, and a color to print on it."""
    ball = _placed(random, log_within(random, (30.0, 110.0)))
    colors = (_vivid(random), _pale(random))
    base, ink = colors if random.random() < 0.5 else colors[::-1]
    return _room(random), _plain(base), ball, ink


def _finished(random: Random, room: Singles, colors: Singles, ball: Circle3) -> Singles:
    return over(room, disc(SIZE, ball), _lit(random, colors, ball))


def _spotted(random: Random) -> tuple[Singles, Circle3, Circle3]:
    """Draw a ball with a round spot."""
    room, colors, ball, ink = _printed(random)
    place = away(ball[:2], any_angle(random), within(random, (0.0, ANYWHERE)) * ball[2])
    spot = (*place, ball[2] * within(random, (0.22, 0.4)))
    return _finished(random, room, over(colors, disc(SIZE, spot), ink), ball), ball, spot


def _logo(random: Random) -> tuple[Singles, Circle3, Circle3]:
    """Draw a ball with a patch of no particular shape."""
    room, colors, ball, ink = _printed(random)
    place = away(ball[:2], any_angle(random), within(random, (0.0, ANYWHERE)) * ball[2])
    spot = (*place, ball[2] * within(random, (0.3, 0.5)))
    angles = np.sort(random.uniform(0.0, 2.0 * math.pi, CORNERS))
    reach = spot[2] * random.uniform(0.35, 1.0, CORNERS)
    corners = np.column_stack((place[0] + reach * np.cos(angles), place[1] + reach * np.sin(angles)))
    return _finished(random, room, over(colors, polygon(SIZE, corners), ink), ball), ball, spot


def _striped(random: Random) -> tuple[Singles, Circle3, None]:
    """Draw a ball with one to three parallel stripes."""
    room, colors, ball, ink = _printed(random)
    angle = any_angle(random)
    for at in np.linspace(-0.5, 0.5, random.integers(1, 4)) if random.random() < 0.7 else (0.0,):
        limits = (float(at) - STRIPE) * ball[2], (float(at) + STRIPE) * ball[2]
        colors = over(colors, band(SIZE, ball, angle, limits), ink)
    return _finished(random, room, colors, ball), ball, None


KINDS: dict[str, Callable[[Random], tuple[Singles, Circle3, Circle3 | None]]] = {
    "before a disc": _before_disc,
    "beside a lamp": _beside_lamp,
    "pupil": _pupil,
    "spotted": _spotted,
    "logo": _logo,
    "striped": _striped,
}
"""What is drawn, by name."""
