"""Every limit of the validation, one by one: a fit just within it is believed, one just beyond it is not."""

import math

import pytest
from msgspec.structs import replace

from matchset.fitting import validation
from matchset.fitting.evidence import EvidenceParameters
from matchset.fitting.validation import (
    Prior,
    Rejection,
    ValidationParameters,
    Validator,
    is_fitted,
    rejection_without_fit,
    validate_track,
)
from matchset.fitting.workspace import FitStatistics
from matchset.numeric.jit import interpreted

LINES = 64
LIMITS = ValidationParameters()
EVIDENCE = EvidenceParameters()
GOOD = FitStatistics(
    edge_noise=0.3,
    pixel_noise=2.0,
    visible=LINES,
    inliers=60.0,
    msac_score=0.84,
    color_score=0.84,
    residual_autocorrelation=0.0,
    harmonic_score=0.0,
    interior_share=1.0,
    core_share=1.0,
    hollowness=0.0,
    half_width=40.0,
    ellipticity=0.0,
)
SURE = GOOD._replace(color_score=0.95, msac_score=0.95)
VALIDATOR = Validator(LIMITS, LINES)


@pytest.fixture(autouse=True)
def _plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(validation, "is_wrong_shape", interpreted(validation.is_wrong_shape))


def tracked(fit: FitStatistics) -> Rejection:
    return Rejection(interpreted(validate_track)(fit, LIMITS, LINES))


def detected(fit: FitStatistics, prior: Prior = Prior.PRESENT, evidence: float | None = None) -> Rejection:
    return VALIDATOR.validate_detection(fit, prior, evidence)


@pytest.mark.parametrize(
    ("name", "limit", "sign", "rejection"),
    [
        ("visible", LIMITS.min_visible * LINES, -1, Rejection.OUT_OF_VIEW),
        ("inliers", LIMITS.min_support * LINES, -1, Rejection.TOO_FEW_INLIERS),
        ("msac_score", LIMITS.min_msac_score, -1, Rejection.WRONG_SHAPE),
        ("residual_autocorrelation", LIMITS.max_autocorrelation * LIMITS.track_leeway, 1, Rejection.WRONG_SHAPE),
        ("harmonic_score", LIMITS.max_harmonic * LIMITS.track_leeway, 1, Rejection.WRONG_SHAPE),
        ("ellipticity", LIMITS.max_ellipticity * LIMITS.track_leeway, 1, Rejection.WRONG_SHAPE),
        ("hollowness", LIMITS.max_hollowness * LIMITS.track_leeway, 1, Rejection.WRONG_SHAPE),
        ("interior_share", LIMITS.min_interior, -1, Rejection.WRONG_INTERIOR),
        ("core_share", LIMITS.min_core, -1, Rejection.WRONG_INTERIOR),
    ],
)
def test_a_track_is_believed_up_to_each_limit(name: str, limit: float, sign: int, rejection: Rejection) -> None:
    assert tracked(GOOD._replace(**{name: limit - 1e-6 * sign})) is Rejection.NONE
    assert tracked(GOOD._replace(**{name: limit + 1e-6 * sign})) is rejection


def test_few_inliers_of_a_shape_of_which_little_is_visible_are_enough() -> None:
    half = GOOD._replace(visible=32.0, inliers=LIMITS.min_support * 32.0 + 0.1)
    assert tracked(half) is Rejection.NONE


@pytest.mark.parametrize(
    ("name", "limit", "sign", "rejection"),
    [
        ("visible", LIMITS.min_visible * LINES, -1, Rejection.OUT_OF_VIEW),
        ("color_score", LIMITS.color_score, -1, Rejection.LOW_COLOR_SCORE),
        ("residual_autocorrelation", LIMITS.max_autocorrelation * LIMITS.hint_leeway, 1, Rejection.WRONG_SHAPE),
        ("harmonic_score", LIMITS.max_harmonic * LIMITS.hint_leeway, 1, Rejection.WRONG_SHAPE),
        ("ellipticity", LIMITS.max_ellipticity * LIMITS.hint_leeway, 1, Rejection.WRONG_SHAPE),
        ("hollowness", LIMITS.max_hollowness * LIMITS.hint_leeway, 1, Rejection.WRONG_SHAPE),
        ("interior_share", LIMITS.detection_interior, -1, Rejection.WRONG_INTERIOR),
        ("core_share", LIMITS.detection_core, -1, Rejection.WRONG_INTERIOR),
    ],
)
def test_a_detection_is_believed_up_to_each_limit(name: str, limit: float, sign: int, rejection: Rejection) -> None:
    good = GOOD._replace(visible=LINES)
    assert detected(good._replace(**{name: limit - 1e-6 * sign})) is Rejection.NONE
    assert detected(good._replace(**{name: limit + 1e-6 * sign})) is rejection


