import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.pid import Pid, PidParameters

STEP = 0.02


def test_the_terms_are_those_of_the_equation() -> None:
    pid = Pid(PidParameters(proportional=2.0, integral=0.5, derivative=0.1))
    pid.update(1.0, 0.0, STEP)
    output = pid.update(1.0, 0.3, STEP)
    assert pid.terms.proportional == pytest.approx(2.0 * 0.7)
    assert pid.terms.integral == pytest.approx(0.5 * STEP * 1.7)
    assert pid.terms.derivative == pytest.approx(-0.1 * 0.3 / STEP)
    assert output == pid.terms.output == pytest.approx(sum(pid.terms[:3]))


def test_a_new_goal_does_not_kick() -> None:
    pid = Pid(PidParameters(proportional=1.0, derivative=10.0))
    pid.update(0.0, 0.0, STEP)
    assert pid.update(1.0, 0.0, STEP) == 1.0


def test_the_derivative_is_low_passed() -> None:
    pid = Pid(PidParameters(proportional=0.0, derivative=1.0, derivative_filter_time=0.1))
    pid.update(0.0, 0.0, STEP)
    for k in range(1, 26):
        pid.update(0.0, k * STEP, STEP)
    assert -1.0 < pid.terms.derivative < -0.95
    assert Pid(PidParameters(proportional=0.0, derivative=1.0)).update(0.0, 0.0, STEP, rate=0.4) == -0.4


def test_the_integral_does_not_wind_up_at_the_limit() -> None:
    pid = Pid(PidParameters(proportional=1.0, integral=1.0, output_limit=0.5))
    for _ in range(500):
        assert pid.update(10.0, 0.0, STEP) == 0.5
    assert pid.terms.integral == 0.0
    assert pid.update(0.0, 1.0, STEP) == -0.5
    assert pid.update(0.0, 0.1, STEP) < 0.0


def test_a_constant_disturbance_is_forgotten() -> None:
    pid = Pid(PidParameters(proportional=4.0, integral=2.0, derivative=3.0, integral_limit=2.0))
    place, speed = 0.5, 0.0
    for _ in range(1500):
        speed += (pid.update(0.0, place, STEP, speed) + 0.7) * STEP
        place += speed * STEP
    assert abs(place) < 1e-3
    assert pid.terms.integral == pytest.approx(-0.7, abs=1e-2)
    pid.reset(keep_integral=True)
    assert pid.terms.integral == pytest.approx(-0.7, abs=1e-2)


def test_the_integral_learns_fast_at_first() -> None:
    pid = Pid(PidParameters(proportional=0.0, integral=1.0, integral_decay_time=1.0, integral_floor=0.2))
    terms = []
    for _ in range(round(6.0 / STEP)):
        pid.update(1.0, 0.0, STEP)
        terms.append(pid.terms.integral)
    first, last = round(1.0 / STEP), round(5.0 / STEP)
    assert terms[first - 1] == pytest.approx(1.0 - math.exp(-1.0), abs=0.02)
    assert terms[-1] - terms[last - 1] == pytest.approx(0.2, abs=1e-6)


def test_what_was_learned_before_a_reset_does_not_slow_what_comes_after() -> None:
    pid, fresh = (Pid(PidParameters(proportional=0.0, integral=1.0, integral_decay_time=0.5)) for _ in range(2))
    for _ in range(100):
        pid.update(1.0, 0.0, STEP)
    pid.reset()
    assert pid.update(1.0, 0.0, STEP) == fresh.update(1.0, 0.0, STEP)


@given(st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 2, st.floats(1e-4, 1.0)), max_size=30))
def test_the_output_stays_within_its_limit(calls: list[tuple[float, float, float]]) -> None:
    pid = Pid(PidParameters(proportional=3.0, integral=2.0, derivative=1.0, output_limit=0.7, integral_limit=0.2))
    for goal, measured, step in calls:
        assert abs(pid.update(goal, measured, step)) <= 0.7
        assert abs(pid.terms.integral) <= 0.2


@pytest.mark.parametrize("bad", [(math.nan, 0.0, STEP), (0.0, math.inf, STEP), (0.0, 0.0, 0.0), (0.0, 0.0, math.nan)])
def test_what_is_no_number_is_refused(bad: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="needs numbers"):
        Pid(PidParameters(proportional=1.0)).update(*bad)


