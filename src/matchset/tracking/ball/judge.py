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
from matchset.image.click_region import disc_mask
from matchset.image.color import ColorModel
from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.mean_disc import mean_disc
from matchset.image.disc_network.network import Disc, DiscNetwork, NetworkFollowParameters
from matchset.image.disc_network.patch_format import Circle3, Colors
from matchset.image.disc_network.polar_patch import colors_of

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Mask = npt.NDArray[np.bool_]

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
    alone : float
        Log-odds from which it is taken where the fit was rejected: more loses blurred balls, less follows other things.
    differs, differs_much : float
        Squared distance, in its standard deviations, from which a fit that was confirmed and a detection differ from
        it: edge points are more exact where both agree. The first is the 99 % quantile of chi-square with three degrees
        of freedom. A region that differs by it, in the standard deviations of both, is of something else.
    sharp : float
        MSAC score of a confirmed fit from which it is not compared: of 6 clicks on real clips with more than 0.75, edge
        points were right in 4 and the network in 4, and in rendered sequences edge points were, from 0.68 on, with a
        tenth of the error.
    far : float
        How far from the prediction it may be where the fit was rejected, radii.
    middle, color_share : float
        Share of the pixels within so many radii that must have the target's color.
    lost : float
        Log-odds from which a disc is the lost target, all that is known of its place and color added ...
    forgotten, anywhere : float
        ... of its place: in how many frames as much is forgotten as by half a width of way, and what is taken at most,
        of a disc that is far off ...
    growth, grown : float
        ... if its size differs from the last one by no more than this factor in the next frame, and by its square as
        many frames later, ...
    returned : float
        ... but never by more than this one, however long it was not seen: more finds a ball that comes back nearer or
        farther away, and takes small things of its color for a ball that is gone, ...
    lightness, chroma : float
        ... and the median color of its middle by no more than this, units of CIE Lab.
    renewed : float
        Log-odds of a lost target from which its color is remembered anew, and its region need not be a disc's.
    clicked : float
        Log-odds of a disc that was clicked from which its region need not be a disc's.
    chroma_sigma : float
        Standard deviation of that in chroma, where a target is looked for in a picture, units of CIE Lab.
    range_share, min_range_px, sigma_share : float
        Search range of the fit that begins at a disc, in half-widths and at least px; and how far edge points are
        expected, as a share of that: less keeps to the disc, more to what lies around it.
    """

    used: bool = True
    looks: int = 12
    follow: NetworkFollowParameters = NetworkFollowParameters(rounds=5, still=0.3)
    search: NetworkFollowParameters = NetworkFollowParameters(rounds=5, still=0.3, hopeless=-2.0)
    moved: float = 1.0
    inflation: float = 4.0
    same: float = 0.5
    sure: float = 1.0
    clear: float = 2.0
    alone: float = 5.0
    differs: float = 11.3
    differs_much: float = 30.0
    sharp: float = 0.68
    far: float = 1.0
    middle: float = 0.7
    color_share: float = 0.3
    lost: float = 1.2
    forgotten: float = 4.0
    anywhere: float = 2.5
    growth: float = 1.6
    grown: float = 10.0
    returned: float = 3.0
    lightness: float = 30.0
    chroma: float = 12.0
    renewed: float = 4.5
    clicked: float = 3.0
    chroma_sigma: float = 6.0
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
        self.begin_picture()
        self.know(None)

    def begin_picture(self) -> None:
        """Have all looks of a picture before it."""
        self.left, self._led = self.limits.looks, dict[Circle3, Disc | None]()

    def know(self, sample: Sample | None) -> None:
        """Know the colors of the target from a picture that shows it, or none of them.

        Parameters
        ----------
        sample : Sample or None
        """
        self._sample, self._gains = sample if self.limits.used else None, np.ones(1)
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
        (height, width), found = image.shape[:2], []
        for start in begin:
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
            ln(half-width / px), and its standard deviation.
        """
        radius, sigma = math.exp(size[0]), size[1]
        known, other = disc.precision / self.limits.inflation, np.zeros((DISC, DISC))
        other[2, 2] = 1.0 / (sigma * radius) ** 2
        usual = np.array((0.0, 0.0, radius))
        x, y, radius = np.linalg.solve(known + other, known @ disc.circle + other @ usual).tolist()
        return Disc((x, y, radius), disc.precision + other, disc.log_odds)

    def has_color(self, image: Image, color: ColorModel, circle: Circle3) -> bool:
        """Whether enough of the middle of a disc has the target's color."""
        part, inside = middle_of(image, circle, self.limits.middle)
        if not inside.any():
            return False
        return bool((color.scores(part).reshape(inside.shape)[inside] > 0).mean() > self.limits.color_share)

    def median_color(self, image: Image, circle: Circle3) -> Floats | None:
        """Median color of the middle of a disc, CIE Lab; None outside of the picture and unused."""
        if not self.limits.used:
            return None
        part, inside = middle_of(image, circle, self.limits.middle)
        if not inside.any():
            return None
        return np.asarray(np.median(lab_of(part)[inside], axis=0), np.float64)

    def alike(self, image: Image, disc: Disc, own: Floats, color: ColorModel | None = None) -> float | None:
        """Log-odds that a disc is a ball with a median color; None where it has another one.

        Of the network's log-odds the chroma takes some, as a normal distribution does. In another light the median
        color may be far off; then the color model decides, which knows that hue tells more than lightness.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        disc : Disc
        own : ndarray of shape (3,), float64
            Median color of the ball's middle, CIE Lab.
        color : ColorModel, optional
        """
        seen, limits = self.median_color(image, disc.circle), self.limits
        if seen is None:
            return None
        light, chroma = abs(float(seen[0] - own[0])), math.hypot(*(seen - own)[1:].tolist())
        if (light > limits.lightness or chroma > limits.chroma) and (
            color is None or not self.has_color(image, color, disc.circle)
        ):
            return None
        return disc.log_odds - 0.5 * (min(chroma, limits.chroma) / limits.chroma_sigma) ** 2


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


def middle_of(image: Image, circle: Circle3, share: float) -> tuple[Image, Mask]:
    """Part of a picture around the middle of a disc, and which of its pixels are in that."""
    (x, y, radius), (height, width) = circle, image.shape[:2]
    reach = share * radius
    left, top = max(round(x - reach), 0), max(round(y - reach), 0)
    rows, columns = range(top, min(round(y + reach) + 1, height)), range(left, min(round(x + reach) + 1, width))
    part = np.ascontiguousarray(image[top : max(rows.stop, top), left : max(columns.stop, left)])
    return part, disc_mask(part.shape[:2], (x - left, y - top, radius), share)


def covariance_of(disc: Disc) -> Floats:
    """Covariance of a disc's center and radius, px^2."""
    return np.asarray(np.linalg.inv(disc.precision), np.float64)
