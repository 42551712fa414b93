"""Fits shapes of one family to pictures: `Fitter`, and `Estimate`, what it answers."""

import functools
import math
from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.evidence import BEST_STEP, EvidenceParameters, log_odds, measure_color_step, measure_near_step
from matchset.fitting.fit_quality import QualityParameters, tolerance_of, write_answer
from matchset.fitting.match_set import MatchParameters
from matchset.fitting.prior import FieldParameters, GateParameters, MotionParameters, WindowParameters
from matchset.fitting.robust_fit import FitParameters
from matchset.fitting.validation import Prior, Rejection, ValidationParameters, Validator, is_fitted
from matchset.fitting.workspace import (
    FEW_LINES,
    MAX_LINES,
    PLACE_COLUMNS,
    STATE,
    FitStatistics,
    SearchWindow,
    workspace_dtype,
)
from matchset.image.color import ColorModel
from matchset.image.frame import ROWS, Rows
from matchset.numeric.copies import Copied
from matchset.numeric.jit import compile_user_function, interpreted, kernel
from matchset.numeric.record import Block, Record, fields, new_block, store
from matchset.shapes.family_check import check_family
from matchset.shapes.shape import Shape, corners, places, slopes, steady

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]
S = TypeVar("S", bound=Shape)

# theorem: multiples of the golden ratio, modulo 1, are spread evenly (Weyl)
GOLDEN = 0.6180339887
MIN_SIDED_STATE, MAX_SIDED_STATE = 5, 8  # geometry: numbers of a state with which one side can move alone


class FittingParameters(msgspec.Struct, frozen=True):
    """Everything that decides a fit.

    Parameters
    ----------
    match : MatchParameters
        What makes an edge point.
    fit : FitParameters
        How a shape is fitted to edge points.
    quality : QualityParameters
        How a fit is measured.
    validation : ValidationParameters
        What confirms a shape.
    evidence : EvidenceParameters
        How much evidence a detection needs.
    motion : MotionParameters
        Constant-velocity motion, and how far its predictions are trusted.
    window : WindowParameters
        Search range while a shape is tracked.
    gate : GateParameters
        How far from its prediction a shape needs no other proof.
    fields : FieldParameters
        What is expected of the two fields of an interlaced picture.
    """

    match: MatchParameters = MatchParameters()
    fit: FitParameters = FitParameters()
    quality: QualityParameters = QualityParameters()
    validation: ValidationParameters = ValidationParameters()
    evidence: EvidenceParameters = EvidenceParameters()
    motion: MotionParameters = MotionParameters()
    window: WindowParameters = WindowParameters()
    gate: GateParameters = GateParameters()
    fields: FieldParameters = FieldParameters()


class Estimate(NamedTuple):
    """A fit.

    Attributes
    ----------
    state : ndarray of shape (s,), float64
        The state that was reached.
    fit : FitStatistics
        What it rests on.
    rejection : Rejection
        Why it is rejected as a track, `Rejection.NONE` if it is not.
    evidence : float or None
        Log-odds of being the target, once they were weighed, see `Fitter.weigh`.
    """

    state: Floats
    fit: FitStatistics
    rejection: Rejection
    evidence: float | None = None

    @property
    def is_fitted(self) -> bool:
        """Whether there were edge points to fit at all, whatever the fit is worth."""
        return is_fitted(self.rejection)


NOT_FOUND = Estimate(np.zeros(0), FitStatistics(*(0,) * len(FitStatistics._fields)), Rejection.NOT_FOUND)
"""Where there is nothing to fit."""


@functools.cache
def make_answer(layout: "np.dtype[np.void]") -> Callable[[Floats, Floats, Block], tuple[float, int]]:
    """Compile ``answer(points, covariance, block)``, see `write_answer`."""

    @kernel(refcount=False)
    def answer(points: Floats, covariance: Floats, block: Block) -> tuple[float, int]:
        return write_answer(block.view(layout)[0], points, covariance)

    return answer


