"""Validation: what a fit must show before anyone is told of it, for a shape that is tracked and for one just detected.

The rules are plain functions of `FitStatistics` and `ValidationParameters`: compiled with the fit, and called by
`Validator` in Python with the same fields.
"""

import enum
import math
from typing import Any

import msgspec
import numpy as np

from matchset.fitting.evidence import EvidenceParameters
from matchset.numeric.jit import helper, interpreted

Statistics = Any  # `FitStatistics`, or the record of the same fields


class Rejection(enum.IntEnum):
    """Why a fit is not believed; `NONE`, which is 0, where it is.

    Attributes
    ----------
    NONE
        The fit is confirmed.
    OUT_OF_VIEW
        Most of the shape is outside the picture.
    TOO_FEW_INLIERS
        Too little of the outline is confirmed.
    WRONG_SHAPE
        The edge points follow an outline of another shape.
    WRONG_INTERIOR
        The inside does not have the target's color.
    NO_EDGES
        There was nothing to fit.
    LEFT_VIEW
        There was nothing to fit, since the shape has left the picture.
    AMBIGUOUS
        Other hypotheses should be tested first.
    LOW_COLOR_SCORE
        A detection shows too little evidence.
    UNREACHABLE
        It would have jumped or changed its size faster than it can.
    FADED
        Its color score has been low for too long.
    NOT_FOUND
        A search found nothing.
    """

    NONE = 0
    OUT_OF_VIEW = 1
    TOO_FEW_INLIERS = 2
    WRONG_SHAPE = 3
    WRONG_INTERIOR = 4
    NO_EDGES = 5
    LEFT_VIEW = 6
    AMBIGUOUS = 7
    LOW_COLOR_SCORE = 8
    UNREACHABLE = 9
    FADED = 10
    NOT_FOUND = 11


class Prior(enum.Enum):
    """What is known of a shape before it is detected.

    Attributes
    ----------
    NONE
        Nothing: there may be none in the picture.
    PRESENT
        It is in the picture: somebody clicked at it, or it was tracked until now.
    HERE
        It is expected about here.
    ASKED
        Nothing, but somebody asks for this one picture.
    CLICKED
        Somebody clicked at it in this very picture, and this is the circle that was found around the click.
    """

    NONE, PRESENT, HERE, ASKED, CLICKED = range(5)


