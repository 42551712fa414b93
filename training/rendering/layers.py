"""What scenes are drawn with: numbers by chance, masks of shapes, and layers laid over a picture.

A mask is 0 where a shape is not and 1 where it is, with a smooth rim. Pixel centers are at integers.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.patch_format import Circle3

Singles = npt.NDArray[np.float32]
Floats = npt.NDArray[np.float64]
Random = np.random.Generator
Range = tuple[float, float]
Counts = tuple[int, int]
Size = tuple[int, int]

FULL = 255.0  # brightest, of 8 bits
SHIFT = 4  # bits of a pixel's fraction in the coordinates that OpenCV draws at
FINE = 1 << SHIFT
HALF = 0.5  # of a mask: more counts as inside
LEAST_BLUR = 0.01  # px: OpenCV takes a standard deviation of zero for one to be chosen


class Offsets(NamedTuple):
    """How far each pixel is from a circle's center along x and y, in radii."""

    x: Singles
    y: Singles


class MaterialParameters(msgspec.Struct, frozen=True):
    """How the surface of a thing looks that hides a ball.

    Parameters
    ----------
    mottle : float
        Standard deviation of its brightness, as a share.
    mottle_size : (float, float)
        Distance over which that changes, radii of the ball.
    dark_rim : (float, float)
        How much darker it is at its rim than in its middle, as a share.
    """

    mottle: float = 0.1
    mottle_size: Range = (0.15, 0.8)
    dark_rim: Range = (0.0, 0.5)


class BlobParameters(msgspec.Struct, frozen=True):
    """A patch of no particular shape: a polygon around a point.

    Parameters
    ----------
    apart : (float, float)
        Distance of the point from the ball's center, radii.
    corners : (int, int)
        Least and largest number of corners.
    size : (float, float)
        Farthest a corner can be from the point, radii.
    uneven : float
        Least distance of a corner as a share of that.
    """

    apart: Range = (0.6, 1.6)
    corners: Counts = (5, 9)
    size: Range = (0.2, 0.9)
    uneven: float = 0.5


def happens(random: Random, share: float) -> bool:
    """Decide by chance whether something happens that does so in a share of cases."""
    return bool(random.random() < share)


def within(random: Random, limits: Range) -> float:
    """Draw a number between two, all equally likely."""
    return float(random.uniform(*limits))


def log_within(random: Random, limits: Range) -> float:
    """Draw a number between two, all ratios equally likely."""
    return math.exp(random.uniform(math.log(limits[0]), math.log(limits[1])))


def count_within(random: Random, limits: Counts) -> int:
    """Draw a whole number from the first to the last."""
    return int(random.integers(limits[0], limits[1] + 1))


def which(random: Random, shares: Sequence[float]) -> int:
    """Draw the index of one of several kinds by their shares; what they leave of 1 belongs to one more kind."""
    return int(np.searchsorted(np.cumsum(shares), random.random(), side="right"))


def any_angle(random: Random) -> float:
    """Draw a direction, rad."""
    return within(random, (0.0, 2.0 * math.pi))


def unit(vector: Floats) -> Floats:
    """Return a vector of length 1 of the same direction."""
    return np.asarray(vector / np.linalg.norm(vector))


def away(start: tuple[float, float], angle: float, distance: float) -> tuple[float, float]:
    """Go from a point in a direction, px."""
    return start[0] + distance * math.cos(angle), start[1] + distance * math.sin(angle)


def pixel_at(picture: Singles, x: float, y: float) -> Singles:
    """Color of the pixel that holds a point, or of the nearest to it in the picture."""
    height, width = picture.shape[:2]
    return np.asarray(picture[int(np.clip(y, 0, height - 1)), int(np.clip(x, 0, width - 1))])


def offsets(size: Size, circle: Circle3) -> Offsets:
    """How far each pixel of a picture of a size (height, width) is from a circle's center."""
    rows, columns = np.mgrid[: size[0], : size[1]].astype(np.float32)
    x, y, radius = np.asarray(circle, np.float32)
    return Offsets((columns - x) / radius, (rows - y) / radius)


def smooth_noise(random: Random, size: Size, distance: float) -> Singles:
    """Noise of a standard deviation near 1 that changes over a distance, px."""
    rows, columns = (max(int(side / distance), 2) + 2 for side in size)
    coarse = random.normal(size=(rows, columns)).astype(np.float32)
    return np.asarray(cv2.resize(coarse, (size[1], size[0]), interpolation=cv2.INTER_CUBIC), np.float32)