class Fitter(Copied, Generic[S]):
    """Fits shapes of one family to pictures.

    Everything is compiled in the constructor's module on first use of a family; see `precompile`.

    Parameters
    ----------
    family : type
        The family of shapes, `Circle` for one.
    points : int
        Number of lines across the outline: the size of the match-set.
    make_step : callable
        Compiles what fits: ``make_step(trace, half_width, layout)``, see `tracking.compiled_step`.
    parameters : FittingParameters, optional
    uses_color : bool
        Whether a color tells the target from what is around it; otherwise edges alone count.

    Attributes
    ----------
    work : record
        The workspace: after a fit its tables hold what that was made of.
    block : ndarray, float64
        The same, as compiled code takes it.
    state : ndarray of shape (s,), float64
        The state in the workspace; the next fit overwrites it.
    outline, interior : ndarray of shape (n, 4 + s + 2) and (n,), float64
        The outline as it was traced last, and the share of the way to it where the inside is looked at.
    validator : Validator
        By the limits of the family.
    has_corners : bool
        Whether the family's shapes have corners.
    sides_move : bool
        Whether one of its sides can move without the others, as that of a rectangle can and that of a template cannot.
    """

    def __init__(
        self,
        family: type[S],
        points: int,
        make_step: Callable[..., Callable[[Image, Scores, Block, float, float], int]],
        parameters: FittingParameters | None = None,
        uses_color: bool = True,
    ) -> None:
        check_family(family)
        self.family, self.points, self.uses_color = family, points, uses_color
        self._rows: Rows = "all"
        self.parameters = parameters or FittingParameters()
        shape, where = family.from_coarse(0.0, 0.0, 1.0), places(family, points)
        self.has_corners = corners(shape) is not None
        self.sides_move = self.has_corners and MIN_SIDED_STATE <= len(shape.state) <= MAX_SIDED_STATE
        self.moves_covariance = slopes(shape) is not None
        lines = FEW_LINES if points <= FEW_LINES else MAX_LINES
        self.layout = workspace_dtype(lines, max(len(shape.state), STATE), max(where.shape[1], PLACE_COLUMNS))
        self.block = new_block(self.layout)
        self._hollow = False
        self.validator = Validator(self._limits(), points, self.parameters.evidence)
        self._fill(fields(self.block, self.layout), where, len(shape.state))
        self._answer_shape = (points, 2), (len(family.parameters),) * 2
        self._make_step = make_step
        self._make_derived()

    def _derive(self) -> None:
        points, family = self.points, self.family
        self.work: Record = fields(self.block, self.layout)
        self.state: Floats = self.work.state[: self.work.state_count]
        self.outline: Floats = self.work.outline[:points]
        self.interior: Floats = self.work.interior[:points]
        first = self.layout.fields["fit"][1] // 8 if self.layout.fields else 0
        self._statistics: Floats = self.block[first : first + len(FitStatistics._fields)]
        self._field_offset: Floats = self.work.field_offset.fitted
        compiled = compile_user_function(family.trace), compile_user_function(family.half_width)
        self._step = self._make_step(*compiled, self.layout)
        self._answer = make_answer(self.layout)

    def _limits(self) -> ValidationParameters:
        """Limits as they are for the family.

        Corners speak against round shapes only, and a printed mark has another color inside.
        """
        limits, changes = self.parameters.validation, dict[str, float]()
        if self._hollow:
            names = "min_interior", "detection_interior"
            changes = dict.fromkeys(names, limits.ring_interior) | {"most_interior": limits.ring_filled}
            changes |= dict.fromkeys(("min_core", "detection_core"), -math.inf)
            changes |= dict.fromkeys(("max_hollowness", "detection_rim"), math.inf)
        if self.has_corners:
            changes |= {"max_harmonic": math.inf, "max_hollowness": math.inf}
        if not self.sides_move or not self.uses_color:
            changes["ambiguous_color_score"] = -math.inf
        if not self.uses_color:
            changes["ambiguous_msac_score"] = limits.colorless_msac_score
        return msgspec.structs.replace(limits, **changes)

    def _fill(self, work: Record, where: Floats, state: int) -> None:
        """Write the parameters, and what tells the family's lines apart."""
        chosen, n = self.parameters, self.points
        work.line_count, work.place_columns = where.shape
        work.state_count, work.parameter_count = state, len(self.family.parameters)
        work.places[: where.size] = where.ravel()
        work.interior[:n] = chosen.quality.interior_radius * np.sqrt((np.arange(n) * GOLDEN) % 1.0)
        work.motion.slow_from = steady(self.family)
        store(work.match_limits, chosen.match)
        store(work.fit_limits, chosen.fit)
        store(work.quality_limits, chosen.quality)
        store(work.validation, self.validator.limits)
        store(work.motion_limits, chosen.motion)
        store(work.window_limits, chosen.window)
        store(work.gate, chosen.gate)
        store(work.field_limits, chosen.fields)
        if self.has_corners:
            work.fit_limits.start_noise = chosen.fit.sided_start_noise
        work.fit.pixel_noise = chosen.fit.initial_pixel_noise

    def take_rows(self, rows: Rows) -> None:
        """Take edge points from these rows of the pictures to come only, `Frame.rows`."""
        if rows != self._rows:
            self._rows, self.work.rows = rows, ROWS[rows]

    def fit(self, image: Image, color: ColorModel, start: Floats, window: SearchWindow) -> Estimate:
        """Fit the shape near a state.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        start : ndarray of shape (s,), float64
            Where to begin.
        window : SearchWindow
            How far around it to look.
        """
        self.state[:] = start
        sigma = window.initial_sigma or max(window.range_px / 3.0, 1.0)
        self.work["window"] = tuple(window._replace(initial_sigma=sigma))
        return self.estimate(self.refine(image, color))

    def refine(self, image: Image, color: ColorModel) -> int:
        """Fit the shape near the state in the workspace, by the window there; the `Rejection` as a track."""
        self._suit(color)
        return self._step(image, color.table, self.block, 0.0, 0.0)

    def _suit(self, color: ColorModel) -> None:
        """Ask less of the inside of a ring."""
        if color.is_hollow != self._hollow:
            self._hollow = color.is_hollow
            self.validator.limits = self._limits()
            store(self.work.validation, self.validator.limits)

    def track(self, image: Image, color: ColorModel, time: float, interval: float) -> int:
        """Fit the shape where its motion has it at a time, s, an interval after the last frame, and correct that.

        Returns the `Rejection`; where it is not `Rejection.NONE` the motion is as it was predicted.
        """
        self._suit(color)
        return self._step(image, color.table, self.block, time, interval)

    def estimate(self, rejection: int) -> Estimate:
        """Estimate in the workspace, which was rejected or not."""
        return Estimate(self.state.copy(), self.statistics, Rejection(rejection))

    def weighs(self, color: ColorModel) -> bool:
        """Whether the evidence of fits is weighed: not of shapes with corners, of rings, nor where brightness tells.

        Parameters
        ----------
        color : ColorModel
            Of the target.
        """
        return not (self.has_corners or color.gray or color.is_hollow)

    def weigh(self, estimate: Estimate, image: Image, color: ColorModel) -> Estimate:
        """Estimate of the last fit with its evidence, if that is weighed.

        Where even the best step in color would not be enough, none is measured.
        """
        if not self.weighs(color):
            return estimate
        fit, limits = estimate.fit, self.parameters.evidence
        tolerance = _tolerance_of(self.parameters.quality, fit.half_width)
        best = log_odds(fit, BEST_STEP, tolerance, limits)
        if best < min(limits.here, limits.clicked):
            return estimate._replace(evidence=best)
        step = measure_color_step(image, color, self.outline, fit.half_width, limits)
        return estimate._replace(evidence=log_odds(fit, step, tolerance, limits))

    def near_step(self, estimate: Estimate, image: Image, color: ColorModel) -> float:
        """Step in color near the outline of the last fit, 0 ... 1, see `measure_near_step`."""
        return measure_near_step(image, color, self.outline, estimate.fit.half_width, self.parameters.evidence)

    def validate_detection(self, estimate: Estimate, prior: Prior = Prior.PRESENT) -> Rejection:
        """Say why a shape that a search found is rejected, see `Validator.validate_detection`."""
        return self.validator.validate_detection(estimate.fit, prior, estimate.evidence)

    @property
    def statistics(self) -> FitStatistics:
        """What the last fit rests on."""
        return FitStatistics._make(self._statistics.tolist())

    def answer(self) -> tuple[float, Floats, Floats]:
        """Support, covariance of the state's first numbers and match-set of the last fit."""
        points, covariance = np.empty(self._answer_shape[0]), np.empty(self._answer_shape[1])
        support, count = self._answer(points, covariance, self.block)
        return support, covariance, points if count == self.points else points[:count]

    @property
    def field_offset(self) -> tuple[float, float]:
        """From where the odd rows showed the shape to where the even rows did, in the last fit, px."""
        x, y = self._field_offset.tolist()  # a view that is kept: to read names of a record takes 10 us
        return x, y

    def assume_noise(self, fit: FitStatistics) -> None:
        """Begin the next fit with the noise of an earlier one."""
        self.work.fit.edge_noise, self.work.fit.pixel_noise = fit.edge_noise, fit.pixel_noise

    def free_modes(self) -> None:
        """Let the next fit move the modes as far as edge points ask: the noise of a fit that failed holds them."""
        self.work.fit.edge_noise = 0.0

    def forget(self) -> None:
        """Forget what was learned from earlier pictures."""
        self.work["fit"] = (0.0,) * len(FitStatistics._fields)
        self.work.fit.pixel_noise = self.parameters.fit.initial_pixel_noise


_tolerance_of = interpreted(tolerance_of)
