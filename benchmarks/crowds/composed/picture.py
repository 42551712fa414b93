"""How balls are laid into a picture: `Painter`, with light, shadow, blur and noise; and what is seen: `shares`."""

import math
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.crowds.composed.footage import HEIGHT, RADIUS, SIDE, WIDTH, Bytes, Floats

LEVELS = (1.0, 0.5, 0.25)  # sizes at which a cut-out is kept
RIM = 1.0  # px, from a ball to its background
MOST_BLUR = 10  # places that make a blurred ball
SHIFTED = 97  # px, by less than which the noise of frames is shifted


class Look(NamedTuple):
    """What one ball looks like.

    Parameters
    ----------
    cutouts : tuple of two arrays
        Between which it changes as it turns.
    gain : float
        Its brightness.
    """

    cutouts: tuple[Floats, Floats]
    gain: float


class Laid(NamedTuple):
    """A ball while the shutter is open.

    Parameters
    ----------
    look : Look
    begin, middle, end : tuple of float
        Center, px.
    radius : float
        px.
    turn : float
        rad.
    """

    look: Look
    begin: tuple[float, float]
    middle: tuple[float, float]
    end: tuple[float, float]
    radius: float
    turn: float


class Painter:
    """Lays balls into the frames of one background.

    Parameters
    ----------
    background : list of arrays
        Its frames; a photograph is one.
    softness : float
        Of the lens, px.
    shade : float
        Darkness of shadows, from 0 to 1.
    floor : float or None
        Height of the floor, px, on which shadows lie; None: they lie beside the balls.
    """

    def __init__(self, background: list[Bytes], softness: float, shade: float, floor: float | None) -> None:
        self._background, self._softness, self._shade, self._floor = background, softness, shade, floor
        gray = cv2.cvtColor(background[0], cv2.COLOR_BGR2GRAY).astype(np.float32)
        smooth = cv2.GaussianBlur(gray, (0, 0), 45.0)
        self._light = np.clip((smooth + 20.0) / (float(smooth.mean()) + 20.0), 0.65, 1.6) ** 0.6
        self.noise = float(np.clip(noise_of(gray), 0.8, 3.0))
        size = (HEIGHT + SHIFTED, WIDTH + SHIFTED, 3)
        noise = np.random.default_rng(0).normal(0.0, self.noise, size).astype(np.float32)
        self._noise = 1.5 * cv2.GaussianBlur(noise, (0, 0), 0.6)

    def paint(self, index: int, balls: list[Laid], random: np.random.Generator) -> Bytes:
        """Lay balls, the farthest first, into a frame of the background.

        Returns
        -------
        array of uint8
        """
        number = index % max(2 * len(self._background) - 2, 1)  # to and fro
        frame = self._background[min(number, 2 * len(self._background) - 2 - number)]
        picture = frame.astype(np.float32)
        for ball in balls:
            self._shadow(picture, ball)
        covered = np.zeros((HEIGHT, WIDTH), np.float32)
        for ball in balls:
            self._ball(picture, covered, ball)
        top, left = random.integers(0, SHIFTED, 2)
        noise = self._noise[top : top + HEIGHT, left : left + WIDTH]
        if len(self._background) > 1:  # its frames have noise of their own
            noise = noise * covered[:, :, np.newaxis]
        return np.clip(np.rint(picture + noise), 0, 255).astype(np.uint8)

    def _shadow(self, picture: Floats, ball: Laid) -> None:
        """Darken what is below a ball on its floor, the less the higher it is, or what is beside it."""
        x, y = ball.middle
        radius = ball.radius
        if self._floor is None:
            wide, high, dark, x, y = radius, radius, 0.6 * self._shade, x + 0.25 * radius, y + 0.3 * radius
        else:
            above = max(self._floor - y - radius, 0.0) / radius
            spread = 1.0 + 0.25 * above
            wide, high, dark = 0.95 * radius * spread, 0.28 * radius * spread, self._shade / (1.0 + 0.6 * above) ** 1.5
            y = self._floor
        left, top, right, bottom = _box(x, y, 2.0 * wide, 2.0 * high)
        if left >= right or top >= bottom or dark < 0.01:
            return
        rows, columns = np.mgrid[top:bottom, left:right]
        far = ((columns - x) / wide) ** 2 + ((rows - y) / high) ** 2
        picture[top:bottom, left:right] *= (1.0 - dark * np.exp(-(far**1.5)))[:, :, np.newaxis]

    def _ball(self, picture: Floats, covered: Floats, ball: Laid) -> None:
        length = math.dist(ball.begin, ball.end)
        number = int(np.clip(math.ceil(length), 1, MOST_BLUR))
        margin = ball.radius + length / 2.0 + 4.0
        left, top, right, bottom = _box(*ball.middle, margin, margin, -math.ceil(2.0 * margin))
        if right <= 0 or bottom <= 0 or left >= WIDTH or top >= HEIGHT:
            return
        total: Floats = np.zeros((bottom - top, right - left, 4), np.float32)
        cut = _turned(ball)
        for part in (np.arange(number) + 0.5) / number:
            x, y = (_between(*each, part) for each in zip(ball.begin, ball.middle, ball.end, strict=True))
            total += _patch(ball, cut, x - left, y - top, total.shape[1], total.shape[0])
        total = np.asarray(cv2.GaussianBlur(total / number, (0, 0), self._softness), np.float32)
        x0, y0, x1, y1 = max(left, 0), max(top, 0), min(right, WIDTH), min(bottom, HEIGHT)
        total = total[y0 - top : y1 - top, x0 - left : x1 - left]
        alpha = total[:, :, 3:]
        light = self._light[y0:y1, x0:x1, np.newaxis]
        shown = picture[y0:y1, x0:x1]
        shown[:] = shown * (1.0 - alpha) + np.minimum(total[:, :, :3] * light, 255.0 * alpha)
        covered[y0:y1, x0:x1] = np.maximum(covered[y0:y1, x0:x1], alpha[:, :, 0])


