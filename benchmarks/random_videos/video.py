"""A video of a ball drawn by chance before a photograph, and its truth: `frames`, from a seed."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
from training.rendering.ball import BallColorParameters, BallParameters, ball_colors, surface_normal
from training.rendering.layers import (
    FULL,
    Floats,
    Random,
    Range,
    Singles,
    Size,
    blurred,
    disc,
    happens,
    log_within,
    offsets,
    over,
    within,
)
from training.rendering.light import LightParameters, lit
from training.rendering.photographs import Photographs

import matchset as ms
from benchmarks.random_videos.motion import (
    BallMotionParameters,
    BallWay,
    CameraMotionParameters,
    CameraWay,
    ball_way,
    camera_way,
)
from matchset.app.track.score import Circle3, TruthRow
from matchset.sim.digital_camera.control_steps import ControlSteps
from matchset.sim.digital_camera.digital_camera import CameraPipeline, DigitalCamera
from matchset.sim.digital_camera.h264 import H264Coder

FRAMES_PER_SECOND = 30.0
BALL_RADIUS = 96  # px, of the ball's own picture
MARGIN = 4  # px around it there


class VideoParameters(msgspec.Struct, frozen=True):
    """What videos are drawn; chosen by hand, before any of them was followed.

    Parameters
    ----------
    frames : int
    sizes : tuple of (int, int)
        Width and height, px, each as likely.
    camera : CameraMotionParameters
    motion : BallMotionParameters
    ball : BallParameters
    light : LightParameters
        On the ball.
    border : float
        How much larger the photograph is than the picture at each side, widths of the picture.
    blurs : float
        Share of photographs out of focus.
    blur : (float, float)
        Standard deviation of that, px.
    posts : float
        Share of videos with a post in front, upright and fixed to the photograph; none begins behind it.
    post_at, post_width : (float, float)
        Where its middle is, and how wide it is, widths of the picture.
    exposures : tuple of float
        Shares of a frame during which the shutter is open, each as likely.
    finest : float
        Way of the ball from one picture that blur is made of to the next, px.
    most : int
        Of these.
    soft, softness : float, (float, float)
        Share of cameras out of focus, and the radius of their disc of confusion, px.
    noise : (float, float)
        Standard deviation of the sensor's noise, of 255.
    denoised, sharpened : float
        Shares of cameras that reduce noise, and that sharpen.
    denoising, sharpening : (float, float)
        By how much, see `DigitalCamera`.
    saturation : (float, float)
        Factor on all color.
    steps : float
        Share of videos in which exposure and white balance change in steps.
    brightness, tint, every : (float, float)
        Of these, see `ControlSteps`.
    bits : (float, float)
        Of the coded video, per pixel and frame.
    keyframes : int
        Frames from one whole one to the next.
    known : float
        Share of the disc that is seen from which a row counts as well known.
    seen : float
        Share below which the ball counts as absent.
    """

    frames: int = 90
    sizes: tuple[tuple[int, int], ...] = ((320, 240), (320, 240), (480, 360), (640, 360), (640, 480), (848, 480))
    camera: CameraMotionParameters = CameraMotionParameters()
    motion: BallMotionParameters = BallMotionParameters()
    ball: BallParameters = BallParameters(color=BallColorParameters(shares=(0.1, 0.7), value=(110, 255)))
    light: LightParameters = LightParameters()
    border: float = 0.5
    blurs: float = 0.35
    blur: Range = (1.0, 4.0)
    posts: float = 0.35
    post_at: Range = (0.3, 0.7)
    post_width: Range = (0.04, 0.18)
    exposures: tuple[float, ...] = (0.0, 0.3, 0.8)
    finest: float = 2.0
    most: int = 8
    soft: float = 0.4
    softness: Range = (0.0, 1.5)
    noise: Range = (1.0, 8.0)
    denoised: float = 0.5
    denoising: Range = (0.0, 0.8)
    sharpened: float = 0.4
    sharpening: Range = (0.3, 1.5)
    saturation: Range = (0.5, 1.2)
    steps: float = 0.25
    brightness: Range = (0.6, 1.6)
    tint: Range = (-0.15, 0.15)
    every: Range = (0.5, 1.5)
    bits: Range = (0.03, 0.25)
    keyframes: int = 60
    known: float = 0.6
    seen: float = 0.02


class Post(NamedTuple):
    """What is in front of the ball: its middle and width, px of the photograph, and its own photograph."""

    x: float
    width: float
    photograph: Singles


class Stage(NamedTuple):
    """All that is drawn: photograph, what moves how, the ball's colors and mask, and a post."""

    size: tuple[int, int]
    photograph: Singles
    camera: CameraWay
    ball: BallWay
    colors: Singles
    mask: Singles
    post: Post | None


