"""One weighted sum of what speaks for a disc, and the prior of its place."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.tracking.ball.log_odds import (
    ExpectedPlace,
    Features,
    FeatureWeights,
    PlaceParameters,
    SizeParameters,
    log_odds,
    log_prior_of_place,
    log_prior_of_size,
)

LIMITS = PlaceParameters()
EXPECTED = ExpectedPlace(x=100.0, y=100.0, radius=10.0, missed=1.0, unsized=1.0, speed=0.0, innovation=0.0, sightings=1)
numbers = st.floats(-10.0, 10.0)
features = st.builds(Features, *[numbers] * len(Features._fields))
places = st.builds(
    ExpectedPlace,
    x=st.floats(0.0, 640.0),
    y=st.floats(0.0, 480.0),
    radius=st.floats(2.0, 100.0),
    missed=st.floats(1.0, 200.0),
    unsized=st.floats(1.0, 200.0),
    speed=st.floats(0.0, 100.0),
    innovation=st.floats(0.0, 100.0),
    sightings=st.integers(1, 100),
    way=st.floats(0.0, 200.0),
)
distances = st.floats(0.0, 2000.0)
turns = st.floats(0.0, 2.0 * math.pi)


def prior(expected: ExpectedPlace, away: float, turn: float = 0.0) -> float:
    """Prior of a place so far from where it is expected, in a direction, rad."""
    at = expected.x + away * math.cos(turn), expected.y + away * math.sin(turn)
    return log_prior_of_place(at, expected, LIMITS)


@given(features)
def test_it_is_the_weighted_sum_and_the_network_counts_up_to_its_most(each: Features) -> None:
    weights = FeatureWeights(bias=-0.5, most_network=2.0, network=1.5, color=0.5, foreign=-2.0, place=0.7, arrived=3.0)
    capped = each._replace(network=min(each.network, 2.0))
    summed = sum(getattr(weights, name) * getattr(capped, name) for name in Features._fields)
    assert log_odds(each, weights) == pytest.approx(summed - 0.5)


@given(features, st.sampled_from(Features._fields))
def test_what_speaks_for_a_disc_adds_and_what_speaks_against_it_takes(each: Features, name: str) -> None:
    more = log_odds(each._replace(**{name: getattr(each, name) + 1.0}), FeatureWeights())
    if name in ("foreign", "before"):
        assert more < log_odds(each, FeatureWeights())
    else:
        assert more >= log_odds(each, FeatureWeights())


def test_a_look_alike_that_was_there_before_is_not_the_ball_however_sure_the_network_is() -> None:
    assert log_odds(Features(network=99.0), FeatureWeights()) > 0.0
    assert log_odds(Features(network=99.0, before=1.0), FeatureWeights()) < 0.0


@given(places, distances, turns)
def test_no_place_is_likelier_than_the_expected_one(expected: ExpectedPlace, away: float, turn: float) -> None:
    assert prior(expected, away, turn) <= prior(expected, 0.0)
    assert 0.0 <= prior(expected, 0.0) <= math.log(1.0 + 1.0 / LIMITS.rivals)


@given(places, distances, distances, turns)
def test_it_falls_with_the_distance_and_no_direction_is_better(
    expected: ExpectedPlace, away: float, more: float, turn: float
) -> None:
    assert prior(expected, away + more) <= prior(expected, away) + 1e-9
    assert prior(expected, away, turn) == pytest.approx(prior(expected, away), abs=1e-6)


@given(places, distances, st.floats(0.0, 50.0))
def test_it_forgets_with_the_missed_pictures(expected: ExpectedPlace, away: float, more: float) -> None:
    resting = expected._replace(speed=0.0)
    later = resting._replace(missed=resting.missed + more)
    assert prior(later, away) >= prior(resting, away) - 1e-9
    difference = prior(later, 0.0) - prior(later, away)
    assert difference <= prior(resting, 0.0) - prior(resting, away) + 1e-9


@given(places, distances)
def test_after_very_long_it_may_be_anywhere(expected: ExpectedPlace, away: float) -> None:
    anywhere = math.log(1.0 / LIMITS.rivals)
    assert prior(expected._replace(missed=1e4), away) >= anywhere - 0.01


@given(places, distances, st.floats(0.0, 50.0))
def test_a_ball_that_is_faster_or_less_predictable_may_be_farther_off(
    expected: ExpectedPlace, away: float, more: float
) -> None:
    assert prior(expected._replace(speed=expected.speed + more), away) >= prior(expected, away) - 1e-9
    assert prior(expected._replace(innovation=expected.innovation + more), away) >= prior(expected, away) - 1e-9


@given(places, st.floats(1.0, 2000.0))
def test_a_ball_whose_motion_is_known_does_not_jump(expected: ExpectedPlace, away: float) -> None:
    known, new = expected._replace(sightings=LIMITS.sightings), expected._replace(sightings=1)
    assert prior(known, away) <= prior(new, away)


def test_the_prior_of_a_size_is_widest_where_the_outline_was_not_seen_for_long_and_has_a_heavy_tail() -> None:
    limits = SizeParameters()
    here = EXPECTED._replace(radius=20.0, unsized=1.0)
    assert log_prior_of_size(20.0, here, limits) == 0.0
    larger = [log_prior_of_size(factor * 20.0, here, limits) for factor in (1.1, 1.3, 1.6, 3.0)]
    assert larger == sorted(larger, reverse=True)
    smaller = [log_prior_of_size(20.0 / factor, here, limits) for factor in (1.1, 1.3, 1.6, 3.0)]
    assert smaller == pytest.approx(larger)
    later = here._replace(unsized=30.0)
    assert log_prior_of_size(60.0, later, limits) > log_prior_of_size(60.0, here, limits) + 1.5
    tiny = EXPECTED._replace(radius=2.0, unsized=1.0)
    assert log_prior_of_size(2.6, tiny, limits) > log_prior_of_size(26.0, here, limits)


def test_a_ball_that_was_seen_once_may_be_anywhere_near_by() -> None:
    limits = PlaceParameters()
    once = EXPECTED._replace(sightings=1, speed=0.0)
    often = EXPECTED._replace(sightings=2, speed=0.0)
    away = once.x + 8.0 * once.radius, once.y
    assert log_prior_of_place(away, once, limits) > log_prior_of_place(away, often, limits) + 1.0
