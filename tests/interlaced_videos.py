"""Interlaced pictures of one ball, rendered, with either field first; and the same ball in progressive ones."""

import functools

import numpy as np
import numpy.typing as npt

from matchset.image.frame import Frame
from matchset.sim.analog_link import TYPICAL, AnalogLink
from matchset.sim.clips.clip import Clip

Pictures = tuple[npt.NDArray[np.uint8], ...]
PLAIN = AnalogLink(interlaced=True, blur=0.5, luma_bandwidth=3e6, luma_noise=3.0)


def ball_clip(link: AnalogLink = TYPICAL, frames: int = 12, speed: float = 2.0, seed: int = 41) -> Clip:
    """Clip of a fast ball, half as large as usual."""
    return Clip(frames=frames, width=320, height=240, seed=seed, preset=link, speed=0.5 * speed, radii=(24.0, 36.0))


@functools.cache
def pictures_of(clip: Clip) -> Pictures:
    """Pictures of a clip, the top field first where it is interlaced."""
    return tuple(frame.image for frame, _ in clip)


def upside_down(pictures: Pictures) -> Pictures:
    """Pictures with the bottom field first: of an even number of rows, turned upside down."""
    return tuple(np.ascontiguousarray(picture[::-1]) for picture in pictures)


def frames_of(pictures: Pictures, fps: float = 30.0) -> list[Frame]:
    """Frames of pictures."""
    return [Frame(picture, index / fps, index) for index, picture in enumerate(pictures)]


def circle_at(clip: Clip, seconds: float) -> tuple[float, float, float]:
    """Where the ball of a clip is at a time, s: x, y and radius, px."""
    circle = clip._outline(seconds * clip.fps).circle()
    return circle.x, circle.y, circle.radius
