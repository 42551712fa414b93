"""The step from one frame to the next: `TrackStep` (Epstein & Feldman, Alg. 3), and `precompile`, which compiles it.

Predict, open the search window, fit (trace, match-set, robust fit, until the shape stands still), validate, gate,
correct: where all goes well that is one compiled call (`compiled_step`). Where the fit is rejected or ambiguous, others
are tried.
"""

import functools
import math
from typing import Any, Generic, TypeVar

import cv2
import numpy as np
import numpy.typing as npt

from matchset.fitting.consensus import Consensus
from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.soft_region import SoftRegion, find_soft_region
from matchset.fitting.validation import Prior, Rejection
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.color_adaptation import AdaptationParameters, adapt_table, adaptation_block
from matchset.numeric.copies import Copied
from matchset.numeric.jit import collection_paused, interpreted
from matchset.numeric.record import Block
from matchset.shapes.described import box_of
from matchset.shapes.shape import Shape, finds_itself, outline
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.hypotheses import Hypotheses
from matchset.tracking.hypothesis_filter import HypothesisFilter
from matchset.tracking.initialization import noise_in
from matchset.tracking.motion import Gate, gate_of, in_gate, initialize, make_accept, usual_size
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.voting import Searcher

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

SAME_OFFSET = 1e-3  # theorem: share by which a field offset that is taken for half a frame's way differs: rounding
MAX_DISC_PARAMETERS = 3  # geometry: center and size
SAME_AWAY = 1e-3  # theorem: points of a circle of 20 px are equally far from its center, but for rounding, px
PICTURE = 64  # format: size of a small picture, px
CENTER, HALF_WIDTH = 31.5, 20.0  # geometry: of the shape in it, px


