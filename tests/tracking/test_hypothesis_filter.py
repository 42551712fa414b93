"""The forward pass over hypotheses: against a slow twin, and what it is for."""

import math

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.fitting.consensus import Proposals
from matchset.tracking.outlines.hypothesis_filter import HypothesisFilter, HypothesisFilterParameters

Floats = npt.NDArray[np.float64]
LIMITS = HypothesisFilterParameters()
STILL = np.zeros(2)
INTERVAL = 1.0 / 30.0


def proposals(scores: list[float], sizes: list[float]) -> Proposals:
    return Proposals(np.zeros((len(scores), 3)), np.array(sizes), np.array(scores))


def slow_twin(frames: list[tuple[Floats, Floats, Floats]], expected: Floats, usual: tuple[float, float]) -> list[int]:
    """Best hypothesis of each frame, one number at a time."""
    before: list[tuple[float, Floats, float]] = []
    answers = []
    for scores, sizes, places in frames:
        now = []
        for k in range(len(scores)):
            total = LIMITS.score_weight * scores[k] + (LIMITS.preference if k == 0 else 0.0)
            unusual = (math.log(sizes[k]) - usual[0]) / LIMITS.usual_sigma
            total -= min(0.5 * unusual**2 / usual[1], LIMITS.most_unusual)
            ways = []
            for log_odds, place, size in before:
                growth = math.log(sizes[k] / size) / LIMITS.size_sigma
                off = [(places[k][i] - place[i] - expected[i]) / (LIMITS.place_sigma * sizes[0]) for i in range(2)]
                penalty = min(0.5 * (growth**2 + off[0] ** 2 + off[1] ** 2), LIMITS.most)
                ways.append(LIMITS.memory * log_odds - penalty)
            now.append(total + (max(ways) if ways else 0.0))
        most = max(now)
        answers.append(now.index(most))
        before = [(each - most, place, size) for each, place, size in zip(now, places, sizes, strict=True)]
    return answers


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 6))
@settings(max_examples=60, deadline=None)
def test_it_answers_as_the_slow_twin_does(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    expected, usual = rng.normal(0.0, 2.0, 2), (math.log(rng.uniform(18.0, 22.0)), float(rng.integers(1, 4)))
    frames = []
    for _ in range(4):
        k = int(rng.integers(1, count + 1))
        frames.append((rng.random(k), rng.uniform(18.0, 22.0, k), rng.normal(100.0, 2.0, (k, 2))))
    tested, answers = HypothesisFilter(LIMITS), []
    for index, (scores, sizes, places) in enumerate(frames):
        found = Proposals(np.zeros((len(scores), 3)), sizes, scores)
        answers.append(tested.choose(found, places, (expected, usual), (INTERVAL * index, INTERVAL), True))
    assert answers == slow_twin(frames, expected, usual)


def test_a_size_that_was_there_before_wins_against_a_slightly_better_score() -> None:
    tested = HypothesisFilter(LIMITS)
    tested.begin(STILL, 20.0, 0.0)
    found = proposals([0.5, 0.56], [20.0, 16.0])
    assert tested.choose(found, np.zeros((2, 2)), (STILL, None), (INTERVAL, INTERVAL), True) == 0
    tested.forget()
    assert tested.choose(found, np.zeros((2, 2)), (STILL, None), (2.0 * INTERVAL, INTERVAL), True) == 1


def test_the_usual_size_wins_against_a_slightly_better_score_and_not_against_a_much_better_one() -> None:
    places, usual = np.zeros((2, 2)), (math.log(20.0), 1.0)
    for scores, best in (([0.5, 0.56], 0), ([0.3, 0.5], 1)):
        tested = HypothesisFilter(LIMITS)
        found = proposals(scores, [20.0, 24.0])
        assert tested.choose(found, places, (STILL, usual), (INTERVAL, INTERVAL), True) == best


def test_a_much_better_score_wins_against_what_was_there_before() -> None:
    tested = HypothesisFilter(LIMITS)
    tested.begin(STILL, 20.0, 0.0)
    found = proposals([0.3, 0.7], [20.0, 16.0])
    assert tested.choose(found, np.zeros((2, 2)), (STILL, None), (INTERVAL, INTERVAL), True) == 1


def test_several_frames_outweigh_one() -> None:
    """Twice the smaller outline scores a little better, but only the larger one has gone on."""
    tested = HypothesisFilter(LIMITS)
    for index, smaller in enumerate((16.0, 12.0, 14.0)):
        found = proposals([0.52, 0.55], [20.0, smaller])
        best = tested.choose(found, np.zeros((2, 2)), (STILL, None), (INTERVAL * index, INTERVAL), False)
    assert best == 0


def test_after_a_while_nothing_is_remembered() -> None:
    tested = HypothesisFilter(LIMITS)
    tested.begin(STILL, 20.0, 0.0)
    found = proposals([0.5, 0.56], [20.0, 16.0])
    late = LIMITS.remembered_s + INTERVAL
    assert tested.choose(found, np.zeros((2, 2)), (STILL, None), (late, INTERVAL), True) == 1


@pytest.mark.parametrize(("preferred", "answer"), [(True, 0), (False, 1)])
def test_the_first_is_preferred_or_not(preferred: bool, answer: int) -> None:
    found = proposals([0.50, 0.51], [20.0, 20.0])
    assert HypothesisFilter(LIMITS).choose(found, np.zeros((2, 2)), (STILL, None), (0.0, INTERVAL), preferred) == answer


def test_the_spread_is_the_covariance_of_the_outlines_by_their_probabilities() -> None:
    tested, steps = HypothesisFilter(LIMITS), np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.0, -4.0, 2.0]])
    scores = np.array([0.5, 0.45, 0.3])
    found = Proposals(steps, np.full(3, 20.0), scores)
    which = tested.choose(found, np.zeros((3, 2)), (STILL, None), (0.0, INTERVAL), True)
    log_odds = LIMITS.score_weight * scores + LIMITS.preference * np.array([1.0, 0.0, 0.0])
    chances = np.exp(log_odds / LIMITS.temperature) / np.exp(log_odds / LIMITS.temperature).sum()
    expected = sum(chance * np.outer(step, step) for chance, step in zip(chances, steps, strict=True))
    assert which == 0
    np.testing.assert_allclose(tested.spread(steps, which), expected, rtol=1e-12)


def test_one_outline_alone_has_no_spread() -> None:
    tested = HypothesisFilter(LIMITS)
    tested.choose(proposals([0.6], [20.0]), np.zeros((1, 2)), (STILL, None), (0.0, INTERVAL), True)
    np.testing.assert_array_equal(tested.spread(np.ones((1, 3)), 0), np.zeros((3, 3)))
