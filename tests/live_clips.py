"""Rendered clips of a ball on a path that it goes along some times, with their truth, written as a video."""

import math
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

import matchset as ms
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from matchset.sim.clips.balloon import Balloon

CAMERA = ms.CameraModel.from_fov(320, 240, math.radians(60.0))
PERIOD = 4.0  # s, after which a path begins again
FRAMES = 120  # in a period
TIMES = 2  # that a clip goes along the path
LAST = TIMES * FRAMES - 1
"""Index of the last frame of a clip."""


def going_around(time: float) -> np.ndarray:
    """Where the ball is, m: it goes around slowly, in view all the time."""
    angle = 2.0 * math.pi * time / PERIOD
    return np.array((0.16 * math.sin(angle), 0.12 * math.cos(angle), 1.6 + 0.2 * math.sin(angle)))


def leaving(time: float) -> np.ndarray:
    """Where the ball is, m: it rests in the middle, goes to the right and is out of view for 1.2 of 4 s."""
    away = 0.5 * (1.0 - math.cos(2.0 * math.pi * time / PERIOD))
    return np.array((2.2 * away**3, 0.0, 1.6))


def filmed(folder: Path, place: Callable[[float], np.ndarray]) -> tuple[Path, BallFlightClip]:
    """Write a video that goes along a path twice; only one time is rendered."""
    balloon = Balloon(marker_radius=0.0)  # a click on its middle means the ball
    rendered = BallFlightClip(camera=CAMERA, place=place, balloon=balloon, frames=FRAMES, fps=FRAMES / PERIOD)
    writer = cv2.VideoWriter(str(folder / "ball.avi"), cv2.VideoWriter.fourcc(*"MJPG"), rendered.fps, (320, 240))
    images = [frame.image for frame in rendered]
    for image in images * TIMES:
        writer.write(image)
    writer.release()
    return folder / "ball.avi", rendered
