"""The firmware's pilot walked through every state that it can reach: states, inputs and timers, none left out.

From the two starts every input is tried in every state, until no new state appears. Ages count up to the failsafe and
one more: the code compares an age with two limits and cannot tell later ones apart (a test of its own). Sticks are
neutral here; `test_emu_jumps.py` has them. Then the whole firmware, bytes in and packets and status
frames out, plays every sequence of some events (`host_walk.c`).
"""

import ctypes
import os
import subprocess
from collections.abc import Callable, Iterator

import pytest
import toolchain
from firmware_in_c import STATES, Pilot, hear, library
from hypothesis import given
from hypothesis import strategies as st

LENGTH = int(os.environ.get("MATCHSET_WALK_EVENTS", "4"))  # 5: make fuzz
BINDING, LOCKED, ARMED, HOLDING, FAILSAFE = range(5)
NEUTRAL_TICKS, FAILSAFE_TICKS, BIND_PACKETS, LOWS = 26, 61, 345, 3  # pilot.h
ARM = {"low": 172, "middle": 992, "high": 1811}
THROTTLE = {"zero": 172, "little": 300, "full": 1811}
Input = tuple[str, ...]
INPUTS: list[Input] = [
    *[("frame", arm, throttle) for arm in ARM for throttle in THROTTLE],
    ("tick",),
    ("bind",),
    ("bind packet",),
]
Step = tuple[Pilot, Input, Pilot]


def key(pilot: Pilot) -> tuple[int, ...]:
    heard, before, flown = pilot.heard, pilot.before, pilot.flown
    return (
        pilot.state,
        pilot.low_frames,
        pilot.age,
        pilot.bind_left if pilot.state == BINDING else 0,
        heard.throttle,
        before.throttle,
        flown.throttle if pilot.state in (ARMED, HOLDING) else 0,
    )


def act(pilot: Pilot, how: Input) -> Pilot:
    after = Pilot.from_buffer_copy(pilot)
    if how[0] == "frame":
        values = [992, 992, THROTTLE[how[2]], 992, ARM[how[1]], 172, 172, *[992] * 9]
        hear(after, values)
    else:
        functions: dict[str, Callable[..., object]] = {
            "tick": library().pilot_tick,
            "bind": library().pilot_bind,
            "bind packet": library().pilot_bind_packet,
        }
        functions[how[0]](ctypes.byref(after))
    after.age = min(after.age, FAILSAFE_TICKS + 1)
    return after


def throttle(pilot: Pilot) -> int:
    return int(library().pilot_sticks(ctypes.byref(pilot)).throttle)


def start(bind: bool, in_flight: bool) -> Pilot:
    pilot = Pilot()
    library().pilot_begin(ctypes.byref(pilot), bind, in_flight)
    pilot.age = min(pilot.age, FAILSAFE_TICKS + 1)
    return pilot


def walk() -> Iterator[Step]:
    """Every step from every state; binding is entered with 3 packets left, the rest of them are alike."""
    begin = [start(False, False), start(False, True), start(True, False)]
    waiting = {key(pilot): pilot for pilot in begin}
    seen = set(waiting)
    while waiting:
        _, before = waiting.popitem()
        if before.state == BINDING and before.bind_left > 3:
            before = Pilot.from_buffer_copy(before)
            before.bind_left = 3
        for how in INPUTS:
            after = act(before, how)
            yield before, how, after
            if key(after) not in seen:
                seen.add(key(after))
                waiting[key(after)] = after


@pytest.fixture(scope="module")
def steps() -> list[Step]:
    return list(walk())


def test_the_walk_is_complete(steps: list[Step]) -> None:
    assert {before.state for before, _, _ in steps} == set(range(5))
    assert {how for _, how, _ in steps} == set(INPUTS)
    assert {(before.state, before.age) for before, _, _ in steps} >= {
        *[(ARMED, age) for age in range(NEUTRAL_TICKS)],
        *[(HOLDING, age) for age in range(NEUTRAL_TICKS, FAILSAFE_TICKS)],
        *[(state, age) for state in (BINDING, LOCKED, FAILSAFE) for age in range(FAILSAFE_TICKS + 2)],
    }
    assert len(steps) > 50_000


def test_no_throttle_while_disarmed(steps: list[Step]) -> None:
    for before, how, after in steps:
        if after.state not in (ARMED, HOLDING):
            sticks = library().pilot_sticks(ctypes.byref(after))
            assert bytes(sticks) == bytes(6), (STATES[before.state], how)
            assert not library().pilot_flying(ctypes.byref(after))


