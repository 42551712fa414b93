"""Detection: from the whole frame to shapes, best first (Epstein & Feldman, Alg. 2)."""

import itertools
import math
from collections.abc import Iterator
from typing import Any, Generic, NamedTuple, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.validation import Prior
from matchset.fitting.workspace import SearchWindow
from matchset.image.brightness import BrightnessParameters
from matchset.image.color import ColorModel
from matchset.shapes.shape import Shape, finds_itself, from_hull, slopes
from matchset.tracking.outlines.hypotheses import Hypotheses, HypothesisParameters
from matchset.tracking.search.voting import Searcher
from matchset.tracking.track import Acquisition, Track

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
DETECTION_LINES = 64  # format: lines across the outline of a detected shape


class DetectionParameters(msgspec.Struct, frozen=True):
    """How the candidates of a search are fitted.

    All numbers chosen by hand; `python -m benchmarks --only reacquisition` would show a change.

    Parameters
    ----------
    min_score : float
        MSAC score below which a candidate is given up at once: less finds more and takes longer.
    speed : float
        Speed that a shape may have at first sight, px per frame: the fields of an interlaced picture may lie apart.
    range_cells, range_share : float
        Search range around a candidate: at least so many cells of the grid, or a share of its half-width.
    refit_range, mode_range : float
        Search range of the fits after the first one, px.
    same_distance, same_shrink, same_growth : float
        Two shapes are the same within this distance, in half-widths, if their sizes differ by a factor between these.
    near, agreed, sure : float
        Weights of the step in color near the outline and of the MSAC score in the rank of a fit beside its log-odds,
        and the rank from which no other fit of a candidate is tried.
    hopeless : float
        Log-odds below which a candidate that is not expected here is not fitted again.
    color_rounds, color_range, color_share, color_sigma : float
        How often a candidate is fitted again where the target's color ends; the search range there, at least px or a
        share of its half-width; and how far edge points are expected, px.
    smaller : float
        How much smaller than at the click a shape may be for a search of small cells, as a factor.
    blob_size, blob_msac : float
        Least half-width of a fit at a blob, as a share of that at the click, and its MSAC score: less finds specks.
    hint_bonus : float
        Merit that a shape gains by holding the point that was given; the merit itself is 1 at most.
    """

    min_score: float = 0.25
    speed: float = 8.0
    range_cells: float = 2.0
    range_share: float = 0.2
    refit_range: float = 4.0
    mode_range: float = 5.0
    same_distance: float = 0.5
    same_shrink: float = 0.6
    same_growth: float = 1.7
    near: float = 6.0
    agreed: float = 4.0
    sure: float = 14.5
    hopeless: float = -3.0
    color_rounds: int = 2
    color_range: float = 2.0
    color_share: float = 0.06
    color_sigma: float = 1.0
    smaller: float = 0.5
    blob_size: float = 0.85
    blob_msac: float = 0.6
    hint_bonus: float = 2.0


class FitStart(NamedTuple):
    """Where the fit of a candidate begins: center, half-width, px, state, and the least half-width that counts."""

    x: float
    y: float
    half_width: float
    state: Floats
    least: float = 0.0