class TrackStep(Copied, Generic[S]):
    """Tracks a shape into the next frame.

    Parameters
    ----------
    fitter : Fitter
    parameters : TrackerParameters

    Attributes
    ----------
    faint : int
        For how many frames the shape has been seen faintly.
    given : bool
        Whether the shape was given by somebody and no picture has confirmed it yet.
    without_outline : bool
        Whether the last sighting was a disc by its color or its looks, whose outline nothing confirmed.
    """

    def __init__(self, fitter: Fitter[S], parameters: TrackerParameters) -> None:
        self.fitter, self.parameters, self.faint, self.given = fitter, parameters, 0, False
        self.spread: Floats | None = None
        self.without_outline = False
        self._spare: tuple[Block, Floats | None] | None = None
        self._hypotheses = Hypotheses(fitter, parameters.hypotheses)
        self._consensus = Consensus(len(fitter.family.parameters), parameters.consensus)
        self._filter = HypothesisFilter(parameters.hypothesis_filter)
        away = np.hypot(*outline(fitter.family.from_coarse(0.0, 0.0, HALF_WIDTH)).T)
        self.is_disc = len(fitter.family.parameters) <= MAX_DISC_PARAMETERS and bool(np.ptp(away) < SAME_AWAY)

    def forget(self) -> None:
        """Be as a step is that has seen nothing."""
        self.faint, self.spread, self._spare, self.given, self.without_outline = 0, None, None, False, False
        self._filter.forget()
        self._make_derived()

    def _derive(self) -> None:
        self._accept = make_accept(self.fitter.layout)

    def track(self, image: Image, color: ColorModel, time: float, interval: float, index: int) -> Estimate | None:
        """Track the shape into the frame (Alg. 3); the estimate that was rejected, None if one was accepted.

        Where the first fit is rejected, ambiguous or outside the gate, others are tried.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        time, interval : float
            Of the frame, s, and since the frame before.
        index : int
            Number of the frame.
        """
        fitter, self.spread, self._spare = self.fitter, None, None
        rejection = fitter.track(image, color, time, interval)
        if not rejection and not self.given:  # of an `IntEnum` that is faster than a comparison
            self.without_outline = False
            return None
        estimate = fitter.estimate(rejection)
        if rejection:
            estimate = self._reacquire(image, color, estimate, (time, interval, index))
        if self.given and not estimate.rejection:
            estimate = estimate._replace(rejection=self._chance_in_noise(estimate, image, color))
        if estimate.rejection:
            return estimate
        if rejection:
            self.accept(time)
        self.given = False
        return None

    def _chance_in_noise(self, estimate: Estimate, image: Image, color: ColorModel) -> Rejection:
        """Demand of a shape that was given what a detection needs, where noise alone has edge points anywhere."""
        box = box_of(self.fitter.family.from_state(estimate.state))
        if noise_in(image, box, self.parameters.initialization) <= self.parameters.confidence.noise:
            return Rejection.NONE
        return self.fitter.validate_detection(self.fitter.weigh(estimate, image, color), Prior.HERE)

    def _reacquire(
        self, image: Image, color: ColorModel, estimate: Estimate, when: tuple[float, float, int]
    ) -> Estimate:
        """Fit again where the first fit was not enough.

        In a wider window, if that was rejected; other hypotheses, if it is ambiguous; and with the evidence of a
        detection, if it is far from where it was expected.
        """
        limits, motion, (time, interval, index) = self.parameters, self.fitter.work.motion, when
        predicted = motion.predicted[: len(estimate.state)].copy()
        missed, speed = self.missed(time, interval), interval * float(motion.speed)
        innovation = float(motion.innovation)
        if estimate.rejection == Rejection.AMBIGUOUS:
            estimate = estimate._replace(rejection=Rejection.NONE)
        window = limits.window
        if estimate.rejection and window.min_range + window.innovations * innovation * missed < window.max_range:
            estimate = self.fitter.fit(image, color, predicted, SearchWindow(window.max_range, speed))
        period = limits.hypotheses.period if finds_itself(self.fitter.family) else 1
        may_test = bool(estimate.rejection) or index % period == 0
        if may_test and self.fitter.validator.is_ambiguous(estimate.fit):
            stretched = self._with_modes(image, color, estimate, speed)
            if stretched is not None:
                estimate = stretched
            elif self._draws_outlines(color):
                estimate = self._by_consensus(image, color, estimate, (time, interval), speed)
            else:
                estimate = self._test_hypotheses(image, color, estimate, speed)
        rejection = estimate.rejection or self._confidence_lost(estimate, image, color)
        if not rejection:
            rejection = self._outside_gate(self.fitter.weigh(estimate, image, color), predicted, missed)
        return estimate._replace(rejection=rejection)

    def _outside_gate(self, estimate: Estimate, predicted: Floats, missed: float) -> Rejection:
        """Why a fit far from its prediction is rejected, `Rejection.NONE` where it is near or has other proof."""
        here, there = gate_of(self.fitter.family, predicted), gate_of(self.fitter.family, estimate.state)
        if interpreted(in_gate)(self.fitter.work, there.half_width, here.half_width):
            return Rejection.NONE
        alone = here.alone(there, self.parameters.reach)
        rejection = self.fitter.validate_detection(estimate, Prior.NONE if alone else Prior.PRESENT)
        if not here.reachable(there, missed, self.parameters.reach):
            return rejection or Rejection.UNREACHABLE
        if (
            rejection
            and not (alone or self.given or self.without_outline)
            and not self.fitter.validate_detection(estimate, Prior.FOLLOWED)
        ):
            self._spare = self.fitter.block.copy(), self.spread
        return rejection

    def _confidence_lost(self, estimate: Estimate, image: Image, color: ColorModel) -> Rejection:
        """Give up a shape that is seen so faintly that chance explains it as well, or faintly for too long."""
        limits, fit = self.parameters.confidence, estimate.fit
        if fit.color_score < limits.faint_score:
            weighed = self.fitter.weigh(estimate, image, color)
            if weighed.evidence is None or weighed.evidence < self.parameters.evidence.faint:
                self.faint += 1
            if weighed.evidence is not None and fit.pixel_noise > limits.noise:  # chance has edge points, too
                rejection = self.fitter.validate_detection(weighed, Prior.HERE)
                if rejection:
                    return rejection
        elif fit.color_score > limits.clear_score:
            self.faint = 0
        return Rejection.FADED if self.faint > limits.faint_frames else Rejection.NONE

    def _draws_outlines(self, color: ColorModel) -> bool:
        """Whether outlines are drawn from edge points: not where those of two fields, known apart, would be mixed."""
        fitter, limits = self.fitter, self.parameters.consensus
        apart = math.hypot(*fitter.work.field_offset.expected.tolist())
        half = self.parameters.fields.frame_share * float(fitter.work.window.speed)
        mixed = apart > limits.max_field_offset_px and math.isclose(apart, half, rel_tol=SAME_OFFSET)
        return len(fitter.family.parameters) <= limits.most_parameters and fitter.weighs(color) and not mixed

    def _with_modes(self, image: Image, color: ColorModel, estimate: Estimate, speed: float) -> Estimate | None:
        """Fit with larger modes, as a lens may ask for; None, and the workspace as it was, where that is no better."""
        limits, fitter, made = self.parameters.hypotheses, self.fitter, self.fitter.block.copy()
        with_modes = self._hypotheses.with_modes(estimate)
        if with_modes is None:
            return None
        fitter.free_modes()
        stretched = fitter.fit(image, color, with_modes, SearchWindow(limits.range_px, speed))
        least = max(estimate.fit.color_score + limits.mode_gain, limits.mode_score)
        if not stretched.rejection and stretched.fit.color_score > least:
            return stretched
        fitter.block[:] = made
        return None

    def _by_consensus(
        self, image: Image, color: ColorModel, estimate: Estimate, frame: tuple[float, float], speed: float
    ) -> Estimate:
        """Fit the likeliest of the outlines that edge points around an ambiguous fit ask for.

        A fit that was rejected needs evidence of the outline; without it, it is as it was.
        """
        fitter, limits, p = self.fitter, self.parameters.hypothesis_filter, len(self.fitter.family.parameters)
        motion, step = fitter.work.motion, np.zeros(p)
        if float(fitter.work.iteration.moved) > 0.0:  # the outline was traced before the last step
            step = fitter.work.step[:p].copy()
        traced, predicted, last = estimate.state[:p] - step, motion.predicted[:p].copy(), motion.last_state.copy()
        if self._filter.time < float(motion.time):
            self._filter.begin(last[:2], float(fitter.family.half_width(last)), float(motion.time))
        size = estimate.fit.half_width
        region, worth = self._soft_region(image, estimate.state)
        given = np.array([step, predicted - traced, *([region[:p] - traced] if worth else [])])
        found = self._consensus.propose(image, color, fitter.outline, size, given)
        scores = found.scores.copy()
        if worth:
            found.scores[2] = max(float(scores[2]), 0.0) + worth
        places, ahead = (traced + found.steps)[:, :2], (predicted[:2] - last[:2], usual_size(fitter.work, frame))
        which = self._filter.choose(found, places, ahead, frame, preferred=not estimate.rejection)
        state, reach = estimate.state.copy(), max(limits.range_share * size, limits.min_range_px)
        state[:p] = traced + found.steps[which]
        fields = fitter.work.field_offset.fitted.copy()
        fitted = fitter.fit(image, color, state, SearchWindow(reach, initial_sigma=limits.sigma_share * reach))
        fitter.work.window.speed, fitter.work.field_offset.fitted[:] = speed, fields  # learned from the first fit
        rejection = fitted.rejection
        if not rejection and estimate.rejection:
            unseen = fitter.validate_detection(fitter.weigh(fitted, image, color), Prior.HERE)
            if unseen or scores[which] < limits.least_score:
                rejection = estimate.rejection
        self.spread = self._filter.spread(found.steps, which)
        if rejection:
            self._filter.forget()
            self.spread = None
        return fitted._replace(rejection=rejection)

    def _soft_region(self, image: Image, state: Floats) -> tuple[Floats, float]:
        """State of the region of a blurred target around a fit, and what it is worth; 0 where its rim is sharp."""
        limits, family = self.parameters.soft_region, self.fitter.family
        region = self._region(image, state)
        worth = region.worth(limits) if region else 0.0
        return (family.from_coarse(*region[:3], state).state, worth) if region and worth else (state, 0.0)

    def _region(self, image: Image, state: Floats) -> SoftRegion | None:
        if not self.is_disc:
            return None
        here = float(state[0]), float(state[1]), float(self.fitter.family.half_width(state))
        return find_soft_region(image, here, self.parameters.soft_region)

    def is_other_shape(self, image: Image, state: Floats) -> bool:
        """Say whether the region at a state is another shape than a disc, where that is seen and discs are tracked.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        state : ndarray of shape (s,), float64
        """
        region = self._region(image, state)
        return region is not None and region.is_other(self.parameters.soft_region)

    def on_soft_region(self, image: Image, color: ColorModel, estimate: Estimate, prior: Prior) -> Estimate:
        """Fit a detection anew from the region of a blurred target, if it is one and that is a detection too.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        estimate : Estimate
            The last fit, which was confirmed.
        prior : Prior
            What was known of it beforehand.
        """
        fitter, limits = self.fitter, self.parameters.hypothesis_filter
        if not self._draws_outlines(color):
            return estimate
        state, worth = self._soft_region(image, estimate.state)
        if worth <= self.parameters.soft_region.sure * self.parameters.soft_region.worth:
            return estimate
        made = fitter.block.copy()
        reach = max(limits.range_share * float(fitter.family.half_width(state)), limits.min_range_px)
        window = SearchWindow(reach, initial_sigma=limits.sigma_share * reach, velocity_unknown=True)
        fitted = fitter.weigh(fitter.fit(image, color, state, window), image, color)
        if fitter.validate_detection(fitted, prior):
            fitter.block[:] = made
            return estimate
        return fitted

    def _test_hypotheses(self, image: Image, color: ColorModel, estimate: Estimate, speed: float) -> Estimate:
        """Fit the hypotheses around an ambiguous fit; the best of all, fitted once more."""
        limits, fitter = self.parameters.hypotheses, self.fitter
        best, most = estimate.state, -math.inf
        if not estimate.rejection:
            most = self._hypotheses.score(estimate, image, color) + limits.better
        window = SearchWindow(limits.range_px, speed, limits.initial_sigma)
        for start in [*self._hypotheses.around(estimate, image, color)]:
            other = fitter.fit(image, color, start, window)
            if not other.rejection and (score := self._hypotheses.score(other, image, color)) > most:
                best, most = other.state, score
        return fitter.fit(image, color, best, SearchWindow(limits.final_range, speed, limits.final_sigma))

    def accept_spare(self, time: float) -> bool:
        """Accept the fit outside the gate that was refused at a time, s, if a little speaks for it; whether one was.

        For when a search found nothing: what it finds has more evidence.
        """
        if self._spare is None:
            return False
        self.fitter.block[:], self.spread = self._spare
        self.accept(time)
        return True

    def take_disc(self, image: Image, color: ColorModel, disc: Gate, sigma: float, when: tuple[float, bool]) -> bool:
        """Take a disc that no edges confirm for the target, unless it is seen to be another shape.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        disc : Gate
        sigma : float
            Standard deviation of its center and half-width, half-widths.
        when : (float, bool)
            Time, s, and whether it is nowhere near where the target was expected.
        """
        time, begins = when
        fitter, p = self.fitter, len(self.fitter.family.parameters)
        state = fitter.family.from_coarse(disc.x, disc.y, disc.half_width).state
        if self.is_other_shape(image, state):
            return False
        sigma *= disc.half_width
        fitter.fit(image, color, state, SearchWindow(sigma))  # edge points near it
        covariance = fitter.work.covariance
        fitter.state[:], covariance[:], fitter.work.fit.msac_score = state, sigma**2 * np.eye(*covariance.shape), 0.0
        if begins:
            initialize(fitter.work, state, time, self.parameters.initialization.detected_share * disc.half_width)
        self.accept(time)
        covariance[:], self.spread, self.without_outline = 0.0, sigma**2 * np.eye(p), True
        return True

    def accept(self, time: float) -> None:
        """Correct the motion with the last fit, which was accepted at a time, s."""
        self.given, self.without_outline, self._spare = False, False, None
        self._accept(self.fitter.block, time)

    def missed(self, time: float, interval: float) -> float:
        """How many frames have passed since the last sighting, at least 1."""
        return max((time - float(self.fitter.work.motion.time)) / interval, 1.0)


