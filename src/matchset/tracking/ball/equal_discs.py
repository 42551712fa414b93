"""All discs of a picture that are like some that were found: `EqualDiscs`.

Once some of many equal things are found, the rest is easier: their size and color are known, and where many are alike,
one more is likely. Places are looked at where discs of these sizes stand out by their color, and where their color is
not covered by a disc that was found: in a heap nothing stands out. The network is led from them, a few places at a
time, the commonest size first. What is found teaches the next round. A size is done after so many places in vain.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.image.circle_score import sample_of
from matchset.image.color import ColorModel
from matchset.image.disc_network.network import Disc
from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.disc_detector import DiscDetector, DiscDetectorParameters
from matchset.tracking.ball.discs import are_same
from matchset.tracking.ball.log_odds import probability_of
from matchset.tracking.ball.places.uncovered_places import UncoveredPlaceParameters, uncovered_places
from matchset.tracking.ball.spanning_color import spanning_color

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
RIM = 64  # format: directions in which the rim of a disc is looked at


class EqualWeights(msgspec.Struct, frozen=True):
    """Weights of what speaks for one more disc beside those that were found, and their sum where nothing does.

    Fitted by logistic regression on 285 discs in half of the labelled stills and in composed crowds of seeds 610 to
    619; of 255 discs in the other half they took 113 of 118 right ones, and no other
    (docs/log/search.md#equal-discs).

    Parameters
    ----------
    bias : float
    network : float
        Of its log-odds of a ball.
    chroma : float
        Of the difference of chroma from the most similar disc that was found, 10 units of CIE Lab.
    evidence : float
        Of the evidence for an outline.
    alike : float
        Of ln(1 + how many discs of about this size were found), each counted by its probability.
    """

    bias: float = -4.8
    network: float = 0.7
    chroma: float = -5.5
    evidence: float = 0.46
    alike: float = 2.0


class EqualDiscsParameters(msgspec.Struct, frozen=True):
    """How discs are found that are like others.

    Parameters
    ----------
    weights : EqualWeights
    asked : float
        Least log-odds of a disc: less finds more, and more other things.
    same_size : float
        Factor between the radii of discs that are of one size.
    most_alike : float
        So many discs of a size say all that their number can say.
    most_chroma : float
        Difference of chroma that counts at most, CIE Lab.
    foreign : float
        Difference of chroma from which an outline is of something else, if others are like what was clicked: more
        keeps things of other colors, less loses discs in other light. Of 263 right ones no one differed by more than
        14 from the most similar other one.
    brighter : float
        By what factor its chroma may be another one since more or less light falls on it.
    unweighed : float
        What counts as the evidence where none is weighed: where brightness tells the target.
    touching : float
        Share of its radius beyond which a disc touches none, and by which it overlaps those that it touches at most.
    same : float
        Discs nearer to one that was found than so many of the larger radius are that one.
    same_place : float
        Share of the radius by which circles may differ that lead to the same disc.
    batch, batch_share : float
        How many places are looked at in a round: so many, and more per disc that was found. More takes longer where
        there is nothing else, and finds a crowd in fewer rounds.
    patience, patience_share : float
        Places in vain after which a size is done: so many, and more per disc of that size. More finds what is hidden
        deeper, and takes longer.
    looks : int
        Looks of the network per place.
    sizes : int
        How many sizes are looked for, the commonest first.
    relearn : float
        A color that was learned against what is next to the click is learned anew when so many times as many discs are
        known: less follows them sooner, each time takes some ms.
    taught : (float, float)
        Share of its radius within which a pixel teaches the color of a disc, and up to which that of what is around.
    clicked : float
        Log-odds of the disc that was clicked at, in the picture that was clicked.
    discs : DiscDetectorParameters
        How places are proposed, and what a disc is.
    uncovered : UncoveredPlaceParameters
    """

    weights: EqualWeights = EqualWeights()
    asked: float = 0.0
    same_size: float = 1.2
    most_alike: float = 10.0
    most_chroma: float = 30.0
    foreign: float = 20.0
    brighter: float = 1.6
    unweighed: float = 0.0
    touching: float = 0.12
    same: float = 0.5
    same_place: float = 0.3
    batch: float = 3.0
    batch_share: float = 0.5
    patience: float = 2.0
    patience_share: float = 1.5
    looks: int = 5
    sizes: int = 3
    relearn: float = 1.5
    taught: tuple[float, float] = (0.85, 1.6)
    clicked: float = 7.0
    discs: DiscDetectorParameters = DiscDetectorParameters()
    uncovered: UncoveredPlaceParameters = UncoveredPlaceParameters()


class _Known(NamedTuple):
    """A disc that was found: its circle, px, its color, CIE Lab, and its probability."""

    circle: Circle3
    lab: Floats
    probability: float


class EqualDiscs:
    """Finds all discs of one picture that are like some.

    Parameters
    ----------
    fitter : Fitter
        Of circles.
    color : ColorModel
        With what was around the circle at the click.
    image : ndarray of shape (h, w, channels), uint8
    limits : EqualDiscsParameters, optional
    """

    def __init__(
        self, fitter: Fitter[Any], color: ColorModel, image: Image, limits: EqualDiscsParameters | None = None
    ) -> None:
        self._fitter, self._color, self._image = fitter, color, image
        self._limits = limits = limits or EqualDiscsParameters()
        self._detector = DiscDetector(fitter, color, limits.discs)
        self._known = list[_Known]()
        self._tried = list[Circle3]()
        self._vain = list[float]()
        self._done = list[float]()
        self._taught = 1

    def __len__(self) -> int:
        """How many are known."""
        return len(self._known)

    def know(self, circle: Circle3, probability: float) -> None:
        """Take a disc for found, px, with its probability."""
        lab = self._detector.middle(self._image, circle)
        if lab is not None:
            self._known.append(_Known(circle, lab, probability))

    def is_known(self, circle: Circle3) -> bool:
        """Whether a disc is one of those that were found."""
        return any(
            math.dist(circle[:2], each.circle[:2]) < self._limits.same * max(circle[2], each.circle[2])
            for each in self._known
        )

    def alike(self, circles: Sequence[Circle3]) -> list[int]:
        """Say which circles look like what was clicked, or like another that does: their numbers, in order.

        All, if none does: the light may be another.

        Parameters
        ----------
        circles : sequence of (x, y, radius)
            px.
        """
        labs = [self._detector.middle(self._image, circle) for circle in circles]
        like, left = [self._detector.lab], dict(enumerate(labs))
        while near := [number for number, lab in left.items() if self._is_near(lab, like)]:
            like += [left.pop(number) for number in near]
        return [number for number in range(len(circles)) if number not in left or len(left) == len(circles)]

    def _is_near(self, lab: Floats | None, others: Sequence[Floats | None]) -> bool:
        """Whether a color has about the chroma of one of others; what is not known is near to all."""
        return any(
            lab is None or each is None or _chroma_apart(lab, each, self._limits.brighter) < self._limits.foreign
            for each in others
        )

    def log_odds(self, circle: Circle3, network: float, evidence: float) -> float:
        """Log-odds that a circle is one more of those that were found.

        Parameters
        ----------
        circle : (x, y, radius)
            px.
        network, evidence : float
            What the network says of it, and the evidence for an outline.
        """
        limits, lab = self._limits, self._detector.middle(self._image, circle)
        if lab is None or not self._known:
            return -math.inf
        weights = limits.weights
        chroma = min(min(math.dist(lab[1:], each.lab[1:]) for each in self._known), limits.most_chroma)
        alike = min(sum(each.probability for each in self._of_size(circle[2])), limits.most_alike)
        odds = weights.bias + weights.network * network + weights.chroma * chroma / 10.0
        return odds + weights.evidence * evidence + weights.alike * math.log1p(alike)

    def clicked(self) -> Iterator[tuple[float, Floats]]:
        """Yield the disc that was clicked, if this is the picture of the click and it is not known; see `find`."""
        circle, sample = self._color.circle, self._color.sample
        if circle is None or sample is None or self.is_known(circle):
            return
        height, width = self._image.shape[:2]
        if not (-0.5 <= circle[0] < width - 0.5 and -0.5 <= circle[1] < height - 0.5):
            return
        if not np.array_equal(sample_of(self._image, circle).image, sample.image):
            return
        for disc in self._detector.led(self._image, [circle], self._limits.looks):
            if are_same(disc.circle, circle, self._limits.same_place):
                self._evidence(disc)
                yield self._limits.clicked, self._settled(disc, self._limits.clicked)
                return

    def find(self, most: int) -> Iterator[tuple[float, Floats]]:
        """Yield more discs; meanwhile the workspace holds the fit or the disc of each.

        Parameters
        ----------
        most : int
            So many may be known at the end.

        Yields
        ------
        float
            Log-odds that it is one of them.
        ndarray of shape (3, 3)
            Covariance beside that of the workspace, px^2.
        """
        while len(self._known) < most and (radius := self._next_size()) is not None:
            self._learn()
            starts = self._places(radius)
            found = 0
            for disc in self._detector.led(self._image, starts, self._limits.looks * len(starts)):
                if self.is_known(disc.circle):
                    continue
                odds = self.log_odds(disc.circle, disc.log_odds, self._evidence(disc))
                if odds > self._limits.asked and len(self._known) < most:
                    found += 1
                    yield odds, self._settled(disc, odds)
            self._tried += starts
            self._vain += [radius] * (len(starts) - found)
            if not starts:
                self._done.append(radius)

    def _learn(self) -> None:
        """Learn the color anew from all discs, where it was learned of one and its surroundings, and they are more."""
        limits = self._limits
        if not self._color.is_local or len(self._known) < limits.relearn * self._taught:
            return
        self._taught = len(self._known)
        circles = [each.circle for each in self._known]
        self._color = spanning_color(self._image, self._color, circles, limits.taught)
        self._detector = DiscDetector(self._fitter, self._color, limits.discs)

    def _settled(self, disc: Disc, odds: float) -> Floats:
        """Know a disc, and have the workspace hold it; covariance beside that."""
        spread = self._detector.settle(disc)
        x, y, radius = self._fitter.state[:3].tolist()
        self.know((x, y, radius), probability_of(odds))
        return spread

    def _evidence(self, disc: Disc) -> float:
        """Evidence for an outline; where others that are known touch it, a step in color cannot be asked for."""
        evidence = self._detector.evidence(self._image, disc)
        if not self._fitter.weighs(self._color):
            return self._limits.unweighed
        return evidence if evidence > 0.0 else evidence * self._free_share(disc.circle)

    def _free_share(self, circle: Circle3) -> float:
        """Share of the rim of a disc that touches no other one that is known."""
        x, y, radius = circle
        angles = np.linspace(0.0, math.tau, RIM, endpoint=False)
        reach = (1.0 + self._limits.touching) * radius
        rim = np.stack((x + reach * np.cos(angles), y + reach * np.sin(angles)), axis=1)
        free = np.ones(RIM, bool)
        for each in self._known:
            if math.dist((x, y), each.circle[:2]) < (1.0 - self._limits.touching) * (radius + each.circle[2]):
                continue  # it overlaps that one: where two lie on each other there is an edge
            free &= np.hypot(*(rim - each.circle[:2]).T) > (1.0 + self._limits.touching) * each.circle[2]
        return float(free.mean())

    def _of_size(self, radius: float) -> list[_Known]:
        """Discs that were found of about a radius."""
        most = math.log(self._limits.same_size)
        return [each for each in self._known if abs(math.log(each.circle[2] / radius)) < most]

    def _next_size(self) -> float | None:
        """Radius that is looked for next: of the commonest size that is not done."""
        limits, left, sizes = self._limits, [each.circle[2] for each in self._known], list[tuple[int, float]]()
        while left and len(sizes) < limits.sizes:
            common = max(left, key=lambda radius: len(self._of_size(radius)))
            alike = [radius for radius in left if _are_of_size(radius, common, limits.same_size)]
            left = [radius for radius in left if radius not in alike]
            sizes.append((len(alike), float(np.median(alike))))
        for count, radius in sorted(sizes, reverse=True):
            vain = sum(_are_of_size(each, radius, limits.same_size) for each in self._vain)
            done = any(_are_of_size(each, radius, limits.same_size) for each in self._done)
            if not done and vain < limits.patience + limits.patience_share * count:
                return radius
        return None

    def _places(self, radius: float) -> list[Circle3]:
        """Circles from which the network is led next: by turns those that stand out and those that nothing covers."""
        limits = self._limits
        most = round(limits.batch + limits.batch_share * len(self._known))
        circles = [each.circle for each in self._known]
        covered = [(x, y, limits.uncovered.covered * size) for x, y, size in circles]
        covered += [(x, y, limits.uncovered.in_vain * size) for x, y, size in self._tried]
        proposed = (
            self._detector.places(self._image, radius, 0, covered),
            uncovered_places(
                self._image,
                ([each.lab for each in self._known], self._color),
                radius,
                (circles, self._tried),
                most,
                limits.uncovered,
            ),
        )
        starts = list[Circle3]()
        for place in itertools.chain(*itertools.zip_longest(*proposed)):
            if place is not None and not self._is_tried(place, starts):
                starts.append(place)
        return starts[:most]

    def _is_tried(self, place: Circle3, starts: Sequence[Circle3]) -> bool:
        return any(are_same(place, each, self._limits.same_place) for each in (*starts, *self._tried))


def _are_of_size(first: float, second: float, factor: float) -> bool:
    return abs(math.log(first / second)) < math.log(factor)


def _chroma_apart(one: Floats, other: Floats, brighter: float) -> float:
    """Distance of the chroma of two colors, of which one may have more light by a factor."""
    length = max(float(other[1:] @ other[1:]), 1.0)
    scale = min(max(float(one[1:] @ other[1:]) / length, 1.0 / brighter), brighter)
    return float(np.linalg.norm(one[1:] - scale * other[1:]))
