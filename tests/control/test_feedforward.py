import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.feedforward import FeedforwardParameters, SpeedFeedforward

STEP = 0.01


def test_a_steady_speed_is_flown_along_in_full() -> None:
    feedforward = SpeedFeedforward(FeedforwardParameters(high_frequency_gain=0.0, crossover_time=0.5))
    feedforward.update(0.0, STEP)
    for _ in range(1000):
        feedforward.update(0.3, STEP)
    assert feedforward.output(0.3) == pytest.approx(0.3, abs=1e-6)


@pytest.mark.parametrize("rate", [0.2, 1.0, 2.0, 5.0, 20.0])
def test_of_a_wobble_a_share_is_flown_along(rate: float) -> None:
    calm, share = 0.5, 0.4
    feedforward = SpeedFeedforward(FeedforwardParameters(high_frequency_gain=share, crossover_time=calm))
    times = [k * STEP for k in range(round(40.0 * math.pi / rate / STEP))]
    most = 0.0
    for time in times:
        speed = math.sin(rate * time)
        feedforward.update(speed, STEP)
        if time > 0.5 * times[-1]:
            most = max(most, feedforward.output(speed))
    expected = abs((1.0 + 1j * share * rate * calm) / (1.0 + 1j * rate * calm))
    assert most == pytest.approx(expected, abs=0.03)


@given(st.floats(0.0, 1.0), st.floats(0.01, 10.0), st.lists(st.floats(-5.0, 5.0), min_size=1))
def test_it_is_never_faster_than_the_neighbor_was(share: float, calm: float, speeds: list[float]) -> None:
    feedforward = SpeedFeedforward(FeedforwardParameters(high_frequency_gain=share, crossover_time=calm))
    for speed in speeds:
        feedforward.update(speed, STEP)
        assert abs(feedforward.output(speed)) <= max(map(abs, speeds)) + 1e-9


def test_before_anything_was_seen_all_is_flown_along() -> None:
    assert SpeedFeedforward(FeedforwardParameters(high_frequency_gain=0.3)).output(0.7) == 0.7


@pytest.mark.parametrize(
    "bad",
    [
        {"high_frequency_gain": 1.5},
        {"high_frequency_gain": -0.1},
        {"high_frequency_gain": math.nan},
        {"crossover_time": 0.0},
    ],
)
def test_bad_numbers_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        FeedforwardParameters(**bad)


@pytest.mark.parametrize("step", [0.01, 0.1, 1.0, 10.0])
def test_one_step_however_long_goes_part_of_the_way_and_not_beyond(step: float) -> None:
    parameters = FeedforwardParameters(high_frequency_gain=0.0, crossover_time=0.2)
    speed = SpeedFeedforward(parameters)
    speed.update(0.0, step)
    speed.update(1.0, step)
    assert speed.output(0.0) == pytest.approx(step / (0.2 + step))
    assert speed.output(0.0) < 1.0


def test_the_first_speed_counts_as_steady() -> None:
    feedforward = SpeedFeedforward(FeedforwardParameters(high_frequency_gain=0.0, crossover_time=5.0))
    feedforward.update(0.7, STEP)
    assert feedforward.output(0.7) == 0.7