class Detector(Generic[S]):
    """Detection of one family in pictures of one size: candidates, fitted and validated.

    Parameters
    ----------
    fitter : Fitter
        Fits the candidates.
    searcher : Searcher
        Proposes them.
    limits : DetectionParameters, optional
    hypotheses : HypothesisParameters, optional
    brightness : BrightnessParameters, optional
    """

    def __init__(
        self,
        fitter: Fitter[S],
        searcher: Searcher,
        limits: DetectionParameters | None = None,
        hypotheses: HypothesisParameters | None = None,
        brightness: BrightnessParameters | None = None,
    ) -> None:
        self.fitter, self.searcher = fitter, searcher
        self.limits = limits or DetectionParameters()
        self._brightness = brightness or BrightnessParameters()
        self._hypotheses = Hypotheses(fitter, hypotheses or HypothesisParameters())

    def detections(
        self, image: Image, color: ColorModel, prior: Prior = Prior.NONE, first: S | None = None
    ) -> Iterator[tuple[Estimate, float]]:
        """Yield the validated shapes of a picture, likeliest first, with their merit.

        While one is looked at, the fitter's workspace holds its match-set.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        prior : Prior
            What is known of them before.
        first : Shape, optional
            Where one may be, looked at first.
        """
        known: list[FitStart] = []
        given = [] if first is None else [[_start_at(self.fitter.family, first.state)]]
        for starts in itertools.chain(given, self._starts(image, color), self._blobs(image, color, known, prior)):
            asked = Prior.HERE if prior is Prior.CLICKED and starts not in given else prior
            best, merit = self._best(image, color, starts, (known, asked))
            if best is None:
                continue
            place, alone = _place_of(best), asked is Prior.CLICKED and self.fitter.validate_detection(best, Prior.HERE)
            if alone and not self._is_known(place, starts):
                continue
            if len(starts) > 1:
                best = self.fitter.weigh(
                    self.fitter.fit(image, color, best.state, SearchWindow(self.limits.refit_range)), image, color
                )
                if not self._is_whole(best, starts[0].least):
                    continue
            if starts not in given:  # a circle that a click showed does not keep a better one out
                known.append(place._replace(half_width=best.fit.half_width, state=best.state))
            yield best, merit

    def _best(
        self, image: Image, color: ColorModel, starts: list[FitStart], known: tuple[list[FitStart], Prior]
    ) -> tuple[Estimate | None, float]:
        """Best validated fit of a candidate, which may begin at several states, and its merit."""
        found, prior = known
        limits, best, most = self.limits, None, 0.0
        for start in starts:
            if self._is_known(start, found):
                continue
            reach = max(limits.range_cells * self.searcher.stride, limits.range_share * start.half_width)
            estimate = self.fitter.fit(image, color, start.state, SearchWindow(reach, min_score=limits.min_score))
            if not self._is_whole(estimate, start.least) or self._is_known(_place_of(estimate), found):
                continue
            valid = self._validated(image, color, estimate, start, prior)
            if valid is None or self._is_known(_place_of(valid), found):
                continue
            merit = self.fitter.validator.merit(valid.fit, valid.evidence)
            if best is None or merit > most:
                best, most = valid, merit
        return best, most

    def _starts(self, image: Image, color: ColorModel) -> Iterator[list[FitStart]]:
        """Where fits may begin: one or several for each candidate."""
        family = self.fitter.family
        for sought in color.search_models(image, self._brightness):
            if finds_itself(family):
                for hull in self.searcher.hulls(image, sought):
                    states = [shape.state for shape in from_hull(family, hull)]
                    yield [_start_at(family, state) for state in states]
                continue
            for x, y, radius, _ in self.searcher.candidates(image, sought).tolist():
                yield [FitStart(x, y, radius, family.from_coarse(x, y, radius).state)]

    def _blobs(self, image: Image, color: ColorModel, known: list[FitStart], prior: Prior) -> Iterator[list[FitStart]]:
        """Where fits may begin in a picture that is asked for, if nothing has an outline in the coarse grid."""
        family, least = self.fitter.family, self.limits.blob_size * self.searcher.radius / self.limits.smaller
        if known or prior is not Prior.ASKED or not self.fitter.weighs(color) or finds_itself(family):
            return
        for discs in self.searcher.blobs(image, color):
            yield [_start_at(family, family.from_coarse(x, y, r).state)._replace(least=least) for x, y, r, _ in discs]

    def _is_whole(self, estimate: Estimate, least: float) -> bool:
        """Whether this is a fit, and one that begins at a blob is large, clear and wholly in the picture."""
        fit, whole = estimate.fit, self.fitter.validator.limits.whole_visible * self.fitter.points
        clear = fit.half_width >= least and fit.visible >= whole and fit.msac_score >= self.limits.blob_msac
        return estimate.is_fitted and bool(not least or clear)

    def _is_known(self, place: FitStart, known: list[FitStart]) -> bool:
        """Whether this is one of the shapes detected already."""
        limits, size = self.limits, place.half_width
        return any(
            math.hypot(place.x - each.x, place.y - each.y) < limits.same_distance * min(size, each.half_width)
            and limits.same_shrink < size / each.half_width < limits.same_growth
            for each in known
        )

    def _validated(
        self, image: Image, color: ColorModel, estimate: Estimate, start: FitStart, prior: Prior
    ) -> Estimate | None:
        """Validate a fit and others of the same candidate: the likeliest, or the first where no evidence is weighed.

        None where all fail.
        """
        fitter = self.fitter
        if fitter.weighs(color):
            return self._likeliest(image, color, fitter.weigh(estimate, image, color), start, prior)
        for other in self._others(image, color, estimate, None):
            if other.is_fitted and not fitter.validate_detection(other, prior):
                return other
        return None

    def _likeliest(
        self, image: Image, color: ColorModel, estimate: Estimate, start: FitStart | None, prior: Prior
    ) -> Estimate | None:
        """Fit with most evidence, of those that are validated; once one is sure, no other is tried.

        The workspace is left as that fit made it.
        """
        fitter, limits, best, most = self.fitter, self.limits, None, -math.inf
        made = fitter.block
        if prior is Prior.NONE or (
            prior not in (Prior.HERE, Prior.CLICKED) and (estimate.evidence or 0.0) < limits.hopeless
        ):
            start = None
        for other in self._others(image, color, estimate, start):
            weighed = fitter.weigh(other, image, color)
            if not weighed.is_fitted or weighed.evidence is None or fitter.validate_detection(weighed, prior):
                continue
            rank = weighed.evidence + limits.agreed * weighed.fit.msac_score
            rank += limits.near * fitter.near_step(weighed, image, color)
            if best is None or rank > most:
                best, most, made = weighed, rank, fitter.block.copy()
            if rank > limits.sure:
                break
        fitter.block[:] = made
        return best

    def near_fits(self, image: Image, color: ColorModel, start: FitStart) -> Iterator[Estimate]:
        """Yield the fit that stays near where a candidate begins, and those where the target's color ends there.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        start : FitStart
        """
        fitter, limits = self.fitter, self.limits
        reach = max(limits.color_range, limits.color_share * start.half_width)
        narrow = SearchWindow(reach, initial_sigma=limits.color_sigma)
        near = fitter.fit(image, color, start.state, narrow)
        yield near
        for _ in range(limits.color_rounds):
            state = self._hypotheses.at_color_boundary(near, image, color)
            if state is None:
                return
            near = fitter.fit(image, color, state, narrow)
            yield near

    def _others(
        self, image: Image, color: ColorModel, estimate: Estimate, start: FitStart | None
    ) -> Iterator[Estimate]:
        """Yield the fit of a candidate, and others of it; from where it begins only if something speaks for it.

        One lets the two fields of an interlaced picture disagree, as they do where the shape moves; one begins with
        larger modes, as a lens may ask for.
        """
        fitter, limits = self.fitter, self.limits
        yield estimate
        if start is not None:
            yield from self.near_fits(image, color, start)
        moving = SearchWindow(limits.refit_range, limits.speed, velocity_unknown=True)
        moved = fitter.fit(image, color, estimate.state, moving)
        yield moved
        modes = self._hypotheses.with_modes(moved)
        if modes is not None:
            fitter.free_modes()
            yield fitter.fit(image, color, modes, SearchWindow(limits.mode_range))
            fitter.assume_noise(moved.fit)  # what was found in vain is not remembered


