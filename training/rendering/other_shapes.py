"""Shapes that are no balls, in the place of one: polygons, long ellipses, stripes, rings, blobs, or nothing at all."""

import msgspec
import numpy as np

from matchset.image.disc_network.patch_format import Circle3
from training.rendering.layers import (
    BlobParameters,
    Counts,
    Random,
    Range,
    Singles,
    Size,
    any_angle,
    band,
    blob,
    count_within,
    disc,
    ellipse,
    happens,
    polygon,
    which,
    within,
)


class OtherShapeParameters(msgspec.Struct, frozen=True):
    """What is in a scene without a ball, in its place; chosen by hand.

    Parameters
    ----------
    shares : (float, float, float, float, float)
        Of scenes with nothing, a polygon, an ellipse, a stripe and a ring; the others have blobs.
    corners : (int, int)
        Least and largest number of a polygon's corners.
    polygon_size : (float, float)
        Distance of its farthest corners from the center, radii.
    turned : float
        Share of polygons whose corners are not evenly spread.
    turn : float
        Standard deviation of the directions of those, rad.
    dented : float
        Share of polygons whose corners are not all as far.
    dent : float
        Least distance of a corner of those, as a share of the largest.
    long_axis, short_axis : (float, float)
        Half axes of an ellipse, radii.
    stripe_offset : float
        Standard deviation of a stripe's middle from the center, radii.
    stripe_width : (float, float)
        Half its width, radii.
    ring_hole : (float, float)
        Radius of a ring's hole, radii.
    blobs : (int, int)
        Least and largest number of blobs.
    blob : BlobParameters
    """

    shares: tuple[float, float, float, float, float] = (0.28, 0.28, 0.19, 0.1, 0.05)
    corners: Counts = (3, 6)
    polygon_size: Range = (0.9, 1.3)
    turned: float = 0.6
    turn: float = 0.25
    dented: float = 0.5
    dent: float = 0.6
    long_axis: Range = (1.2, 2.2)
    short_axis: Range = (0.3, 0.75)
    stripe_offset: float = 0.3
    stripe_width: Range = (0.3, 1.0)
    ring_hole: Range = (0.4, 0.85)
    blobs: Counts = (2, 5)
    blob: BlobParameters = BlobParameters(apart=(0.0, 1.2), corners=(4, 8), size=(0.3, 0.9), uneven=0.4)


def other_shape(random: Random, size: Size, circle: Circle3, limits: OtherShapeParameters) -> Singles:
    """Draw the mask of a shape that is no ball.

    Parameters
    ----------
    random : Generator
    size : (int, int)
        Height and width of the picture, px.
    circle : (x, y, radius)
        Where the shape is, and how large, px.
    limits : OtherShapeParameters

    Returns
    -------
    ndarray of shape (h, w), float32
        0 ... 1.
    """
    kind = which(random, limits.shares)
    if kind == 0:
        return np.zeros(size, np.float32)
    if kind == 1:
        return _polygon(random, size, circle, limits)
    if kind == 2:
        axes = within(random, limits.long_axis), within(random, limits.short_axis)
        return ellipse(size, circle, axes, np.degrees(any_angle(random)))
    if kind == 3:
        middle = random.normal(0.0, limits.stripe_offset) * circle[2]
        half = within(random, limits.stripe_width) * circle[2]
        return band(size, circle, any_angle(random), (middle - half, middle + half))
    if kind == 4:
        x, y, radius = circle
        return disc(size, circle) - disc(size, (x, y, within(random, limits.ring_hole) * radius))
    masks = [blob(random, size, circle, limits.blob) for _ in range(count_within(random, limits.blobs))]
    return np.asarray(np.max(masks, axis=0), np.float32)


def _polygon(random: Random, size: Size, circle: Circle3, limits: OtherShapeParameters) -> Singles:
    """Mask of a polygon, regular or not."""
    count = count_within(random, limits.corners)
    angles = any_angle(random) + 2.0 * np.pi * np.arange(count) / count
    if happens(random, limits.turned):
        angles = angles + random.normal(0.0, limits.turn, count)
    reach = np.full(count, circle[2] * within(random, limits.polygon_size))
    if happens(random, limits.dented):
        reach = reach * random.uniform(limits.dent, 1.0, count)
    return polygon(size, np.column_stack((circle[0] + reach * np.cos(angles), circle[1] + reach * np.sin(angles))))
