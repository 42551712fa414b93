"""The safety filter in every state that it can reach: states, inputs and timers on a grid of a tenth of a second.

Times are kept relative to the last command, what is older than any limit counts as just as old, and of the words only
whether there are any, so the states are finite. Every input leads from every state; what must never happen is looked
for in each of these steps.
"""

import functools
import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

import pytest

from matchset.control.command import Command
from matchset.control.safety import DesiredCommand, SafetyInputs, SafetyParameters, SafetyState, safety_filter
from walks import walk_all

STEP = 0.1
LIMITS = SafetyParameters(
    max_frame_age=0.15,
    hold_time=0.25,
    reacquisition_time=0.15,
    descent_duration=0.25,
    max_yaw=0.8,
    min_throttle=0.4,
    max_throttle=0.8,
    max_throttle_rate=4.0,
    max_near_time=0.35,
)
OLD = 0.4  # s: older than every limit
TINY = 1e-9
HOLDS = 0.5  # throttle that stands still where speeds are told
NOTHING = Command()
DESIRED = (
    None,
    DesiredCommand(math.nan, 0.0, 0.0, 0.9),
    DesiredCommand(9.0, -9.0, 9.0, 9.0),
    DesiredCommand(-9.0, 9.0, -9.0, -9.0),
)


class Situation(NamedTuple):
    """Everything that decides what happens next; times relative to the last command, s."""

    frame_time: float = -math.inf
    seen_time: float = -math.inf
    state: SafetyState = SafetyState()


class Happening(NamedTuple):
    """What one step brings."""

    picture: str
    desired: DesiredCommand | None
    armed: bool
    fault: str
    distance: float = math.nan


class Taken(NamedTuple):
    """One step of the walk."""

    before: Situation
    happening: Happening
    command: Command
    after: Situation
    frame_age: float
    seen_age: float
    near_age: float


