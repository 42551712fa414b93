"""What has moved since the ball was seen: `changes_since`, `arrivals`, `share_before`.

A small ball that flies many radii from picture to picture is found by its motion alone. A coarse picture, every so many
pixels one, is compared with the reference, from when the ball was seen elsewhere. Where it differs, the change is
explained as a mixture of the ball's color and of what was there before,

    now - before = alpha (ball - before) + residual,

as in matting. The sum of alpha over a region is the area of the ball, however blurred it is: a streak has the mass of
its ball, and the center of that mass is where the ball was in the middle of the exposure. What has the ball's color and
has not changed stood there while the ball was elsewhere, and is not the ball.

The camera's own motion is taken out by a coarse translation. Where too much has changed all the same, motion says
nothing.
"""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.places.changes_kernel import (
    LEVELS,
    MixtureLimits,
    Surroundings,
    count_before,
    differences,
    shares_of_ball,
)

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Mask = npt.NDArray[np.bool_]


class ChangeParameters(msgspec.Struct, frozen=True):
    """How motion is seen; chosen by hand.

    Parameters
    ----------
    step : float
        Distance of the pixels that are compared, radii of the ball: less sees smaller parts of it and takes longer.
    most_cells : int
        How many pixels are compared at most.
    noise, most_usual, least : float
        A pixel has changed if it differs by more than so many medians of all differences, of which so many gray levels
        count at most, plus so many gray levels.
    most_share : float
        Share of the pixels that have changed from which motion says nothing.
    moved_share : float
        Share from which the camera may have moved: then its translation is found first.
    contrast : float
        Gray levels by which the ball must differ from what was there, so that motion says something.
    least_alpha : float
        Least share of the ball in a pixel: less sees fainter streaks, and noise.
    residual, residual_share : float
        How far a change may be from a mixture with the ball's color, gray levels, plus a share of the change.
    growth : float
        Largest factor between the radius of the mass and that of the ball.
    regions : int
        How many regions are looked at, those of most mass.
    near : float
        How far around a disc something of the ball's color is looked for that was there before, radii.
    own : float
        Within how many radii of the ball in the reference its color is its own.
    """

    step: float = 0.5
    most_cells: int = 120_000
    noise: float = 4.0
    most_usual: float = 4.0
    least: float = 8.0
    most_share: float = 0.3
    moved_share: float = 0.15
    contrast: float = 40.0
    least_alpha: float = 0.12
    residual: float = 15.0
    residual_share: float = 0.35
    growth: float = 2.2
    regions: int = 12
    near: float = 3.0
    own: float = 1.8


MOST_ALPHA = 1.5  # format: share of the ball in a pixel, beyond which it is something brighter
WEAK = 100.0  # format: added to a squared difference of colors, gray levels^2, so that no share is made of noise
NONE = np.empty((0, 0), np.bool_)  # format: a mask where only the ball's pixel tells
LEAST_SIDE = 8  # format: pixels of a coarse picture along a side
SHIFT_SIDE = 160  # format: pixels along the longer side of the pictures whose translation is found


class Reference(NamedTuple):
    """A coarse picture from when the ball was seen.

    Attributes
    ----------
    picture : ndarray of shape (rows, columns, channels), uint8
        Every so many pixels one.
    circle : (x, y, radius)
        Where the ball was in it, px of the whole picture.
    time : float
        When it was taken, s.
    """

    picture: Image
    circle: Circle3
    time: float


class PictureChanges(NamedTuple):
    """What differs from the reference.

    Attributes
    ----------
    now : ndarray of shape (rows, columns, channels), uint8
    reference : Reference
        Moved as the camera has moved since.
    changed : ndarray of shape (rows, columns), bool
    share : float
        Of the pixels.
    threshold : float
        By how much a pixel must differ, gray levels.
    scale : (float, float)
        Pixels of the picture for one of the coarse picture, across and down.
    """

    now: Image
    reference: Reference
    changed: Mask
    share: float
    threshold: float
    scale: tuple[float, float]


