"""How much a fit speaks for the target: steps in color, the color boundary and the log-odds, against slow twins."""

import math

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import matchset as ms
from kernels import Floats
from matchset.fitting.evidence import (
    BEST_STEP,
    NO_STEP,
    ColorStep,
    EvidenceParameters,
    find_color_boundary,
    log_odds,
    measure_color_step,
    measure_near_step,
)
from matchset.fitting.fit_quality import tolerance_of
from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.validation import Prior, Rejection, Validator
from matchset.fitting.workspace import FitStatistics, SearchWindow
from matchset.numeric.jit import interpreted
from matchset.shapes.shape import Shape
from matchset.tracking.compiled_step import tracking_fitter

Picture = npt.NDArray[np.uint8]
LIMITS = EvidenceParameters()
WIDTH, HEIGHT = 240, 180
X, Y, RADIUS = 118.3, 91.7, 40.0
BLUE, WALL = (200, 70, 30), (140, 140, 140)
GOOD = FitStatistics(0.1, 2.0, 64.0, 60.0, 0.9, 0.9, 0.1, 1.0, 0.98, 0.98, 0.0, 30.0, 0.0)


def picture(x: float = X, y: float = Y, radius: float = RADIUS, gray: bool = False) -> Picture:
    """A plain disc before a plain wall, as pictures reach a fitter: (h, w, channels)."""
    rows, columns = np.indices((HEIGHT, WIDTH))
    inside = np.hypot(columns - x, rows - y)[..., np.newaxis] <= radius
    values = ((60,), (170,)) if gray else (BLUE, WALL)
    return np.where(inside, *(np.array(value, np.uint8) for value in values)).astype(np.uint8)


def model(gray: bool = False) -> ms.ColorModel:
    if gray:
        return ms.ColorModel(np.where(np.arange(256) < 115, 4.0, -4.0).astype(np.float32))
    table = np.full((32, 32, 32), -4.0, np.float32)
    table[24:, :, :] = 4.0
    return ms.ColorModel(table.ravel())


def outline(x: float = X, y: float = Y, radius: float = RADIUS, lines: int = 64) -> Floats:
    """Points and outward normals of a circle."""
    angles = 2.0 * math.pi * np.arange(lines) / lines
    normals = np.column_stack((np.cos(angles), np.sin(angles)))
    return np.column_stack((np.array([x, y]) + radius * normals, normals))


def step_at(radius: float, x: float = X, y: float = Y, gray: bool = False) -> ColorStep:
    return measure_color_step(picture(gray=gray), model(gray), outline(x, y, radius), radius, LIMITS)


@pytest.mark.parametrize("gray", [False, True])
def test_the_color_step_of_a_plain_disc_is_whole(gray: bool) -> None:
    assert step_at(RADIUS, gray=gray) == BEST_STEP


@pytest.mark.parametrize("wrong", [0.4, 0.5, 0.65, 1.35, 1.5, 2.0])
def test_a_disc_of_another_size_has_less_of_a_step(wrong: float) -> None:
    assert step_at(wrong * RADIUS).step < 0.6
    assert (step_at(wrong * RADIUS).outside == 1.0) == (wrong < 1.0)  # the color goes on beyond a disc too small


def test_a_disc_aside_of_the_target_has_less_of_a_step() -> None:
    whole, aside, beside = (step_at(RADIUS, X + shift) for shift in (0.0, 15.0, 70.0))
    assert whole.step > aside.step > beside.step


@pytest.mark.parametrize("radius", [8.0, 15.0, 40.0, 70.0])
def test_the_near_step_ranks_the_right_radius_first(radius: float) -> None:
    image, color = picture(radius=radius), model()
    way = max(LIMITS.near_way * radius, LIMITS.min_near_px)

    def near(off: float) -> float:
        return measure_near_step(image, color, outline(radius=radius + off), radius, LIMITS)

    assert near(0.0) == 1.0
    for side in (-1.0, 1.0):
        steps = [near(side * share * way) for share in (1.0, 1.5, 2.0, 2.5, 3.0)]
        assert steps == sorted(steps, reverse=True)
        assert steps[2] < 0.8
        assert steps[-1] < 0.3
    assert max(near(-way), near(way)) > measure_near_step(image, color, outline(X + 2.0 * way), radius, LIMITS)


