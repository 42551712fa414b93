import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.command import Command
from matchset.control.safety import DesiredCommand, SafetyInputs, SafetyParameters, SafetyState, safety_filter

LIMITS = SafetyParameters()
STEP = 1.0 / 30.0
HOVER = DesiredCommand(0.1, -0.1, 0.0, 0.5)
ANYTHING = st.floats(allow_nan=True, allow_infinity=True)
TIMES = st.one_of(ANYTHING, st.floats(-5.0, 5.0))


def fly(seconds: float = 1.0) -> tuple[SafetyState, float]:
    """Hover with everything well; memory and time at the end."""
    memory, now = SafetyState(), 0.0
    for _ in range(round(seconds / STEP)):
        now += STEP
        _, memory = safety_filter(HOVER, SafetyInputs(now, now - 0.05, now - 0.05, True), memory)
    return memory, now


def test_nothing_turns_before_it_is_armed_and_sure() -> None:
    assert safety_filter(HOVER, SafetyInputs(1.0, 1.0, 1.0, False), SafetyState())[0] == Command()
    for facts in (SafetyInputs(1.0, 0.5, 0.5, True), SafetyInputs(1.0, 1.0, -math.inf, True)):
        command, memory = safety_filter(HOVER, facts, SafetyState())
        assert (command, memory.phase) == (Command(), "locked")
    command, memory = safety_filter(None, SafetyInputs(1.0, 1.0, 1.0, True), SafetyState())
    assert (command, memory.phase) == (Command(), "locked")


def test_a_wish_within_the_limits_is_flown() -> None:
    memory, _ = fly()
    assert (memory.phase, memory.reason) == ("flying", "")
    assert memory.command == Command(*HOVER)


def test_sticks_are_limited_and_change_gradually() -> None:
    memory, now = fly()
    facts = SafetyInputs(now + STEP, now, now, True)
    command, memory = safety_filter(DesiredCommand(9.0, -9.0, 9.0, 9.0), facts, memory)
    assert command.roll == pytest.approx(0.1 + LIMITS.slew * STEP)
    assert command.pitch == pytest.approx(-0.1 - LIMITS.slew * STEP)
    assert command.throttle == pytest.approx(0.5 + LIMITS.throttle_slew * STEP)
    for k in range(2, 40):
        facts = SafetyInputs(now + k * STEP, now + k * STEP, now + k * STEP, True)
        command, memory = safety_filter(DesiredCommand(9.0, -9.0, 9.0, 9.0), facts, memory)
    assert command == Command(LIMITS.tilt, -LIMITS.tilt, LIMITS.yaw, LIMITS.most_throttle)


def test_a_hidden_ball_is_held_for_a_second_then_it_descends_then_it_is_cut() -> None:
    memory, start = fly()
    phases: list[tuple[float, str, Command]] = []
    seen = start - 0.05
    for k in range(1, 140):
        now = start + k * STEP
        command, memory = safety_filter(HOVER, SafetyInputs(now, now - 0.05, seen, True), memory)
        phases.append((now - seen, memory.phase, command))
    assert {phase for age, phase, _ in phases if age <= LIMITS.hold} == {"holding"}
    assert all(command == Command(*HOVER) for age, _, command in phases if age <= LIMITS.hold)
    end = LIMITS.hold + LIMITS.descent
    assert {phase for age, phase, _ in phases if LIMITS.hold + STEP < age < end} == {"descending"}
    falling = [command.throttle for age, phase, command in phases if phase == "descending"]
    assert all(b < a for a, b in zip([0.5, *falling], falling, strict=False))
    assert {phase for age, phase, _ in phases if age > end + 2 * STEP} == {"cut"}
    assert phases[-1][2] == Command()


def test_without_frames_it_goes_down_within_a_third_of_a_second() -> None:
    memory, start = fly()
    frame = start - 0.05
    for k in range(1, 200):
        now = start + k * STEP
        command, memory = safety_filter(HOVER, SafetyInputs(now, frame, frame, True), memory)
        assert (memory.phase in ("descending", "cut")) == (now - frame > LIMITS.fresh)
        if memory.phase == "descending":
            assert command.throttle < 0.5
            assert "frame" in memory.reason
    assert memory.phase == "cut"


def test_a_descent_is_called_off_once_the_ball_is_surely_seen_again() -> None:
    memory, start = fly()
    for k in range(1, 40):
        now = start + k * STEP
        _, memory = safety_filter(HOVER, SafetyInputs(now, now, start, True), memory)
    assert memory.phase == "descending"
    _, memory = safety_filter(HOVER, SafetyInputs(now + STEP, now + STEP, now + STEP, True), memory)
    assert memory.phase == "descending"
    for k in range(2, 6):
        facts = SafetyInputs(now + k * STEP, now + k * STEP, now + k * STEP, True)
        _, memory = safety_filter(HOVER, facts, memory)
    assert memory.phase == "flying"


def test_after_the_cut_only_arming_anew_helps() -> None:
    cut = SafetyState("cut", "the ball has not been seen", 1.0)
    command, memory = safety_filter(HOVER, SafetyInputs(2.0, 2.0, 2.0, True), cut)
    assert (command, memory.phase) == (Command(), "cut")
    _, memory = safety_filter(HOVER, SafetyInputs(2.1, 2.1, 2.1, False), memory)
    _, memory = safety_filter(HOVER, SafetyInputs(2.2, 2.2, 2.2, True), memory)
    assert memory.phase == "flying"


def test_a_controller_without_an_answer_levels_the_sticks() -> None:
    memory, now = fly()
    for k in range(1, 10):
        time = now + k * STEP
        command, memory = safety_filter(
            DesiredCommand(math.nan, 0.0, 0.0, 0.5), SafetyInputs(time, time, time, True), memory
        )
    assert (command, memory.phase) == (Command(throttle=0.5), "holding")


@given(
    st.lists(
        st.tuples(
            st.none() | st.builds(DesiredCommand, *[ANYTHING] * 4),
            st.builds(SafetyInputs, TIMES, TIMES, TIMES, st.booleans()),
        ),
        max_size=30,
    )
)
def test_whatever_happens_what_is_sent_is_finite_and_in_range(
    calls: list[tuple[DesiredCommand | None, SafetyInputs]],
) -> None:
    memory = SafetyState()
    for wish, facts in calls:
        command, memory = safety_filter(wish, facts, memory)  # a Command out of range cannot exist
        assert facts.armed or command == Command()
        assert abs(command.roll) <= LIMITS.tilt
        assert abs(command.pitch) <= LIMITS.tilt
        assert command.throttle <= LIMITS.most_throttle
        assert memory.phase != "cut" or command == Command()


@pytest.mark.parametrize("field", ["tilt", "least_throttle", "slew", "fresh"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_limits_that_are_none_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        SafetyParameters(**{field: value})
