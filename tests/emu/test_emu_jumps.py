"""One damaged frame with a good CRC moves the sticks by a step at most; ordinary commands and a cut never wait."""

import ctypes

import pytest
from emulator import HZ
from firmware_in_c import STATES, Pilot, hear, library
from hypothesis import given
from hypothesis import strategies as st

from flight import FULL, flying_board, frame
from matchset.control.command import Command
from matchset.control.safety import SafetyParameters
from matchset.links import crsf_frame as crsf
from matchset.links.arduino import channels

STICK_STEP, THROTTLE_STEP, STEP_TICKS = 48, 38, 10
NEUTRAL = [992, 992, 172, 992, 172, 172, *[992] * 10]
CHANNEL = st.integers(crsf.CHANNEL_LOW, crsf.CHANNEL_HIGH)
FOUR = st.tuples(CHANNEL, CHANNEL, CHANNEL, CHANNEL)
AXES = ("roll", "pitch", "throttle", "yaw")


@pytest.fixture(autouse=True, scope="module")
def _built() -> None:
    library()


def sticks(arm: int = 1811, **named: int) -> list[int]:
    """Channels with some of them set."""
    values = NEUTRAL.copy()
    values[4] = arm
    for name, value in named.items():
        values[(*AXES, "arm", "rate", "flip").index(name)] = value
    return values


def armed() -> Pilot:
    pilot = Pilot()
    library().pilot_begin(ctypes.byref(pilot), False, False)
    for arm in (172, 172, 172, 1811):
        hear(pilot, sticks(arm))
    assert STATES[pilot.state] == "armed"
    return pilot


def tick(pilot: Pilot, count: int = 8) -> None:
    for _ in range(count):
        library().pilot_tick(ctypes.byref(pilot))


def on_air(pilot: Pilot) -> tuple[int, int, int, int]:
    said = library().pilot_sticks(ctypes.byref(pilot))
    return said.roll, said.pitch, said.throttle, said.yaw


def hovering() -> Pilot:
    pilot = armed()
    for _ in range(2):
        tick(pilot)
        hear(pilot, sticks(throttle=992))
    assert on_air(pilot) == (0, 0, 128, 0)
    return pilot


@given(st.lists(st.tuples(st.integers(1, 60), *[st.floats(-1, 1)] * 4), min_size=1, max_size=30))
def test_what_the_safety_filter_lets_through_is_flown_at_once(
    steps: list[tuple[float, ...]],
) -> None:
    """At any rate of frames, also where some were lost."""
    limits, pilot = SafetyParameters(), armed()
    now, throttle = [0.0, 0.0, 0.0], 0.0
    for ticks, *pushed, lift in steps:
        tick(pilot, round(ticks))
        seconds = 0.004 * ticks
        change = limits.max_stick_rate * seconds
        now = [min(max(value + push * change, -1.0), 1.0) for value, push in zip(now, pushed, strict=True)]
        throttle = min(max(throttle + lift * limits.max_throttle_rate * seconds, 0.0), 1.0)
        values = channels.channels(Command(now[0], now[1], now[2], throttle), armed=True)
        hear(pilot, values)
        roll, pitch, top, yaw = values[:4]
        expected = channels.stick_byte(roll), channels.stick_byte(pitch), channels.throttle_byte(top)
        assert on_air(pilot) == (*expected, channels.stick_byte(yaw))


@given(FOUR)
def test_one_foreign_frame_moves_a_hover_by_a_step_at_most_and_for_one_frame(foreign: tuple[int, ...]) -> None:
    pilot = hovering()
    tick(pilot)
    hear(pilot, sticks(**dict(zip(AXES, foreign, strict=True))))
    roll, pitch, throttle, yaw = on_air(pilot)
    assert max(map(abs, (roll, pitch, yaw))) <= STICK_STEP
    assert throttle <= 128 + THROTTLE_STEP
    tick(pilot)
    hear(pilot, sticks(throttle=992))
    assert on_air(pilot) == (0, 0, 128, 0)


@given(FOUR)
def test_two_alike_are_flown(wanted: tuple[int, ...]) -> None:
    pilot = hovering()
    for _ in range(2):
        tick(pilot)
        hear(pilot, sticks(**dict(zip(AXES, wanted, strict=True))))
    roll, pitch, throttle, yaw = on_air(pilot)
    assert throttle == channels.throttle_byte(wanted[2])
    assert [roll, pitch, yaw] == [channels.stick_byte(wanted[k]) for k in (0, 1, 3)]


@given(st.lists(st.tuples(CHANNEL, CHANNEL, CHANNEL, CHANNEL, st.integers(0, 60)), max_size=12))
def test_lower_throttle_neutral_sticks_and_a_disarm_never_wait(flown: list[tuple[int, int, int, int, int]]) -> None:
    pilot = armed()
    for *values, ticks in flown:
        hear(pilot, sticks(**dict(zip(AXES, values, strict=True))))
        tick(pilot, ticks)
    before = on_air(pilot)
    lower = 172 + (before[2] * 6) // 2
    hear(pilot, sticks(throttle=lower))
    assert on_air(pilot) == (0, 0, channels.throttle_byte(lower), 0)
    hear(pilot, sticks(throttle=172))
    assert on_air(pilot)[2] == 0
    for arm in (172, 992, 1499):
        again = Pilot.from_buffer_copy(pilot)
        hear(again, sticks(arm, throttle=1811))
        assert (STATES[again.state], on_air(again)) == ("locked", (0, 0, 0, 0))


@given(FOUR)
def test_without_frames_the_sticks_become_neutral_and_the_throttle_stays(wanted: tuple[int, ...]) -> None:
    pilot = hovering()
    for _ in range(2):
        hear(pilot, sticks(**dict(zip(AXES, wanted, strict=True)), rate=1811, flip=1811))
    tick(pilot, 26)
    assert STATES[pilot.state] == "holding"
    said = library().pilot_sticks(ctypes.byref(pilot))
    assert on_air(pilot) == (0, 0, channels.throttle_byte(wanted[2]), 0)
    assert (said.fast, said.flip) == (False, False)


def test_a_flip_and_the_high_rate_need_two_frames_and_end_with_one() -> None:
    pilot = hovering()
    for place, name in ((6, "flip"), (5, "rate")):
        seen = []
        for value in (1811, 172, 1811, 1811, 1811, 172):
            values = sticks(throttle=992)
            values[place] = value
            hear(pilot, values)
            said = library().pilot_sticks(ctypes.byref(pilot))
            seen.append(said.flip if name == "flip" else said.fast)
        assert seen == [False, False, False, True, True, False]


def test_arming_begins_from_neutral_whatever_was_heard_before() -> None:
    pilot = Pilot()
    library().pilot_begin(ctypes.byref(pilot), False, False)
    for arm in (172, 172, 172, 1811):
        hear(pilot, sticks(arm, roll=1811))
    assert on_air(pilot) == (0, 0, 0, 0)


@pytest.mark.parametrize("last", [frame(FULL, armed=False), frame(Command()), frame(FULL, ch5=992)], ids=str)
def test_a_cut_is_on_the_air_6_ms_after_its_last_byte(last: bytes) -> None:
    with flying_board() as board:
        for _ in range(12):
            board.run(0.0053)
            board.write(frame())
            board.run(0.02)
        board.write(last)
        packets = board.run(0.03)
        zero = next(packet.cycle for packet in packets if packet.payload[0] == 0)
        assert zero - board.last_byte <= 0.006 * HZ
