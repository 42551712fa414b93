"""The step from one frame to the next: `TrackStep` (Epstein & Feldman, Alg. 3), and `precompile`, which compiles it.

Predict, open the search window, fit (trace, match-set, robust fit, until the shape stands still), validate, gate,
correct: where all goes well that is one compiled call (`compiled_step`). Where the fit is rejected or ambiguous, others
are tried.
"""

import functools
import math
from typing import Any, Generic, TypeVar

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.validation import Prior, Rejection
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.light.color_adaptation import AdaptationParameters, adapt_table, adaptation_block
from matchset.numeric.copies import Copied
from matchset.numeric.jit import collection_paused, interpreted
from matchset.shapes.described import box_of
from matchset.shapes.shape import Shape, finds_itself, outline
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.initialization import noise_in
from matchset.tracking.motion import Gate, gate_of, in_gate, initialize, make_accept
from matchset.tracking.outlines.hypotheses import Hypotheses
from matchset.tracking.outlines.outline_choice import OutlineChoice
from matchset.tracking.search.voting import Searcher
from matchset.tracking.track import Acquisition

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

SIZED = 3  # theorem: center and half-width are all that a family of three parameters has
PICTURE = 64  # format: size of a small picture, px
CENTER, HALF_WIDTH = 31.5, 20.0  # geometry: of the shape in it, px