@functools.cache
@collection_paused()
def precompile(family: type[Any], points: int, cells: int, channels: int) -> None:
    """Run every kernel of a tracker once on a small picture of the shape, so that no frame waits for the compiler.

    Parameters
    ----------
    family : type
        The family of shapes.
    points : int
        Size of the match-set: the workspace of few lines is another than that of many.
    cells : int
        Size of the color table.
    channels : int
        Of the pictures to come.
    """
    color = ColorModel(np.linspace(-4.0, 4.0, cells, dtype=np.float32))
    shape = family.from_coarse(CENTER, CENTER, HALF_WIDTH)
    plain = np.zeros((PICTURE, PICTURE), np.uint8)
    cv2.fillConvexPoly(plain, np.rint(outline(shape)).astype(np.int32), 255)
    image = np.ascontiguousarray(np.repeat(plain[:, :, np.newaxis], channels, axis=2))
    fitter = tracking_fitter(family, points)
    estimate = fitter.fit(image, color, shape.state, SearchWindow(6.0))
    fitter.answer()
    family.half_width(estimate.state)  # Python asks for it too
    initialize(fitter.work, estimate.state, 0.0, 1.0)
    make_accept(fitter.layout)(fitter.block, 2.0)
    rows, shares, first = fitter.work.outline[:points], fitter.work.interior[:points], color.log_odds.copy()
    limits = adaptation_block(AdaptationParameters())
    adapt_table(image, color.log_odds, first, color.table, rows, shares, CENTER, CENTER, 0, limits)


@functools.cache
@collection_paused()
def precompile_search(family: type[Any], cells: int, channels: int) -> None:
    """Run every kernel of a search once; see `precompile`."""
    color = ColorModel(np.linspace(-4.0, 4.0, cells, dtype=np.float32))
    searcher, image = Searcher(PICTURE, PICTURE), np.zeros((PICTURE, PICTURE, channels), np.uint8)
    image[np.hypot(*(np.indices(image.shape[:2]) - CENTER)) < HALF_WIDTH] = 255
    searcher.hulls(image, color) if finds_itself(family) else searcher.candidates(image, color)