def test_a_certain_color_forgives_a_bent_outline_and_no_more() -> None:
    bent = SURE._replace(residual_autocorrelation=0.99)
    assert tracked(bent) is detected(bent) is Rejection.NONE
    for name, limit in (("harmonic_score", LIMITS.max_harmonic), ("ellipticity", LIMITS.max_ellipticity)):
        just = 1.4 * limit
        assert detected(SURE._replace(**{name: just})) is Rejection.NONE
        assert detected(GOOD._replace(**{name: just})) is Rejection.WRONG_SHAPE
    hollow = SURE._replace(hollowness=1.4 * LIMITS.max_hollowness)
    assert detected(hollow) is Rejection.WRONG_SHAPE


def test_an_outline_without_a_filled_rim_is_no_thing_that_nobody_told_of() -> None:
    rimless = GOOD._replace(hollowness=-LIMITS.detection_rim - 0.01)
    for prior in Prior:
        unknown = prior in (Prior.NONE, Prior.ASKED)
        assert detected(rimless, prior) is (Rejection.WRONG_SHAPE if unknown else Rejection.NONE), prior


@pytest.mark.parametrize(
    ("half_width", "least"),
    [
        (1.0, LIMITS.tiny_color_score),
        (LIMITS.tiny_half_width, LIMITS.tiny_color_score),
        (LIMITS.small_half_width, LIMITS.small_color_score),
        (LIMITS.large_half_width, LIMITS.color_score),
        (500.0, LIMITS.color_score),
    ],
)
def test_the_smaller_the_more_color(half_width: float, least: float) -> None:
    fit = GOOD._replace(half_width=half_width)
    assert detected(fit._replace(color_score=least + 1e-6)) is Rejection.NONE
    assert detected(fit._replace(color_score=least - 1e-6)) is Rejection.LOW_COLOR_SCORE


def test_what_changes_the_color_that_a_detection_needs() -> None:
    def least(fit: FitStatistics, prior: Prior) -> float:
        low, high = 0.0, 2.0
        for _ in range(50):
            middle = 0.5 * (low + high)
            refused = detected(fit._replace(color_score=middle), prior) is Rejection.LOW_COLOR_SCORE
            low, high = (middle, high) if refused else (low, middle)
        return low

    assert least(GOOD, Prior.HERE) == pytest.approx(LIMITS.expected_factor * LIMITS.color_score)
    part = GOOD._replace(visible=0.5 * LINES)
    penalty = LIMITS.hidden_penalty * (LIMITS.whole_visible - 0.5)
    assert least(part, Prior.HERE) == pytest.approx(LIMITS.color_score + penalty)
    assert least(part, Prior.PRESENT) == pytest.approx(LIMITS.color_score + penalty)
    assert least(GOOD, Prior.PRESENT) == pytest.approx(LIMITS.color_score)
    for harmonic in (0.0, LIMITS.round_harmonic, 3.0):
        corners = LIMITS.harmonic_penalty * max(harmonic - LIMITS.round_harmonic, 0.0)
        square = GOOD._replace(harmonic_score=harmonic)
        assert least(square, Prior.NONE) == pytest.approx(LIMITS.color_score + corners)
        assert least(square, Prior.PRESENT) == pytest.approx(LIMITS.color_score)
    free = Validator(replace(LIMITS, max_harmonic=math.inf), LINES)
    assert free.validate_detection(GOOD._replace(harmonic_score=9.0), Prior.NONE) is Rejection.NONE