class Arrival(NamedTuple):
    """A region of the ball's color that was not there before.

    Attributes
    ----------
    x, y : float
        Center of its mass, px.
    radius : float
        Of a disc of as much mass, px.
    """

    x: float
    y: float
    radius: float


def reference_of(image: Image, circle: Circle3, time: float, limits: ChangeParameters) -> Reference:
    """Take a coarse picture in which a ball is seen.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    circle : (x, y, radius)
        Where the ball is, px.
    time : float
        Of the picture, s.
    limits : ChangeParameters
    """
    height, width = image.shape[:2]
    step = max(limits.step * circle[2], 1.0, math.sqrt(height * width / limits.most_cells))
    size = max(int(width / step), LEAST_SIDE), max(int(height / step), LEAST_SIDE)
    return Reference(_coarse(image, size), circle, time)


def _coarse(image: Image, size: tuple[int, int]) -> Image:
    """Take every so many pixels one; `size`: columns and rows."""
    small = cv2.resize(image, size, interpolation=cv2.INTER_NEAREST)
    return np.asarray(small.reshape(size[1], size[0], -1), np.uint8)


def changes_since(image: Image, reference: Reference, limits: ChangeParameters) -> PictureChanges | None:
    """Compare a picture with the reference; None where too much has changed.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    reference : Reference
    limits : ChangeParameters
    """
    rows, columns = reference.picture.shape[:2]
    now = _coarse(image, (columns, rows))
    scale = image.shape[1] / columns, image.shape[0] / rows
    changed, threshold = _differs(now, reference.picture, limits)
    share = float(np.count_nonzero(changed)) / changed.size
    if share > limits.moved_share:
        moved = _moved(now, reference, scale)
        again, lower = _differs(now, moved.picture, limits)
        share_again = float(np.count_nonzero(again)) / again.size
        if share_again < share:
            reference = moved
            changed = again
            share = share_again
            threshold = lower
    return None if share > limits.most_share else PictureChanges(now, reference, changed, share, threshold, scale)


def _differs(now: Image, before: Image, limits: ChangeParameters) -> tuple[Mask, float]:
    """Which pixels of two coarse pictures differ by more than noise, and by how much they must, gray levels."""
    away, counts = np.empty(now.shape[:2], np.uint8), np.empty(LEVELS, np.int64)
    usual = differences(now, before, away, counts)
    threshold = limits.noise * min(usual, limits.most_usual) + limits.least
    return np.asarray(away > threshold, np.bool_), threshold


def _moved(now: Image, reference: Reference, scale: tuple[float, float]) -> Reference:
    """Move the reference as the camera has moved since, by the translation of the whole picture."""
    rows, columns = now.shape[:2]
    shrink = max(max(rows, columns) / SHIFT_SIDE, 1.0)
    size = max(round(columns / shrink), LEAST_SIDE), max(round(rows / shrink), LEAST_SIDE)
    first, second = (
        cv2.resize(each, size, interpolation=cv2.INTER_AREA)
        .reshape(size[1], size[0], -1)
        .mean(axis=2, dtype=np.float32)
        for each in (reference.picture, now)
    )
    (across, down), _ = cv2.phaseCorrelate(first, second, cv2.createHanningWindow(size, cv2.CV_32F))
    across *= columns / size[0]
    down *= rows / size[1]
    by = np.array(((1.0, 0.0, across), (0.0, 1.0, down)))
    picture = cv2.warpAffine(reference.picture, by, (columns, rows), borderMode=cv2.BORDER_REPLICATE)
    x, y, radius = reference.circle
    circle = x + across * scale[0], y + down * scale[1], radius
    return reference._replace(picture=np.asarray(picture.reshape(now.shape), np.uint8), circle=circle)


