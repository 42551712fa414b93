"""Compiles what a search for a ball runs, before a picture waits for it: `precompile_ball`."""

import functools

import cv2
import numpy as np

from matchset.fitting.soft_region import SoftRegionParameters, find_soft_region
from matchset.image.color import ColorModel
from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.network import DiscNetwork, NetworkFollowParameters
from matchset.image.disc_network.polar_patch import colors_of
from matchset.numeric.jit import collection_paused
from matchset.tracking.ball.discs import middle_color
from matchset.tracking.ball.parameters import BallSearchParameters
from matchset.tracking.ball.places.changes import arrivals, changes_since, reference_of, share_before
from matchset.tracking.ball.places.color_places import places_of_color

SMALL = 64  # format: side of a small picture, px
COLOR_CELLS = 1 << 15  # format: of a color table


@functools.cache
@collection_paused()
def precompile_ball() -> None:
    """Run every kernel of a search for a ball once on a small picture, so that no frame waits for the compiler."""
    image, circle = np.zeros((SMALL, SMALL, 3), np.uint8), (0.5 * SMALL, 0.5 * SMALL, 0.25 * SMALL)
    cv2.circle(image, (SMALL // 2, SMALL // 2), SMALL // 4, (255, 255, 255), -1)
    known = colors_of(image, circle)
    DiscNetwork.packaged().lead(image, [circle], NetworkFollowParameters(), known)
    find_soft_region(image, circle, SoftRegionParameters())
    limits = BallSearchParameters()
    color, pixel = ColorModel(np.zeros(COLOR_CELLS, np.float32)), image[0, 0].astype(np.float32)
    middle_color(image, color, circle, limits.middle)
    places_of_color(image, (np.zeros(3), color), (circle, float(SMALL)), 0, [], limits.places)
    changes = changes_since(
        np.roll(image, SMALL // 4, axis=1), reference_of(image, circle, 0.0, limits.changes), limits.changes
    )
    if changes is not None:
        arrivals(changes, pixel, circle[2], limits.changes)
        share_before(changes, (color, pixel), circle, limits.changes)
    lab_of(image)  # OpenCV makes its tables at the first call, in 70 ms