class ValidationParameters(msgspec.Struct, frozen=True):
    """What confirms a shape.

    `ambiguous_msac_score`, `color_score`, `small_color_score`, `tiny_color_score`, `expected_factor`,
    `detection_interior`, `detection_core`, `detection_rim`, `round_harmonic`, `harmonic_penalty`, `hidden_penalty` and
    `hint_leeway`: fitted again by `make hypotheses`; no other value was better by 1 % on both sets of seeds
    (docs/log/fitting.md#hypothesis-weights).
    The others are chosen by hand; `python -m benchmarks --only false_locks` (too much is believed) and `--only
    reacquisition` (too little) would show a change.

    Parameters
    ----------
    min_support : float
        Least share of the visible outline that must be inliers while tracking.
    min_msac_score : float
        Least MSAC score while tracking.
    color_score, small_color_score, tiny_color_score : float
        Least color score of a detection, which no motion speaks for: for half-widths from `large_half_width` on, at
        `small_half_width`, and up to `tiny_half_width`. Chance makes small shapes easily.
    large_half_width, small_half_width, tiny_half_width : float
        Those half-widths, px.
    expected_factor : float
        Factor on that score for a shape that is expected about here.
    min_interior, detection_interior : float
        Least share of the inside that must have the target's color, for a track and for a detection: a marker, a
        highlight and things in front of it do not.
    min_core, detection_core : float
        The same for the middle alone, which a ring does not fill.
    ring_interior, ring_filled : float
        The same of all of the inside of a ring, whose middle has another color; and the largest: the dot in its middle
        is no ring.
    most_interior : float
        Largest share of the inside with the target's color; a fitter of rings lowers it.
    min_visible : float
        Least share of the outline that must be in the picture.
    left_visible : float
        Share of the outline in the picture below which a shape without edges has left it.
    whole_visible : float
        Share of the outline in the picture from which a shape counts as whole.
    max_autocorrelation, max_harmonic, max_ellipticity, max_hollowness : float
        Largest correlation of neighboring residuals, harmonic score of a corner, modes in half-widths (0.1 is an
        ellipse of axis ratio 1.22) and emptiness of the middle: above them it is another shape.
    track_leeway, hint_leeway : float
        Factor on these four while motion speaks for the shape, or almost all of its outline; and where somebody said
        that it is there.
    certain_color_score : float
        Color score from which neighboring residuals may err together, as on an ellipse, and a lens may bend it.
    round_harmonic : float
        Harmonic score that noise and a stick leave on a disc, in standard deviations.
    harmonic_penalty : float
        By how much more color score is asked of a detection that nothing else speaks for, per unit of harmonic score
        beyond that: less finds a half-covered ball sooner, more keeps a card from passing for one.
    hidden_penalty : float
        By how much more color score is asked of a detection per share of the outline outside the picture: at the border
        a card may pass for a ball that leaves.
    detection_rim : float
        By how much emptier than the middle the inside near the outline may be, of a detection that nothing else speaks
        for: a card before a foreign ring fills the middle and not the rim.
    ambiguous_msac_score, ambiguous_color_score : float
        MSAC score below which other hypotheses are tested, and color score below which they are for a shape whose sides
        move alone: one of them may lie on another edge while the others look well. More costs time, less finds it late.
    colorless_msac_score : float
        The MSAC score below which other hypotheses are tested where no color tells the target.
    ambiguous_half_width, ambiguous_visible : float
        Half-width, px, and visible share from which on there are other hypotheses to test.
    """

    min_support: float = 0.42
    min_msac_score: float = 0.25
    color_score: float = 0.5
    small_color_score: float = 0.7
    tiny_color_score: float = 0.8
    large_half_width: float = 24.0
    small_half_width: float = 12.0
    tiny_half_width: float = 8.0
    expected_factor: float = 0.8
    min_interior: float = 0.4
    detection_interior: float = 0.5
    min_core: float = 0.12
    detection_core: float = 0.25
    ring_interior: float = 0.15
    ring_filled: float = 0.8
    most_interior: float = 1.0
    min_visible: float = 0.3
    left_visible: float = 0.3
    whole_visible: float = 0.9
    max_autocorrelation: float = 0.5
    max_harmonic: float = 4.0
    max_ellipticity: float = 0.1
    max_hollowness: float = 0.28
    track_leeway: float = 1.5
    hint_leeway: float = 1.25
    certain_color_score: float = 0.85
    round_harmonic: float = 1.5
    harmonic_penalty: float = 0.06
    hidden_penalty: float = 0.5
    detection_rim: float = 0.5
    ambiguous_msac_score: float = 0.7
    ambiguous_color_score: float = 0.92
    colorless_msac_score: float = 0.85
    ambiguous_half_width: float = 6.0
    ambiguous_visible: float = 0.5


Limits = Any  # `ValidationParameters`, or the record of the same fields


@helper
def is_wrong_shape(fit: Statistics, limits: Limits, leeway: float) -> bool:
    """Whether the edge points follow an outline, but not one of this family; `leeway` is a factor on the limits."""
    is_certain = fit.color_score >= limits.certain_color_score
    bent = max(leeway, limits.track_leeway) if is_certain else leeway  # a lens may bend a ball's outline
    return bool(
        (fit.residual_autocorrelation > limits.max_autocorrelation * leeway and not is_certain)
        or fit.harmonic_score > limits.max_harmonic * bent
        or fit.ellipticity > limits.max_ellipticity * bent
        or fit.hollowness > limits.max_hollowness * leeway
    )


