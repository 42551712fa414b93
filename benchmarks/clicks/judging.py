"""Whether a pick took the ball that was clicked, or offered it: `judge`."""

import math
import time
from collections.abc import Iterator
from typing import NamedTuple

import matchset as ms
from benchmarks.clicks.pictures import Shown
from benchmarks.clicks.scenes import Circle3
from benchmarks.real.starts import CLICKS

FAR = 0.7 * math.sqrt(0.5)
PLACES = (*CLICKS, (-FAR, -FAR), (FAR, -FAR), (-FAR, FAR), (FAR, FAR))
"""Where on the disc a click hits, in radii from the center: as on the labelled clips, and nearer to the rim."""

ON_SPOT = " (on the spot)"
SHARE, LEAST = 0.3, 1.0  # format: how far off a circle may be in place and radius together, radii, and px more


class Outcome(NamedTuple):
    """What came of a click.

    Attributes
    ----------
    group : str
    right : bool
        The ball was taken.
    offered : bool
        It is the first reading or the second.
    spot : bool
        A spot on it was taken.
    refused : bool
    sure : float
        Probability of what was taken.
    seconds : float
        Of processor.
    """

    group: str
    right: bool
    offered: bool
    spot: bool
    refused: bool
    sure: float
    seconds: float


def clicks_of(shown: Shown, every: int) -> Iterator[tuple[str, float, float]]:
    """Click at every so manieth place on a ball, and in the middle of a spot on it: with the group that counts."""
    x, y, radius = shown.circle
    height, width = shown.image.shape[:2]
    places = [(shown.group, x + across * radius, y + down * radius) for across, down in PLACES[::every]]
    if shown.spot is not None:
        places.append((shown.group + ON_SPOT, *shown.spot[:2]))
    yield from (place for place in places if 0.0 <= place[1] <= width - 1.0 and 0.0 <= place[2] <= height - 1.0)


def judge(shown: Shown, every: int = 1) -> list[Outcome]:
    """Click into a picture.

    Parameters
    ----------
    shown : Shown
    every : int
        Take every so manieth of `PLACES`.
    """
    return [_outcome(shown, *click) for click in clicks_of(shown, every)]


def _outcome(shown: Shown, group: str, x: float, y: float) -> Outcome:
    begun = time.process_time()
    try:
        color = ms.ColorModel.pick(shown.image, x, y)
    except ValueError:
        return Outcome(group, False, False, False, True, 0.0, time.process_time() - begun)
    seconds = time.process_time() - begun
    circles = [each.circle for each in color.alternatives]
    right = [is_same(circle, shown.circle) for circle in circles]
    spot = shown.spot is not None and is_same(circles[0], shown.spot)
    return Outcome(group, right[0], any(right[:2]), spot, False, color.alternatives[0].probability, seconds)


def is_same(circle: Circle3, truth: Circle3) -> bool:
    """Whether a circle is that of the truth, as far as it needs to be for a first fit."""
    off = math.dist(circle[:2], truth[:2]) + abs(circle[2] - truth[2])
    return off < SHARE * truth[2] + LEAST