def test_it_arms_by_nothing_but_arm_high_after_three_frames_low_all_with_throttle_zero(steps: list[Step]) -> None:
    for before, how, after in steps:
        if before.state not in (ARMED, HOLDING) and after.state in (ARMED, HOLDING):
            assert how == ("frame", "high", "zero")
            assert (before.state, before.low_frames) == (LOCKED, LOWS)
            assert before.age < FAILSAFE_TICKS
            assert (after.state, throttle(after)) == (ARMED, 0)
        if after.low_frames > before.low_frames:
            assert how == ("frame", "low", "zero")
            assert after.low_frames == before.low_frames + 1 <= LOWS
            assert after.state == LOCKED
        if how[0] == "frame" and how[1:] != ("low", "zero"):
            assert after.low_frames == 0 or after.state == ARMED != before.state
        if before.state in (ARMED, HOLDING) and how[0] == "frame":
            assert after.low_frames == 0  # the frame that disarms does not prepare arming


def test_silence_ends_in_motors_off_in_time_and_for_good(steps: list[Step]) -> None:
    for before, how, after in steps:
        flying = after.state in (ARMED, HOLDING)
        assert not flying or after.age < FAILSAFE_TICKS
        assert after.state != ARMED or after.age < NEUTRAL_TICKS
        assert after.state != HOLDING or after.age >= NEUTRAL_TICKS
        if how == ("tick",):
            assert after.age == min(before.age + 1, FAILSAFE_TICKS + 1)
            assert throttle(after) <= throttle(before)
            if before.state == FAILSAFE:
                assert after.state == FAILSAFE
            if after.age >= FAILSAFE_TICKS:
                assert after.low_frames == 0
        elif how[0] == "frame":
            assert after.age == 0
        else:
            assert after.age == before.age
        if before.state == FAILSAFE and how[0] != "bind":
            assert after.state == (LOCKED if how[:2] == ("frame", "low") else FAILSAFE)


def test_a_frame_without_arm_high_stops_the_motors_at_once(steps: list[Step]) -> None:
    for before, how, after in steps:
        if how[0] == "frame" and before.state in (ARMED, HOLDING):
            assert after.state == (ARMED if how[1] == "high" else LOCKED)
            if how[1:] == ("high", "zero"):
                assert throttle(after) == 0
        if how[:2] in (("frame", "low"), ("frame", "middle")):
            assert throttle(after) == 0


def test_binding_is_refused_in_flight_ends_by_itself_and_does_nothing_else(steps: list[Step]) -> None:
    for before, how, after in steps:
        if how == ("bind",):
            flying = before.state in (ARMED, HOLDING)
            assert after.state == (before.state if flying else BINDING)
            assert flying or (after.bind_left, after.low_frames) == (BIND_PACKETS, 0)
        elif before.state == BINDING and how == ("bind packet",):
            assert after.bind_left == before.bind_left - 1
            assert after.state == (LOCKED if before.bind_left == 1 else BINDING)
        elif before.state == BINDING:
            assert (after.state, after.bind_left) == (BINDING, before.bind_left)
        elif how == ("bind packet",):
            assert bytes(after) == bytes(before)


@given(st.integers(FAILSAFE_TICKS + 1, 0xFFFF), st.sampled_from(INPUTS), st.sampled_from([BINDING, LOCKED, FAILSAFE]))
def test_any_later_age_is_alike(age: int, how: Input, state: int) -> None:
    late, later = start(False, False), start(False, False)
    late.state = later.state = state
    late.bind_left = later.bind_left = 9
    late.age, later.age = FAILSAFE_TICKS + 1, age
    assert key(act(late, how)) == key(act(later, how))
    library().pilot_tick(ctypes.byref(later))
    assert later.age == min(age + 1, 0xFFFF)


@pytest.mark.parametrize(("bind", "in_flight", "state"), [(0, 0, LOCKED), (0, 1, FAILSAFE), (1, 0, BINDING)])
def test_no_start_is_armed(bind: bool, in_flight: bool, state: int) -> None:
    pilot = start(bind, in_flight)
    assert (pilot.state, throttle(pilot), pilot.age) == (state, 0, FAILSAFE_TICKS + 1)


def test_every_sequence_of_events_gives_the_packets_and_the_status_of_the_rules() -> None:
    """From a restart, ready to arm, and in flight."""
    done = subprocess.run([str(toolchain.host_walk()), str(LENGTH)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    sequences, packets, statuses = map(int, done.stdout.split())
    assert sequences == 3 * 11**LENGTH
    assert packets > 50 * sequences
    assert statuses > 5 * sequences
