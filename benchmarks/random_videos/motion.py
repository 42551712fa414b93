"""Where camera and ball are in a random video: `camera_way`, `ball_way`."""

from typing import NamedTuple

import msgspec
import numpy as np
from training.rendering.layers import Counts, Floats, Random, Range, count_within, happens, log_within, which, within

REACH = 3  # standard deviations: where a Gaussian kernel ends


class CameraMotionParameters(msgspec.Struct, frozen=True):
    """How a camera moves; chosen by hand.

    Parameters
    ----------
    kinds : (float, float)
        Shares of cameras at rest and held in a hand; the others are carried by a walker.
    speeds : (float, float, float)
        Standard deviation of the way per `slow` frames of these, widths of the picture.
    shake : float
        The same from frame to frame, as a share of that.
    zoom, turn : float
        Standard deviation of the logarithm of the zoom, and of the roll, rad, of a walker; half of it in a hand.
    slow : int
        Frames over which it changes.
    farthest : float
        From where it begins, widths of the picture.
    """

    kinds: tuple[float, float] = (0.35, 0.3)
    speeds: tuple[float, float, float] = (0.0, 0.016, 0.08)
    shake: float = 0.06
    zoom: float = 0.05
    turn: float = 0.03
    slow: int = 12
    farthest: float = 0.4


class BallMotionParameters(msgspec.Struct, frozen=True):
    """How a ball moves; chosen by hand.

    Parameters
    ----------
    kinds : (float, float)
        Shares of balls that roam and that are thrown again and again; the others approach.
    radius : (float, float)
        Least radius, px, and largest, heights of the picture, of the first two.
    near, far : (float, float)
        Radius of balls that approach: at the end, heights of the picture, and at first, px.
    returns : float
        Share of those that go away again.
    roam : float
        Standard deviation of the place, widths or heights of the picture.
    roam_slow : (int, int)
        Frames over which that changes.
    size : float
        Standard deviation of the logarithm of the radius of a ball that roams; of others less than half of it.
    throws : (int, int)
        Least and largest number of throws.
    wide : float
        How far they go, widths of the picture.
    steep : (float, float)
        How far they fall from their top, heights of the picture, about.
    inside : float
        How far from the border the first place is, radii.
    slow : int
        Frames over which the radius changes.
    """

    kinds: tuple[float, float] = (0.5, 0.25)
    radius: Range = (5.0, 0.16)
    near: Range = (0.12, 0.22)
    far: Range = (4.5, 9.0)
    returns: float = 0.5
    roam: float = 0.2
    roam_slow: Counts = (5, 17)
    size: float = 0.25
    throws: Counts = (2, 4)
    wide: float = 1.15
    steep: Range = (0.36, 0.88)
    inside: float = 2.0
    slow: int = 15


class CameraWay(NamedTuple):
    """Place, px of the photograph, logarithm of the zoom, and roll, rad, of a camera in each frame."""

    x: Floats
    y: Floats
    zoom: Floats
    turn: Floats


class BallWay(NamedTuple):
    """Center and radius of a ball in each frame, px."""

    x: Floats
    y: Floats
    radius: Floats


def smooth(random: Random, frames: int, deviation: float, slow: float) -> Floats:
    """Noise of a standard deviation that changes over so many frames."""
    steps = np.arange(-int(REACH * slow), int(REACH * slow) + 1)
    kernel = np.exp(-0.5 * (steps / slow) ** 2)
    noise = random.normal(size=frames + len(kernel) - 1)
    return np.asarray(deviation * np.convolve(noise, kernel / np.linalg.norm(kernel), "valid"))


def camera_way(random: Random, frames: int, width: int, limits: CameraMotionParameters) -> CameraWay:
    """Move a camera by chance.

    Parameters
    ----------
    random : Generator
    frames : int
    width : int
        Of the picture, px.
    limits : CameraMotionParameters
    """
    kind = which(random, limits.kinds)
    speed, share = limits.speeds[kind] * width, 0.5 * kind
    x, y = (
        smooth(random, frames, speed, limits.slow) + smooth(random, frames, limits.shake * speed, 1.0) for _ in range(2)
    )
    zoom = smooth(random, frames, share * limits.zoom, limits.slow)
    turn = smooth(random, frames, share * limits.turn, limits.slow)
    far = limits.farthest * width
    return CameraWay(np.clip(x - x[0], -far, far), np.clip(y - y[0], -far, far), zoom, turn)


def ball_way(random: Random, frames: int, size: tuple[int, int], limits: BallMotionParameters) -> BallWay:
    """Move a ball by chance; in the first frame it is whole in the picture.

    Parameters
    ----------
    random : Generator
    frames : int
    size : (int, int)
        Width and height of the picture, px.
    limits : BallMotionParameters
    """
    way = (_roaming, _thrown, _approaching)[which(random, limits.kinds)](random, frames, size, limits)
    margin = limits.inside * way.radius[0]
    x, y = (
        along - along[0] + np.clip(along[0], margin, side - 1 - margin)
        for along, side in zip((way.x, way.y), size, strict=True)
    )
    return way._replace(x=x, y=y)


def _roaming(random: Random, frames: int, size: tuple[int, int], limits: BallMotionParameters) -> BallWay:
    x, y = (
        0.5 * side + smooth(random, frames, limits.roam * side, count_within(random, limits.roam_slow)) for side in size
    )
    radius = log_within(random, (limits.radius[0], limits.radius[1] * size[1]))
    return BallWay(x, y, radius * np.exp(smooth(random, frames, limits.size, limits.slow)))


def _thrown(random: Random, frames: int, size: tuple[int, int], limits: BallMotionParameters) -> BallWay:
    width, height = size
    along = np.arange(frames) * count_within(random, limits.throws) / frames % 1.0 - 0.5
    direction = 1.0 if happens(random, 0.5) else -1.0
    fall = 4.0 * within(random, limits.steep) * along**2
    radius = log_within(random, (limits.radius[0], limits.radius[1] * height))
    x, y = width * (0.5 + direction * limits.wide * along), height * (0.25 + fall)
    return BallWay(x, y, radius * np.exp(smooth(random, frames, 0.4 * limits.size, limits.slow)))


def _approaching(random: Random, frames: int, size: tuple[int, int], limits: BallMotionParameters) -> BallWay:
    width, height = size
    near, far = log_within(random, limits.near) * height, log_within(random, limits.far)
    done = np.linspace(0.0, 2.0, frames) if happens(random, limits.returns) else np.linspace(0.0, 1.0, frames)
    done = 1.0 - np.abs(1.0 - done)
    x = 0.5 * width + smooth(random, frames, 0.5 * limits.roam * width, limits.slow)
    y = height * (0.4 + 0.25 * done) + smooth(random, frames, 0.25 * limits.roam * height, limits.slow)
    return BallWay(x, y, far * (near / far) ** done)
