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
    """Hover with everything well; state and time at the end."""
    state, now = SafetyState(), 0.0
    for _ in range(round(seconds / STEP)):
        now += STEP
        _, state = safety_filter(HOVER, SafetyInputs(now, now - 0.05, now - 0.05, True), state)
    return state, now


def test_nothing_turns_before_it_is_armed_and_sure() -> None:
    assert safety_filter(HOVER, SafetyInputs(1.0, 1.0, 1.0, False), SafetyState())[0] == Command()
    for inputs in (SafetyInputs(1.0, 0.5, 0.5, True), SafetyInputs(1.0, 1.0, -math.inf, True)):
        command, state = safety_filter(HOVER, inputs, SafetyState())
        assert (command, state.phase) == (Command(), "locked")
    command, state = safety_filter(None, SafetyInputs(1.0, 1.0, 1.0, True), SafetyState())
    assert (command, state.phase) == (Command(), "locked")


def test_a_desired_command_within_the_limits_is_flown() -> None:
    state, _ = fly()
    assert (state.phase, state.reason) == ("flying", "")
    assert state.command == Command(*HOVER)


def test_sticks_are_limited_and_change_gradually() -> None:
    state, now = fly()
    inputs = SafetyInputs(now + STEP, now, now, True)
    command, state = safety_filter(DesiredCommand(9.0, -9.0, 9.0, 9.0), inputs, state)
    assert command.roll == pytest.approx(0.1 + LIMITS.max_stick_rate * STEP)
    assert command.pitch == pytest.approx(-0.1 - LIMITS.max_stick_rate * STEP)
    assert command.throttle == pytest.approx(0.5 + LIMITS.max_throttle_rate * STEP)
    for k in range(2, 25):
        inputs = SafetyInputs(now + k * STEP, now + k * STEP, now + k * STEP, True)
        command, state = safety_filter(DesiredCommand(9.0, -9.0, 9.0, 9.0), inputs, state)
    assert command == Command(LIMITS.max_tilt, -LIMITS.max_tilt, LIMITS.max_yaw, LIMITS.max_throttle)
    for k in range(25, 65):
        inputs = SafetyInputs(now + k * STEP, now + k * STEP, now + k * STEP, True)
        command, state = safety_filter(DesiredCommand(-9.0, 9.0, -9.0, -9.0), inputs, state)
    assert command == Command(-LIMITS.max_tilt, LIMITS.max_tilt, -LIMITS.max_yaw, LIMITS.min_throttle)


def test_a_descent_out_of_a_climb_begins_with_no_more_than_what_hovers() -> None:
    for hover, first in ((0.6, 0.6), (0.95, 0.9)):
        state, now = SafetyState(), 0.0
        for _ in range(30):
            now += STEP
            climb = DesiredCommand(0.0, 0.0, 0.0, 0.9)
            _, state = safety_filter(climb, SafetyInputs(now, now, now, True, hover=hover), state)
        assert state.command.throttle == pytest.approx(0.9)
        inputs = SafetyInputs(now + STEP, now + STEP, now + STEP, True, "old pictures", hover=hover)
        command, _ = safety_filter(climb, inputs, state)
        assert command.throttle == pytest.approx(LIMITS.initial_throttle_ratio * first)


@pytest.mark.parametrize(
    ("hover", "highest"),
    [(math.nan, 0.9), (0.3, 0.9), (0.71, 0.9), (0.76, 0.95), (0.97, 1.0), (-1.0, 0.9)],
)
def test_a_weak_vehicle_gets_a_reserve_over_what_hovers(hover: float, highest: float) -> None:
    state, now = fly()
    climb = DesiredCommand(0.0, 0.0, 0.0, 9.0)
    for _ in range(30):
        now += STEP
        command, state = safety_filter(climb, SafetyInputs(now, now, now, True, hover=hover), state)
    assert command.throttle == pytest.approx(highest)


def test_one_that_soon_cannot_carry_itself_lands_for_good() -> None:
    state, now = fly()
    phases = []
    for _ in range(150):
        now += STEP
        hover = 0.99 if state.phase == "flying" else 0.5  # a descent is not called off because it knows better then
        command, state = safety_filter(HOVER, SafetyInputs(now, now, now, True, hover=hover), state)
        phases.append(state.phase)
        if state.phase == "descending":
            assert "hovering takes nearly all of the throttle" in state.reason
            assert command.throttle < HOVER.throttle
    steps = LIMITS.max_hover_time / STEP
    assert steps <= phases.index("descending") <= steps + 1.0
    assert phases[-1] == "cut"
    assert phases.count("descending") * STEP == pytest.approx(LIMITS.descent_duration, abs=2.0 * STEP)


