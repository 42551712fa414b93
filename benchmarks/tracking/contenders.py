"""What is timed: the tracker, the search, and two yardsticks, to convert a frame's color and to copy it."""

from collections.abc import Callable, Sequence
from typing import Any

import cv2
import msgspec
import numpy as np

import matchset as ms
from benchmarks.tracking.stopwatch import Contender
from matchset.sim.clips.clip import Clip

LOW, HIGH = (100, 90, 40), (130, 255, 255)  # a blue in OpenCV's HSV


class Pool(msgspec.Struct, frozen=True):
    """Frames, the color of the ball in them, and where it is in the first.

    Parameters
    ----------
    frames : list of Frame
    radii : list of float
        True radius in each, px; 0 where the ball is absent.
    color : ColorModel
        From one click in the first frame.
    start : Circle
        Where the ball is in the first frame.
    """

    frames: list[ms.Frame]
    radii: list[float]
    color: ms.ColorModel
    start: ms.Circle

    @classmethod
    def render(cls, clip: Clip) -> "Pool":
        """Render a clip with a ball."""
        frames = [frame for frame, _ in clip]
        circles = [clip.truth(index).circle for index in range(len(clip))]
        assert circles[0] is not None
        color = ms.ColorModel.pick(frames[0].image, *clip.first_click)
        return cls(frames, [0.0 if c is None else c.radius for c in circles], color, circles[0])


def update(name: str, pool: Pool) -> Contender:
    """`Tracker.update` with default settings, begun anew with each turn through the pool."""

    def begin() -> Callable[[ms.Frame], Any]:
        tracker = ms.Tracker(ms.Circle, pool.color)
        tracker.start(pool.start)
        return tracker.update

    return Contender(name=name, frames=pool.frames, begin=begin)


def search(name: str, frames: Sequence[ms.Frame], color: ms.ColorModel) -> Contender:
    """`Tracker.update` of a tracker that has not found its ball yet."""
    return Contender(name=name, frames=frames, begin=lambda: ms.Tracker(ms.Circle, color).update)


def detect(name: str, pool: Pool, offset: int) -> Contender:
    """`matchset.detect` on the whole frame."""

    def call(frame: ms.Frame) -> list[ms.Track[ms.Circle]]:
        return ms.detect(frame, ms.Circle, pool.color)

    return Contender(name=name, frames=pool.frames, begin=lambda: call, offset=offset)


def function(name: str, frames: Sequence[ms.Frame], make: Callable[[], Callable[[Any], Any]], offset: int) -> Contender:
    """Whatever finds something in a picture, made anew with each turn through the pool."""

    def begin() -> Callable[[ms.Frame], Any]:
        find = make()
        return lambda frame: find(frame.image)

    return Contender(name=name, frames=frames, begin=begin, offset=offset)


def convert(name: str, frames: Sequence[ms.Frame], offset: int) -> Contender:
    """`cv2.cvtColor` to HSV and `cv2.inRange`, as everybody writes them."""

    def call(frame: ms.Frame) -> Any:
        return cv2.inRange(cv2.cvtColor(frame.image, cv2.COLOR_BGR2HSV), LOW, HIGH)

    return Contender(name=name, frames=frames, begin=lambda: call, offset=offset)


def convert_kept(name: str, frames: Sequence[ms.Frame], offset: int) -> Contender:
    """Do the same into buffers that are kept: no memory is asked from the system."""
    hsv = np.empty_like(frames[0].image)
    mask = np.empty(hsv.shape[:2], np.uint8)

    def call(frame: ms.Frame) -> Any:
        return cv2.inRange(cv2.cvtColor(frame.image, cv2.COLOR_BGR2HSV, dst=hsv), LOW, HIGH, dst=mask)

    return Contender(name=name, frames=frames, begin=lambda: call, offset=offset)


def copy(name: str, frames: Sequence[ms.Frame], offset: int) -> Contender:
    """`frame.copy()`, as everybody writes it."""

    def call(frame: ms.Frame) -> Any:
        return frame.image.copy()

    return Contender(name=name, frames=frames, begin=lambda: call, offset=offset)


def copy_kept(name: str, frames: Sequence[ms.Frame], offset: int) -> Contender:
    """Copy into a buffer that is kept."""
    buffer = np.empty_like(frames[0].image)

    def call(frame: ms.Frame) -> Any:
        np.copyto(buffer, frame.image)
        return buffer

    return Contender(name=name, frames=frames, begin=lambda: call, offset=offset)
