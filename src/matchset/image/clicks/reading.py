"""What a click may mean, each with how likely that is: `Reading`, `readings_of`."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from matchset.image.disc_network.click_discs import BallAtClickParameters, WeighedDisc

Circle3 = tuple[float, float, float]
BALL, SPOT, AROUND, OTHER, REGION = "ball", "spot on it", "ball around it", "another ball", "region"
"""Format: what a reading is called; all but the first and the last beside the likeliest one."""
PERCENT = 100.0  # geometry: of one
TINY = 1e-9  # theorem: a probability is not zero


class Reading(msgspec.Struct, frozen=True):
    """Something that a click may mean.

    Parameters
    ----------
    name : str
        "ball" for the likeliest disc; "spot on it", "ball around it" or "another ball" for a disc within it, around it
        or beside it; "region" for what grew in color and is no ball.
    circle : (x, y, radius)
        The disc, or the smallest circle around the region, px.
    log_odds : float
        That this was meant, and none of the other readings.
    """

    name: str
    circle: Circle3
    log_odds: float

    @property
    def probability(self) -> float:
        """The same as a probability."""
        return 1.0 / (1.0 + math.exp(-self.log_odds))

    def __str__(self) -> str:
        x, y, radius = self.circle
        percent = min(max(round(PERCENT * self.probability), 1), 99)
        return f"{self.name} at ({x:.0f}, {y:.0f}), r = {radius:.0f} px, {percent} %"


def readings_of(
    discs: Sequence[WeighedDisc], shares: Sequence[float], extent: Circle3, limits: BallAtClickParameters
) -> tuple[Reading, ...]:
    """Weigh the discs at a click and the region that grew there against each other.

    That a reading is the one that was meant has the probability exp(m) over the sum of that for all, with m the merit
    of a disc, and more if the region is that disc. That the region is another thing than a disc is as likely as its
    pixels are not that disc's.

    Parameters
    ----------
    discs : sequence of WeighedDisc
    shares : sequence of float
        Of each, which share of disc and region together is in both.
    extent : (x, y, radius)
        Smallest circle around the region, px.
    limits : BallAtClickParameters

    Returns
    -------
    tuple of Reading
        The likeliest first, at least one.
    """
    weighed = [(disc.circle, disc.merit + limits.region * share) for disc, share in zip(discs, shares, strict=True)]
    found = [each for each in weighed if each[1] > limits.grown]
    rest = 1.0 - max((share for share, each in zip(shares, weighed, strict=True) if each in found), default=0.0)
    order = sorted(found, key=lambda each: each[1], reverse=True)
    names = [_name_beside(circle, order[0][0]) for circle, _ in order]
    if not any(_is_same(extent, circle, limits.same) for circle, _ in order):
        order, names = [*order, (extent, limits.grown + math.log(max(rest, TINY)))], [*names, REGION]
    merits = [merit for _, merit in order]
    total = float(np.logaddexp.reduce(merits))
    return tuple(
        Reading(name, circle, _log_odds(merit - total)) for name, (circle, merit) in zip(names, order, strict=True)
    )


def _log_odds(log_probability: float) -> float:
    rest = -math.expm1(min(log_probability, 0.0))
    return log_probability - math.log(max(rest, TINY))


def _is_same(one: Circle3, other: Circle3, same: float) -> bool:
    return sum(abs(a - b) for a, b in zip(one, other, strict=True)) < same * other[2]


def _name_beside(circle: Circle3, first: Circle3) -> str:
    """Name a disc beside the likeliest one."""
    apart = math.dist(circle[:2], first[:2])
    if circle == first:
        return BALL
    if apart < first[2] and circle[2] < first[2]:
        return SPOT
    return AROUND if apart < circle[2] and first[2] < circle[2] else OTHER