def test_one_that_needs_all_of_the_throttle_for_a_second_lands() -> None:
    state, now = fly()
    phases = []
    for k in range(40):
        now += STEP
        all_but_once = DesiredCommand(0.0, 0.0, 0.0, 0.99 if k == 4 else 1.0)
        _, state = safety_filter(all_but_once, SafetyInputs(now, now, now, True), state)
        phases.append(state.phase)
    steps = LIMITS.max_hover_time / STEP
    assert 5.0 + steps <= phases.index("descending") <= 5.0 + steps + 1.0
    assert "nearly all of the throttle" in state.reason


def test_what_hovers_may_be_too_much_for_a_moment_or_before_it_flies() -> None:
    state, now = SafetyState(), 0.0
    for k in range(300):
        now += STEP
        seen = now if k > 100 else -math.inf
        hover = 0.99 if k <= 100 or k % 30 else 0.97
        _, state = safety_filter(HOVER, SafetyInputs(now, now, seen, True, hover=hover), state)
        assert state.phase == ("flying" if k > 100 else "locked")


def test_a_hidden_ball_is_held_for_a_second_then_it_descends_then_it_is_cut() -> None:
    state, start = fly()
    phases: list[tuple[float, str, Command]] = []
    seen = start - 0.05
    for k in range(1, 140):
        now = start + k * STEP
        command, state = safety_filter(HOVER, SafetyInputs(now, now - 0.05, seen, True), state)
        phases.append((now - seen, state.phase, command))
        assert state.phase != "descending" or "the ball has not been seen" in state.reason
    assert {phase for age, phase, _ in phases if age <= LIMITS.hold_time} == {"holding"}
    assert all(command == Command(*HOVER) for age, _, command in phases if age <= LIMITS.hold_time)
    end = LIMITS.hold_time + LIMITS.descent_duration
    assert {phase for age, phase, _ in phases if LIMITS.hold_time + STEP < age < end} == {"descending"}
    falling = [command.throttle for age, phase, command in phases if phase == "descending"]
    assert all(b < a for a, b in zip([0.5, *falling], falling, strict=False))
    assert {phase for age, phase, _ in phases if age > end + 2 * STEP} == {"cut"}
    assert phases[-1][2] == Command()


def test_without_frames_it_goes_down_within_a_third_of_a_second() -> None:
    state, start = fly()
    frame = start - 0.05
    for k in range(1, 200):
        now = start + k * STEP
        command, state = safety_filter(HOVER, SafetyInputs(now, frame, frame, True), state)
        assert (state.phase in ("descending", "cut")) == (now - frame > LIMITS.max_frame_age)
        if state.phase == "descending":
            assert command.throttle < 0.5
            assert "frame" in state.reason
    assert state.phase == "cut"


def test_frames_that_come_again_must_show_the_ball_for_a_while_until_a_descent_is_called_off() -> None:
    state, start = fly()
    for k in range(1, 20):
        now = start + k * STEP
        _, state = safety_filter(HOVER, SafetyInputs(now, start, start, True), state)
    assert state.phase == "descending"  # the ball is in the last frame, but that is an old one
    back = now + STEP
    while now < back + LIMITS.reacquisition_time + STEP:
        now += STEP
        _, state = safety_filter(HOVER, SafetyInputs(now, now, now, True), state)
        assert (state.phase == "flying") == (now - back >= LIMITS.reacquisition_time)


def test_the_state_tells_since_when_the_ball_is_seen_without_a_gap() -> None:
    state, now = fly()
    assert state.seen_since == STEP
    _, state = safety_filter(HOVER, SafetyInputs(now + STEP, now + STEP, now, True), state)
    assert (state.phase, state.seen_since) == ("holding", math.inf)
    for k in (2, 3):
        _, state = safety_filter(HOVER, SafetyInputs(now + k * STEP, now + k * STEP, now + k * STEP, True), state)
    assert (state.phase, state.seen_since) == ("flying", now + 2 * STEP)


