"""The offset of a clock is within its uncertainty of the truth, whatever the network does; a jump is told."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.sharing.clock_offset import ClockOffset, Exchange, ExchangeParameters, Offset

DELAYS = st.floats(1e-5, 0.3)
HOUR = 3600.0


def exchange(begin: float, ahead: float, there: float, work: float, back: float) -> Exchange:
    """Of a partner whose clock is so far ahead."""
    return Exchange(begin, begin + there + ahead, begin + there + work + ahead, begin + there + work + back)


@given(st.floats(-1e6, 1e6), st.lists(st.tuples(DELAYS, DELAYS, DELAYS), min_size=1, max_size=20))
def test_the_truth_is_within_the_uncertainty(ahead: float, delays: list[tuple[float, float, float]]) -> None:
    clock, now = ClockOffset(ExchangeParameters()), 1000.0
    for there, work, back in delays:
        now += 1.0
        assert not clock.add(exchange(now, ahead, there, work, back))
        known = clock.at(now + there + work + back)
        assert known is not None
        assert abs(known.seconds + ahead) <= known.uncertainty + 1e-8
        assert known.uncertainty <= (there + back) / 2 + 1e-4 * 20 + 1e-8


def test_the_quickest_of_several_counts_until_it_is_old() -> None:
    clock = ClockOffset(ExchangeParameters(drift=1e-3))
    clock.add(exchange(0.0, 0.0, 0.001, 0.0, 0.001))
    clock.add(exchange(1.0, 0.0, 0.100, 0.0, 0.020))
    assert clock.at(1.2) == pytest.approx(Offset(0.0, 0.001 + 1e-3 * (1.2 - 0.002)))
    late = clock.at(100.0)
    assert late is not None
    assert late.uncertainty > 0.09


def test_a_clock_that_jumps_is_told_and_measured_anew() -> None:
    clock = ClockOffset(ExchangeParameters())
    assert not clock.add(exchange(0.0, 0.0, 0.001, 0.0, 0.001))
    assert clock.add(exchange(1.0, HOUR, 0.01, 0.0, 0.01))  # not as quick as what it contradicts
    known = clock.at(1.03)
    assert known is not None
    assert known.seconds == pytest.approx(-HOUR, abs=0.011)


@pytest.mark.parametrize(
    "odd",
    [
        Exchange(1.0, 5.0, 4.0, 2.0),
        Exchange(1.0, 5.0, 9.0, 2.0),
        Exchange(2.0, 5.0, 5.0, 1.0),
        Exchange(1.0, math.nan, 5.0, 2.0),
        Exchange(1.0, 5.0, math.inf, 2.0),
    ],
)
def test_an_exchange_that_cannot_be_is_left_out(odd: Exchange) -> None:
    clock = ClockOffset(ExchangeParameters())
    assert not clock.add(odd)
    assert clock.at(2.0) is None


def test_parameters_are_positive() -> None:
    with pytest.raises(ValueError, match="interval must be positive"):
        ExchangeParameters(interval=0.0)
