"""Balls anywhere in a picture that somebody asks for, by the network of discs: `DiscDetector`.

The same steps as for a lost ball, with a flat belief of place and size. Places are where its color stands out, in discs
of all sizes, and those that somebody else proposes. The network is led from all of them in one call. Of each disc the
log-odds that it is the ball are one weighted sum of what the network says, of its hue and size beside those at the
click, and of the evidence for an outline of the target's color there. The weights are fitted together, since all see
the same pixels.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.mean_disc import mean_disc
from matchset.image.disc_network.network import Disc
from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.discs import are_same, middle_pixels
from matchset.tracking.ball.judge import DISC, Judge, NetworkParameters, covariance_of, squared_distances
from matchset.tracking.ball.places.color_places import ColorPlaceParameters, places_of_color

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


class DetectionWeights(msgspec.Struct, frozen=True):
    """Weights of what speaks for a disc in one picture, and their sum where nothing does.

    Fitted by logistic regression on 4,256 discs in 103 stills of 37 folders and nine clips, each with its own and with
    foreign colors (docs/log/tracking.md#one-belief).

    Parameters
    ----------
    bias : float
    network : float
        Of its log-odds of a ball.
    hue : float
        Of the difference of hue from that at the click, rad, as far as that has a hue.
    evidence : float
        Of the evidence for an outline.
    size : float
        Of the difference of ln(radius) from that at the click.
    """

    bias: float = -4.94
    network: float = 1.39
    hue: float = -3.39
    evidence: float = 0.35
    size: float = -1.07


class DiscDetectorParameters(msgspec.Struct, frozen=True):
    """Which discs of a picture are looked at, and when one is the ball.

    Parameters
    ----------
    weights : DetectionWeights
    asked : float
        Least log-odds: less finds more balls, and more other things.
    doubted : float
        How far below that a disc may be a ball, and is doubtful.
    denied : float
        Evidence of edge points up to which they deny a disc, whatever is known of it beforehand.
    least_px, most_share, factor : float
        Radii that are looked for: the least, px, the largest, as a share of the picture's shorter side, and the factor
        from one to the next.
    small_px : float
        Radius below which a disc is small ...
    small : int
        ... and how many places are proposed of each such radius: a picture shows many small things.
    same : float
        Share of the radius by which circles may differ that lead to the same disc.
    apart : float
        Distance of two discs, in the larger's radii, below which the likelier counts.
    compared : int
        How many of the likeliest discs are fitted for their evidence.
    reach, least_reach_px : float
        Range of edge points around a disc, radii and px.
    least_evidence, most_evidence : float
        Bounds between which evidence counts.
    most_hue : float
        Difference of hue that counts at most, rad.
    full_chroma : float
        Chroma at the click from which it has a hue, units of CIE Lab.
    middle : float
        Share of the radius within which the color is taken.
    agrees : float
        Squared distance of the fit from the disc, in standard deviations of that, below which the fit stays: where both
        agree, edge points are more exact.
    network : NetworkParameters
    places : ColorPlaceParameters
    """

    weights: DetectionWeights = DetectionWeights()
    asked: float = -0.15
    doubted: float = 2.0
    denied: float = -4.0
    least_px: float = 2.8
    most_share: float = 0.45
    factor: float = 1.4
    small_px: float = 10.0
    small: int = 20
    same: float = 0.3
    apart: float = 0.5
    compared: int = 12
    reach: float = 0.1
    least_reach_px: float = 2.0
    least_evidence: float = -6.0
    most_evidence: float = 4.0
    most_hue: float = 1.5
    full_chroma: float = 30.0
    middle: float = 0.7
    agrees: float = 6.0
    network: NetworkParameters = NetworkParameters(looks=600, moved=100.0)
    places: ColorPlaceParameters = ColorPlaceParameters(
        lightness=30.0, chroma=15.0, most=5, least=0.05, larger=1.2, cells=10_000_000
    )


class DiscDetector:
    """Finds balls of a color that was clicked in a picture.

    Parameters
    ----------
    fitter : Fitter
        Of circles.
    color : ColorModel
        With what was around the circle at the click.
    limits : DiscDetectorParameters

    Attributes
    ----------
    lab : ndarray of shape (3,), float64, or None
        Median color at the click, CIE Lab; None where nothing is known of it.
    """

    def __init__(self, fitter: Fitter[Any], color: ColorModel, limits: DiscDetectorParameters) -> None:
        self._fitter, self._model, self._limits = fitter, color, limits
        self._network = Judge(limits.network)
        sample = color.sample
        self._radius = 0.0 if sample is None else sample.radius
        self.lab = None if sample is None else self.middle(sample.image, sample.circle)
        self._network.know(sample)

    def find(self, image: Image, proposed: Sequence[Circle3] = ()) -> Iterator[tuple[float, Floats]]:
        """Yield the balls of a picture, the likeliest first; meanwhile the workspace holds the fit or the disc of each.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        proposed : sequence of (x, y, radius)
            Circles from which the network is led beside those of color, px.

        Yields
        ------
        float
            Log-odds that it is the ball.
        ndarray of shape (3, 3)
            Covariance beside that of the workspace, px^2.
        """
        if self.lab is None:
            return
        starts = self._starts(image, proposed)
        for odds, spread in self.judged(image, self.led(image, starts, self._limits.network.looks)):
            if odds > self._limits.asked:
                yield odds, spread

    def places(
        self, image: Image, radius: float, turn: int, covered: Sequence[Circle3], most: int | None = None
    ) -> list[Circle3]:
        """Circles of about a radius where the target's color stands out, so many at most; see `places_of_color`."""
        if self.lab is None:
            return []
        height, width = image.shape[:2]
        everywhere = (0.5 * width, 0.5 * height, radius), float(max(height, width))
        limits = self._limits.places if most is None else msgspec.structs.replace(self._limits.places, most=most)
        return places_of_color(image, (self.lab, self._model), everywhere, turn, covered, limits)

    def led(self, image: Image, starts: Sequence[Circle3], looks: int) -> list[Disc]:
        """Discs to which the network is led from circles, apart from each other, the likeliest first.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        starts : sequence of (x, y, radius)
            px.
        looks : int
            How many looks of the network it may cost.
        """
        self._network.begin_picture(looks)
        return self._apart(self._network.discs(image, [*map(np.array, starts)], searched=True))

    def judged(
        self, image: Image, discs: Sequence[Disc], prior: Callable[[Disc], float] | None = None
    ) -> Iterator[tuple[float, Floats]]:
        """Yield those of some discs that are balls, or may be; see `find`.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        discs : sequence of Disc
        prior : callable, optional
            Log-odds by what is known beforehand of a disc. They count only where edge points do not deny the disc:
            what is behind a ball of one color is expected where that ball was, too.
        """
        found = list[tuple[float, Disc, Floats]]()
        for disc in discs[: self._limits.compared]:
            evidence = self.evidence(image, disc)
            odds = self._log_odds(image, disc, evidence)
            if odds is None:
                continue
            if prior is not None and evidence > self._limits.denied:
                odds += prior(disc)
            if odds > self._limits.asked - self._limits.doubted:
                found.append((odds, disc, self._fitter.block.copy()))
        for odds, disc, block in sorted(found, key=lambda each: -each[0]):
            self._fitter.block[:] = block
            yield odds, self.settle(disc)

    def settle(self, disc: Disc) -> Floats:
        """Have the workspace, which holds the fit near a disc, hold that or the disc: the fit where both agree.

        Returns
        -------
        ndarray of shape (3, 3)
            Covariance beside that of the workspace, px^2.
        """
        if squared_distances(disc, self._fitter.state[:DISC]) < self._limits.agrees:
            return np.zeros((DISC, DISC))
        self._fitter.state[:DISC] = disc.circle
        self._fitter.work.covariance[:] = 0.0
        return covariance_of(disc)

    def middle(self, image: Image, circle: Circle3) -> Floats | None:
        """Median color of the middle of a disc, CIE Lab; None outside of the picture."""
        pixels = middle_pixels(image, circle, self._limits.middle)
        if not len(pixels):
            return None
        return np.median(lab_of(pixels[:, np.newaxis, :]).reshape(-1, 3), axis=0).astype(np.float64)

    def evidence(self, image: Image, disc: Disc) -> float:
        """Evidence for an outline of the target's color at a disc, within its bounds; the workspace holds the fit."""
        limits, fitter = self._limits, self._fitter
        reach = max(limits.least_reach_px, limits.reach * disc.circle[2])
        fitter.forget()
        state = fitter.family.from_coarse(*disc.circle).state
        estimate = fitter.weigh(fitter.fit(image, self._model, state, SearchWindow(reach)), image, self._model)
        evidence = estimate.evidence if estimate.is_fitted else None
        return min(max(evidence or limits.least_evidence, limits.least_evidence), limits.most_evidence)

    def _starts(self, image: Image, proposed: Sequence[Circle3]) -> list[Circle3]:
        """Circles from which the network is led."""
        limits, starts = self._limits, [*proposed]
        height, width = image.shape[:2]
        radius = limits.least_px
        while radius < limits.most_share * min(height, width):
            small = radius < limits.small_px
            for place in self.places(image, radius, 0, (), limits.small if small else None):
                if not any(are_same(place, each, limits.same) for each in starts):
                    starts.append(place)
            radius *= limits.factor
        return starts

    def _apart(self, discs: Sequence[Disc]) -> list[Disc]:
        """Discs apart from all that are likelier to be a ball, the likeliest first; each is the mean of its like."""
        kept = list[Disc]()
        odds = np.array([disc.log_odds for disc in discs])
        for disc in sorted(discs, key=lambda each: -each.log_odds):
            reach = [self._limits.apart * max(disc.circle[2], each.circle[2]) for each in kept]
            away = [math.dist(disc.circle[:2], each.circle[:2]) for each in kept]
            if all(far >= near for far, near in zip(away, reach, strict=True)):
                like = np.where(odds <= disc.log_odds, odds, -math.inf)
                kept.append(mean_disc(discs, like, self._limits.network.same))
        return kept

    def _log_odds(self, image: Image, disc: Disc, evidence: float) -> float | None:
        """Log-odds that a disc is the ball."""
        limits, weights, lab = self._limits, self._limits.weights, self.middle(image, disc.circle)
        if lab is None or self.lab is None:
            return None
        turned = math.atan2(lab[2], lab[1]) - math.atan2(self.lab[2], self.lab[1])
        hue = min(abs(math.remainder(turned, math.tau)), limits.most_hue)
        hue *= min(math.hypot(self.lab[1], self.lab[2]) / limits.full_chroma, 1.0)
        size = abs(math.log(disc.circle[2] / self._radius))
        odds = weights.bias + weights.network * disc.log_odds + weights.hue * hue
        return odds + weights.evidence * evidence + weights.size * size
