"""A bad camera: blur, colors, noise, sharpening, and JPEG with half the color: `taken`; and videos: `through_video`.

In a video the pictures before one show the ball elsewhere, so that the encoder predicts from them and leaves out what
is not worth its bits: blocks, smears and the colors of what was there before.
"""

import math
from fractions import Fraction
from typing import Any

import cv2
import msgspec
import numpy as np

from matchset.app.films.codecs import EVEN
from matchset.image.disc_network.patch_format import Circle3, Image
from training.rendering.layers import (
    FULL,
    Counts,
    Random,
    Range,
    Singles,
    any_angle,
    away,
    blurred,
    count_within,
    happens,
    within,
)

FRAMES_PER_SECOND = 30


class CameraParameters(msgspec.Struct, frozen=True):
    """What a camera does to a picture; chosen by hand.

    Parameters
    ----------
    blurs : float
        Share of pictures that are not sharp.
    blur : (float, float)
        Standard deviation of the Gaussian by which all of those are blurred, px.
    defocus : float
        Largest standard deviation that is added to that, radii of the ball; few are near it, by a cube.
    gain : float
        Standard deviation of the gain of a channel from 1: the white balance.
    gamma : float
        Standard deviation of the logarithm of gamma.
    exposure : (float, float)
        Factor of the brightness.
    noise : float
        Largest standard deviation of the noise, of 255; few are near it, by a square.
    sharpened : float
        Share of pictures that are sharpened.
    sharpening : (float, float)
        Factor of the unsharp mask.
    sharpening_size : (float, float)
        Standard deviation of its Gaussian, px.
    coded : float
        Share of pictures that are coded as JPEG, with 4:2:0 colors.
    quality : (int, int)
        Of that, least and largest.
    rescaled : float
        Share of those that are coded at a smaller size.
    scale : (float, float)
        That size as a share.
    """

    blurs: float = 0.7
    blur: Range = (0.3, 1.0)
    defocus: float = 0.12
    gain: float = 0.06
    gamma: float = 0.25
    exposure: Range = (0.55, 1.25)
    noise: float = 12.0
    sharpened: float = 0.3
    sharpening: Range = (0.3, 1.2)
    sharpening_size: Range = (0.8, 2.0)
    coded: float = 0.6
    quality: Counts = (8, 91)
    rescaled: float = 0.3
    scale: Range = (0.5, 1.0)


class VideoParameters(msgspec.Struct, frozen=True):
    """How pictures go through an encoder of videos; chosen by hand.

    Parameters
    ----------
    earlier : (int, int)
        Pictures before the one that is kept.
    step : (float, float)
        How far the ball moves from one to the next, radii.
    turn : float
        Standard deviation of the direction of each step from that of the first, rad.
    region : (float, float)
        What is nearer to the ball's center than the first, in radii, moves with it; farther than the second, nothing.
    carried : float
        Share of videos whose camera moves.
    camera_step : (float, float)
        By how much from one picture to the next, radii.
    mpeg4 : float
        Share of videos that are MPEG-4 part 2; the others are H.264.
    crf : (float, float)
        Quality of H.264 (libx264's "crf"): more is worse.
    quantizer : (int, int)
        Quality of MPEG-4 part 2: more is worse.
    """

    earlier: Counts = (1, 3)
    step: Range = (0.0, 0.7)
    turn: float = 0.4
    region: Range = (1.0, 2.4)
    carried: float = 0.4
    camera_step: Range = (0.0, 0.4)
    mpeg4: float = 0.25
    crf: Range = (22.0, 40.0)
    quantizer: Counts = (3, 24)


def taken(random: Random, scene: Singles, radius: float, oversampling: int, limits: CameraParameters) -> Image:
    """Take a picture of a scene.

    Parameters
    ----------
    random : Generator
    scene : ndarray of shape (h, w, 3), float32
        0 ... 255.
    radius : float
        Of the ball in the scene, px.
    oversampling : int
        How many pixels of the scene make one of the picture, along each axis.
    limits : CameraParameters

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
    """
    if happens(random, limits.blurs):
        defocus = limits.defocus * radius * random.random() ** 3
        scene = blurred(scene, within(random, limits.blur) * oversampling + defocus)
    if oversampling > 1:
        size = scene.shape[1] // oversampling, scene.shape[0] // oversampling
        scene = np.asarray(cv2.resize(scene, size, interpolation=cv2.INTER_AREA), np.float32)
    scene = _exposed(random, scene, limits)
    scene = scene + random.normal(0.0, random.random() ** 2 * limits.noise, scene.shape).astype(np.float32)
    if happens(random, limits.sharpened):
        factor = np.float32(within(random, limits.sharpening))
        scene = scene + factor * (scene - blurred(scene, within(random, limits.sharpening_size)))
    picture = np.clip(scene, 0.0, FULL).astype(np.uint8)
    return _coded(random, picture, limits) if happens(random, limits.coded) else picture