@pytest.mark.parametrize("throttle", [0.25, 0.5, 0.85])
def test_a_descent_lowers_the_throttle_it_began_with_along_a_straight_line(throttle: float) -> None:
    state = SafetyState("flying", "", 0.0, seen_time=0.0, seen_since=0.0, command=Command(throttle=throttle))
    first, last = LIMITS.initial_throttle_ratio, LIMITS.final_throttle_ratio
    for k in range(20):
        now = 0.5 + 0.1 * k
        command, state = safety_filter(HOVER, SafetyInputs(now, 0.0, 0.0, True), state)
        share = 0.1 * k / LIMITS.descent_duration
        assert command.throttle == pytest.approx(throttle * (first + (last - first) * share))


def test_a_descent_is_called_off_once_the_ball_is_surely_seen_again() -> None:
    state, start = fly()
    for k in range(1, 40):
        now = start + k * STEP
        _, state = safety_filter(HOVER, SafetyInputs(now, now, start, True), state)
    assert state.phase == "descending"
    _, state = safety_filter(HOVER, SafetyInputs(now + STEP, now + STEP, now + STEP, True), state)
    assert state.phase == "descending"
    for k in range(2, 6):
        inputs = SafetyInputs(now + k * STEP, now + k * STEP, now + k * STEP, True)
        _, state = safety_filter(HOVER, inputs, state)
    assert state.phase == "flying"


def test_after_the_cut_only_arming_anew_helps() -> None:
    cut = SafetyState("cut", "the ball has not been seen", 1.0)
    command, state = safety_filter(HOVER, SafetyInputs(2.0, 2.0, 2.0, True), cut)
    assert (command, state.phase) == (Command(), "cut")
    _, state = safety_filter(HOVER, SafetyInputs(2.1, 2.1, 2.1, False), state)
    _, state = safety_filter(HOVER, SafetyInputs(2.2, 2.2, 2.2, True), state)
    assert state.phase == "flying"


def test_a_controller_without_an_answer_levels_the_sticks() -> None:
    state, now = fly()
    for k in range(1, 10):
        time = now + k * STEP
        command, state = safety_filter(
            DesiredCommand(math.nan, 0.0, 0.0, 0.5), SafetyInputs(time, time, time, True), state
        )
    assert (command, state.phase) == (Command(throttle=0.5), "holding")


NO_ANSWER = st.none() | st.builds(
    lambda values, broken, where: DesiredCommand(*(broken if k == where else each for k, each in enumerate(values))),
    st.tuples(*[ANYTHING] * 4),
    st.sampled_from((math.nan, math.inf, -math.inf)),
    st.integers(0, 3),
)


@given(st.lists(st.tuples(NO_ANSWER, st.floats(0.001, 0.2)), min_size=5, max_size=400))
def test_a_controller_without_an_answer_is_a_ball_that_is_not_seen(
    calls: list[tuple[DesiredCommand | None, float]],
) -> None:
    state, now = fly()
    answered, descent = now - 0.05, math.inf
    for desired, step in calls:
        now += step
        command, state = safety_filter(desired, SafetyInputs(now, now, now, True), state)
        assert command.throttle <= 0.5
        if now - answered <= LIMITS.hold_time:
            assert state.phase == "holding"
            continue
        descent = min(descent, now)
        assert state.phase == ("descending" if now - descent < LIMITS.descent_duration else "cut")
        assert command.throttle < 0.5
        assert "controller has not answered" in state.reason


@given(st.lists(st.tuples(st.booleans(), st.integers(1, 60)), max_size=12))
def test_it_makes_no_difference_whether_the_ball_or_the_answer_is_missing(runs: list[tuple[bool, int]]) -> None:
    without_ball, now = fly()
    without_answer, seen = without_ball, now - 0.05
    for answered in (answered for answered, length in runs for _ in range(length)):
        now += STEP
        seen = now if answered else seen
        _, without_ball = safety_filter(HOVER, SafetyInputs(now, now, seen, True), without_ball)
        wanted = HOVER if answered else None
        _, without_answer = safety_filter(wanted, SafetyInputs(now, now, now, True), without_answer)
        assert without_answer.phase == without_ball.phase
        assert without_answer.command.throttle <= without_ball.command.throttle  # it cannot undo a called-off descent


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
    state = SafetyState()
    for desired, inputs in calls:
        command, state = safety_filter(desired, inputs, state)  # a Command out of range cannot exist
        assert inputs.armed or command == Command()
        assert abs(command.roll) <= LIMITS.max_tilt
        assert abs(command.pitch) <= LIMITS.max_tilt
        assert command.throttle <= LIMITS.max_throttle
        assert state.phase != "cut" or command == Command()