def _start_at(family: type[Any], state: Floats) -> FitStart:
    return FitStart(float(state[0]), float(state[1]), float(family.half_width(state)), state)


def _place_of(estimate: Estimate) -> FitStart:
    return FitStart(float(estimate.state[0]), float(estimate.state[1]), estimate.fit.half_width, estimate.state)


def track_of(
    fitter: Fitter[S],
    last: S | None,
    time: float,
    spread: Floats | None = None,
    acquired: Acquisition | None = None,
    pixel_aspect: float = 1.0,
) -> Track[S]:
    """Answer with the last fit of a fitter.

    Parameters
    ----------
    fitter : Fitter
    last : Shape or None
        The parameters describe the shape as this one is described: a square has four angles.
    time : float
        Of the frame, s.
    spread : ndarray of shape (p, p), float64, optional
        Covariance between the outlines that it may be: what the covariance of its edge points does not know of.
    acquired : Acquisition, optional
        When it was found.
    pixel_aspect : float
        Width of a pixel of the frame, in its heights.
    """
    support, covariance, points = fitter.answer()
    if spread is not None:
        covariance = covariance + spread
    shape = fitter.family.from_state(fitter.state, last)
    if fitter.moves_covariance and (by := slopes(shape)) is not None:
        covariance = by @ covariance @ by.T
    return Track(shape, covariance, support, points, time, acquired, fitter.field_offset, pixel_aspect)
