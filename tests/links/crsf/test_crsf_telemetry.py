"""What a module says, and everything that is none of it."""

import contextlib
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.command import Command
from matchset.links import crsf_frame as crsf
from matchset.links.crsf import telemetry
from matchset.links.crsf.sticks import channels, on_air
from matchset.links.crsf.telemetry import (
    Battery,
    CrsfAttitude,
    Device,
    FlightMode,
    FrameTiming,
    LinkStatistics,
    decode,
)
from radio_modules import channels_of, flight_mode, link_statistics, message, timing

STICK = st.floats(-1.0, 1.0)


def read(data: bytes) -> list[tuple[int, bytes]]:
    return crsf.CrsfParser(telemetry.ADDRESSES).feed(data)


def only(data: bytes) -> telemetry.Message | None:
    [(kind, payload)] = read(data)
    return decode(kind, payload)


@given(st.lists(st.integers(172, 1811), min_size=16, max_size=16))
def test_channels_are_packed_as_bit_by_bit(values: list[int]) -> None:
    assert channels_of(crsf.pack_channels(values)) == values


@given(STICK, STICK, STICK, st.floats(0.0, 1.0), st.integers(5, 16))
def test_a_command_comes_back_within_half_a_step(
    roll: float, pitch: float, yaw: float, throttle: float, arm: int
) -> None:
    command = Command(roll=roll, pitch=pitch, yaw=yaw, throttle=throttle)
    values = channels_of(crsf.pack_channels(channels(command, True, arm)))
    back = on_air(values)
    for name in ("roll", "pitch", "yaw"):
        assert abs(getattr(back, name) - getattr(command, name)) <= 1.0 / 819, name
    assert abs(back.throttle - throttle) <= 0.5 / 1639 + 1e-9
    assert [k + 1 for k in range(4, 16) if values[k] > 1000] == [arm]


@given(STICK, STICK, STICK, st.floats(0.0, 1.0))
def test_disarmed_there_is_no_throttle_and_every_switch_is_low(
    roll: float, pitch: float, yaw: float, throttle: float
) -> None:
    values = channels(Command(roll=roll, pitch=pitch, yaw=yaw, throttle=throttle), False, 5)
    assert values[2] == 172
    assert set(values[4:]) == {172}


def test_the_order_and_the_signs_of_the_sticks() -> None:
    values = channels(Command(roll=1.0, pitch=-1.0, throttle=1.0, yaw=0.5), True, 6)
    assert values[:6] == [1811, 173, 1811, 1402, 172, 1811]


def test_the_checksum_of_a_command_is_the_published_one() -> None:
    bind = bytes.fromhex(
        "ecc810019e"
    )  # "start binding" of a flight controller to its receiver: C8 07 32 EC C8 10 01 9E E8
    assert telemetry.command_checksum(bind[:-1]) == bind[-1]
    assert crsf.frame(telemetry.COMMAND, bind).hex() == "c80732ecc810019ee8"


@given(st.integers(0, 63))
def test_the_number_of_the_receiver_is_in_its_command(number: int) -> None:
    payload = telemetry.select_receiver(number)
    assert payload[:-1] == bytes((0xEE, 0xEA, 0x10, 0x05, number))
    assert telemetry.command_checksum(payload[:-1]) == payload[-1]


def test_each_message_is_read() -> None:
    assert only(link_statistics(97, 61, -5)) == LinkStatistics(rssi=-61, quality=97, snr=-5, quality_back=99)
    battery = message(0x08, struct.pack(">HHBHB", 38, 52, 1, 2, 80))
    assert only(battery) == Battery(voltage=3.8, current=5.2, used=65.538, left=0.8)
    assert only(message(0x1E, struct.pack(">hhh", -100, 200, 31415))) == CrsfAttitude(
        roll=0.02, pitch=-0.01, yaw=3.1415
    )
    assert only(flight_mode("ANGL*")) == FlightMode("ANGL*")
    found = only(timing(0.004, -0.0005))
    assert isinstance(found, FrameTiming)
    assert found.interval == pytest.approx(0.004)
    assert found.early == pytest.approx(-0.0005)
    name = b"\xea\xeeBench TX\0ELRS" + bytes(4) + bytes((0, 3, 5, 2)) + b"\x10\0"
    assert only(message(0x29, name)) == Device("Bench TX", "3.5.2")