PICTURES, FAULTS, DISTANCES = ("ball", "no ball", "none"), ("", "the picture stands still"), (math.nan, 0.4)
ARMED = [Happening(*each) for each in itertools.product(PICTURES, DESIRED, (True,), FAULTS, DISTANCES)]
DISARMED = [Happening(each, DESIRED[k], False, FAULTS[k % 2], DISTANCES[k // 2]) for each in PICTURES for k in range(4)]
HAPPENINGS = [*ARMED, *DISARMED]  # disarmed every input occurs, but not every combination: nothing comes of any


def shifted(time: float, by: float) -> float:
    """Return a time relative to a later moment; what is very old is `OLD`."""
    return time if math.isinf(time) else max(round(time - by, 6), -OLD)


@functools.cache
def rounded(command: Command) -> Command:
    """Return a command with its throttle on a grid: a descent multiplies, so there would be no end of values."""
    return Command(command.roll, command.pitch, command.yaw, round(command.throttle, 1))


def step(before: Situation, happening: Happening, holds: float = math.nan) -> Taken:
    """Take one step, `STEP` after the last."""
    now = STEP
    frame_time = before.frame_time if happening.picture == "none" else now
    seen_time = now if happening.picture == "ball" else before.seen_time
    inputs = SafetyInputs(
        now, frame_time, seen_time, happening.armed, happening.fault, distance=happening.distance, hold_throttle=holds
    )
    command, state = safety_filter(happening.desired, inputs, before.state, LIMITS)
    state = SafetyState(
        state.phase,
        state.reason and "why",
        shifted(state.time, now),
        shifted(state.descent_start, now),
        shifted(state.seen_time, now),
        shifted(state.seen_since, now),
        round(state.initial_throttle, 1),
        rounded(state.command),
        math.inf,  # an empty battery has tests of its own
        shifted(state.near_since, now),
    )
    after = Situation(shifted(frame_time, now), shifted(seen_time, now), state)
    near_age = now - before.state.near_since if is_near(happening) else 0.0
    return Taken(before, happening, command, after, now - frame_time, now - seen_time, near_age)


def is_near(happening: Happening) -> bool:
    """Whether something is too near."""
    return happening.distance < LIMITS.min_distance


@functools.cache
def walk() -> list[Taken]:
    """Every step from every situation that can be reached."""
    return walk_all(Situation(), HAPPENINGS, step)


@functools.cache
def walk_of_speeds() -> list[Taken]:
    """The same of a vehicle that is told speeds."""
    return walk_all(Situation(), HAPPENINGS, functools.partial(step, holds=HOLDS))


@functools.cache
def steps_to_standstill(situation: Situation, happening: Happening, holds: float = math.nan) -> int:
    """How many steps of the same kind it takes until the motors are off."""
    taken = step(situation, happening, holds)
    if taken.command == NOTHING and taken.after.state.phase in ("cut", "locked"):
        return 1
    return 1 + steps_to_standstill(taken.after, happening, holds)


@pytest.fixture(scope="module", autouse=True)
def forgotten() -> Iterator[None]:
    """Forget the steps at the end: Python's garbage collection would look at them all, again and again."""
    yield
    for each in (walk, walk_of_speeds, steps_to_standstill):
        each.cache_clear()


def test_the_walk_sees_every_phase_in_every_neighborhood() -> None:
    pairs = {(each.before.state.phase, each.after.state.phase) for each in walk()}
    armed = {
        ("locked", "locked"),
        ("locked", "flying"),
        ("flying", "flying"),
        ("flying", "holding"),
        ("flying", "descending"),
        ("holding", "flying"),
        ("holding", "holding"),
        ("holding", "descending"),
        ("descending", "descending"),
        ("descending", "flying"),
        ("descending", "cut"),
        ("cut", "cut"),
    }
    disarmed = {(phase, "locked") for phase in ("locked", "flying", "holding", "descending", "cut")}
    assert pairs == armed | disarmed
    assert len({each.before for each in walk()}) > 1000


def test_no_throttle_while_disarmed() -> None:
    for each in walk():
        if not each.happening.armed or each.after.state.phase in ("locked", "cut"):
            assert each.command == NOTHING
            assert each.happening.armed or each.after.state.phase == "locked"


def test_motors_start_only_with_the_ball_in_sight_and_an_answer() -> None:
    for each in walk():
        if each.before.state.phase == "locked" and each.command != NOTHING:
            assert each.happening.armed
            assert not each.happening.fault
            assert each.seen_age == each.frame_age <= LIMITS.max_frame_age
            assert not is_near(each.happening)
            assert each.happening.desired is not None
            assert all(map(math.isfinite, each.happening.desired))
            assert each.command.throttle <= LIMITS.max_throttle_rate * LIMITS.max_step + TINY


def test_it_never_arms_again_by_itself() -> None:
    for each in walk():
        if each.before.state.phase == "cut" and each.happening.armed:
            assert each.command == NOTHING
            assert each.after.state.phase == "cut"


def test_a_descent_never_raises_the_throttle_and_levels_the_sticks() -> None:
    for each in walk():
        if each.after.state.phase == "descending":
            last = each.before.state.command
            assert each.command.throttle <= last.throttle
            if each.before.state.phase != "descending":
                assert each.command.throttle < last.throttle or last.throttle == 0.0
            for name in ("roll", "pitch", "yaw"):
                assert abs(getattr(each.command, name)) <= abs(getattr(last, name))


def test_every_way_into_a_descent_has_its_reason() -> None:
    for each in walk():
        down = each.after.state.phase in ("descending", "cut")
        if down and each.before.state.phase in ("flying", "holding"):
            state = each.after.state
            unanswered = -shifted(state.seen_time, 0.0)
            assert (
                each.happening.fault
                or each.frame_age > LIMITS.max_frame_age
                or each.seen_age > LIMITS.hold_time
                or unanswered > LIMITS.hold_time
                or each.near_age >= LIMITS.max_near_time
            )
            assert state.reason
        assert (each.after.state.phase == "flying") == (not each.after.state.reason)


def test_the_caps_on_a_step_of_the_sticks_hold() -> None:
    change, rise = LIMITS.max_stick_rate * STEP + TINY, LIMITS.max_throttle_rate * STEP + TINY
    for each in walk():
        if each.after.state.phase in ("locked", "cut"):
            continue
        last = each.before.state.command
        for name in ("roll", "pitch", "yaw"):
            assert abs(getattr(each.command, name) - getattr(last, name)) <= change
        assert abs(each.command.throttle - last.throttle) <= rise
        assert max(abs(each.command.roll), abs(each.command.pitch)) <= LIMITS.max_tilt
        assert abs(each.command.yaw) <= LIMITS.max_yaw
        assert each.command.throttle <= LIMITS.max_throttle


def test_it_flies_only_by_new_pictures_with_an_answer() -> None:
    for each in walk():
        if each.after.state.phase in ("flying", "holding"):
            assert not each.happening.fault
            assert each.frame_age <= LIMITS.max_frame_age
            assert -each.after.state.seen_time <= LIMITS.hold_time
        if each.before.state.phase == "descending" and each.after.state.phase == "flying":
            assert each.frame_age == each.seen_age


def test_whatever_is_too_near_is_backed_off_from_as_fast_as_the_sticks_may() -> None:
    flown = [each for each in walk() if is_near(each.happening) and each.after.state.phase in ("flying", "holding")]
    assert flown
    for each in flown:
        assert each.after.state.phase == "holding"
        last, change = each.before.state.command.pitch, LIMITS.max_stick_rate * STEP
        assert each.command.pitch <= max(-LIMITS.back_off, last - change) + TINY


def test_nothing_too_near_for_long_is_flown_beside() -> None:
    for each in walk():
        if each.near_age >= LIMITS.max_near_time:
            assert each.after.state.phase in ("locked", "descending", "cut")


@pytest.mark.parametrize(
    ("happening", "limit"),
    [
        (Happening("none", DESIRED[2], True, ""), LIMITS.max_frame_age),
        (Happening("none", None, True, ""), LIMITS.max_frame_age),
        (Happening("no ball", DESIRED[2], True, ""), LIMITS.hold_time),
        (Happening("ball", None, True, ""), LIMITS.hold_time),
        (Happening("ball", DESIRED[1], True, ""), LIMITS.hold_time),
        (Happening("ball", DESIRED[2], True, "the picture stands still"), 0.0),
        (Happening("ball", DESIRED[2], False, ""), -LIMITS.descent_duration),
        (Happening("ball", DESIRED[2], True, "", 0.4), LIMITS.max_near_time),
        (Happening("no ball", None, True, "", 0.0), LIMITS.hold_time),
    ],
)
def test_from_everywhere_silence_ends_in_motors_off_in_time(happening: Happening, limit: float) -> None:
    longest = max(steps_to_standstill(situation, happening) for situation in {each.before for each in walk()})
    assert STEP * longest <= limit + LIMITS.descent_duration + 2.0 * STEP


def test_one_that_is_told_speeds_stands_still_without_an_answer() -> None:
    flown = [each for each in walk_of_speeds() if each.after.state.phase in ("flying", "holding")]
    unanswered = [
        each for each in flown if each.happening.desired is None or not all(map(math.isfinite, each.happening.desired))
    ]
    assert unanswered
    for each in unanswered:
        last, change = each.before.state.command.throttle, LIMITS.max_throttle_rate * STEP
        assert abs(each.command.throttle - HOLDS) <= max(abs(last - HOLDS) - change, 0.0) + TINY


def test_a_descent_of_one_that_is_told_speeds_never_climbs_and_sinks_no_faster_than_it_did_or_is_to() -> None:
    slowest = LIMITS.final_throttle_ratio * HOLDS
    descents = [each for each in walk_of_speeds() if each.after.state.phase == "descending"]
    assert descents
    for each in descents:
        last = each.before.state.command
        assert each.command.throttle <= min(last.throttle, HOLDS)
        assert each.command.throttle >= min(last.throttle, slowest) - TINY
        for name in ("roll", "pitch", "yaw"):
            assert abs(getattr(each.command, name)) <= abs(getattr(last, name))


@pytest.mark.parametrize(
    ("happening", "limit"),
    [
        (Happening("none", DESIRED[2], True, ""), LIMITS.max_frame_age),
        (Happening("no ball", DESIRED[3], True, ""), LIMITS.hold_time),
        (Happening("ball", None, True, ""), LIMITS.hold_time),
        (Happening("ball", DESIRED[2], True, "the picture stands still"), 0.0),
    ],
)
def test_from_everywhere_one_that_is_told_speeds_lands_in_time(happening: Happening, limit: float) -> None:
    situations = {each.before for each in walk_of_speeds()}
    longest = max(steps_to_standstill(situation, happening, HOLDS) for situation in situations)
    assert STEP * longest <= limit + LIMITS.descent_duration + 2.0 * STEP
