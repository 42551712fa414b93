"""A bad camera: blur, colors, noise, sharpening, and JPEG with half the color: `taken`."""

import math

import cv2
import msgspec
import numpy as np

from benchmarks.training.layers import Counts, Random, Range, Singles, blurred, count_within, happens, within
from matchset.image.disc_network.polar_patch import Image

FULL = 255.0  # brightest, of 8 bits


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
    coded: float = 0.75
    quality: Counts = (8, 91)
    rescaled: float = 0.3
    scale: Range = (0.5, 1.0)


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