def _exposed(random: Random, scene: Singles, limits: CameraParameters) -> Singles:
    """Change white balance, gamma and brightness."""
    gains = 1.0 + random.normal(0.0, limits.gain, 3).astype(np.float32)
    gamma = np.float32(math.exp(random.normal(0.0, limits.gamma)))
    share = np.clip(scene * gains, 0.0, FULL) / np.float32(FULL)
    return np.asarray(np.float32(FULL * within(random, limits.exposure)) * share**gamma, np.float32)


def _coded(random: Random, picture: Image, limits: CameraParameters) -> Image:
    """Code a picture as JPEG, at a smaller size now and then, and decode it."""
    height, width = picture.shape[:2]
    small = picture
    if happens(random, limits.rescaled):
        scale = within(random, limits.scale)
        small = np.asarray(cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)
    colors = cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420
    quality = cv2.IMWRITE_JPEG_QUALITY, count_within(random, limits.quality)
    _, code = cv2.imencode(".jpg", small, [*quality, *colors])
    decoded = np.asarray(cv2.imdecode(code, cv2.IMREAD_COLOR), np.uint8)
    if decoded.shape == picture.shape:
        return decoded
    return np.asarray(cv2.resize(decoded, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)


def through_video(random: Random, picture: Image, circle: Circle3, limits: VideoParameters) -> Image:
    """Encode a picture after some in which the ball was elsewhere, and decode it.

    Parameters
    ----------
    random : Generator
    picture : ndarray of shape (h, w, 3), uint8
        BGR.
    circle : (x, y, radius)
        Of the ball in it, px.
    limits : VideoParameters

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
    """
    height, width = picture.shape[:2]
    bordered = cv2.copyMakeBorder(picture, 0, height % EVEN, 0, width % EVEN, cv2.BORDER_REPLICATE)
    even = np.asarray(bordered, np.uint8)
    video = [*_earlier(random, even, circle, limits), even]
    return np.ascontiguousarray(_decoded(video, _encoder(random, even.shape[:2], limits))[:height, :width])


def _earlier(random: Random, picture: Image, circle: Circle3, limits: VideoParameters) -> list[Image]:
    """Pictures before a picture, the first one first."""
    x, y, radius = circle
    rows, columns = np.indices(picture.shape[:2], np.float32)
    nearest, farthest = limits.region
    distance = np.hypot(columns - np.float32(x), rows - np.float32(y)) / np.float32(radius)
    moves = np.clip((farthest - distance) / (farthest - nearest), 0.0, 1.0)
    length, direction = within(random, limits.step) * radius, any_angle(random)
    camera = within(random, limits.camera_step) * radius if happens(random, limits.carried) else 0.0
    turned, ball, view = any_angle(random), (0.0, 0.0), (0.0, 0.0)
    pictures = []
    for _ in range(count_within(random, limits.earlier)):
        ball = away(ball, direction + random.normal(0.0, limits.turn), length)
        view = away(view, turned, camera)
        across = columns + moves * np.float32(ball[0]) + np.float32(view[0])
        down = rows + moves * np.float32(ball[1]) + np.float32(view[1])
        moved = cv2.remap(picture, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101)
        pictures.append(np.asarray(moved, np.uint8))
    return pictures[::-1]


def _encoder(random: Random, size: tuple[int, ...], limits: VideoParameters) -> Any:
    """Start an encoder of pictures of a height and width, which delays none."""
    import av

    name = "mpeg4" if happens(random, limits.mpeg4) else "libx264"
    encoder: Any = av.CodecContext.create(name, "w")
    encoder.height, encoder.width = size
    encoder.pix_fmt, encoder.time_base = "yuv420p", Fraction(1, FRAMES_PER_SECOND)
    encoder.thread_count = 1
    if name == "mpeg4":
        quantizer = str(count_within(random, limits.quantizer))
        encoder.options = {"qmin": quantizer, "qmax": quantizer}
    else:
        crf = f"{within(random, limits.crf):.1f}"
        encoder.options = {"preset": "veryfast", "tune": "zerolatency", "crf": crf, "x264-params": "threads=1"}
    return encoder


def _decoded(pictures: list[Image], encoder: Any) -> Image:
    """Encode pictures, decode them, and return the last."""
    import av

    decoder: Any = av.CodecContext.create("h264" if encoder.name == "libx264" else "mpeg4", "r")
    decoder.thread_count = 1
    packets: list[Any] = []
    for count, picture in enumerate(pictures):
        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="bgr24").reformat(format="yuv420p")
        frame.pts, frame.time_base = count, encoder.time_base
        packets += encoder.encode(frame)
    packets += encoder.encode(None)
    decoded = [frame for packet in [*packets, None] for frame in decoder.decode(packet)]
    if len(decoded) != len(pictures):
        raise ValueError(f"the encoder {encoder.name} returned {len(decoded)} pictures of {len(pictures)}")
    return np.asarray(decoded[-1].to_ndarray(format="bgr24"), np.uint8)
