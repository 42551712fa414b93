"""What a click may mean, by the network: `discs_at`."""

import math
from collections.abc import Iterator, Sequence

import msgspec
import numpy as np

from matchset.image.disc_network.mean_disc import are_same, mean_disc
from matchset.image.disc_network.network import Disc, DiscNetwork, NetworkFollowParameters
from matchset.image.disc_network.patch_format import Circle3, Image


class BallAtClickParameters(msgspec.Struct, frozen=True):
    """How the balls are found that a click may mean, and which one it means.

    `growth` was chosen on real clips; `precision`, `ways`, `region` and `grown` by the likelihood of the right readings
    on 334 clicks of ``python -m benchmarks.clicks`` and 8 on other shapes (decision 130); the others by hand.

    Parameters
    ----------
    used : bool
        Whether the network is asked at all.
    smallest, largest : float
        Radii of the first and the last circle around the click: px, and as a share of the longer side of the picture.
    growth : float
        By which factor these circles grow: less finds more, and takes longer.
    follow : NetworkFollowParameters
        How the network is led from them.
    holds : float
        How far from its center the click may be, in radii.
    larger : float
        Factor by which a disc may be larger than the circle that led to it.
    sure : float
        Log-odds of a ball from which a disc is weighed at all: low, since balls with stripes and logos have less than
        even odds, and many ways lead to their outline.
    precision : float
        Share of ln sqrt(det P) that is added to the log-odds of a disc, P the inverse of its covariance in radii: of
        two that may both be the ball, the clearer outline.
    ways : float
        Share of ln n that is added, n the number of circles around the click that lead to a disc: to a ball those of
        several sizes do, to what is none often one alone.
    region : float
        What is added if what grew in color at the click is that disc, and less by the share of both that is in both: a
        disc of one color was clicked, as a marker on a ball or a ball before a plate is.
    grown : float
        Least merit of a disc, and that of what grew in color: more takes a small or blurred ball for no disc, less
        takes cards and pieces of a wall for balls. Of 318 right discs 3 had less than 9.4; of 8 clicks on other shapes
        only those on ellipses had more than 8.0, in noise the most was 6.
    same : float
        Discs whose x, y and radius differ by less in all, in radii, are the same ball: what is taken is their mean.
        A region that is so near to a disc is no reading of its own.
    """

    used: bool = True
    smallest: float = 4.0
    largest: float = 0.35
    growth: float = 1.35
    follow: NetworkFollowParameters = NetworkFollowParameters(most_step=0.35)
    holds: float = 1.02
    larger: float = 3.0
    sure: float = -3.0
    precision: float = 0.5
    ways: float = 2.0
    region: float = 2.0
    grown: float = 8.5
    same: float = 0.5


class WeighedDisc(msgspec.Struct, frozen=True):
    """A disc that a click may mean: its circle, px, and its merit, the logarithm of how likely it is beside others."""

    circle: Circle3
    merit: float


def discs_at(
    image: Image, x: float, y: float, others: Sequence[Circle3], limits: BallAtClickParameters
) -> list[WeighedDisc]:
    """Find the discs around a click that may be balls.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    x, y : float
        The click, px.
    others : sequence of (x, y, radius)
        Circles from which the network is led beside those around the click, px.
    limits : BallAtClickParameters

    Returns
    -------
    list of WeighedDisc
        Each the mean of those that are the same ball.
    """
    if not limits.used:
        return []
    left = [disc for start in (*others, *_around(image, x, y, limits)) if (disc := _led(image, (x, y), start, limits))]
    found = []
    while left:
        merits = np.array([disc.log_odds + limits.precision * _clarity(disc) for disc in left])
        same = are_same(left, left[int(merits.argmax())], limits.same)
        merit = float(merits.max()) + limits.ways * math.log(same.sum())
        found.append(WeighedDisc(mean_disc(left, merits, limits.same).circle, merit))
        left = [disc for disc, is_same in zip(left, same, strict=True) if not is_same]
    return found


def _led(image: Image, click: tuple[float, float], start: Circle3, limits: BallAtClickParameters) -> Disc | None:
    """Disc that holds a click and may be a ball, to which the network is led from a circle."""
    disc = DiscNetwork.packaged().follow(image, start, limits.follow)
    if disc is None or disc.circle[2] > limits.larger * start[2] or disc.log_odds <= limits.sure:
        return None
    return disc if math.dist(disc.circle[:2], click) <= limits.holds * disc.circle[2] else None


def _clarity(disc: Disc) -> float:
    """Logarithm of the square root of the determinant of a disc's precision, in radii."""
    return 0.5 * float(np.linalg.slogdet(disc.precision * disc.circle[2] ** 2).logabsdet)


def _around(image: Image, x: float, y: float, limits: BallAtClickParameters) -> Iterator[Circle3]:
    """Circles around a click, the smallest first."""
    radius = limits.smallest
    while radius < limits.largest * max(image.shape[:2]):
        yield x, y, radius
        radius *= limits.growth