def disc(size: Size, circle: Circle3) -> Singles:
    """Mask of a disc."""
    x, y = offsets(size, circle)
    return np.clip(circle[2] * (1.0 - np.hypot(x, y)) + np.float32(HALF), 0.0, 1.0)


def line(size: Size, points: Sequence[tuple[float, float]], half_width: float) -> Singles:
    """Mask of a thick line with round ends through points."""
    mask = np.zeros(size, np.uint8)
    thickness = max(round(2.0 * half_width), 1)
    cv2.polylines(mask, [_fine(points)], False, 255, thickness, cv2.LINE_AA, SHIFT)
    return _as_mask(mask)


def polygon(size: Size, corners: npt.ArrayLike) -> Singles:
    """Mask of a polygon with corners of shape (n, 2)."""
    mask = np.zeros(size, np.uint8)
    cv2.fillPoly(mask, [_fine(corners)], (255,), cv2.LINE_AA, SHIFT)
    return _as_mask(mask)


def ellipse(size: Size, circle: Circle3, axes: tuple[float, float], degrees: float) -> Singles:
    """Mask of an ellipse around a circle's center, its half axes in radii."""
    mask = np.zeros(size, np.uint8)
    center = int(circle[0] * FINE), int(circle[1] * FINE)
    lengths = int(circle[2] * FINE * axes[0]), int(circle[2] * FINE * axes[1])
    cv2.ellipse(mask, center, lengths, degrees, 0.0, 360.0, (255,), -1, cv2.LINE_AA, SHIFT)
    return _as_mask(mask)


def band(size: Size, circle: Circle3, angle: float, limits: Range) -> Singles:
    """Mask of all between two parallel lines, whose distances from a circle's center in a direction are given in px."""
    x, y = offsets(size, circle)
    distance = circle[2] * (x * np.float32(math.cos(angle)) + y * np.float32(math.sin(angle)))
    inside = np.minimum(distance - np.float32(limits[0]), np.float32(limits[1]) - distance)
    return np.asarray(np.clip(inside + np.float32(HALF), 0.0, 1.0), np.float32)


def blob(random: Random, size: Size, circle: Circle3, limits: BlobParameters) -> Singles:
    """Mask of a patch of no particular shape near a circle."""
    center = away(circle[:2], any_angle(random), within(random, limits.apart) * circle[2])
    count = count_within(random, limits.corners)
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, count))
    reach = within(random, limits.size) * circle[2] * random.uniform(limits.uneven, 1.0, count)
    return polygon(size, np.column_stack((center[0] + reach * np.cos(angles), center[1] + reach * np.sin(angles))))


def _fine(points: npt.ArrayLike) -> npt.NDArray[np.int32]:
    return np.round(np.asarray(points, np.float64) * FINE).astype(np.int32)


def _as_mask(mask: npt.NDArray[np.uint8]) -> Singles:
    return mask.astype(np.float32) / np.float32(255.0)


def blurred(layer: Singles, deviation: float) -> Singles:
    """Blur a mask or a picture by a Gaussian of a standard deviation, px."""
    return np.asarray(cv2.GaussianBlur(layer, (0, 0), max(deviation, LEAST_BLUR)), np.float32)


def over(picture: Singles, mask: Singles, colors: npt.ArrayLike) -> Singles:
    """Lay colors over a picture where a mask says so."""
    share = mask[..., np.newaxis]
    return np.asarray(picture * (1.0 - share) + share * np.asarray(colors, np.float32), np.float32)


def darkened(picture: Singles, mask: Singles, share: float) -> Singles:
    """Take a share of its light from a picture where a mask says so."""
    return np.asarray(picture * (1.0 - np.float32(share) * mask[..., np.newaxis]), np.float32)


def surface(random: Random, mask: Singles, color: npt.ArrayLike, radius: float, limits: MaterialParameters) -> Singles:
    """Colors of a thing of a shape: mottled, and darker at its rim.

    Parameters
    ----------
    random : Generator
    mask : ndarray of shape (h, w), float32
    color : array of shape (3,)
        BGR.
    radius : float
        That of the ball, px.
    limits : MaterialParameters

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    size = mask.shape[0], mask.shape[1]
    noise = smooth_noise(random, size, within(random, limits.mottle_size) * radius)
    light = 1.0 + np.float32(limits.mottle) * noise
    depth = cv2.distanceTransform((mask > HALF).astype(np.uint8), cv2.DIST_L2, 3)
    deepest = float(depth.max())
    if deepest > 0.0:
        light = light * (1.0 - np.float32(within(random, limits.dark_rim)) * (1.0 - depth / np.float32(deepest)))
    return np.asarray(light[..., np.newaxis] * np.asarray(color, np.float32), np.float32)