def arrivals(
    changes: PictureChanges, pixel: npt.NDArray[np.float32], radius: float, limits: ChangeParameters
) -> list[Arrival]:
    """Find regions of a ball's color and mass that were not there before, those of the likeliest mass first.

    Parameters
    ----------
    changes : PictureChanges
    pixel : ndarray of shape (channels,), float32
        Color of the ball.
    radius : float
        Of the ball, px.
    limits : ChangeParameters
    """
    alphas = np.empty(changes.changed.shape, np.float32)
    mixture = MixtureLimits(
        limits.contrast, limits.least_alpha, limits.residual, limits.residual_share, MOST_ALPHA, WEAK
    )
    pictures = changes.now, changes.reference.picture
    if not shares_of_ball(pictures, changes.changed, pixel, mixture, alphas):
        return []
    rows, columns = np.nonzero(alphas)
    alpha, mask = alphas[rows, columns], (alphas > 0.0).view(np.uint8)
    joined = cv2.dilate(mask, np.ones((3, 3), np.uint8))
    count, labels = cv2.connectedComponents(joined, connectivity=8)
    region = labels[rows, columns]
    mass = np.bincount(region, alpha, count)
    x = np.bincount(region, alpha * columns, count) * changes.scale[0]
    y = np.bincount(region, alpha * rows, count) * changes.scale[1]
    found = list[tuple[float, Arrival]]()
    for k in np.argsort(-mass)[: limits.regions].tolist():
        if mass[k] <= 0.0:
            break
        size = math.sqrt(mass[k] * changes.scale[0] * changes.scale[1] / math.pi)
        off = abs(math.log(size / radius))
        if off < math.log(limits.growth):
            found.append((off, Arrival(float(x[k] / mass[k]), float(y[k] / mass[k]), size)))
    return [arrival for _, arrival in sorted(found)]


def departures(
    changes: PictureChanges, pixel: npt.NDArray[np.float32], radius: float, limits: ChangeParameters
) -> list[Arrival]:
    """Find regions of a ball's color and mass that are gone, but for the ball's own; see `arrivals`."""
    own = changes.reference.circle
    backward = changes._replace(now=changes.reference.picture, reference=Reference(changes.now, own, 0.0))
    gone = arrivals(backward, pixel, radius, limits)
    return [each for each in gone if math.dist(each[:2], own[:2]) > limits.own * max(own[2], radius)]


def share_before(
    changes: PictureChanges,
    known: tuple[ColorModel, npt.NDArray[np.float32]],
    circle: Circle3,
    limits: ChangeParameters,
    *,
    moved: bool = True,
) -> float:
    """Say how much of a disc was there before the ball was, in or near its place, as a share of its area.

    It counts what had the ball's color within the disc, or near by and is gone now: a look-alike that rests, or that
    has moved; and what has not changed within the disc though the ball would have changed it. Where the ball itself
    was is left out.

    Parameters
    ----------
    changes : PictureChanges
    known : (ColorModel, ndarray of shape (channels,), float32)
        What the ball's color is, and the ball as a pixel.
    circle : (x, y, radius)
        The disc, px.
    limits : ChangeParameters
    moved : bool
        Whether look-alikes that have moved count too.
    """
    (x, y, radius), (across, down), reference = circle, changes.scale, changes.reference
    color, pixel = known
    reach = limits.near * radius
    left, top = max(int((x - reach) / across), 0), max(int((y - reach) / down), 0)
    columns = slice(left, max(int((x + reach) / across) + 1, left))
    rows = slice(top, max(int((y + reach) / down) + 1, top))
    before = np.ascontiguousarray(reference.picture[rows, columns])
    if not before.size:
        return 0.0
    own_x, own_y, own_radius = reference.circle
    disc = Surroundings(
        x,
        y,
        radius,
        own_x,
        own_y,
        limits.own * max(own_radius, radius),
        across * left,
        down * top,
        across,
        down,
        changes.threshold,
        limits.contrast,
    )
    alike = NONE if color.gray else color.scores(before).reshape(before.shape[:2]) > 0
    changed = np.ascontiguousarray(changes.changed[rows, columns])
    return count_before(before, changed, alike, pixel, disc, moved, np.empty(LEVELS, np.int64))
