"""The compiled step of a marker tracker: learn how the colors differ, place every marker, describe it; one call."""

import math

import numpy as np
import numpy.typing as npt

from matchset.localization.markers.marker_color import blend, teach, tell_apart
from matchset.localization.markers.marker_fit import fit_marker
from matchset.localization.markers.marker_shape import describe
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

# places of what one memory holds: sums of colors (2, 10), direction of color (4), color of the ball (3), and what
# `fit_marker` knows of the noise (1)
AXIS, GROUND, TIED, KNOWN = 20, 24, 27, 28
# places in `numbers`: the ball's x, y, radius and the variance of that; radius and depth of a marker, in ball radii;
# and the fields of `MarkerParameters` that a frame needs
SPREAD, SIZE, DEPTH, SOFT, LEAST_HEIGHT, LEAST_EXPLAINED, FARTHEST, MEMORY, INFLATION, FLOOR, NUMBERS = range(3, 14)
# places in a row of `found`: radius, share explained, covariance (3, 3), rim (RIM, 2); x and y
RADIUS, EXPLAINED, WIDE, OUTLINE = 0, 1, 2, 11
RIM = 16  # points of a marker's match-set
AT = OUTLINE + 2 * RIM
FOUND = AT + 2
TAUGHT = 12.0  # pixels of the ball's radius that are looked at to learn the colors


@kernel
def is_alone(place: Floats, others: Floats, count: int, apart: float) -> bool:
    """Whether none of the first others is nearer than `apart`."""
    alone = True
    for k in range(count):
        alone = alone and math.sqrt((place[0] - others[k, 0]) ** 2 + (place[1] - others[k, 1]) ** 2) > apart
    return alone


@kernel
def _learn(image: Bytes, ball: Floats, at: Floats, count: int, numbers: Floats, known: Floats) -> None:
    """Learn which direction of color tells marker from ball."""
    sums, fresh = known[:AXIS].reshape(2, 10), np.empty((2, 10))
    step = max(int(ball[2] / TAUGHT), 1)
    teach(image, ball, at, count, numbers[SIZE], numbers[DEPTH], step, fresh)
    if blend(sums, fresh, numbers[MEMORY]):
        tell_apart(sums, known[AXIS:GROUND], known[GROUND:TIED])


@kernel
def follow_markers(image: Bytes, numbers: Floats, seen: int, places: Floats, known: Floats, found: Floats) -> int:
    """Place the markers of a ball anew.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    numbers : (NUMBERS,)
        The ball, and what is asked for: see the names of their places above.
    seen : int
        How many of the markers were seen in the last frame; they come first, and teach the colors.
    places : (k, 2), written
        The markers, from the ball's middle, in ball radii: those that are found come first then, in their order, the
        others after them, where they were.
    known : (KNOWN,), written
        What is known of colors and noise; zeros at first.
    found : (k, FOUND), written
        What was found, see the names of their places above.

    Returns
    -------
    int
        How many were found; of the others `found` has their former row, as its first number.
    """
    n, ball, size, depth = places.shape[0], numbers[:SPREAD], numbers[SIZE], numbers[DEPTH]
    radius, at, unseen, kept = ball[2], np.empty((n, 2)), np.empty((n, 3)), 0
    axis, ground, tied = known[AXIS:GROUND], known[GROUND:TIED], known[TIED:KNOWN]
    for k in range(n):
        at[k, 0], at[k, 1] = ball[0] + radius * places[k, 0], ball[1] + radius * places[k, 1]
    _learn(image, ball, at, seen, numbers, known)
    place, covariance, missed = np.empty(2), np.empty((2, 2)), 0
    for k in range(n):
        before = at[k, 0], at[k, 1]
        covariance[:] = 0.0
        height, _, explained = fit_marker(
            image, ball, at, k, size, depth, numbers[SOFT], axis, ground, tied, covariance
        )
        place[0], place[1] = (at[k, 0] - ball[0]) / radius, (at[k, 1] - ball[1]) / radius
        far = math.sqrt(place[0] ** 2 + place[1] ** 2)
        good = height >= numbers[LEAST_HEIGHT] and explained >= numbers[LEAST_EXPLAINED]
        if not (good and far < numbers[FARTHEST] * depth and is_alone(place, places, kept, size)):
            at[k, 0], at[k, 1] = before
            unseen[missed, 0], unseen[missed, 1], unseen[missed, 2] = k, places[k, 0], places[k, 1]
            missed += 1
            continue
        row, floor = found[kept], numbers[FLOOR] ** 2
        for p in range(2):
            for q in range(2):
                covariance[p, q] = numbers[INFLATION] * covariance[p, q] + (floor if p == q else 0.0)
        rim, wide = row[OUTLINE:AT].reshape(RIM, 2), row[WIDE:OUTLINE].reshape(3, 3)
        row[RADIUS] = describe(at[k], ball, size, depth, covariance, numbers[SPREAD], rim, wide)
        row[EXPLAINED], row[AT], row[AT + 1] = explained, at[k, 0], at[k, 1]
        places[kept, 0], places[kept, 1] = place[0], place[1]
        kept += 1
    for k in range(missed):
        found[kept + k, 0], places[kept + k, 0], places[kept + k, 1] = unseen[k, 0], unseen[k, 1], unseen[k, 2]
    return kept