@pytest.mark.parametrize("field", ["max_tilt", "min_throttle", "max_stick_rate", "max_frame_age"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_limits_that_are_none_are_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        SafetyParameters(**{field: value})


@pytest.mark.parametrize(
    "field",
    [
        "max_tilt",
        "max_yaw",
        "min_throttle",
        "max_throttle",
        "max_hover",
        "initial_throttle_ratio",
        "final_throttle_ratio",
    ],
)
def test_shares_of_a_full_stick_above_1_are_refused(field: str) -> None:
    with pytest.raises(ValueError, match=rf"{field}.*within 0 \.\.\. 1, got 1\.001"):
        SafetyParameters(**{field: 1.001})


@pytest.mark.parametrize("least", [0.6, 0.7])
def test_the_least_throttle_is_below_the_most(least: float) -> None:
    with pytest.raises(ValueError, match="below max_throttle"):
        SafetyParameters(min_throttle=least, max_throttle=0.6)


def test_a_reserve_below_what_hovers_is_refused() -> None:
    with pytest.raises(ValueError, match=r"reserve.*at least 1, got 0\.99"):
        SafetyParameters(throttle_reserve=0.99)


def test_a_descent_never_raises_the_throttle_whatever_the_clock_does() -> None:
    state, now = fly()
    last = state.command.throttle
    for ahead in (0.4, 1.0, 0.5, 1.2, 0.41, 1.9):  # also back in time
        time = now + ahead
        command, state = safety_filter(HOVER, SafetyInputs(time, -math.inf, -math.inf, True), state)
        assert state.phase == "descending"
        assert command.throttle <= last
        last = command.throttle
    _, state = safety_filter(HOVER, SafetyInputs(now - 1.0, -math.inf, -math.inf, True), state)
    assert state.phase == "cut"  # before it began


def test_a_descent_brings_full_sticks_to_neutral_gradually() -> None:
    far = Command(0.8, -0.8, 1.0, 0.5)
    state = SafetyState("flying", "", 0.0, seen_time=0.0, seen_since=0.0, command=far)
    for k in range(1, 6):
        command, state = safety_filter(HOVER, SafetyInputs(k * STEP, -math.inf, 0.0, True), state)
        left = max(0.8 - k * LIMITS.max_stick_rate * STEP, 0.0)
        assert command.roll == pytest.approx(left)
        assert command.pitch == pytest.approx(-left)
        assert command.yaw == pytest.approx(max(1.0 - k * LIMITS.max_stick_rate * STEP, 0.0))


def test_before_it_flies_the_reason_is_the_one_that_holds() -> None:
    state = SafetyState()
    for k in range(1, 60):
        now = k * STEP
        _, state = safety_filter(None, SafetyInputs(now, now, now, True), state)
        assert (state.phase, state.reason) == ("locked", "the controller has no answer")
    _, state = safety_filter(None, SafetyInputs(9.0, 1.0, 1.0, True), state)
    assert "no new frame" in state.reason
    _, state = safety_filter(HOVER, SafetyInputs(9.0, 9.0, 1.0, True), state)
    assert "not been seen" in state.reason


def test_a_clock_that_jumps_ahead_gives_no_jump_of_the_sticks() -> None:
    state, now = fly()
    time = now + 50.0
    command, _ = safety_filter(DesiredCommand(1.0, 0.0, 0.0, 0.9), SafetyInputs(time, time, time, True), state)
    assert command.roll == pytest.approx(min(0.1 + LIMITS.max_stick_rate * LIMITS.max_step, LIMITS.max_tilt))
    assert command.throttle == pytest.approx(0.5 + LIMITS.max_throttle_rate * LIMITS.max_step)


@pytest.mark.parametrize("frame_time", [1000.0, math.nan, math.inf])
def test_a_frame_from_the_future_or_of_no_time_is_no_new_frame(frame_time: float) -> None:
    state, now = fly()
    seen = now + STEP - 0.05
    _, state = safety_filter(HOVER, SafetyInputs(now + STEP, frame_time, seen, True), state)
    assert state.phase == "descending"
    assert "no new frame" in state.reason


def test_the_first_command_after_arming_is_no_jump() -> None:
    """Armed with the ball in sight, as again after a cut: nothing was sent before, so no time has passed for it."""
    limits = SafetyParameters()
    full = DesiredCommand(limits.max_tilt, -limits.max_tilt, limits.max_yaw, limits.max_throttle)
    inputs = SafetyInputs(now=7.0, frame_time=6.9, seen_time=6.9, armed=True)
    command, state = safety_filter(full, inputs, SafetyState())
    assert state.phase == "flying"
    sticks = max(abs(command.roll), abs(command.pitch), abs(command.yaw))
    assert 0.0 < sticks <= limits.max_stick_rate * limits.min_step
    assert 0.0 < command.throttle <= limits.max_throttle_rate * limits.min_step


@pytest.mark.parametrize("seen_time", [1000.0, math.nan, math.inf])
def test_a_ball_seen_in_the_future_or_at_no_time_is_not_seen(seen_time: float) -> None:
    state, now = fly()
    _, state = safety_filter(HOVER, SafetyInputs(now + STEP, now, seen_time, True), state)
    assert state.phase == "descending"
    assert "the ball has not been seen" in state.reason


def test_a_ball_that_is_in_view_but_not_believed_is_not_called_unseen() -> None:
    state, now = fly()
    doubt, seen, reasons = "a ball is seen, but not where the neighbor should be", now, set()
    for k in range(1, 40):
        time = now + k * STEP
        _, state = safety_filter(HOVER, SafetyInputs(time, time, seen, True, doubt=doubt), state)
        reasons.add(state.reason)
    assert state.phase == "descending"
    assert reasons == {doubt, f"{doubt} for {LIMITS.hold_time:g} s"}


def test_what_is_too_near_is_backed_off_from_and_forgotten_when_it_has_gone() -> None:
    state, now = fly()
    for distance, pitch, phase in ((0.4, -LIMITS.back_off, "holding"), (0.6, HOVER.pitch, "flying")):
        for _ in range(15):
            now += STEP
            inputs = SafetyInputs(now, now, now, True, distance=distance)
            command, state = safety_filter(HOVER, inputs, state)
        assert command == Command(HOVER.roll, pitch, HOVER.yaw, HOVER.throttle)
        assert state.phase == phase
        assert state.reason == ("something is nearer than 0.5 m" if phase == "holding" else "")


def test_a_controller_that_goes_back_faster_is_not_held() -> None:
    state, now = fly()
    for _ in range(15):
        now += STEP
        inputs = SafetyInputs(now, now, now, True, distance=0.0)
        command, state = safety_filter(DesiredCommand(0.0, -0.8, 0.0, 0.5), inputs, state)
    assert command.pitch == pytest.approx(-0.8)


def test_one_that_stays_too_near_is_landed_for_good() -> None:
    state, now = fly()
    for _ in range(round((LIMITS.max_near_time + LIMITS.descent_duration + 0.1) / STEP)):
        now += STEP
        _, state = safety_filter(HOVER, SafetyInputs(now, now, now, True, distance=0.4), state)
    assert (state.phase, state.reason) == ("cut", "something was nearer than 0.5 m for 2 s")


def test_it_does_not_start_before_something_too_near() -> None:
    command, state = safety_filter(HOVER, SafetyInputs(1.0, 1.0, 1.0, True, distance=0.3), SafetyState())
    assert (command, state.phase, state.reason) == (Command(), "locked", "something is nearer than 0.5 m")


def test_before_something_near_no_descent_is_called_off() -> None:
    state, now = fly()
    for fault, distance, phase in (("old", math.nan, "descending"), ("", 0.4, "descending"), ("", math.nan, "flying")):
        for _ in range(6):
            now += STEP
            _, state = safety_filter(HOVER, SafetyInputs(now, now, now, True, fault, distance=distance), state)
        assert state.phase == phase


def test_a_landing_from_something_near_goes_on_when_that_has_gone() -> None:
    state, now = fly()
    for distance, seconds in ((0.4, LIMITS.max_near_time + 0.2), (1.5, 0.5)):
        for _ in range(round(seconds / STEP)):
            now += STEP
            _, state = safety_filter(HOVER, SafetyInputs(now, now, now, True, distance=distance), state)
        assert state.phase == "descending"


def test_on_the_ground_it_waits_for_what_is_near_to_go() -> None:
    state, now = SafetyState(), 0.0
    for _ in range(round((LIMITS.max_near_time + 0.5) / STEP)):
        now += STEP
        _, state = safety_filter(HOVER, SafetyInputs(now, now, now, True, distance=0.4), state)
    assert (state.phase, state.reason) == ("locked", "something is nearer than 0.5 m")
    _, state = safety_filter(HOVER, SafetyInputs(now + STEP, now + STEP, now + STEP, True, distance=1.5), state)
    assert state.phase == "flying"
