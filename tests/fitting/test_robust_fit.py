"""The robust fit and its review against their slow twins, and what they are for."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import naive_tracking as naive
from kernels import Fit, Floats, Prior, fit, median, review, trace, turns
from matchset.fitting.robust_fit import FitParameters
from matchset.shapes.circle import Circle

N = 64
LIMITS = FitParameters()
STATE = Circle(100.0, 80.0, 30.0).state
FREE = Prior(STATE, np.zeros(3), 30.0)


def jacobian(state: Floats = STATE) -> Floats:
    outline = trace(state, turns(N))
    half = np.where(np.arange(N) % 2, -0.5, 0.5)[:, np.newaxis]  # as if every other line lay in the odd field
    return np.concatenate((outline.jacobian, half * outline.normals), axis=1)


def edge_points(step: Floats, seed: int = 0, noise: float = 0.0) -> tuple[Floats, Floats]:
    """Offsets and strengths of the edge points of the state moved by `step`; two false ones on every line."""
    rng = np.random.default_rng(seed)
    true = jacobian()[:, : len(step)] @ step + rng.normal(0.0, noise, N)
    offset = np.column_stack((true, true + rng.uniform(3, 9, N), true - rng.uniform(3, 9, N)))
    strength = np.column_stack((np.full(N, 9e5), np.full(N, 4e5), np.full(N, 1e5)))
    return offset, strength


def test_exact_edge_points_give_the_exact_step() -> None:
    step = np.array([1.2, -0.7, 0.5, 0.0, 0.0])
    result = fit(jacobian(), *edge_points(step), STATE, FREE)
    np.testing.assert_allclose(result.step, step, atol=1e-9)
    assert result.chosen.tolist() == [0] * N
    assert result.noise == 0.05  # less is never claimed


@pytest.mark.parametrize("speed", [0.0, 4.0])
@pytest.mark.parametrize("spread", [np.zeros(3), np.array([2.0, 2.0, 0.5])])
@pytest.mark.parametrize("seed", range(4))
def test_the_fit_is_weighted_least_squares(seed: int, spread: Floats, speed: float) -> None:
    state = np.array([100.0, 80.0, 30.0, 0.6, -0.3])
    rng = np.random.default_rng(100 + seed)
    offset, strength = edge_points(rng.normal(0.0, 1.0, 5), seed, noise=0.5)
    strength[rng.integers(0, N, 9)] = 0.0
    offset[rng.integers(0, N, 9)] += 6.0
    prior = Prior(state + rng.normal(0.0, 0.5, 5), spread, 30.0, speed, noise=0.7)
    result = fit(jacobian(state), offset, strength, state, prior)
    assert result.noise > 0.0
    p = 7 if speed > 0.5 else 5
    priors, means = prior_rows(state, prior, p)
    there = result.weight > 0.0
    assert there.sum() > 40
    root = np.sqrt(result.weight[there])[:, np.newaxis]
    rows = np.concatenate((root * jacobian(state)[there, :p], priors))
    values = offset[np.arange(N), result.chosen][there]
    step, *_ = np.linalg.lstsq(rows, np.concatenate((root[:, 0] * values, means)))
    np.testing.assert_allclose(result.step, step[:5], atol=1e-8)
    near = np.abs(result.residual[np.isfinite(result.residual)])
    total = result.weight.sum()
    scale = 1.4826 * median(near)  # of normal errors
    assert result.noise == pytest.approx(scale * math.sqrt(total / (total - p)), rel=1e-5)
    covariance = result.noise**2 * np.linalg.inv(rows.T @ rows)
    np.testing.assert_allclose(result.covariance, covariance[:3, :3], rtol=1e-6, atol=1e-12)


def prior_rows(state: Floats, prior: Prior, p: int) -> tuple[Floats, Floats]:
    """Priors of the module's text as rows of a least squares problem in units of the noise."""
    noise = max(prior.noise, LIMITS.min_prior_noise)
    tracked = prior.spread[0] > 0.0
    rows: list[tuple[int, float, float]] = []  # which number of the step, 1 / deviation, mean
    if tracked:
        rows += [(k, noise / prior.spread[k], prior.expected[k] - state[k]) for k in range(3)]
        rows += [(k, noise / (LIMITS.mode_drift * prior.size), prior.expected[k] - state[k]) for k in (3, 4)]
    rows += [(k, noise / (LIMITS.mode_sigma * prior.size), -state[k]) for k in (3, 4)]
    rows += [(k, 1.0 / (0.1 + 0.5 * prior.speed), 0.0) for k in range(5, p)]
    matrix = np.zeros((len(rows), p))
    for i, (k, sharp, _) in enumerate(rows):
        matrix[i, k] = sharp
    return matrix, np.array([sharp * mean for _, sharp, mean in rows])


@pytest.mark.parametrize("seed", range(4))
def test_choice_and_weight_are_those_of_the_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    offset, strength = edge_points(rng.normal(0.0, 1.0, 3), seed, noise=0.4)
    strength *= np.sort(rng.uniform(0.1, 1.0, (N, 3)))[:, ::-1]
    strength[rng.integers(0, N, 9), 1:] = 0.0
    strength[rng.integers(0, N, 9)] = 0.0
    offset[rng.integers(0, N, 20)] -= 4.0
    result = fit(jacobian(), offset, strength, STATE, FREE)
    there = np.isfinite(result.residual)
    before = offset[np.arange(N), result.chosen] - np.where(there, result.residual, 0.0)
    sigma = sigma_of(result, strength)
    chosen, residual, weight = naive.weigh(offset, strength, before, sigma)
    assert np.array(chosen)[there].tolist() == result.chosen[there].tolist()
    np.testing.assert_allclose(result.residual, residual, atol=1e-12)
    np.testing.assert_allclose(result.weight, weight, atol=1e-9)