class Moment(NamedTuple):
    """A picture at one time, the circle in it, px, and the share of its disc that is seen."""

    picture: Singles
    circle: Circle3
    share: float


def frames(seed: int, photographs: Photographs, limits: VideoParameters) -> Iterator[tuple[ms.Frame, TruthRow]]:
    """Render a video; the same seed, photographs and parameters give the same bytes.

    Parameters
    ----------
    seed : int
    photographs : Photographs
    limits : VideoParameters

    Yields
    ------
    Frame
    TruthRow
        The circle in the middle of the exposure; not tight where much of it is hidden or out of the picture.
    """
    random = np.random.default_rng(seed)
    stage = _stage(random, photographs, limits)
    exposure = float(random.choice(limits.exposures))
    camera = CameraPipeline(_camera(random, limits))
    width, height = stage.size
    kbps = log_within(random, limits.bits) * width * height * FRAMES_PER_SECOND / 1000.0
    coder = H264Coder(width, height, FRAMES_PER_SECOND, kbps, limits.keyframes)
    for index in range(limits.frames):
        moments = [_moment(stage, time) for time in _times(stage.ball, index, exposure, limits)]
        picture = np.asarray(np.mean([each.picture for each in moments], axis=0), np.float32)
        x, y, radius = np.mean([each.circle for each in moments], axis=0).tolist()
        share, seconds = float(np.mean([each.share for each in moments])), index / FRAMES_PER_SECOND
        taken = camera(picture, seconds, (1.0, 1.0, 1.0), seed * limits.frames + index)
        image = coder(np.clip(np.rint(taken), 0.0, FULL).astype(np.uint8))
        known = (x, y, radius) if share >= limits.seen else None
        yield ms.Frame(image, seconds, index), TruthRow(index, known, lowconf=limits.seen <= share < limits.known)


def _stage(random: Random, photographs: Photographs, limits: VideoParameters) -> Stage:
    width, height = size = limits.sizes[random.integers(len(limits.sizes))]
    border = int(limits.border * width)
    larger = height + 2 * border, width + 2 * border
    photograph = photographs.crop(random, larger)
    if happens(random, limits.blurs):
        photograph = blurred(photograph, within(random, limits.blur))
    camera = camera_way(random, limits.frames, width, limits.camera)
    ball = ball_way(random, limits.frames, size, limits.motion)
    colors, mask = _painted(random, photograph[border:-border, border:-border], limits)
    post = _post(random, photographs, larger, limits) if happens(random, limits.posts) else None
    if post and abs(post.x - border - ball.x[0]) < 0.5 * post.width + limits.motion.inside * ball.radius[0]:
        post = None
    return Stage(size, photograph, camera, ball, colors, mask, post)


def _post(random: Random, photographs: Photographs, larger: Size, limits: VideoParameters) -> Post:
    """Put a post up in a photograph of a size."""
    width = larger[1] / (1.0 + 2.0 * limits.border)
    x = (limits.border + within(random, limits.post_at)) * width
    return Post(x, within(random, limits.post_width) * width, photographs.crop(random, larger))


def _painted(random: Random, around: Singles, limits: VideoParameters) -> tuple[Singles, Singles]:
    """Colors and mask of a ball in light, in a picture of its own."""
    side = 2 * (BALL_RADIUS + MARGIN) + 1
    circle = 0.5 * (side - 1), 0.5 * (side - 1), float(BALL_RADIUS)
    behind = np.asarray(cv2.resize(np.ascontiguousarray(around), (side, side)), np.float32)
    normal = surface_normal(offsets((side, side), circle))
    colors = lit(random, ball_colors(random, behind, circle, normal, limits.ball), normal, limits.light)
    return np.asarray(np.clip(colors, 0.0, FULL), np.float32), disc((side, side), circle)


