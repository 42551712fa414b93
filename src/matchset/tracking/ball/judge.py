"""What the network of `image/disc_network` sees, with what else is known of a ball: `Judge`.

Edge points say where contrasts are, not whose they are: a hand, a tube or leaves of its color make better ones than a
ball's shaded rim. The network has seen many balls, and says where the outline is and how sure that is.
"""

import math
from collections.abc import Iterable, Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.circle_score import Sample
from matchset.image.color import ColorModel
from matchset.image.disc_network.mean_disc import mean_disc
from matchset.image.disc_network.network import Disc, DiscNetwork, NetworkFollowParameters
from matchset.image.disc_network.patch_format import Circle3, Colors
from matchset.image.disc_network.polar_patch import colors_of
from matchset.tracking.ball.discs import middle_color

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

DISC = 3  # format: parameters of a disc


class NetworkParameters(msgspec.Struct, frozen=True):
    """When the network is believed.

    Chosen on nine real clips, three starts of three clicks each; the weights of the network know none of them
    (docs/log/network.md#network-of-discs). `python -m benchmarks --only real,false_locks` would show a change.

    Parameters
    ----------
    used : bool
        Whether it is asked at all: without it ambiguous frames take a tenth of the time, and more of them are wrong.
    looks : int
        How many looks of the network a picture may cost: a budget of work, not of time, so that a replay is the same
        bit for bit. What does not fit is looked at in the next picture. More finds a lost ball sooner.
    follow, search : NetworkFollowParameters
        How it is led to a ball, and how from places where one is looked for.
    moved : float
        Farthest way from where it began, sum of the changes of x, y and radius in radii: beyond, it is led elsewhere.
    inflation : float
        By how much the covariance of its errors is larger than it says, beside a region.
    same : float
        Discs whose x, y and radius differ by less in all, in radii, are the same ball: their mean counts.
    sure : float
        Log-odds of a ball from which a detection is compared with it.
    clear : float
        Log-odds from which it is taken where a fit differs from it.
    differs : float
        Squared distance, in its standard deviations, from which a fit that was confirmed differs from it: edge points
        are more exact where both agree. It is the 99 % quantile of chi-square with three degrees of freedom. A region
        that differs by it, in the standard deviations of both, is of something else.
    sharp : float
        MSAC score of a confirmed fit from which it is not compared: of 6 clicks on real clips with more than 0.75, edge
        points were right in 4 and the network in 4, and in rendered sequences edge points were, from 0.68 on, with a
        tenth of the error.
    middle, color_share : float
        Share of the pixels within so many radii that must have the target's color.
    size_sigma : float
        Standard deviation of ln(half-width) beside the size remembered, a frame later; it grows with the root of the
        frames. Less holds on to wrong sizes, more takes streaks for larger balls.
    range_share, min_range_px, sigma_share : float
        Search range of the fit that begins at a disc, in half-widths and at least px; and how far edge points are
        expected, as a share of that: less keeps to the disc, more to what lies around it.
    """

    used: bool = True
    looks: int = 6
    follow: NetworkFollowParameters = NetworkFollowParameters(rounds=5, still=0.3)
    search: NetworkFollowParameters = NetworkFollowParameters(rounds=5, still=0.3, hopeless=-2.0)
    moved: float = 1.0
    inflation: float = 4.0
    same: float = 0.5
    sure: float = 1.0
    clear: float = 2.0
    differs: float = 11.3
    sharp: float = 0.68
    middle: float = 0.7
    color_share: float = 0.3
    size_sigma: float = 0.12
    range_share: float = 0.03
    min_range_px: float = 1.5
    sigma_share: float = 0.4


