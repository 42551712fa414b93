import math

import numpy as np
import pytest

from matchset.control.chain.slow_part import SlowPart

STEP = 0.01


def followed(values: np.ndarray, time: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    slow, seen = SlowPart(time), []
    for value in values:
        slow.update((value, 0.0, -value), STEP)
        seen.append((slow.values[0], slow.speeds[0]))
        assert slow.values[2] == -slow.values[0]
        assert slow.values[1] == 0.0
    return np.array(seen)[:, 0], np.array(seen)[:, 1]


def test_a_steady_drift_is_slow() -> None:
    values = 2.0 + 0.3 * STEP * np.arange(600)
    slow, speed = followed(values)
    assert slow[0] == 2.0
    assert slow[-1] == pytest.approx(values[-1], abs=0.004)
    assert speed[-1] == pytest.approx(0.3, rel=0.01)


@pytest.mark.parametrize("period", [0.5, 3.0, 12.0])
def test_what_is_left_of_an_oscillation_is_that_of_the_filter(period: float) -> None:
    time = STEP * np.arange(round(24.0 / STEP))
    values = np.sin(2.0 * math.pi * time / period)
    left = (values - followed(values)[0])[time >= 12.0]
    w = 2.0 * math.pi / period * 0.5
    assert math.sqrt(2.0) * left.std() == pytest.approx(w * w / (1.0 + w * w), rel=0.05)


def test_a_long_gap_does_not_upset_it() -> None:
    slow = SlowPart(0.3)
    for step in (0.033, 5.0, 0.033, 5.0, 5.0):
        slow.update((1.0, 2.0, 3.0), step)
    assert slow.values == [1.0, 2.0, 3.0]
    slow.forget()
    slow.update((4.0, 4.0, 4.0), 0.033)
    assert slow.values == [4.0, 4.0, 4.0]


def test_a_jump_over_a_long_gap_is_come_near_to_and_not_past_by_much() -> None:
    slow = SlowPart(0.3)
    for value in (1.0, 2.0, 2.0, 2.0):
        slow.update((value, value, value), 5.0)
        assert all(0.9 < each < 2.2 for each in slow.values)
