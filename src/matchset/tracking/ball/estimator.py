"""Estimates where a ball is that is not where its outline was expected: `BallEstimator`.

Three steps, on one belief:

1. *Propose*: where it is expected and was seen last, what has moved (`changes`), and where its color stands out
   (`color_places`), the likeliest first.
2. *Measure*: the network of discs is led from all of them in one call. Each disc that it sees has features, and one
   weighted sum of them, its log-odds (`log_odds`). The likeliest disc is the prior of a fit to its edge points; where
   these do not confirm it, the disc itself counts.
3. *Update*: if the log-odds are above 0 the ball is found, and where it was looked for in vain is noted.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.fitting.validation import Rejection
from matchset.image.color import ColorModel
from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.network import Disc
from matchset.image.disc_network.patch_format import Circle3
from matchset.shapes.shape import Shape
from matchset.tracking.ball.belief import Belief
from matchset.tracking.ball.discs import middle_color, middle_pixels
from matchset.tracking.ball.judge import covariance_of, likeliest
from matchset.tracking.ball.log_odds import (
    ExpectedPlace,
    Features,
    log_odds,
    log_prior_of_place,
    log_prior_of_size,
)
from matchset.tracking.ball.places.changes import (
    Arrival,
    arrivals,
    changes_since,
    departures,
    reference_of,
    share_before,
)
from matchset.tracking.ball.precompile import precompile_ball
from matchset.tracking.ball.propose import BallSearch, arrived_at, propose
from matchset.tracking.ball.streak import Streak, streak_at
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.motion import Gate, gate_of, usual_size
from matchset.tracking.track import Acquisition
from matchset.tracking.track_step import TrackStep

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


class _Candidate(NamedTuple):
    """A disc with its log-odds of being the ball."""

    disc: Disc
    log_odds: float


class BallEstimator:
    """Believes something of a ball while it is seen, and finds it once it is not where it was expected.

    Parameters
    ----------
    step : TrackStep
    parameters : TrackerConstants

    Attributes
    ----------
    belief : Belief or None
        None before the ball was seen.
    """

    def __init__(self, step: TrackStep[Any], parameters: TrackerConstants) -> None:
        self._step = step
        self._parameters = parameters
        self.belief: Belief | None = None
        if step.outlines.is_disc and parameters.network.used:
            precompile_ball()

    def forget(self, color: ColorModel) -> None:
        """Reset to what the color was learned from.

        Parameters
        ----------
        color : ColorModel
        """
        self._step.outlines.network.know(color.sample)
        self.belief = None

    def knows(self) -> bool:
        """Whether this is a ball that was seen before: otherwise nothing can be found here."""
        return self.belief is not None and self._step.outlines.network.limits.used

    def is_due(self, time: float) -> bool:
        """Whether color and reference are older than they should be, at a time, s."""
        return self.belief is None or time - self.belief.time >= self._parameters.ball.renewed_s

    def note(self, image: Image, circle: Circle3, time: float, score: float) -> None:
        """Note a ball whose outline is seen.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        circle : (x, y, radius)
            Where it is, px.
        time : float
            Of the picture, s.
        score : float
            MSAC score of its fit.
        """
        limits, belief = self._parameters.ball, self.belief
        if not self._step.outlines.is_disc or (belief is not None and score < limits.least_score):
            return
        pixels = middle_pixels(image, circle, limits.middle)
        if not len(pixels):
            return
        pixel = np.median(pixels.astype(np.float32), axis=0)
        lab = np.median(lab_of(pixels[:, np.newaxis, :]).reshape(-1, 3), axis=0).astype(np.float64)
        reference = reference_of(image, circle, time, limits.changes) if limits.moves else None
        if belief is None:
            self.belief = Belief(circle, (math.log(circle[2]), time), lab, pixel, time, reference=reference)
            return
        renewed = limits.renewed if belief.way == 0.0 else 1.0  # the color of a streak is mixed
        share = renewed if score > limits.sure_score else 0.0
        self.belief = belief._replace(
            circle=circle,
            lab=belief.lab + share * (lab - belief.lab),
            pixel=belief.pixel + np.float32(share) * (pixel - belief.pixel),
            time=time,
            reference=reference,
            way=0.0 if share > 0.0 else belief.way,
        )

    def relight(self, gains: Floats) -> None:
        """Believe the same of the ball in another light.

        Parameters
        ----------
        gains : ndarray of shape (channels,), float64
            By which the channels of all pixels were multiplied.
        """
        self._step.outlines.network.relight(gains)
        if self.belief is None:
            return
        pixel = np.clip(self.belief.pixel * gains, 0.0, 255.0).astype(np.float32)
        lab = lab_of(np.rint(pixel).astype(np.uint8).reshape(1, 1, -1)).reshape(3).astype(np.float64)
        reference = self.belief.reference
        if reference is not None:
            lit = np.clip(np.rint(reference.picture * gains), 0.0, 255.0).astype(np.uint8)
            reference = reference._replace(picture=lit)
        self.belief = self.belief._replace(pixel=pixel, lab=lab, reference=reference)

    def find(
        self, image: Image, color: ColorModel, last: Gate, expected: Gate | None, when: tuple[float, float]
    ) -> bool:
        """Find the ball, and leave the workspace as its fit made it; whether it was found.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        last : Gate
            Where the ball was seen last.
        expected : Gate or None
            Where it should be, if it was seen lately.
        when : (float, float)
            Time of the picture and since the one before, s.
        """
        belief, limits = self.belief, self._parameters.ball
        assert belief is not None
        size = self._size(belief, last.half_width, when)
        self.belief = belief = belief._replace(circle=last[:3], size=size, searched=belief.searched + 1)
        search = self._search(image, color, expected or last, when, is_expected=expected is not None)
        starts, proposed = propose(belief, search, self._parameters)
        network = self._step.outlines.network
        network.discs(image, [np.array(each) for each in starts], searched=True)
        discs = self._with_arrivals(search, network.seen(image))
        candidates = self._measure(belief, search, discs)
        best = max(candidates, key=lambda each: each.log_odds, default=None)
        found = best is not None and self._take(search, best, when[0], expected)
        vain = [
            (x, y, belief.searched)
            for x, y, radius in dict.fromkeys(proposed)
            if all(math.dist((x, y), disc.circle[:2]) > radius for disc in discs)
        ]
        kept = [each for each in belief.in_vain if belief.searched - each[2] <= limits.again]
        self.belief = belief._replace(in_vain=(*kept, *vain))
        return found

    def _size(self, belief: Belief, radius: float, when: tuple[float, float]) -> tuple[float, float]:
        """Size that is believed: it follows the last outline, but no faster than a ball grows."""
        last_seen = float(self._step.fitter.work.motion.time)
        if self._step.without_outline or not last_seen > belief.size[1]:
            return belief.size
        most = self._parameters.ball.grows * max((last_seen - belief.size[1]) / when[1], 1.0)
        change = math.log(radius) - belief.size[0]
        return belief.size[0] + min(max(change, -most), most), last_seen

    def _search(
        self, image: Image, color: ColorModel, place: Gate, when: tuple[float, float], *, is_expected: bool
    ) -> BallSearch:
        """See what has moved, and say where the ball is expected."""
        belief, limits, motion = self.belief, self._parameters.ball, self._step.fitter.work.motion
        assert belief is not None
        radius = math.exp(belief.size[0])
        expected = ExpectedPlace(
            x=place.x,
            y=place.y,
            radius=radius,
            missed=self._step.missed(*when),
            unsized=max((when[0] - belief.size[1]) / when[1], 1.0),
            speed=float(motion.speed) * when[1],
            innovation=float(motion.innovation),
            sightings=int(motion.size_count),
            way=belief.way,
        )
        changes, arrived, is_told = None, list[Arrival](), False
        if belief.reference is not None:
            changes = changes_since(image, belief.reference, limits.changes)
        if changes is not None:
            mass = expected.mass_radius()
            arrived = arrivals(changes, belief.pixel, mass, limits.changes)
            is_told = is_expected or not departures(changes, belief.pixel, mass, limits.changes)
            if not self._parameters.search.whole_frame:
                reach = limits.reach * expected.missed * radius
                arrived = [each for each in arrived if math.dist(each[:2], (place.x, place.y)) < reach]
        return BallSearch(image, color, expected, is_expected, when[1], changes, arrived, is_told)

    def _with_arrivals(self, search: BallSearch, discs: list[Disc]) -> list[Disc]:
        """Discs of the network, and where a fast ball is due what has arrived and is no disc to the network."""
        limits, expected = self._parameters.ball, search.expected
        found = list(discs)
        for each in search.arrived[: limits.starts] if self._is_fast(expected) else ():
            taken = any(self._explains(disc, each) for disc in discs)
            if not taken and abs(math.log(each.radius / expected.mass_radius())) < math.log(limits.unseen_growth):
                precision = np.eye(3) / (limits.mass_sigma * expected.radius) ** 2
                found.append(Disc((each.x, each.y, expected.radius), precision, limits.unseen))
        return found

    def _explains(self, disc: Disc, arrival: Arrival) -> bool:
        """Whether what has arrived is a disc of the network, or its blur and shadow beside a disc that is sure."""
        beside = arrival.radius if disc.log_odds > self._parameters.ball.seen else 0.0
        return math.dist(arrival[:2], disc.circle[:2]) < disc.circle[2] + beside

    def _is_fast(self, expected: ExpectedPlace) -> bool:
        """Whether a streak may be due, of which the network knows nothing."""
        limits = self._parameters.ball
        return max(expected.speed, expected.way) > limits.streak * expected.radius

    def is_look_alike(self, image: Image, color: ColorModel, state: Floats, time: float) -> bool:
        """Say whether what is followed stood there while the ball was elsewhere; as often as the color is renewed.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        state : ndarray of shape (>= 3,), float64
            What is followed, px.
        time : float
            Of the picture, s.
        """
        belief, limits = self.belief, self._parameters.ball
        if belief is None or belief.reference is None or not self.is_due(time):
            return False
        if not self._step.outlines.judges(color):
            return False
        x, y, radius = state[:3].tolist()
        circle = x, y, radius
        if math.dist(circle[:2], belief.reference.circle[:2]) < limits.changes.own * circle[2]:
            return False
        changes = changes_since(image, belief.reference, limits.changes)
        if changes is None:
            return False
        return share_before(changes, (color, belief.pixel), circle, limits.changes, moved=False) > limits.before

    def _measure(self, belief: Belief, search: BallSearch, discs: Sequence[Disc]) -> list[_Candidate]:
        """Features and log-odds of each disc that can be the ball."""
        found = list[_Candidate]()
        for disc in discs:
            features = self._features(belief, search, disc)
            if features is not None:
                found.append(_Candidate(disc, log_odds(features, self._parameters.ball.weights)))
        return found

    def _features(self, belief: Belief, search: BallSearch, disc: Disc) -> Features | None:
        """Features of a disc; None where it is far too large or small, or of quite another color."""
        limits, expected = self._parameters.ball, search.expected
        growth = abs(math.log(disc.circle[2] / expected.radius))
        seen = middle_color(search.image, search.color, disc.circle, limits.middle)
        if growth > math.log(limits.most_growth) or seen is None:
            return None
        away = (seen[0] - belief.lab).tolist()
        known = seen[1] > limits.color_share
        light, chroma = abs(away[0]), math.hypot(*away[1:])
        if not known and chroma > limits.other_chroma:
            return None
        color = -0.5 * min(chroma / limits.chroma, limits.most_chroma) ** 2
        place = log_prior_of_place(disc.circle[:2], expected, limits.place)
        fast = self._is_fast(expected) or expected.sightings <= 1
        may_arrive = fast or place > limits.due or disc.log_odds > limits.seen
        arrived = arrived_at(search, disc.circle, limits) if may_arrive else 0.0
        before = 0.0
        if search.changes is not None:
            far = math.dist(disc.circle[:2], expected[:2]) > disc.circle[2]
            before = share_before(search.changes, (search.color, belief.pixel), disc.circle, limits.changes, moved=far)
        unseen = limits.unseen if arrived > 0.0 and fast else -math.inf
        return Features(
            network=max(disc.log_odds, unseen),
            color=max(color, limits.mixed_color) if arrived > 0.0 else color,
            foreign=float(
                not known and not arrived > 0.0 and (chroma > limits.far_chroma or light > limits.far_lightness)
            ),
            place=place,
            size=log_prior_of_size(disc.circle[2], expected, limits.size),
            arrived=0.0 if before > limits.before else arrived,
            before=float(before > limits.before),
        )

    def _take(self, search: BallSearch, best: _Candidate, time: float, expected: Gate | None) -> bool:
        """Take the likeliest disc, or the fit to the edge points around it, if its log-odds are enough."""
        step, weights = self._step, self._parameters.ball.weights
        if best.log_odds + weights.edges <= 0.0:
            return False
        disc = step.outlines.refined(search.image, best.disc)
        near = expected is not None and math.dist(disc.circle[:2], expected[:2]) < max(disc.circle[2], expected[2])
        size = usual_size(step.fitter.work, (time, search.interval)) if near else None
        if size is not None:
            disc = step.outlines.network.of_size(disc, size)
        begins = expected is None
        if self._fits(search.image, search.color, disc):
            step.take_fit(time, begins)
            step.acquired = Acquisition(time, best.log_odds + weights.edges)
            return True
        if best.log_odds <= 0.0:
            return False
        step.take_disc(search.image, search.color, Gate(*disc.circle), covariance_of(disc), (time, begins))
        step.acquired = Acquisition(time, best.log_odds)
        return True

    def _fits(self, image: Image, color: ColorModel, disc: Disc) -> bool:
        """Fit the edge points around a disc, as far out of shape as a lens may draw it; whether they confirm it."""
        if not self._step.outlines.fit_lost(image, color, disc):
            return False
        self._step.with_modes(image, color, self._step.fitter.estimate(Rejection.NONE), 0.0)
        return True

    def begin(self, image: Image, color: ColorModel, clicked: Shape, time: float) -> bool:
        """Begin with a disc that the network sees at the click, or with a streak; whether there is one.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        clicked : Shape
            Circle around the click.
        time : float
            Of the picture, s.
        """
        step, network = self._step, self._step.outlines.network
        if not step.outlines.is_disc or color.sample is None:
            return False
        circle = gate_of(step.fitter.family, clicked.state)[:3]
        streak = streak_at(image, color, circle, self._parameters.ball.streaks)
        if streak is not None:
            self._begin_streak(image, color, streak, time)
            return True
        disc = likeliest(network.discs(image, [clicked.state]), network.limits.sure, network.limits.same)
        if disc is None:
            return False
        refined = step.outlines.refined(image, disc)
        if self._fits(image, color, refined):
            step.take_fit(time, begins=True)
        else:
            step.take_disc(image, color, Gate(*refined.circle), covariance_of(refined), (time, True))
        step.acquired = Acquisition(time, disc.log_odds)
        self.note(image, refined.circle, time, 1.0)
        return True

    def _begin_streak(self, image: Image, color: ColorModel, streak: Streak, time: float) -> None:
        """Begin with the ball whose streak was clicked."""
        spread = (self._parameters.ball.mass_sigma * streak.circle[2]) ** 2 * np.eye(3)
        self._step.take_disc(image, color, Gate(*streak.circle), spread, (time, True))
        self._step.acquired = Acquisition(time, 0.0)
        self.note(image, streak.circle, time, 1.0)
        if self.belief is not None:
            self.belief = self.belief._replace(way=streak.way)
