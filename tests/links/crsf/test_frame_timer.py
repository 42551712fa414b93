"""Frames leave at a fixed rate and follow the module's timing, also that of a module whose clock is another one."""

import math
import random

import pytest

from matchset.links.crsf.frame_timer import FrameTimer


def timer(period: float = 0.004, step: float = 0.1) -> FrameTimer:
    return FrameTimer(period, 0.002, 0.04, step, 0.0)


def test_frames_are_due_one_period_after_the_other() -> None:
    one = timer()
    times: list[float] = []
    now = 0.0
    while len(times) < 100:
        now += 0.0001
        if now >= one.due:
            times.append(now)
            one.sent(now)
    assert max(abs(when - 0.004 * k) for k, when in enumerate(times)) < 0.0002


def test_what_was_missed_is_not_sent_in_a_burst() -> None:
    one = timer()
    one.sent(0.0)
    one.sent(1.0)
    assert one.due == pytest.approx(1.004)


@pytest.mark.parametrize(("wanted", "period"), [(0.004, 0.004), (0.02, 0.02), (0.001, 0.002), (1 / 1500, 0.002)])
def test_the_period_becomes_the_module_s_or_a_multiple(wanted: float, period: float) -> None:
    one = timer()
    one.correct(wanted, 0.0)
    assert one.period == pytest.approx(period)


@pytest.mark.parametrize("interval", [0.0, -0.004, 0.05, math.inf, math.nan])
def test_timing_without_sense_changes_nothing(interval: float) -> None:
    one = timer()
    one.correct(interval, 0.001)
    assert (one.period, one.lag) == (0.004, 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_frames_come_in_time_for_a_module_with_another_clock(seed: int) -> None:
    rng = random.Random(seed)
    one = timer()
    interval, phase, margin = 0.004 * (1.0 + rng.uniform(-2e-3, 2e-3)), rng.uniform(0.0, 0.004), 0.0005
    early, told = [], 0.0
    for _ in range(5000):
        now = one.due + abs(rng.gauss(0.0, 5e-5))
        slot = phase + math.ceil((now - phase) / interval) * interval
        early.append(slot - now - margin)  # the module transmits in its next slot
        one.sent(now)
        if now - told > 0.2:
            told = now
            one.correct(interval, early[-1])
    assert max(abs(each) for each in early[500:]) < 0.0004


def test_a_step_is_no_larger_than_its_share() -> None:
    one = timer()
    one.correct(0.004, 0.0019)
    before = one.due
    one.sent(0.0)
    assert one.due - before == pytest.approx(0.0044)
