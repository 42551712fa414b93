"""The ball around a click, by the network: `ball_at`."""

import math
from collections.abc import Iterator

import msgspec
import numpy as np

from matchset.image.disc_network.mean_disc import are_same, mean_disc
from matchset.image.disc_network.network import Disc, DiscNetwork, FollowParameters
from matchset.image.disc_network.patch_format import Circle3, Image


class BallAtClickParameters(msgspec.Struct, frozen=True):
    """How the ball is found that somebody clicked at.

    `growth` and `sure` were chosen on real clips, `alone` on 1,600 clicks into random videos 1000-1399 and 216 on other
    shapes (docs/log.md), the others by hand; `python -m benchmarks --only real,shapes_accuracy` would show a change.

    Parameters
    ----------
    used : bool
        Whether the network is asked at all.
    smallest, largest : float
        Radii of the first and the last circle around the click: px, and as a share of the longer side of the picture.
    growth : float
        By which factor these circles grow: less finds more, and takes longer.
    follow : FollowParameters
        How the network is led from them.
    holds : float
        How far from its center the click may be, in radii.
    grown : float
        Factor by which a disc may be larger than the circle that led to it.
    sure : float
        Least log-odds of a ball.
    precision : float
        Share of ln sqrt(det P) that is added to the log-odds of a disc, P the inverse of its covariance in radii: of
        two that may both be the ball, the clearer outline.
    outlined, spot : float
        A disc that lies within another one may be a spot on it: if the other one has the circle whose outline stands
        out by more than the first, the second is added to its log-odds.
    same : float
        Discs whose x, y and radius differ by less in all, in radii, are the same ball: what is taken is their mean.
    alone : float
        Largest radius of a disc to which only one circle leads, px. To a ball, circles of other sizes lead too, but for
        the smallest, around which there are few; where only one leads, mostly there is none.
    """

    used: bool = True
    smallest: float = 4.0
    largest: float = 0.35
    growth: float = 1.35
    follow: FollowParameters = FollowParameters(most_step=0.35)
    holds: float = 1.02
    grown: float = 3.0
    sure: float = 1.5
    precision: float = 0.2
    outlined: float = 0.5
    spot: float = 1.5
    same: float = 0.5
    alone: float = 10.0


def ball_at(
    image: Image, x: float, y: float, known: tuple[float, Circle3] | None, limits: BallAtClickParameters
) -> Circle3 | None:
    """Find the circle around a click that is likeliest to be a ball.

    Of several that are the same ball it is the mean.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    x, y : float
        The click, px.
    known : (float, (x, y, radius)) or None
        Circle that may be the ball's, px, beside those around the click, and how much it stands out, 0 ... 1.
    limits : BallAtClickParameters

    Returns
    -------
    (x, y, radius) or None
        px; None where none is likely.
    """
    if not limits.used:
        return None
    first = _led(image, (x, y), known[1], limits) if known else None
    led = [disc for disc in (first, *(_led(image, (x, y), at, limits) for at in _around(image, x, y, limits))) if disc]
    found = [disc for disc in led if disc.circle[2] <= limits.alone or np.sum(are_same(led, disc, limits.same)) > 1]
    if not found:
        return None
    merits = np.array([disc.log_odds + limits.precision * _clarity(disc) for disc in found])
    best = int(merits.argmax())
    if known and found[0] is first and known[0] > limits.outlined and _is_on(found[best], found[0]):
        merits[0] += limits.spot
    return mean_disc(found, merits, limits.same).circle


def _led(image: Image, click: tuple[float, float], start: Circle3, limits: BallAtClickParameters) -> Disc | None:
    """Disc that holds a click and is likely to be a ball, to which the network is led from a circle."""
    disc = DiscNetwork.packaged().follow(image, start, limits.follow)
    if disc is None or disc.circle[2] > limits.grown * start[2] or disc.log_odds <= limits.sure:
        return None
    return disc if math.dist(disc.circle[:2], click) <= limits.holds * disc.circle[2] else None


def _is_on(spot: Disc, disc: Disc) -> bool:
    """Whether a disc lies within another one."""
    return math.dist(spot.circle[:2], disc.circle[:2]) + spot.circle[2] < disc.circle[2]


def _clarity(disc: Disc) -> float:
    """Logarithm of the square root of the determinant of a disc's precision, in radii."""
    return 0.5 * float(np.linalg.slogdet(disc.precision * disc.circle[2] ** 2).logabsdet)


def _around(image: Image, x: float, y: float, limits: BallAtClickParameters) -> Iterator[Circle3]:
    """Circles around a click, the smallest first."""
    radius = limits.smallest
    while radius < limits.largest * max(image.shape[:2]):
        yield x, y, radius
        radius *= limits.growth