def sigma_of(result: Fit, strength: Floats) -> float:
    """Scale of the last round, from the weight of the farthest edge point that has one."""
    there = [i for i in range(N) if result.weight[i] > 1e-3 and result.residual[i] > 0.0]
    far = max(there, key=lambda i: float(result.residual[i]))
    share = result.weight[far] / naive.trust(strength, far, int(result.chosen[far]))
    return float(result.residual[far] / (LIMITS.outer_cut * math.sqrt(1.0 - math.sqrt(share))))


def test_a_third_that_is_hidden_has_no_say() -> None:
    step = np.array([0.8, 0.4, -0.6])
    offset, strength = edge_points(step, noise=0.2)
    offset[5:26, 0] -= 12.0  # a finger: one edge inside the rim
    strength[5:26, 1:] = 0.0
    result = fit(jacobian(), offset, strength, STATE, FREE)
    np.testing.assert_allclose(result.step[:3], step, atol=0.25)
    assert (result.weight[5:26] == 0.0).all()
    assert result.noise == pytest.approx(0.2, abs=0.15)


def test_a_prediction_holds_what_the_edge_points_leave_open() -> None:
    offset, strength = edge_points(np.array([0.0, 0.0, 0.0]), noise=0.1)
    strength[8:] = 0.0  # an arc of an eighth
    expected = STATE + np.array([0.3, -0.2, 0.1, 0.0, 0.0])
    held = fit(jacobian(), offset, strength, STATE, Prior(expected, np.full(3, 0.05), 30.0, noise=0.2))
    np.testing.assert_allclose(held.step[:3], [0.3, -0.2, 0.1], atol=0.15)
    free = fit(jacobian(), offset, strength, STATE, FREE)
    assert np.trace(held.covariance) < 0.2 * np.trace(free.covariance)


def test_fields_far_apart_need_to_be_expected_there() -> None:
    prior = Prior(STATE, np.zeros(3), float(STATE[2]), speed=18.0, start=0.5)
    columns = jacobian()
    offset = np.zeros((N, 3))
    true = np.array([5.0, 3.5, 0.0])  # the even field lies about where the outline was traced
    offset[:, 0] = columns[:, :3] @ true + columns[:, -2:] @ (9.0, 6.0)  # so far lies the odd field from the even one
    strength = np.tile((1.0, 0.0, 0.0), (N, 1))
    begun_near = fit(columns, offset, strength, STATE, prior, begin=(9.0, 6.0))
    assert np.abs(begun_near.step[:3] - true).max() < 0.2
    surely = fit(columns, offset, strength, STATE, prior, begin=(9.0, 6.0), expected=(9.0, 6.0, 0.5))
    np.testing.assert_allclose(surely.step, (*true, 0.0, 0.0), atol=0.01)  # what is expected does not pull it elsewhere
    begun_at_rest = fit(columns, offset, strength, STATE, prior)
    assert np.abs(begun_at_rest.step[:3] - true).max() > 3.0  # one of the fields taken for the whole


def test_too_few_edge_points_are_no_fit() -> None:
    offset, strength = edge_points(np.zeros(3))
    for kept in (0, 1, 4):
        strength[kept:] = 0.0
        assert fit(jacobian(), offset, strength, STATE, FREE).noise == 0.0


def test_the_covariance_tells_the_spread_of_the_answers() -> None:
    answers, claimed = [], []
    for seed in range(300):
        result = fit(jacobian(), *edge_points(np.zeros(3), seed, noise=0.5), STATE, FREE)
        answers.append(result.step[:3])
        claimed.append(result.covariance)
    ratio = np.diag(np.mean(claimed, axis=0)) / np.diag(np.cov(np.array(answers).T))
    assert (ratio > 1.0).all()  # a little too modest
    assert (ratio < 1.6).all()


@given(arrays(np.float64, st.integers(1, 40), elements=st.floats(0.0, 9.0)))
def test_the_median_is_the_upper_one(values: Floats) -> None:
    assert median(values) == sorted(values.astype(np.float32))[len(values) // 2]


@given(st.integers(0, 10_000), st.sampled_from((16, 64, 129)), st.floats(0.3, 3.0))
def test_the_review_is_its_slow_twin(seed: int, n: int, tolerance: float) -> None:
    rng = np.random.default_rng(seed)
    residual = rng.normal(0.0, rng.choice([0.2, 1.0, 5.0]), n)
    seen = rng.random(n) > rng.choice([0.0, 0.3, 1.0])
    residual[(rng.random(n) < 0.2) | ~seen] = math.inf
    whiteness = rng.random(n)
    np.testing.assert_allclose(
        review(residual, whiteness, seen, tolerance),
        naive.review(residual, whiteness, seen, tolerance),
        rtol=1e-9,
        atol=1e-12,
    )


@pytest.mark.parametrize(("harmonic", "corners"), [(0, False), (1, False), (2, False), (3, True), (4, True)])
def test_corners_are_those_of_triangles_and_squares(harmonic: int, corners: bool) -> None:
    angles = 2.0 * np.pi * (np.arange(N) + 0.5) / N
    residual = 1.0 * np.cos(harmonic * angles)
    everything = review(residual, np.ones(N), np.ones(N, bool), 1.5)
    assert (everything[5] > 4.0) == corners
    assert everything[4] > 0.5  # neighbors err together