class Judge:
    """Finds discs by the network and weighs outlines against them.

    Parameters
    ----------
    limits : NetworkParameters

    Attributes
    ----------
    left : int
        How many looks are left for this picture.
    """

    def __init__(self, limits: NetworkParameters) -> None:
        self.limits = limits
        self._led: dict[Circle3, Disc | None] = {}
        self.begin_picture()
        self.know(None)

    def begin_picture(self, looks: int | None = None) -> None:
        """Have all looks of a picture before it, or so many."""
        self.left = self.limits.looks if looks is None else looks
        if self._led:  # in most pictures nobody asks
            self._led = {}

    def know(self, sample: Sample | None) -> None:
        """Know the colors of the target from a picture that shows it, or none of them.

        They are kept while the network is not asked, too: it may be asked later.

        Parameters
        ----------
        sample : Sample or None
        """
        self._sample = sample
        self._gains = np.ones(1)
        self._known: Colors | None = None

    def relight(self, gains: Floats) -> None:
        """Know the colors of the target in another light.

        Parameters
        ----------
        gains : ndarray of shape (channels,), float64
            By which the channels of all pixels were multiplied, since the last time.
        """
        if self._sample is not None:
            self._gains = self._gains * gains  # of the picture as it was: what was clipped once would stay so
            self._known = None

    def _colors(self) -> Colors | None:
        """Colors of the target in the light of now, worked out when they are asked for first."""
        if self._known is None and self._sample is not None:
            relit = np.clip(np.rint(self._sample.image * self._gains), 0.0, 255.0)
            self._known = colors_of(np.asarray(relit, np.uint8), self._sample.circle)
        return self._known

    def discs(self, image: Image, starts: Iterable[Floats], *, searched: bool = False) -> list[Disc]:
        """Discs in the picture to which the network is led from several starts.

        Of a disc whose center is outside, too little is seen. Where this picture was led from before, it is not looked
        at again.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        starts : iterable of ndarray of shape (>= 3,), float64
            x, y and radius, px.
        searched : bool
            Whether they are places where a ball is looked for.
        """
        begin = [(float(start[0]), float(start[1]), float(start[2])) for start in starts]
        if not self.limits.used or not begin:
            return []
        follow = self.limits.search if searched else self.limits.follow
        new = [start for start in begin if start not in self._led]
        discs, taken = DiscNetwork.packaged().lead(image, new, follow, self._colors(), self.left)
        self.left -= taken
        self._led |= dict(zip(new, discs, strict=True))
        return self._found(image, begin)

    def seen(self, image: Image) -> list[Disc]:
        """Discs to which the network was led in this picture so far.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        """
        return self._found(image, list(self._led))

    def _found(self, image: Image, starts: Sequence[Circle3]) -> list[Disc]:
        """Discs to which some starts led, in the picture and near to where they began."""
        (height, width), found = image.shape[:2], []
        for start in starts:
            disc = self._led[start]
            if disc is None or np.abs(np.subtract(disc.circle, start)).sum() >= self.limits.moved * start[2]:
                continue
            if 0.0 <= disc.circle[0] <= width - 1 and 0.0 <= disc.circle[1] <= height - 1:
                found.append(disc)
        return found

    def weighed(self, disc: Disc, circle: Circle3, sigma: float) -> Disc:
        """Mean of a disc and another measurement of its circle, weighed by their inverse covariances.

        The disc alone where they differ too much to be the same ball's.

        Parameters
        ----------
        disc : Disc
            Its covariance is inflated: of blurred balls it knows less than it says.
        circle : (x, y, radius)
        sigma : float
            Standard deviation of each number of that, px.

        Returns
        -------
        Disc
        """
        known, other = disc.precision / self.limits.inflation, np.eye(DISC) / sigma**2
        both = np.asarray(np.linalg.inv(np.linalg.inv(known) + sigma**2 * np.eye(DISC)), np.float64)
        if squared_distances(disc._replace(precision=both), np.array(circle)) > self.limits.differs:
            return disc
        x, y, radius = np.linalg.solve(known + other, known @ disc.circle + other @ circle).tolist()
        return Disc((x, y, radius), known + other, disc.log_odds)

    def of_size(self, disc: Disc, size: tuple[float, float]) -> Disc:
        """Mean of a disc and the size remembered, by their inverse covariances.

        Parameters
        ----------
        disc : Disc
            Its covariance is inflated, as in `weighed`.
        size : (float, float)
            ln(half-width / px), and how many frames ago that was known.
        """
        radius, sigma = math.exp(size[0]), self.limits.size_sigma * math.sqrt(size[1])
        known, other = disc.precision / self.limits.inflation, np.zeros((DISC, DISC))
        other[2, 2] = 1.0 / (sigma * radius) ** 2
        usual = np.array((0.0, 0.0, radius))
        x, y, radius = np.linalg.solve(known + other, known @ disc.circle + other @ usual).tolist()
        return Disc((x, y, radius), disc.precision + other, disc.log_odds)

    def has_color(self, image: Image, color: ColorModel, circle: Circle3) -> bool:
        """Whether enough of the middle of a disc has the target's color."""
        seen = middle_color(image, color, circle, self.limits.middle)
        return seen is not None and seen[1] > self.limits.color_share


def likeliest(discs: Sequence[Disc], least: float, same: float) -> Disc | None:
    """Disc with the highest log-odds, if these are above the least: the mean of those that are the same ball.

    Parameters
    ----------
    discs : sequence of Disc
    least : float
        Log-odds.
    same : float
        See `mean_disc`.
    """
    odds = np.array([disc.log_odds for disc in discs])
    return mean_disc(discs, odds, same) if odds.max(initial=-math.inf) > least else None


def squared_distances(disc: Disc, states: Floats) -> Floats:
    """Squared distance of states from a disc, in its standard deviations (Mahalanobis); of shape (...,)."""
    apart = states - disc.circle
    return np.asarray(np.einsum("...i,ij,...j->...", apart, disc.precision, apart))


def covariance_of(disc: Disc) -> Floats:
    """Covariance of a disc's center and radius, px^2."""
    return np.asarray(np.linalg.inv(disc.precision), np.float64)
