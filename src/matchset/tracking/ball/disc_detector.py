"""A ball anywhere in a picture that somebody asks for, by the network of discs: `DiscDetector`.

Votes for circles need an outline of the target's color; a ball that is small, blurred or partly of another color has
none, but the network sees it. So discs that stand out (`disc_search`) are looked at, of some sizes about that at the
click, and for each the log-odds that it is the ball are a sum: those of the network, less what the chroma of its middle
takes, and half of the evidence for an outline of the target's color there, since both see the same pixels.
"""

import math
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.disc_network.network import Disc
from matchset.tracking.ball.disc_search import DiscSearch, DiscSearchParameters
from matchset.tracking.ball.judge import DISC, Judge, NetworkParameters, covariance_of, squared_distances
from matchset.tracking.motion import Gate

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


class DiscDetectorParameters(msgspec.Struct, frozen=True):
    """Which discs of a picture are looked at, and when one is the ball.

    Chosen on nine real clips and on the colors of each in the others (docs/log/network.md#lost-balls);
    `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    sizes : tuple of float
        Radii that are looked for, as shares of that at the click.
    least_px : float
        Least radius of those, px.
    growth : float
        Largest factor between the radius at the click and that of the ball.
    known : float
        Log-odds of a disc from which nothing else is looked for within it.
    compared : int
        How many of the likeliest discs are fitted for their evidence.
    reach, least_reach_px : float
        Range of edge points around a disc, radii and px.
    evidence : float
        Share of the evidence that counts beside the network's log-odds.
    least_evidence, most_evidence : float
        Bounds between which it counts.
    asked : float
        Least sum: less finds more balls, and more other things.
    same : float
        Squared distance of the fit from the disc, in standard deviations of that, below which the fit stays: where both
        agree, edge points are more exact.
    network : NetworkParameters
    search : DiscSearchParameters
    """

    sizes: tuple[float, ...] = (1.0, 0.7, 1.4, 0.5, 2.0)
    least_px: float = 3.5
    growth: float = 2.5
    known: float = 4.0
    compared: int = 3
    reach: float = 0.1
    least_reach_px: float = 2.0
    evidence: float = 0.5
    least_evidence: float = -6.0
    most_evidence: float = 4.0
    asked: float = 3.0
    same: float = 6.0
    network: NetworkParameters = NetworkParameters(looks=400)
    search: DiscSearchParameters = DiscSearchParameters(cells=1_000_000, most=5)


class DiscDetector:
    """Finds the ball that was clicked in a picture.

    Parameters
    ----------
    fitter : Fitter
        Of circles.
    color : ColorModel
        With what was around the circle at the click.
    limits : DiscDetectorParameters
    """

    def __init__(self, fitter: Fitter[Any], color: ColorModel, limits: DiscDetectorParameters) -> None:
        self._fitter, self._model, self._limits = fitter, color, limits
        self._network = Judge(limits.network)
        self._search = DiscSearch(limits.search)
        sample = color.sample
        self._radius = 0.0 if sample is None else sample.radius
        self._color = None if sample is None else self._network.median_color(sample.image, sample.circle)
        self._network.know(sample)

    def find(self, image: Image) -> Floats | None:
        """Find the ball, and leave the workspace as its fit made it, or with the network's disc.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8

        Returns
        -------
        ndarray of shape (3, 3) or None
            Covariance beside that of the workspace, px^2; None if no disc is the ball.
        """
        likely = sorted(self._likely(image), key=lambda each: -each[0])[: self._limits.compared]
        best, most, block = None, self._limits.asked, self._fitter.block
        for odds, disc in likely:
            total = odds + self._limits.evidence * self._evidence(image, disc)
            if total > most:
                best, most, block = disc, total, self._fitter.block.copy()
        if best is None:
            return None
        self._fitter.block[:] = block
        if squared_distances(best, self._fitter.state[:DISC]) < self._limits.same:
            return np.zeros((DISC, DISC))
        self._fitter.state[:DISC] = best.circle
        self._fitter.work.covariance[:] = 0.0
        return covariance_of(best)

    def _likely(self, image: Image) -> list[tuple[float, Disc]]:
        """Discs that the network sees with the color and about the size at the click, with their log-odds."""
        limits, found = self._limits, list[tuple[float, Disc]]()
        if self._color is None:
            return found
        height, width = image.shape[:2]
        everywhere = Gate(0.5 * width, 0.5 * height, self._radius)
        for size in limits.sizes:
            if size * self._radius < limits.least_px:
                continue
            sought = everywhere._replace(half_width=size * self._radius)
            for place in self._search.about(image, self._color, sought, float(max(height, width))):
                if any(disc.log_odds > limits.known and _holds(disc, place) for _, disc in found):
                    continue
                for disc in self._network.discs(image, [np.array(place)], searched=True):
                    odds = self._network.alike(image, disc, self._color)
                    if odds is not None and abs(math.log(disc.circle[2] / self._radius)) < math.log(limits.growth):
                        found.append((odds, disc))
        return found

    def _evidence(self, image: Image, disc: Disc) -> float:
        """Evidence for an outline of the target's color at a disc, within its bounds; the workspace holds the fit."""
        limits, fitter = self._limits, self._fitter
        reach = max(limits.least_reach_px, limits.reach * disc.circle[2])
        fitter.forget()
        state = fitter.family.from_coarse(*disc.circle).state
        estimate = fitter.weigh(fitter.fit(image, self._model, state, SearchWindow(reach)), image, self._model)
        evidence = estimate.evidence if estimate.is_fitted else None
        return min(max(evidence or limits.least_evidence, limits.least_evidence), limits.most_evidence)


def _holds(disc: Disc, place: Gate) -> bool:
    """Whether a place is within a disc."""
    return math.dist(disc.circle[:2], place[:2]) < disc.circle[2]