def _camera(random: Random, limits: VideoParameters) -> DigitalCamera:
    """Choose a camera."""
    steps = ControlSteps()
    if happens(random, limits.steps):
        steps = ControlSteps(
            brightness=log_within(random, limits.brightness),
            tint=within(random, limits.tint),
            every=within(random, limits.every),
        )
    return DigitalCamera(
        defocus=within(random, limits.softness) if happens(random, limits.soft) else 0.0,
        steps=steps,
        noise=within(random, limits.noise),
        denoising=within(random, limits.denoising) if happens(random, limits.denoised) else 0.0,
        sharpening=within(random, limits.sharpening) if happens(random, limits.sharpened) else 0.0,
        saturation=within(random, limits.saturation),
    )


def _times(ball: BallWay, index: int, exposure: float, limits: VideoParameters) -> Floats:
    """Choose the times that a picture is made of, frames; the first and the last of a video are sharp."""
    if not 0 < index < limits.frames - 1:
        return np.array([float(index)])
    way = math.hypot(ball.x[index + 1] - ball.x[index], ball.y[index + 1] - ball.y[index])
    count = int(np.clip(math.ceil(exposure * way / limits.finest), 1, limits.most))
    return np.asarray(index + exposure * ((np.arange(count) + 0.5) / count - 0.5), np.float64)


def _moment(stage: Stage, time: float) -> Moment:
    """Draw what is to be seen at a time, frames."""
    matrix = _view(stage, time)
    picture = np.asarray(cv2.warpAffine(stage.photograph, matrix, stage.size), np.float32)
    x, y, radius = (_at(each, time) for each in stage.ball)
    mask, colors = _placed(stage, (x, y, radius))
    picture = over(picture, mask, colors)
    free = np.ones_like(mask)
    if stage.post is not None:
        middle = float((matrix @ (stage.post.x, 0.5 * stage.photograph.shape[0], 1.0))[0])
        across = np.arange(stage.size[0], dtype=np.float32) - np.float32(middle)
        post = np.clip(0.5 * np.float32(stage.post.width) - np.abs(across) + 0.5, 0.0, 1.0)[np.newaxis].repeat(
            stage.size[1], axis=0
        )
        picture = over(picture, post, cv2.warpAffine(stage.post.photograph, matrix, stage.size))
        free -= post
    return Moment(picture, (x, y, radius), min(float((mask * free).sum()) / (math.pi * radius**2), 1.0))


def _view(stage: Stage, time: float) -> Floats:
    """Matrix of shape (2, 3) from px of the photograph to px of the picture: a camera turns about its middle."""
    width, height = stage.size
    left, top = (0.5 * (larger - side) for larger, side in zip(stage.photograph.shape[1::-1], stage.size, strict=True))
    x, y, zoom, turn = (_at(each, time) for each in stage.camera)
    middle = 0.5 * width + left + x, 0.5 * height + top + y
    matrix = np.asarray(cv2.getRotationMatrix2D(middle, math.degrees(turn), math.exp(zoom)), np.float64)
    matrix[:, 2] -= left + x, top + y
    return matrix


def _placed(stage: Stage, circle: Circle3) -> tuple[Singles, Singles]:
    """Mask and colors of the ball at a circle of the picture, each pixel a mean of what it covers."""
    x, y, radius = circle
    scale, middle = radius / BALL_RADIUS, 0.5 * (stage.mask.shape[0] - 1)
    matrix = np.array([[scale, 0.0, x - scale * middle], [0.0, scale, y - scale * middle]])
    deviation = 0.5 * math.sqrt(max(scale**-2 - 1.0, 0.0))
    mask, colors = blurred(stage.mask, deviation), blurred(stage.colors, deviation)
    placed = cv2.warpAffine(mask, matrix, stage.size)
    colored = cv2.warpAffine(colors, matrix, stage.size, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(placed, np.float32), np.asarray(colored, np.float32)


def _at(values: Floats, time: float) -> float:
    """Value at a time between two frames."""
    return float(np.interp(time, np.arange(len(values)), values))