@settings(max_examples=50)
@given(
    radius=st.floats(8.0, 45.0),
    share=st.floats(-0.7, 0.7),
    x=st.floats(95.0, 140.0),
    y=st.floats(85.0, 93.0),
    gray=st.booleans(),
)
def test_the_color_boundary_is_found_to_a_pixel(radius: float, share: float, x: float, y: float, gray: bool) -> None:
    off = share * max(LIMITS.boundary * radius, LIMITS.min_boundary_px)
    lines = outline(x, y, radius + off)
    distances, seen = find_color_boundary(picture(x, y, radius, gray), model(gray), lines, radius, LIMITS)
    assert seen.all()
    spacing = 2.0 * max(LIMITS.boundary * radius, LIMITS.min_boundary_px) / (LIMITS.boundary_samples - 1)
    assert np.abs(distances + off).max() <= 0.75 + max(spacing, 1.0) / 2.0  # half a diagonal, half a sample
    assert abs(float(np.median(distances)) + off) < 1.0


def slow_boundary(image: Picture, color: ms.ColorModel, line: Floats, half_width: float) -> float | None:
    """Twin of `find_color_boundary` for one line: every split is tried."""
    span = max(LIMITS.boundary * half_width, LIMITS.min_boundary_px)
    count = min(max(2 * round(span) + 1, 9), LIMITS.boundary_samples)
    white = []
    for k in range(count):
        offset = -span + 2.0 * span * k / (count - 1)
        column, row = round(line[0] + offset * line[2]), round(line[1] + offset * line[3])
        if not (0 <= column < image.shape[1] and 0 <= row < image.shape[0]):
            return None
        white.append(int(color.scores(image[row, column]).item()))
    sums = [sum(white[:split]) - sum(white[split:]) for split in range(count + 1)]
    return -span + (sums.index(max(sums)) - 0.5) * 2.0 * span / (count - 1)


@settings(max_examples=40)
@given(
    seed=st.integers(0, 1000),
    x=st.floats(-20.0, 260.0),
    y=st.floats(-20.0, 200.0),
    radius=st.floats(2.0, 90.0),
    half_width=st.floats(1.0, 90.0),
)
def test_the_color_boundary_is_that_of_its_slow_twin(
    seed: int, x: float, y: float, radius: float, half_width: float
) -> None:
    image = np.random.default_rng(seed).integers(0, 256, (HEIGHT, WIDTH, 3), np.uint8)
    lines = outline(x, y, radius, lines=12)
    distances, seen = find_color_boundary(image, model(), lines, half_width, LIMITS)
    for line, distance, in_view in zip(lines, distances.tolist(), seen.tolist(), strict=True):
        slow = slow_boundary(image, model(), line, half_width)
        assert in_view == (slow is not None)
        assert distance == pytest.approx(slow or 0.0, abs=1e-9)


@pytest.mark.parametrize(("x", "seen"), [(2.0, True), (-500.0, False), (1e6, False)])
def test_lines_outside_the_picture_count_nothing(x: float, seen: bool) -> None:
    image, color, lines = picture(x=2.0), model(), outline(x=x)
    step = measure_color_step(image, color, lines, RADIUS, LIMITS)
    assert step == (BEST_STEP if seen else NO_STEP)
    assert measure_near_step(image, color, lines, RADIUS, LIMITS) == (1.0 if seen else 0.0)
    distances, found = find_color_boundary(image, color, lines, RADIUS, LIMITS)
    assert found.any() == seen
    assert not found.all()
    assert np.isfinite(distances).all()
    assert (distances[~found] == 0.0).all()
    assert np.abs(distances[found]).max(initial=0.0) < 2.0


