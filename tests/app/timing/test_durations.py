"""Times of frames in bins: four figures of any number of them, in memory that does not grow."""

import math
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.app.timing.durations import Durations, FrameTimes, ms_text, times_of

TIMES = st.lists(st.floats(0.0, 900.0) | st.floats(-16.0, 6.5).map(math.exp), min_size=1, max_size=300)


def counted(times: list[float]) -> Durations:
    durations = Durations()
    for each in times:
        durations.add(each)
    return durations


@settings(max_examples=300)
@given(TIMES, st.integers(0, 64))
def test_quantiles_are_those_of_numpy_but_for_half_a_percent(times: list[float], sixty_fourths: int) -> None:
    share = sixty_fourths / 64
    found, exact = counted(times).quantile(share), float(np.quantile(times, share, method="inverted_cdf"))
    assert found == pytest.approx(exact, rel=0.0051, abs=1e-6)


@settings(max_examples=100)
@given(TIMES)
def test_mean_and_worst_are_exact_and_the_figures_in_order(times: list[float]) -> None:
    found = counted(times).times()
    assert found is not None
    assert found.worst == max(times)
    assert found.mean == pytest.approx(float(np.mean(times)))
    assert min(times) <= found.median <= found.percentile_95 <= found.worst
    exact = times_of(np.array(times))
    assert exact is not None
    assert (exact.mean, exact.worst) == pytest.approx((found.mean, found.worst))


def test_a_slow_frame_in_twenty_is_seen_beside_the_median() -> None:
    found = counted([0.00015] * 900 + [0.210] * 90 + [1.02] * 10).times()
    assert found is not None
    assert found.words == "median 0.15, mean 29.2, 95 % 210, worst 1020 ms"
    assert found.in_ms == pytest.approx({"median": 0.15, "mean": 29.24, "percentile_95": 210, "worst": 1020}, rel=0.006)


def test_without_frames_there_are_no_figures() -> None:
    empty = Durations()
    assert empty.times() is None
    assert (empty.quantile(0.5), empty.mean, empty.worst, empty.count) == (0.0, 0.0, 0.0, 0)
    assert times_of(np.array([math.nan, math.inf])) is None


def test_times_that_are_not_finite_are_left_out_of_those_at_hand() -> None:
    assert times_of(np.array([1.0, math.nan, 3.0])) == FrameTimes(2.0, 2.0, 2.9, 3.0)


def test_memory_does_not_grow() -> None:
    durations = counted([1e-5])
    size = sys.getsizeof(durations._bins)
    for each in np.geomspace(1e-9, 1e5, 20_000).tolist():
        durations.add(each)
    assert sys.getsizeof(durations._bins) == size < 20_000
    assert durations.count == 20_001
    assert 990.0 < durations.quantile(1.0) < 1010.0  # longer ones count as 1000 s
    assert durations.worst == pytest.approx(1e5)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "0.00"), (0.00015, "0.15"), (0.009994, "9.99"), (0.009996, "10.0"), (0.0999, "99.9"), (1.02, "1020")],
)
def test_three_digits_of_ms(seconds: float, text: str) -> None:
    assert ms_text(seconds) == text


def test_the_words_fit_beside_a_label_in_a_terminal() -> None:
    assert len(FrameTimes(99.999, 99.999, 99.999, 99.999).words) <= 60