def test_gains_that_are_none_are_refused() -> None:
    with pytest.raises(ValueError, match="derivative_filter_time"):
        PidParameters(proportional=1.0, derivative_filter_time=-1.0)
    with pytest.raises(ValueError, match="integral_limit"):
        PidParameters(proportional=1.0, integral_limit=0.0)


def test_far_off_the_integral_stands_still() -> None:
    pid = Pid(PidParameters(proportional=1.0, integral=1.0, integral_zone=0.2))
    for _ in range(10):
        pid.update(1.0, 0.0, 0.1)
    assert pid.terms.integral == 0.0
    pid.update(0.1, 0.0, 0.1)
    assert pid.terms.integral > 0.0


def test_a_far_goal_is_approached_no_faster_than_the_largest_error_says() -> None:
    pid, place, speed, fastest = Pid(PidParameters(proportional=5.0, derivative=3.0, max_error=0.25)), 0.0, 0.0, 0.0
    for _ in range(400):
        speed += STEP * pid.update(3.0, place, STEP, speed)
        place += STEP * speed
        fastest = max(fastest, speed)
    assert fastest <= 5.0 * 0.25 / 3.0 + 1e-9
    assert place == pytest.approx(3.0, abs=0.02)


def test_an_approach_as_the_gains_want_it_adds_nothing_to_the_integral() -> None:
    """With the lead D/P: at y' = -y the predicted error is zero; a standing error is added up in full."""
    pid = Pid(PidParameters(proportional=2.0, integral=1.0, derivative=2.0, integral_lead=1.0))
    for position in (1.0, 0.9, 0.8):
        pid.update(0.0, position, 0.1, rate=-position)
        assert pid.terms.integral == pytest.approx(0.0, abs=1e-12)
    pid.update(0.0, 0.8, 0.1, rate=0.0)
    assert pid.terms.integral == pytest.approx(-0.08)
    pid.update(0.0, 0.8, 0.1, rate=0.4)  # away from the goal: more than the error alone
    assert pid.terms.integral == pytest.approx(-0.08 - 0.12)


def test_at_the_limit_against_the_error_the_integral_goes_on() -> None:
    pid = Pid(PidParameters(proportional=1.0, integral=1.0, derivative=10.0, output_limit=0.5))
    assert pid.update(1.0, 0.5, 0.1, rate=1.0) == -0.5  # braking, with half the way to go
    assert pid.terms.integral == pytest.approx(0.5 * 0.1)


def test_the_first_rate_counts_in_full_however_slow_the_filter() -> None:
    pid = Pid(PidParameters(proportional=0.0, derivative=1.0, derivative_filter_time=5.0))
    assert pid.update(0.0, 0.0, STEP, rate=0.4) == -0.4
    assert pid.update(0.0, 0.0, STEP, rate=-0.4) == pytest.approx(-0.4, abs=0.01)
    pid.reset()
    assert pid.update(0.0, 0.0, STEP, rate=-0.4) == 0.4


def test_an_integral_that_is_kept_goes_on_learning_as_slowly_as_before() -> None:
    kept, steady = (Pid(PidParameters(proportional=0.0, integral=1.0, integral_decay_time=0.5)) for _ in range(2))
    for pid in (kept, steady):
        for _ in range(100):
            pid.update(1.0, 0.0, STEP)
    kept.reset(keep_integral=True)
    assert kept.update(1.0, 0.0, STEP) == steady.update(1.0, 0.0, STEP)


@pytest.mark.parametrize("keep_integral", [False, True])
def test_a_jump_of_the_measurement_over_a_reset_is_no_speed(keep_integral: bool) -> None:
    pid = Pid(PidParameters(proportional=0.0, derivative=1.0))
    pid.update(0.0, 0.0, STEP)
    pid.reset(keep_integral)
    assert pid.update(0.0, 5.0, STEP) == 0.0
    assert pid.update(0.0, 6.0, STEP) == pytest.approx(-1.0 / STEP)


@pytest.mark.parametrize("rate", [math.nan, math.inf, -math.inf])
def test_a_rate_that_is_no_number_is_refused(rate: float) -> None:
    with pytest.raises(ValueError, match="got rate"):
        Pid(PidParameters(proportional=1.0)).update(0.0, 0.0, STEP, rate)
