"""What lens, sensor and image processor of a digital camera do to a picture: float32, BGR, 0 ... 255."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from matchset.sim.rendering.renderer import Picture

FINE = 5  # geometry: samples per pixel, along x and along y, of the disc of confusion
DARK, MIDDLE = (
    16.0,
    128.0,
)  # format: display units; the gray level at which a sensor's noise is stated, and its dark part


def defocus(picture: Picture, radius: float) -> Picture:
    """Blur by the disc of confusion of a lens out of focus: an edge becomes 2 radius wide and stays in its place.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
    radius : float
        Of the disc, px. 0: sharp.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    if radius <= 0.0:
        return picture
    half = math.ceil(radius)
    axis = (np.arange((2 * half + 1) * FINE) + 0.5) / FINE - half - 0.5
    inside = (axis[:, None] ** 2 + axis**2 <= max(radius, 0.5) ** 2).astype(np.float32)
    disc = inside.reshape(2 * half + 1, FINE, 2 * half + 1, FINE).sum(axis=(1, 3))
    return _picture(cv2.filter2D(picture, -1, disc / disc.sum(), borderType=cv2.BORDER_REPLICATE))


def add_sensor_noise(picture: Picture, noise: float, rng: np.random.Generator) -> Picture:
    """Add the noise of a sensor: shot noise, whose variance grows with the light, and a dark part.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
    noise : float
        Standard deviation in each of B, G, R at a gray level of 128, display units.
    rng : Generator

    Returns
    -------
    ndarray of shape (h, w, 3), float32
        Not clipped.
    """
    sigma = noise * np.sqrt((picture + np.float32(DARK)) / np.float32(DARK + MIDDLE))
    return _picture(picture + sigma * rng.standard_normal(picture.shape, np.float32))


def denoise(picture: Picture, share: float, reach: float) -> Picture:
    """Smooth what is nearly even and keep edges: a median of 3 x 3 px, then a bilateral filter.

    Weak texture goes, corners become round, and noise that is left looks like blots.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        0 ... 255.
    share : float
        Share of the filtered picture in the result, 0 ... 1.
    reach : float
        Differences that the bilateral filter smooths, display units.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    if share <= 0.0:
        return picture
    smooth = cv2.bilateralFilter(cv2.medianBlur(picture, 3), 5, reach, 2.0)
    return _picture(picture + np.float32(share) * (smooth - picture))


def mix_with_last(picture: Picture, last: Picture | None, share: float, reach: float) -> Picture:
    """Average over time where the picture hardly changes: weak contrast that moves leaves a trail.

    A pixel takes ``share / (1 + (difference / reach)^2)`` of what it was in the last picture.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
    last : ndarray of shape (h, w, 3), float32, or None
        What this function returned for the frame before; None: there was none.
    share : float
        Largest share of the last picture, 0 ... 1.
    reach : float
        Difference at which half of it is left, display units.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    if last is None or share <= 0.0:
        return picture
    change = last - picture
    square = (change * change).mean(axis=2, keepdims=True) / np.float32(reach * reach)
    return _picture(picture + np.float32(share) / (1.0 + square) * change)


def sharpen(picture: Picture, amount: float, radius: float) -> Picture:
    """Sharpen by an unsharp mask, ``p + amount (p - blurred p)``: a halo on both sides of every edge.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
    amount : float
        0: unchanged. 1: an edge overshoots by about a fifth of its step to each side.
    radius : float
        Standard deviation of the blur, px: width of the halo.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
        Not clipped.
    """
    if amount <= 0.0:
        return picture
    blurred = cv2.GaussianBlur(picture, (0, 0), radius, borderType=cv2.BORDER_REPLICATE)
    return _picture(picture + np.float32(amount) * (picture - blurred))


def saturate(picture: Picture, factor: float) -> Picture:
    """Scale the distance of each color from its gray (luma of BT.601).

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
    factor : float
        0: gray, 1: unchanged, more: gaudy.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
        Not clipped.
    """
    gray = picture @ np.array([0.114, 0.587, 0.299], np.float32)
    return _picture(gray[..., None] + np.float32(factor) * (picture - gray[..., None]))


def _picture(array: npt.ArrayLike) -> Picture:
    return np.asarray(array, dtype=np.float32)
