"""The ball around a click, by the network: `ball_at`."""

import math
from collections.abc import Iterator, Sequence

import msgspec

from matchset.image.disc_network.network import Disc, DiscNetwork, FollowParameters
from matchset.image.disc_network.polar_patch import Circle3, Image

CHANNELS = 3  # format: of a picture with color


class BallAtClickParameters(msgspec.Struct, frozen=True):
    """How the ball is found that somebody clicked at.

    `growth` and `sure` were chosen on real clips (docs/log.md), the others by hand; `python -m benchmarks --only real`
    would show a change.

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
    """

    used: bool = True
    smallest: float = 4.0
    largest: float = 0.35
    growth: float = 1.35
    follow: FollowParameters = FollowParameters(most_step=0.35)
    holds: float = 1.02
    grown: float = 3.0
    sure: float = 1.5


def ball_at(
    image: Image, x: float, y: float, known: Sequence[Circle3], limits: BallAtClickParameters
) -> Circle3 | None:
    """Find the circle around a click that is likeliest to be a ball.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    x, y : float
        The click, px.
    known : sequence of (x, y, radius)
        Circles that may be the ball's, px, beside those around the click.
    limits : BallAtClickParameters

    Returns
    -------
    (x, y, radius) or None
        px; None where none is likely, and of a gray picture.
    """
    if not limits.used or image.shape[2:] != (CHANNELS,):
        return None
    network = DiscNetwork.packaged()
    best: Disc | None = None
    for start in (*known, *_around(image, x, y, limits)):
        disc = network.follow(image, start, limits.follow)
        if disc is None or disc.circle[2] > limits.grown * start[2] or disc.log_odds <= limits.sure:
            continue
        holds = math.dist(disc.circle[:2], (x, y)) <= limits.holds * disc.circle[2]
        if holds and (best is None or disc.log_odds > best.log_odds):
            best = disc
    return best.circle if best else None


def _around(image: Image, x: float, y: float, limits: BallAtClickParameters) -> Iterator[Circle3]:
    """Circles around a click, the smallest first."""
    radius = limits.smallest
    while radius < limits.largest * max(image.shape[:2]):
        yield x, y, radius
        radius *= limits.growth
