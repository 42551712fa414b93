"""Small pictures of balls with soft edges before a noisy wall: what the tests of the tracker look at."""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

import matchset as ms

Picture = npt.NDArray[np.uint8]
Answer = ms.Track[ms.Circle] | ms.Lost[ms.Circle]

WIDTH, HEIGHT = 320, 240
BLUE = 200, 70, 30
FPS = 30.0


def wall(seed: int = 0, shape: tuple[int, ...] = (HEIGHT, WIDTH, 3)) -> Picture:
    noise = np.random.default_rng(seed).normal(140.0, 4.0, shape)
    return np.rint(noise).clip(0, 255).astype(np.uint8)


def with_ball(image: Picture, x: float, y: float, radius: float, color: tuple[float, ...] | float = BLUE) -> Picture:
    """The picture with a disc drawn on it, each pixel mixed by how much of it the disc covers."""
    rows, columns = np.indices(image.shape[:2])
    cover = np.clip(radius - np.hypot(columns - x, rows - y) + 0.5, 0.0, 1.0)
    if image.ndim == 3:
        cover = cover[:, :, np.newaxis]
    mixed: Picture = np.rint(image + cover * (np.asarray(color, float) - image)).astype(np.uint8)
    return mixed


def scene(*balls: tuple[float, float, float], seed: int = 0) -> Picture:
    """The wall with balls at (x, y, radius)."""
    image = wall(seed)
    for ball in balls:
        image = with_ball(image, *ball)
    return image


def blue() -> ms.ColorModel:
    return ms.ColorModel.pick(scene((160.0, 120.0, 40.0)), 150.0, 120.0)


def at(image: Picture, index: int) -> ms.Frame:
    return ms.Frame(image, index / FPS, index)


def run(tracker: ms.Tracker[ms.Circle], images: Iterable[Picture], begin: int = 0) -> list[Answer]:
    return [tracker.update(at(image, begin + k)) for k, image in enumerate(images)]


def off(answer: Answer, ball: tuple[float, float, float]) -> float:
    """Error of Eq. 10, px; infinite where there is no answer."""
    if not isinstance(answer, ms.Track):
        return float("inf")
    circle = answer.shape
    return sum(abs(a - b) for a, b in zip((circle.x, circle.y, circle.radius), ball, strict=True))