def slow_log_odds(fit: FitStatistics, step: ColorStep, tolerance: float) -> float:
    weights = {
        "msac": fit.msac_score,
        "inliers": fit.inliers / fit.visible if fit.visible >= 1.0 else fit.inliers,
        "harmonic": fit.harmonic_score / 5.0,
        "core": fit.core_share,
        "size": (math.log(fit.half_width) if fit.half_width > 1.0 else 0.0) / 4.0,
        "small": 1.0 - fit.half_width / LIMITS.small_px if fit.half_width < LIMITS.small_px else 0.0,
        "noise": fit.edge_noise / tolerance / 3.0 if fit.edge_noise < 3.0 * tolerance else 1.0,
        "step": step.step,
        "agreement": step.step * fit.msac_score,
        "outside": step.outside,
    }
    return LIMITS.bias + sum(float(getattr(LIMITS, name)) * figure for name, figure in weights.items())


share = st.floats(0.0, 1.0)
statistics = st.builds(
    FitStatistics,
    edge_noise=st.floats(0.0, 10.0),
    pixel_noise=st.floats(0.0, 30.0),
    visible=st.floats(0.0, 64.0),
    inliers=st.floats(0.0, 64.0),
    msac_score=share,
    color_score=share,
    residual_autocorrelation=st.floats(-1.0, 1.0),
    harmonic_score=st.floats(0.0, 20.0),
    interior_share=st.floats(-1.0, 1.0),
    core_share=st.floats(-1.0, 1.0),
    hollowness=share,
    half_width=st.floats(0.0, 500.0),
    ellipticity=share,
)
steps = st.builds(ColorStep, share, share)


@given(fit=statistics, step=steps, tolerance=st.floats(0.3, 5.0))
def test_the_log_odds_are_those_of_their_slow_twin(fit: FitStatistics, step: ColorStep, tolerance: float) -> None:
    assert log_odds(fit, step, tolerance, LIMITS) == pytest.approx(slow_log_odds(fit, step, tolerance), abs=1e-9)


@given(fit=statistics, step=steps, more=st.floats(0.01, 5.0))
def test_the_log_odds_grow_with_inliers_and_fall_with_corners(fit: FitStatistics, step: ColorStep, more: float) -> None:
    odds = log_odds(fit, step, 1.0, LIMITS)
    assert log_odds(fit._replace(inliers=fit.inliers + more), step, 1.0, LIMITS) > odds
    assert log_odds(fit._replace(harmonic_score=fit.harmonic_score + more), step, 1.0, LIMITS) < odds
    assert log_odds(fit._replace(msac_score=fit.msac_score + more), step, 1.0, LIMITS) > odds
    assert log_odds(fit, BEST_STEP, 1.0, LIMITS) >= odds >= log_odds(fit, NO_STEP, 1.0, LIMITS)


def fitted(image: Picture, radius: float = RADIUS) -> tuple[Fitter[ms.Circle], Estimate]:
    fitter = tracking_fitter(ms.Circle, 64)
    start = ms.Circle.from_coarse(X + 1.0, Y - 1.0, radius).state
    return fitter, fitter.weigh(fitter.fit(image, model(), start, SearchWindow(8.0)), image, model())


def card() -> Picture:
    image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    image[:] = WALL
    image[round(Y - 40) : round(Y + 40), round(X - 40) : round(X + 40)] = BLUE
    return image


def test_a_disc_beats_a_card_of_the_same_color() -> None:
    fitter, disc = fitted(picture())
    assert disc.evidence is not None
    assert disc.evidence > LIMITS.unknown
    assert not fitter.validate_detection(disc, Prior.NONE)
    fitter, square = fitted(card())
    assert square.evidence is not None
    assert square.evidence < disc.evidence - 2.0
    assert fitter.validate_detection(square, Prior.NONE)


def test_what_has_no_target_is_given_up_before_a_step_is_measured() -> None:
    image = picture()
    fitter, estimate = fitted(image)
    hopeless = estimate._replace(fit=GOOD._replace(inliers=0.0, msac_score=0.0, core_share=-1.0, edge_noise=9.0))
    weighed = fitter.weigh(hopeless, np.empty((0, 0, 3), np.uint8), model())
    assert weighed.evidence is not None
    assert weighed.evidence < LIMITS.clicked