class TrackStep(Copied, Generic[S]):
    """Tracks a shape into the next frame.

    Parameters
    ----------
    fitter : Fitter
    parameters : TrackerConstants

    Attributes
    ----------
    faint : int
        For how many frames the shape has been seen faintly.
    outlines : OutlineChoice
        Chooses an outline where a fit is ambiguous or a detection.
    given : bool
        Whether the shape was given by somebody and no picture has confirmed it yet.
    without_outline : bool
        Whether the last sighting was a disc by its color or its looks, whose outline nothing confirmed.
    acquired : Acquisition or None
        When the shape was found last; None if somebody said where it is.
    """

    def __init__(self, fitter: Fitter[S], parameters: TrackerConstants) -> None:
        self.fitter, self.parameters, self.faint, self.given = fitter, parameters, 0, False
        self.without_outline = False
        self.acquired: Acquisition | None = None
        self._hypotheses = Hypotheses(fitter, parameters.hypotheses)
        self.outlines = OutlineChoice(fitter, parameters)
        self._crowded = False

    @property
    def crowded(self) -> bool:
        """Whether others like the shape are next to it.

        Then the network of discs is not asked, which knows single balls; nor are other outlines of a disc tried, which
        take in a part of the others.
        """
        return self._crowded

    @crowded.setter
    def crowded(self, crowded: bool) -> None:
        self._crowded = crowded
        network = self.outlines.network
        asks = self.parameters.network.used and not crowded
        if network.limits.used != asks:
            network.limits = msgspec.structs.replace(network.limits, used=asks)

    @property
    def fields(self) -> tuple[float, float]:
        """What is known of the time between the fields of a camera's pictures; another tracker of it may be told."""
        return float(self.fitter.work.motion.offset_moment), float(self.fitter.work.motion.speed_moment)

    @fields.setter
    def fields(self, known: tuple[float, float]) -> None:
        self.fitter.work.motion.offset_moment, self.fitter.work.motion.speed_moment = known

    def hold_size(self, half_width: float, sigma: float) -> None:
        """Expect a half-width, px, in the next frame, give or take a share of it, whatever the last outlines were.

        Only of a shape whose state is its center and its half-width.
        """
        if len(self.fitter.family.parameters) != SIZED:
            return
        motion = self.fitter.work.motion
        motion.last_state[SIZED - 1] = half_width
        motion.velocity[SIZED - 1] = 0.0
        motion.innovation_scale[SIZED - 1] = min(motion.innovation_scale[SIZED - 1], sigma * half_width)

    def forget(self) -> None:
        """Be as a step is that has seen nothing."""
        self.faint, self.given, self.without_outline = 0, False, False
        self.outlines.spread = None
        self.acquired = None
        self.crowded = False
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
        fitter, self.outlines.spread = self.fitter, None
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

    def note_acquired(self, image: Image, color: ColorModel, time: float) -> None:
        """Note the last fit, of a shape that was not seen in the frame before, as found at a time, s."""
        weighed = self.fitter.weigh(self.fitter.estimate(Rejection.NONE), image, color)
        self.acquired = Acquisition(time, weighed.evidence)

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
        if self.outlines.judges(color):
            return self._reacquire_ball(image, color, estimate, when[:2])
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
            among_discs = self.crowded and self.outlines.is_disc
            gain = limits.hypotheses.mode_gain
            stretched = None if among_discs else self.with_modes(image, color, estimate, speed, gain)
            if stretched is not None:
                estimate = stretched
            else:
                chosen = None if among_discs else self._test_hypotheses(image, color, estimate, speed)
                estimate = chosen or self._unless_faint(estimate, image, color)
        rejection = estimate.rejection or self._confidence_lost(estimate, image, color)
        if not rejection:
            rejection = self._outside_gate(self.fitter.weigh(estimate, image, color), predicted, missed)
        return estimate._replace(rejection=rejection)

    def _reacquire_ball(
        self, image: Image, color: ColorModel, estimate: Estimate, when: tuple[float, float]
    ) -> Estimate:
        """Decide about an ambiguous fit of a ball that the network of discs judges.

        Larger modes are tried first, then the network's disc as the prior of the fit. A fit that stays needs color at
        its rim or the evidence of a detection, and evidence at all if it is far from where it was expected.
        """
        if estimate.rejection != Rejection.AMBIGUOUS:
            return estimate
        motion, limits, fitter = self.fitter.work.motion, self.parameters.confidence, self.fitter
        estimate = estimate._replace(rejection=Rejection.NONE)
        predicted, innovation = motion.predicted[:2].tolist(), float(motion.innovation)
        speed = when[1] * float(motion.speed)
        streak = speed > self.parameters.ball.streak * estimate.fit.half_width
        seen_once = self.without_outline and float(motion.size_count) <= 1.0  # and may move at any speed
        if seen_once or (streak and not self.outlines.is_interlaced()):  # each of two fields has a short shutter
            return estimate._replace(rejection=Rejection.LOW_COLOR_SCORE)
        gain = self.parameters.hypotheses.mode_gain
        chosen = self.with_modes(image, color, estimate, speed, gain)
        chosen = chosen or self.outlines.choose(image, color, estimate, when, speed)
        if chosen is not None:
            return chosen
        weighed = fitter.weigh(estimate, image, color)
        rejection = fitter.validate_detection(weighed, Prior.HERE)
        if weighed.fit.color_score < limits.faint_score and rejection:
            return estimate._replace(rejection=rejection)
        away = math.dist(estimate.state[:2].tolist(), predicted)
        near = limits.near * estimate.fit.half_width + limits.near_innovations * innovation
        if away > near and (weighed.evidence or 0.0) < 0.0:
            return estimate._replace(rejection=Rejection.UNREACHABLE)
        return estimate

    def _unless_faint(self, estimate: Estimate, image: Image, color: ColorModel) -> Estimate:
        """Demand of a fit that is seen faintly, where the network sees no ball, what a detection needs."""
        if estimate.rejection or estimate.fit.color_score >= self.parameters.confidence.faint_score:
            return estimate
        weighed = self.fitter.weigh(estimate, image, color)
        return estimate._replace(rejection=self.fitter.validate_detection(weighed, Prior.HERE))

    def _outside_gate(self, estimate: Estimate, predicted: Floats, missed: float) -> Rejection:
        """Why a fit far from its prediction is rejected, `Rejection.NONE` where it is near or has other proof."""
        here, there = gate_of(self.fitter.family, predicted), gate_of(self.fitter.family, estimate.state)
        if interpreted(in_gate)(self.fitter.work, there.half_width, here.half_width):
            return Rejection.NONE
        alone = here.alone(there, self.parameters.reach)
        rejection = self.fitter.validate_detection(estimate, Prior.NONE if alone else Prior.PRESENT)
        if not here.reachable(there, missed, self.parameters.reach):
            return rejection or Rejection.UNREACHABLE
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

    def with_modes(
        self, image: Image, color: ColorModel, estimate: Estimate, speed: float, gain: float = 0.0
    ) -> Estimate | None:
        """Fit with larger modes, as a lens may ask for; None, and the workspace as it was, where that is no better.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        estimate : Estimate
            The last fit.
        speed : float
            Of the shape, px per frame.
        gain : float
            How much better its color score must be.
        """
        limits, fitter, made = self.parameters.hypotheses, self.fitter, self.fitter.block.copy()
        with_modes = self._hypotheses.with_modes(estimate)
        if with_modes is None:
            return None
        fitter.free_modes()
        stretched = fitter.fit(image, color, with_modes, SearchWindow(limits.range_px, speed))
        least = max(estimate.fit.color_score + gain, limits.mode_score)
        if not stretched.rejection and stretched.fit.color_score > least:
            return stretched
        fitter.block[:] = made
        return None

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

    def take_fit(self, time: float, begins: bool) -> None:
        """Take the last fit for the lost target, at a time, s; `begins`: nowhere near where it was expected."""
        if begins:
            fitter, share = self.fitter, self.parameters.initialization.detected_share
            state = fitter.state.copy()
            initialize(fitter.work, state, time, share * float(fitter.family.half_width(state)))
        self.accept(time)

    def take_disc(self, image: Image, color: ColorModel, disc: Gate, spread: Floats, when: tuple[float, bool]) -> None:
        """Take a disc that no edges confirm for the target.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        disc : Gate
        spread : ndarray of shape (3, 3), float64
            Covariance of its center and half-width, px^2.
        when : (float, bool)
            Time, s, and whether it is nowhere near where the target was expected.
        """
        time, begins = when
        fitter, p, sigma = self.fitter, len(self.fitter.family.parameters), math.sqrt(float(np.diag(spread).mean()))
        state = fitter.family.from_coarse(disc.x, disc.y, disc.half_width).state
        fitter.fit(image, color, state, SearchWindow(sigma))  # edge points near it
        covariance = fitter.work.covariance
        fitter.state[:], covariance[:], fitter.work.fit.msac_score = state, sigma**2 * np.eye(*covariance.shape), 0.0
        if begins:
            initialize(fitter.work, state, time, self.parameters.initialization.detected_share * disc.half_width)
        self.accept(time)
        covariance[:], self.outlines.spread, self.without_outline = 0.0, spread[:p, :p].copy(), True

    def accept(self, time: float) -> None:
        """Correct the motion with the last fit, which was accepted at a time, s."""
        self.given, self.without_outline = False, False
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
