"""Balls drawn into pictures, with exact truth: `Ball`, `background`, `Camera`.

Nothing of the package draws here. A ball changes only the patch that it covers, and a background is made once: a
picture costs little more than its coding.
"""

import math
from collections.abc import Callable, Sequence

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.common.start import Image

Floats = npt.NDArray[np.float32]
Color = tuple[float, float, float]
"""Blue, green and red, 0 to 255."""
Path = Callable[[float], tuple[float, float]]
"""Center at a time, px; the unit of time is a picture."""

OCTAVES = {8: 1.0, 32: 0.6, 128: 0.3}
"""Cells of a background's texture across its height, and how much each size of them counts."""
STEP_PX = 0.5
"""Longest way of a ball between two steps of an exposure."""
MOST_STEPS = 64
SPARE_PX = 64
"""By how much the field of noise is larger than a picture: each picture is given another part of it."""


class Ball(msgspec.Struct, frozen=True):
    """A ball that moves.

    Parameters
    ----------
    path : callable
    radius : float
        px.
    color : (float, float, float)
    shaded : bool
        Whether light falls on it from above left; otherwise its color is even.
    """

    path: Path
    radius: float
    color: Color
    shaded: bool = False


class Camera:
    """Takes pictures of balls before a background.

    Parameters
    ----------
    background : ndarray of shape (h, w, 3), uint8
    generator : Generator
        Of its noise.
    noise : float
        Standard deviation, gray levels.
    exposure : float
        Share of the time between two pictures.
    quality : int
        Of the JPEG coding, in percent.
    """

    def __init__(
        self,
        background: Image,
        generator: np.random.Generator,
        noise: float = 3.0,
        exposure: float = 0.5,
        quality: int = 90,
    ) -> None:
        self.background, self.exposure, self.quality = background, exposure, quality
        self._generator = generator
        height, width = background.shape[:2]
        size = height + SPARE_PX, width + SPARE_PX, 3
        self._noise = np.rint(noise * generator.standard_normal(size, np.float32)).astype(np.int16)

    def take(self, time: float, balls: Sequence[Ball]) -> Image:
        """Take a picture; its time is the middle of its exposure, in pictures."""
        image = self.background.copy()
        for ball in balls:
            self._draw(image, ball, time)
        height, width = image.shape[:2]
        down, right = self._generator.integers(0, SPARE_PX, 2)
        noise = self._noise[down : down + height, right : right + width]
        noisy = cv2.add(image, np.ascontiguousarray(noise), dtype=cv2.CV_8U)
        return coded(np.asarray(noisy, np.uint8), self.quality)

    def _draw(self, image: Image, ball: Ball, time: float) -> None:
        """Lay a ball over a picture: the mean of its places while the shutter is open."""
        centers = self._centers(ball, time)
        margin = ball.radius + 1.0
        height, width = image.shape[:2]
        left, top = np.maximum(np.floor(centers.min(axis=0) - margin), 0.0).astype(int)
        right, bottom = np.minimum(np.ceil(centers.max(axis=0) + margin) + 1.0, (width, height)).astype(int)
        if right <= left or bottom <= top:
            return
        rows, columns = np.mgrid[top:bottom, left:right].astype(np.float32)
        patch = image[top:bottom, left:right].astype(np.float32)
        total = np.zeros_like(patch)
        for x, y in centers:
            across, down = columns - np.float32(x), rows - np.float32(y)
            covered = np.clip(ball.radius + 0.5 - np.hypot(across, down), 0.0, 1.0)[..., None]
            total += patch + covered * (_light(ball, across, down) - patch)
        image[top:bottom, left:right] = np.clip(np.rint(total / len(centers)), 0, 255).astype(np.uint8)

    def _centers(self, ball: Ball, time: float) -> npt.NDArray[np.float64]:
        begin = np.array(ball.path(time - 0.5 * self.exposure))
        end = np.array(ball.path(time + 0.5 * self.exposure))
        steps = int(np.clip(math.ceil(float(np.hypot(*(end - begin))) / STEP_PX), 1, MOST_STEPS))
        shares = (np.arange(steps) + 0.5) / steps - 0.5
        return np.array([ball.path(time + self.exposure * share) for share in shares])


def _light(ball: Ball, across: Floats, down: Floats) -> Floats:
    """Color of a ball at places, px from its center."""
    color = np.asarray(ball.color, np.float32)
    if not ball.shaded:
        return np.broadcast_to(color, (*across.shape, 3))
    right, below = across / ball.radius, down / ball.radius
    toward = np.sqrt(np.clip(1.0 - right**2 - below**2, 0.0, 1.0))
    lit = np.clip(-0.45 * right - 0.6 * below + 0.66 * toward, 0.0, 1.0)[..., None]
    return np.asarray(color * (0.35 + 0.65 * lit) + 153.0 * lit**40, np.float32)


def background(generator: np.random.Generator, width: int, height: int, tint: Color, clutter: int = 12) -> Image:
    """Draw a background: texture of several sizes, and rectangles.

    Parameters
    ----------
    generator : Generator
    width, height : int
        px.
    tint : (float, float, float)
        Shares of blue, green and red.
    clutter : int
        Number of rectangles.
    """
    texture = np.zeros((height, width, 3), np.float32)
    for cells, weight in OCTAVES.items():
        coarse = generator.random((cells, cells * width // height, 3), np.float32)
        texture += weight * np.asarray(cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC))
    texture = (51.0 + 153.0 * texture / texture.max()) * np.asarray(tint, np.float32)
    for _ in range(clutter):
        left, top = int(generator.integers(0, width)), int(generator.integers(0, height))
        across = int(generator.integers(width // 60, width // 6))
        down = int(generator.integers(height // 50, height // 5))
        color = tuple(float(each) for each in 190.0 * generator.random(3) * np.asarray(tint))
        cv2.rectangle(texture, (left, top), (left + across, top + down), color, -1)
    return np.asarray(np.clip(cv2.GaussianBlur(texture, (0, 0), 1.2), 0, 255), np.uint8)


def coded(image: Image, quality: int) -> Image:
    """Return a picture as it comes back from a JPEG file.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
    quality : int
        In percent.
    """
    _, data = cv2.imencode(".jpg", image, (cv2.IMWRITE_JPEG_QUALITY, quality))
    back = cv2.imdecode(data, cv2.IMREAD_COLOR)
    assert back is not None  # it was written by this very library
    return np.asarray(back, np.uint8)