def test_the_step_is_measured_wherever_the_evidence_may_be_enough() -> None:
    image = picture()
    fitter, estimate = fitted(image)
    weak = estimate._replace(fit=estimate.fit._replace(core_share=0.0, msac_score=0.0))
    tolerance = interpreted(tolerance_of)(fitter.parameters.quality, RADIUS)
    best = log_odds(weak.fit, BEST_STEP, tolerance, LIMITS)
    limits = replace(LIMITS, bias=LIMITS.bias + 0.5 * LIMITS.clicked - best)  # the best is less than `here` asks
    fitter.parameters = replace(fitter.parameters, evidence=limits)
    weighed = fitter.weigh(weak, np.full_like(image, WALL[0]), model())
    assert weighed.evidence is not None
    assert weighed.evidence < LIMITS.clicked


def unweighed(family: type[Shape], color: ms.ColorModel) -> None:
    image = picture()
    fitter = tracking_fitter(family, 64)
    start = family.from_coarse(X, Y, RADIUS).state
    estimate = fitter.fit(image, color.for_image(image), start, SearchWindow(8.0))
    assert fitter.weigh(estimate, image, color.for_image(image)) is estimate


def test_shapes_with_corners_are_not_weighed() -> None:
    unweighed(ms.Rectangle, model())


@pytest.mark.parametrize("color", [ms.ColorModel.dark(), ms.ColorModel.light(), ms.ColorModel.edges()])
def test_brightness_is_not_weighed(color: ms.ColorModel) -> None:
    unweighed(ms.Circle, color)


def test_the_less_is_known_the_more_evidence_is_asked_for() -> None:
    validator = Validator(tracking_fitter(ms.Circle, 64).validator.limits, 64)
    dim = GOOD._replace(color_score=0.0)  # so that the other rule does not let it pass
    order = [Prior.CLICKED, Prior.HERE, Prior.PRESENT, Prior.ASKED, Prior.NONE]
    least = [LIMITS.clicked, LIMITS.here, LIMITS.present, LIMITS.asked, LIMITS.unknown]
    assert least == sorted(least)
    for prior, limit in zip(order, least, strict=True):
        assert validator.validate_detection(dim, prior, limit) is Rejection.NONE
        assert validator.validate_detection(dim, prior, limit - 0.01) is Rejection.LOW_COLOR_SCORE


def test_a_hidden_outline_needs_more_evidence() -> None:
    limits = tracking_fitter(ms.Circle, 64).validator.limits
    validator = Validator(limits, 64)
    half = GOOD._replace(visible=32.0, inliers=32.0)
    asked = LIMITS.here + LIMITS.hidden * (limits.whole_visible - 0.5)
    assert validator.validate_detection(half, Prior.HERE, asked - 0.01) is Rejection.LOW_COLOR_SCORE
    assert validator.validate_detection(half, Prior.HERE, asked + 0.01) is Rejection.NONE
    few = GOOD._replace(visible=1.0, inliers=1.0)
    assert validator.validate_detection(few, Prior.HERE, 50.0) is Rejection.OUT_OF_VIEW


def test_evidence_does_not_outweigh_shape_and_inside() -> None:
    limits = tracking_fitter(ms.Circle, 64).validator.limits
    validator = Validator(limits, 64)
    for changes, rejection in (
        ({"hollowness": 2.0}, Rejection.WRONG_SHAPE),
        ({"ellipticity": 2.0}, Rejection.WRONG_SHAPE),
        ({"interior_share": 0.0}, Rejection.WRONG_INTERIOR),
        ({"core_share": 0.0}, Rejection.WRONG_INTERIOR),
    ):
        assert validator.validate_detection(GOOD._replace(**changes), Prior.HERE, 50.0) is rejection
    for prior, least in ((Prior.ASKED, LIMITS.asked_msac), (Prior.NONE, LIMITS.unknown_msac)):
        square = GOOD._replace(msac_score=least - 0.01, color_score=0.0)
        assert validator.validate_detection(square, prior, 50.0) is not Rejection.NONE
        assert validator.validate_detection(square._replace(msac_score=least), prior, 50.0) is Rejection.NONE


@given(evidence=st.floats(-30.0, 30.0))
def test_the_merit_is_a_probability(evidence: float) -> None:
    validator = Validator(tracking_fitter(ms.Circle, 64).validator.limits, 64)
    merit = validator.merit(GOOD, evidence)
    assert merit == pytest.approx(0.5 + 0.5 * math.tanh(0.5 * evidence), abs=1e-12)