def test_the_second_antenna_counts_if_it_is_the_active_one() -> None:
    payload = struct.pack(">BBBbBBBBBb", 90, 70, 50, 0, 1, 0, 0, 0, 0, 0)
    assert decode(0x14, payload) == LinkStatistics(rssi=-70, quality=50, snr=0, quality_back=0)


@pytest.mark.parametrize("first", [0xC8, 0xEA, 0xEE, 0xEC, 0x00])
def test_a_frame_may_begin_with_any_address(first: int) -> None:
    assert read(message(0x21, b"AIR\0", first)) == [(0x21, b"AIR\0")]


def test_what_nobody_asked_for_is_ignored() -> None:
    assert decode(0x02, bytes(15)) is None  # GPS
    assert decode(0x2B, bytes(40)) is None  # parameters
    assert decode(0x29, b"\xea\xc8FC\0" + bytes(14)) is None  # another device than the module
    assert decode(0x3A, b"\xea\xee\x11" + bytes(8)) is None


@pytest.mark.parametrize(
    ("kind", "payload"),
    [
        (0x14, bytes(9)),
        (0x14, bytes((60, 60, 101, 0, 0, 0, 0, 0, 0, 0))),
        (0x08, bytes(7)),
        (0x08, bytes((0, 38, 0, 0, 0, 0, 0, 101))),
        (0x1E, bytes(5)),
        (0x21, b"ANGL"),
        (0x21, b"\xffANGL\0"),
        (0x21, b"AN\nGL\0"),
        (0x3A, b"\xea\xee\x10" + bytes(7)),
        (0x29, b"\xea\xeeBench TX"),
        (0x29, b"\xea\xeeBench TX\0" + bytes(11)),
    ],
)
def test_what_makes_no_sense_is_refused(kind: int, payload: bytes) -> None:
    with pytest.raises(ValueError, match="no "):
        decode(kind, payload)


@given(st.integers(0, 255), st.binary(max_size=60))
def test_no_payload_upsets_the_decoder(kind: int, payload: bytes) -> None:
    with contextlib.suppress(ValueError):
        decode(kind, payload)


@given(st.binary(max_size=400), st.integers(1, 64))
def test_no_noise_hides_what_follows_it(noise: bytes, step: int) -> None:
    parser, found = crsf.CrsfParser(telemetry.ADDRESSES), []
    stream = noise + bytes([1]) * 64 + link_statistics(88) + bytes([1]) * 64
    for begin in range(0, len(stream), step):
        found += parser.feed(stream[begin : begin + step])
    assert (0x14, link_statistics(88)[3:-1]) in found


@given(st.binary(min_size=1, max_size=200))
def test_every_byte_belongs_to_a_frame_or_is_counted(noise: bytes) -> None:
    parser = crsf.CrsfParser(telemetry.ADDRESSES)
    end = bytes([1]) * 70  # no frame begins with it, and it ends all that noise began
    frames = parser.feed(noise + end)
    assert parser.skipped + sum(len(payload) + 4 for _, payload in frames) in (len(noise) + 69, len(noise) + 70)


@pytest.mark.parametrize(
    ("text", "disarmed", "refuses", "rates", "failsafe"),
    [
        ("ANGL", False, False, False, False),
        ("ANGL*", True, False, False, False),
        ("ANGL!", True, True, False, False),
        ("ANGL?", True, False, False, False),
        ("ACRO*", True, False, True, False),
        ("AIR", False, False, True, False),
        ("HOR", False, False, False, False),
        ("!FS!", False, False, False, True),
        ("!ERR", True, True, False, False),
        ("OK", True, False, False, False),
        ("WAIT", True, False, False, False),
        ("", False, False, False, False),
    ],
)
def test_what_a_mode_means(text: str, disarmed: bool, refuses: bool, rates: bool, failsafe: bool) -> None:
    mode = FlightMode(text)
    assert (mode.disarmed, mode.refuses, mode.commands_rates, mode.failsafe) == (disarmed, refuses, rates, failsafe)
