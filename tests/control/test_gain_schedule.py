import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.chain.gain_schedule import ENTRIES, Gains, GainSchedule, GainScheduleParameters, interpolated
from matchset.control.chain.long_chain import LongChainParameters, in_chain
from matchset.control.feedforward import FeedforwardParameters
from matchset.control.follower import FollowerParameters
from matchset.control.pid import PidParameters
from matchset.flight.chain.config import with_world
from matchset.flight.chain.flight_parameters import FlightParameters

HIGH = GainScheduleParameters()
LOW = Gains(
    PidParameters(proportional=4.0, derivative=3.0, integral=2.0),
    FeedforwardParameters(high_frequency_gain=0.7),
    FeedforwardParameters(high_frequency_gain=0.4),
    max_stick=0.8,
)
STEP = 1.0 / 30.0


def test_low_gains_hold_before_a_delay_is_known_and_before_the_vehicle_flies() -> None:
    schedule = GainSchedule(LOW)
    assert schedule.gains == LOW
    assert schedule.update(math.inf, STEP, 10.0) == LOW
    assert schedule.update(0.1, STEP, -math.inf) == LOW
    assert schedule.update(0.1, STEP, HIGH.start_time) == LOW


def test_high_gains_hold_in_full_where_delay_and_chain_are_short() -> None:
    gains = GainSchedule(LOW).update(HIGH.delay, STEP, HIGH.full_time)
    assert gains.horizontal.proportional == HIGH.proportional
    assert gains.horizontal.derivative == HIGH.derivative
    assert gains.horizontal.output_limit == HIGH.output_limit
    assert gains.horizontal.max_error == HIGH.max_error
    assert gains.horizontal.integral == LOW.horizontal.integral  # not scheduled
    assert gains.horizontal_feedforward.high_frequency_gain == HIGH.horizontal_share
    assert gains.vertical_feedforward.high_frequency_gain == HIGH.vertical_share
    assert gains.vertical_drift_feedforward == HIGH.vertical_drift_feedforward
    assert gains.max_stick == HIGH.max_stick


@given(st.floats(0.0, 0.5), st.floats(-1.0, 20.0), st.floats(0.0, 1.0))
def test_the_share_falls_with_the_delay_and_grows_after_lift_off(delay: float, lifted: float, weight: float) -> None:
    high = msgspec.structs.replace(HIGH, weight=weight)
    quick = min(max((high.longest_delay - delay) / (high.longest_delay - high.delay), 0.0), 1.0)
    known = min(max((lifted - high.start_time) / (high.full_time - high.start_time), 0.0), 1.0)
    expected = 4.0 + weight * quick * known * (HIGH.proportional - 4.0)
    found = GainSchedule(LOW, high).update(delay, STEP, lifted).horizontal.proportional
    assert found == pytest.approx(expected, abs=(HIGH.proportional - 4.0) * 0.51 / (ENTRIES - 1))


def test_the_shortest_delay_counts_and_is_forgotten_slowly() -> None:
    schedule = GainSchedule(LOW)
    high = schedule.update(0.1, STEP, HIGH.full_time)
    assert schedule.update(0.4, STEP, HIGH.full_time) == high  # a picture did not come
    for _ in range(round(0.2 / HIGH.forgetting_rate / STEP)):
        schedule.update(0.4, STEP, HIGH.full_time)
    assert schedule.gains == LOW


def test_ends_of_the_interpolation_are_exact() -> None:
    assert interpolated(LOW, HIGH, 0.0) == LOW
    unlimited = LOW._replace(horizontal=PidParameters(proportional=HIGH.proportional, max_error=HIGH.max_error))
    assert interpolated(unlimited, HIGH, 1.0).horizontal.max_error == HIGH.max_error


@pytest.mark.parametrize(
    "bad",
    [
        {"weight": 1.1},
        {"weight": math.nan},
        {"longest_delay": 0.1},
        {"full_time": 3.0},
        {"proportional": -1.0},
        {"max_stick": 2.0},
        {"forgetting_rate": 0.0},
    ],
)
def test_gains_that_are_none_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        GainScheduleParameters(**bad)


@pytest.mark.parametrize(("followers", "weight"), [(1, 1.0), (2, 1.0), (3, 0.75), (4, 0.5), (6, 0.0), (9, 0.0)])
def test_a_longer_chain_has_less_of_the_high_gains(followers: int, weight: float) -> None:
    follower, limits = FollowerParameters(), LongChainParameters()
    changed = in_chain(follower, followers, limits)
    assert changed.gain_schedule.weight == weight
    assert changed.neighbor_filter.tilt_sigma == (
        follower.neighbor_filter.tilt_sigma if followers <= 2 else limits.tilt_sigma
    )
    elsewhere = msgspec.structs.replace(limits, remote_followers=followers - 1)
    assert in_chain(follower, 1, elsewhere) == changed


def test_a_flight_gives_its_followers_the_gains_of_its_length() -> None:
    three, ten = FlightParameters(), with_world(FlightParameters(), vehicles=10)
    assert three.loop == three.pilot
    assert ten.loop.follower.gain_schedule.weight == 0.0
    assert msgspec.structs.replace(ten.loop, follower=ten.pilot.follower) == ten.pilot


@pytest.mark.parametrize("bad", [{"short_followers": -1}, {"long_followers": 2}, {"remote_followers": -1}])
def test_lengths_that_are_none_are_refused(bad: dict[str, int]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        LongChainParameters(**bad)


def test_a_tilt_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="tilt_sigma"):
        LongChainParameters(tilt_sigma=0.0)


@pytest.mark.parametrize("bad", [-0.1, 1.1, math.nan])
def test_a_largest_stick_that_is_none_is_refused(bad: float) -> None:
    with pytest.raises(ValueError, match="max_stick"):
        FollowerParameters(max_stick=bad)
