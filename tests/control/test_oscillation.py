"""Swings of a stick: those of a loop that oscillates are noticed within a second, others never are."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from matchset.control.stability.oscillation import Oscillation, SwingLimits

LIMITS = SwingLimits(1.8, 3, 0.5, 0.15)
STEP = 1.0 / 30.0


def noticed(stick: Callable[[float], float], seconds: float = 20.0) -> float:
    """When it is noticed, s; inf if it never is. Sticks end at 1."""
    watch = Oscillation(LIMITS)
    for k in range(round(seconds / STEP)):
        if watch.update(min(max(stick(k * STEP), -1.0), 1.0), k * STEP):
            return k * STEP
    return math.inf


@pytest.mark.parametrize("frequency", [7.5, 10.0, 14.0])
@pytest.mark.parametrize("phase", np.linspace(0.0, 6.0, 7).tolist())
def test_a_growing_oscillation_is_noticed_in_its_third_large_swing(frequency: float, phase: float) -> None:
    def stick(time: float) -> float:
        return 0.1 * math.exp(0.8 * time) * math.sin(frequency * time + phase)

    large = math.log(0.9 / 0.1) / 0.8  # from here on its amplitude is half of such a swing
    assert large <= noticed(stick) <= large + 3.5 * math.pi / frequency + 2.0 * STEP


@pytest.mark.parametrize("frequency", [9.0, 10.0, 14.0])
def test_one_that_begins_at_once_is_noticed_within_a_second(frequency: float) -> None:
    assert noticed(lambda t: math.cos(frequency * t)) <= 1.0


def test_small_slow_and_single_swings_are_none() -> None:
    assert noticed(lambda t: 0.85 * math.sin(8.0 * t)) == math.inf
    assert noticed(lambda t: math.sin(5.0 * t)) == math.inf
    assert noticed(lambda t: math.sin(8.0 * t) if 1.0 < t < 1.9 else 0.0) == math.inf
    assert noticed(lambda _: 1.0) == math.inf


@pytest.mark.parametrize("seed", range(10))
def test_noise_is_none(seed: int) -> None:
    values = 0.25 * np.random.default_rng(seed).normal(size=1800)
    assert noticed(lambda t: float(values[round(t / STEP)]), 60.0) == math.inf


def test_after_a_reset_it_begins_anew() -> None:
    watch = Oscillation(LIMITS)
    answers = [watch.update(math.sin(8.0 * k * STEP), k * STEP) for k in range(60)]
    assert any(answers)
    watch.reset()
    assert watch.swings == 0
    assert not watch.update(1.0, 3.0)