def test_weighed_evidence_decides_and_more_is_needed_where_less_is_known() -> None:
    needed = {
        Prior.NONE: EVIDENCE.unknown,
        Prior.ASKED: EVIDENCE.asked,
        Prior.PRESENT: EVIDENCE.present,
        Prior.HERE: EVIDENCE.here,
        Prior.CLICKED: EVIDENCE.clicked,
    }
    dull = GOOD._replace(color_score=0.0)
    for prior, least in needed.items():
        assert detected(dull, prior, least + 1e-6) is Rejection.NONE, prior
        assert detected(dull, prior, least - 1e-6) is Rejection.LOW_COLOR_SCORE, prior
        part = dull._replace(visible=0.5 * LINES)
        more = least + EVIDENCE.hidden * (LIMITS.whole_visible - 0.5)
        assert detected(part, prior, more + 1e-6) is Rejection.NONE
        assert detected(part, prior, more - 1e-6) is Rejection.LOW_COLOR_SCORE


def test_weighed_evidence_does_not_excuse_another_shape_or_an_empty_inside() -> None:
    for name, value, rejection in (
        ("visible", LIMITS.min_visible * LINES - 1.0, Rejection.OUT_OF_VIEW),
        ("ellipticity", LIMITS.max_ellipticity * LIMITS.hint_leeway + 1e-6, Rejection.WRONG_SHAPE),
        ("hollowness", LIMITS.max_hollowness * LIMITS.hint_leeway + 1e-6, Rejection.WRONG_SHAPE),
        ("interior_share", LIMITS.detection_interior - 1e-6, Rejection.WRONG_INTERIOR),
        ("core_share", LIMITS.detection_core - 1e-6, Rejection.WRONG_INTERIOR),
    ):
        assert detected(GOOD._replace(**{name: value}), Prior.PRESENT, 50.0) is rejection, name
    loose = GOOD._replace(msac_score=EVIDENCE.unknown_msac - 1e-6, color_score=0.0)
    assert detected(loose, Prior.NONE, 50.0) is not Rejection.NONE
    assert detected(loose, Prior.PRESENT, 50.0) is Rejection.NONE


def test_where_nothing_is_known_either_of_two_strict_rules_is_enough() -> None:
    between = 0.5 * (EVIDENCE.clear + EVIDENCE.unknown)
    assert detected(GOOD, Prior.NONE, between) is Rejection.NONE
    assert detected(GOOD._replace(color_score=0.1), Prior.NONE, between) is Rejection.LOW_COLOR_SCORE
    assert detected(GOOD, Prior.NONE, EVIDENCE.clear + 1e-6) is Rejection.NONE
    assert detected(GOOD, Prior.NONE, EVIDENCE.clear - 1e-6) is Rejection.LOW_COLOR_SCORE


def test_ambiguous_are_weak_fits_of_large_visible_shapes_that_were_fitted() -> None:
    weak = SURE._replace(msac_score=LIMITS.ambiguous_msac_score - 1e-6)
    for fit, expected in (
        (SURE, False),
        (weak, True),
        (SURE._replace(color_score=LIMITS.ambiguous_color_score - 1e-6), True),
        (weak._replace(edge_noise=0.0), False),
        (weak._replace(half_width=LIMITS.ambiguous_half_width), False),
        (weak._replace(visible=LIMITS.ambiguous_visible * LINES), False),
    ):
        assert VALIDATOR.is_ambiguous(fit) is expected


def test_without_edges_it_left_the_picture_or_there_are_none() -> None:
    for visible, expected in ((0.0, Rejection.LEFT_VIEW), (float(LINES), Rejection.NO_EDGES)):
        assert interpreted(rejection_without_fit)(GOOD._replace(visible=visible), LIMITS, LINES) == expected
    assert not is_fitted(Rejection.NO_EDGES)
    assert not is_fitted(Rejection.LEFT_VIEW)
    assert is_fitted(Rejection.WRONG_SHAPE)


def test_merit_is_a_probability_or_the_color_of_the_visible_outline_times_the_inside() -> None:
    assert VALIDATOR.merit(GOOD, 0.0) == 0.5
    assert VALIDATOR.merit(GOOD, 3.0) == pytest.approx(0.9526, abs=1e-4)
    part = GOOD._replace(visible=0.5 * LINES, interior_share=0.5)
    assert VALIDATOR.merit(part) == pytest.approx(0.84 * 0.25)