def _turned(ball: Laid) -> Floats:
    """Mix the cut-outs of a ball, at a size not much larger than it."""
    mixed = 0.5 + 0.5 * math.sin(3.0 * ball.turn)
    one, other = ball.look.cutouts
    cut = (1.0 - mixed) * one + mixed * other
    size = round(SIDE * min((each for each in LEVELS if each * RADIUS >= ball.radius), default=1.0))
    return np.asarray(cv2.resize(cut, (size, size), interpolation=cv2.INTER_AREA), np.float32)


def _patch(ball: Laid, cut: Floats, x: float, y: float, width: int, height: int) -> Floats:
    """Picture of a ball, premultiplied with its share of each pixel."""
    size = len(cut)
    scale = ball.radius * SIDE / (RADIUS * size)
    angle = 0.35 * math.sin(ball.turn)
    c, s, middle = scale * math.cos(angle), scale * math.sin(angle), (size - 1) / 2.0
    matrix = np.array(((c, -s, x - (c - s) * middle), (s, c, y - (s + c) * middle)))
    color = cv2.warpAffine(cut, matrix, (width, height), flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    rows, columns = np.indices((height, width))
    alpha = np.clip((ball.radius - np.hypot(columns - x, rows - y)) / RIM + 0.5, 0.0, 1.0)[:, :, np.newaxis]
    return np.concatenate((ball.look.gain * color * alpha, alpha), axis=2).astype(np.float32)


def _between(begin: float, middle: float, end: float, part: float) -> float:
    if part < 0.5:
        return begin + 2.0 * part * (middle - begin)
    return middle + (2.0 * part - 1.0) * (end - middle)


def _box(x: float, y: float, wide: float, high: float, least: int = 0) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of a rectangle; it ends at the picture, or `-least` px beyond it."""
    left, top = max(math.floor(x - wide), least), max(math.floor(y - high), least)
    right = min(math.ceil(x + wide) + 1, WIDTH - least)
    return left, top, right, min(math.ceil(y + high) + 1, HEIGHT - least)


def noise_of(gray: Floats) -> float:
    """Estimate the standard deviation of a picture's noise from its second derivatives (Immerkaer 1996)."""
    kernel = np.array(((1, -2, 1), (-2, 4, -2), (1, -2, 1)), np.float32)
    return float(np.median(np.abs(cv2.filter2D(gray, cv2.CV_32F, kernel)))) / (6.0 * 0.6745)


def shares(circles: list[tuple[float, float, float]]) -> list[float]:
    """Share of each disc that is in the picture and behind nothing.

    Parameters
    ----------
    circles : list of tuple of three floats
        Center x, y and radius, px; the farthest first.

    Returns
    -------
    list of float
    """
    free = np.ones((HEIGHT, WIDTH), bool)
    found: list[float] = []
    for x, y, radius in reversed(circles):
        left, top, right, bottom = _box(x, y, radius, radius)
        if left >= right or top >= bottom:
            found.append(0.0)
            continue
        part = free[top:bottom, left:right]
        rows, columns = np.mgrid[top:bottom, left:right]
        inside: npt.NDArray[np.bool_] = np.hypot(columns - x, rows - y) < radius
        found.append(min(float((inside & part).sum()) / (math.pi * radius**2), 1.0))
        part &= ~inside
    return found[::-1]
