"""Balls of two colors before a gray wall, in a folder of pictures: what the tests of several targets look at."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

BLUE, RED = (190, 70, 30), (40, 40, 200)
SIZE, FRAMES, RADIUS = (320, 240), 24, 22.0
BALLS = ((BLUE, (60.0, 60.0), (3.0, 1.0)), (BLUE, (250.0, 170.0), (-3.0, 0.5)), (RED, (160.0, 190.0), (0.5, -4.0)))


def places(index: int) -> list[tuple[float, float]]:
    """Centers in a frame, px."""
    return [(x + index * u, y + index * v) for _, (x, y), (u, v) in BALLS]


def picture(index: int) -> npt.NDArray[np.uint8]:
    """A frame."""
    image = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
    for (color, _, _), (x, y) in zip(BALLS, places(index), strict=True):
        cv2.circle(image, (round(x * 16), round(y * 16)), round(RADIUS * 16), color, cv2.FILLED, cv2.LINE_AA, 4)
    blurred = cv2.GaussianBlur(image, (0, 0), 0.8)
    noise = np.random.default_rng(index).integers(-3, 4, image.shape)
    return (blurred.astype(int) + noise).clip(0, 255).astype(np.uint8)


def write_pictures(folder: Path, frames: int = FRAMES) -> Path:
    """Write the frames."""
    folder.mkdir()
    for index in range(frames):
        cv2.imwrite(str(folder / f"{index:04d}.png"), picture(index))
    return folder