@helper
def validate_track(fit: Statistics, limits: Limits, lines: int) -> int:
    """Why a fit of the shape that is tracked is rejected, a `Rejection`; of how many lines it was."""
    if fit.visible < limits.min_visible * lines:
        return Rejection.OUT_OF_VIEW.value
    if fit.inliers < limits.min_support * fit.visible:
        return Rejection.TOO_FEW_INLIERS.value
    if fit.msac_score < limits.min_msac_score or is_wrong_shape(fit, limits, limits.track_leeway):
        return Rejection.WRONG_SHAPE.value
    if fit.interior_share < limits.min_interior or fit.core_share < limits.min_core:
        return Rejection.WRONG_INTERIOR.value
    if fit.interior_share > limits.most_interior:
        return Rejection.WRONG_INTERIOR.value
    return Rejection.NONE.value


@helper
def rejection_without_fit(fit: Statistics, limits: Limits, lines: int) -> int:
    """Why there was nothing to fit, a `Rejection`."""
    return Rejection.LEFT_VIEW.value if fit.visible < limits.left_visible * lines else Rejection.NO_EDGES.value


@helper
def is_weak(fit: Statistics, limits: Limits) -> bool:
    """Whether the edge points hardly agree, or too few have the color's step."""
    weak = fit.msac_score < limits.ambiguous_msac_score or fit.color_score < limits.ambiguous_color_score
    return bool(weak and fit.edge_noise > 0.0)


def is_fitted(rejection: int) -> bool:
    """Whether there were edge points to fit at all, whatever the fit is worth."""
    return rejection not in (Rejection.NO_EDGES, Rejection.LEFT_VIEW)


