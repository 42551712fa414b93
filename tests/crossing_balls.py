"""Two equal balls that cross, one before the other, and a third that comes later, in a small video."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

FRAMES, WIDTH, HEIGHT = 90, 320, 160
RADIUS, RATE = 18.0, 30.0
LATE = 50  # frame from which on there is a third ball
Floats = npt.NDArray[np.float64]


def places(index: int) -> list[tuple[float, float]]:
    """Where the balls are in a frame, px: the first goes right, behind the second, which goes left."""
    way = index / (FRAMES - 1)
    both = [(50.0 + 220.0 * way, 70.0 + 4.0 * way), (270.0 - 220.0 * way, 76.0 - 4.0 * way)]
    return both if index < LATE else [*both, (60.0 + 2.0 * (index - LATE), 132.0)]


def picture(index: int) -> npt.NDArray[np.uint8]:
    """A frame."""
    image = np.random.default_rng(index).normal(90.0, 2.0, (HEIGHT, WIDTH, 3))
    for x, y in places(index):
        cv2.circle(image, (round(16 * x), round(16 * y)), round(16 * RADIUS), (210, 90, 30), cv2.FILLED, cv2.LINE_AA, 4)
    blurred = cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.7)
    return blurred.astype(np.uint8)


def written(folder: Path) -> Path:
    """Write the video."""
    video = folder / "crossing.avi"
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter.fourcc(*"MJPG"), RATE, (WIDTH, HEIGHT))
    for index in range(FRAMES):
        writer.write(picture(index))
    writer.release()
    return video