class Validator:
    """Validates fits and says in words why one is rejected.

    Parameters
    ----------
    limits : ValidationParameters
        As they are for the family: the same that the compiled rules read.
    lines : int
        Lines across the outline.
    evidence : EvidenceParameters, optional
        How much of it a detection needs.
    """

    def __init__(self, limits: ValidationParameters, lines: int, evidence: EvidenceParameters | None = None) -> None:
        self.limits, self.lines, self.evidence = limits, lines, evidence or EvidenceParameters()

    def validate_detection(
        self, fit: Statistics, prior: Prior = Prior.PRESENT, evidence: float | None = None
    ) -> Rejection:
        """Say why a shape that a search found is rejected.

        A shape that is expected about here needs less evidence than one that may be anywhere; one that nothing else
        speaks for needs more, the more corners it has. So does one of which only a part is in the picture.

        Parameters
        ----------
        fit : FitStatistics
        prior : Prior
            What is known of the shape before.
        evidence : float, optional
            Log-odds of being the target, if they were weighed; otherwise the color score decides. For a shape that may
            be anywhere either is enough, the color score with `EvidenceParameters.clear` beside it: two strict rules
            find more than one that is less strict.
        """
        if evidence is not None:
            weighed = self._validate_weighed(fit, prior, evidence)
            if prior is not Prior.NONE or not weighed or evidence < self.evidence.clear:
                return weighed
        limits, unknown = self.limits, prior in (Prior.NONE, Prior.ASKED)
        if fit.visible < limits.min_visible * self.lines:
            return Rejection.OUT_OF_VIEW
        if fit.color_score < self._least_color_score(fit, prior):
            return Rejection.LOW_COLOR_SCORE
        unfilled = unknown and fit.hollowness < -limits.detection_rim
        leeway = self._leeway_of(prior)
        if unfilled or _is_wrong_shape(fit, limits, leeway):
            return Rejection.WRONG_SHAPE
        if fit.interior_share < limits.detection_interior or fit.core_share < limits.detection_core:
            return Rejection.WRONG_INTERIOR
        return Rejection.WRONG_INTERIOR if fit.interior_share > limits.most_interior else Rejection.NONE

    def _leeway_of(self, prior: Prior) -> float:
        """Factor on the limits of a shape: more for one that was there, or is said to be."""
        return self.limits.hint_leeway if prior is Prior.PRESENT else 1.0

    def _validate_weighed(self, fit: Statistics, prior: Prior, evidence: float) -> Rejection:
        """Say why a detection is rejected of which the evidence was weighed."""
        limits, asked = self.limits, self.evidence
        if fit.visible < limits.min_visible * self.lines:
            return Rejection.OUT_OF_VIEW
        hidden = max(limits.whole_visible - fit.visible / self.lines, 0.0)
        least = {
            Prior.NONE: asked.unknown,
            Prior.PRESENT: asked.present,
            Prior.HERE: asked.here,
            Prior.ASKED: asked.asked,
            Prior.CLICKED: asked.clicked,
        }[prior]
        least_msac = {Prior.NONE: asked.unknown_msac, Prior.ASKED: asked.asked_msac}.get(prior, 0.0)
        if evidence < least + asked.hidden * hidden:
            return Rejection.LOW_COLOR_SCORE
        if fit.msac_score < least_msac:
            return Rejection.WRONG_SHAPE
        leeway = self._leeway_of(prior)
        if fit.ellipticity > limits.max_ellipticity * leeway or fit.hollowness > limits.max_hollowness * leeway:
            return Rejection.WRONG_SHAPE
        if fit.interior_share < limits.detection_interior or fit.core_share < limits.detection_core:
            return Rejection.WRONG_INTERIOR
        return Rejection.NONE

    def _least_color_score(self, fit: Statistics, prior: Prior) -> float:
        """Color score that a detection must have."""
        limits, visible = self.limits, fit.visible / self.lines
        whole = fit.visible >= limits.whole_visible * self.lines
        factor = limits.expected_factor if prior is Prior.HERE and whole else 1.0
        penalty = limits.hidden_penalty * max(limits.whole_visible - visible, 0.0)
        if prior in (Prior.NONE, Prior.ASKED) and limits.max_harmonic < math.inf:
            penalty += limits.harmonic_penalty * max(fit.harmonic_score - limits.round_harmonic, 0.0)
        sizes = limits.tiny_half_width, limits.small_half_width, limits.large_half_width
        scores = limits.tiny_color_score, limits.small_color_score, limits.color_score
        return float(factor * np.interp(fit.half_width, sizes, scores) + penalty)

    def is_ambiguous(self, fit: Statistics) -> bool:
        """Whether other hypotheses should be tested: a weak fit of a shape that is large, and seen, enough for it."""
        limits = self.limits
        large = fit.visible > limits.ambiguous_visible * self.lines and fit.half_width > limits.ambiguous_half_width
        return bool(large and _is_weak(fit, limits))

    def merit(self, fit: Statistics, evidence: float | None = None) -> float:
        """Rank of a confirmed shape among others, 0 ... 1.

        Its probability, if its evidence was weighed; otherwise color score of the visible outline times share of the
        inside.
        """
        if evidence is not None:
            return 1.0 / (1.0 + math.exp(-evidence))
        return float(fit.color_score * fit.visible / self.lines * fit.interior_share)

    def describe(self, rejection: Rejection, fit: Statistics) -> str:
        """Say in words a user understands why a fit is rejected; empty where it is not.

        Parameters
        ----------
        rejection : Rejection
        fit : FitStatistics
            Of that fit.
        """
        inliers, interior = 100.0 * fit.inliers / max(fit.visible, 1.0), 100.0 * max(fit.interior_share, 0.0)
        return {
            Rejection.OUT_OF_VIEW: "most of it is outside the picture",
            Rejection.TOO_FEW_INLIERS: f"only {inliers:.0f} % of the outline is confirmed",
            Rejection.WRONG_SHAPE: "its outline has another shape",
            Rejection.WRONG_INTERIOR: f"only {interior:.0f} % of the inside has the target's color",
            Rejection.NO_EDGES: "no edges of the target's color where it should be",
            Rejection.LEFT_VIEW: "it left the picture",
            Rejection.LOW_COLOR_SCORE: f"only {100.0 * fit.color_score:.0f} % of the outline speaks for it",
            Rejection.UNREACHABLE: "it would have jumped or changed its size faster than it can",
            Rejection.FADED: "hardly anything has spoken for it for a while",
            Rejection.NOT_FOUND: "nothing of this color and shape is in the picture",
        }.get(rejection, "")


_is_wrong_shape = interpreted(is_wrong_shape)
_is_weak = interpreted(is_weak)
