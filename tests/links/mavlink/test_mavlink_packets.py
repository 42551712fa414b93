"""Packing, parsing and checking, against pymavlink's packets (`pymavlink_vectors.jsonl`) and a slow twin of the CRC."""

import json
import math
import random
import struct
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.links.mavlink.checksum import accumulate
from matchset.links.mavlink.message import SIZES, MavlinkMessage, MessageField
from matchset.links.mavlink.messages import BY_NAME, MESSAGES
from matchset.links.mavlink.packet import MavlinkPacket, MavlinkParser, PacketWriter

FILE = Path(__file__).with_name("pymavlink_vectors.jsonl")
VECTORS = [json.loads(line) for line in FILE.read_text(encoding="utf-8").splitlines()]
HEART = {"type": 2, "autopilot": 3, "mavlink_version": 3}


def slow_crc(data: bytes) -> int:
    """By long division, bit by bit, of the message with its first 16 bits inverted."""
    bits = [byte >> k & 1 for byte in data for k in range(8)] + [0] * 16
    bits[:16] = [bit ^ 1 for bit in bits[:16]]
    if len(data) < 2:  # the inverted bits reach beyond the data
        return accumulate(data)
    for k in range(len(bits) - 16):
        if bits[k]:
            for power in (16, 12, 5, 0):
                bits[k + 16 - power] ^= 1
    return sum(bit << k for k, bit in enumerate(bits[-16:]))


@given(st.binary(min_size=2, max_size=300))
def test_the_checksum_is_that_of_long_division(data: bytes) -> None:
    assert accumulate(data) == slow_crc(data)


def test_the_checksum_of_the_catalog() -> None:
    assert accumulate(b"123456789") == 0x6F91  # CRC-16/MCRF4XX


def test_every_message_has_vectors() -> None:
    assert {vector["name"] for vector in VECTORS} == set(BY_NAME)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda each: each.name)
def test_the_byte_that_checks_the_fields(message: MavlinkMessage) -> None:
    extras = {vector["extra"] for vector in VECTORS if vector["name"] == message.name}
    assert extras == {message.crc_extra}


def as_lists(values: dict[str, Any]) -> dict[str, Any]:
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}


@pytest.mark.parametrize("vector", VECTORS, ids=lambda each: each["name"])
def test_packets_of_pymavlink_are_read_and_written_alike(vector: dict[str, Any]) -> None:
    theirs = bytes.fromhex(vector["packet"])
    (packet,) = MavlinkParser().feed(theirs)
    assert (packet.system, packet.component, packet.message.name) == (7, 9, vector["name"])
    assert as_lists(packet.values) == vector["values"]
    writer = PacketWriter(7, 9)
    for _ in range(theirs[4]):
        writer.write("HEARTBEAT", {})
    assert writer.write(vector["name"], vector["values"]) == theirs


def element(field: MessageField) -> st.SearchStrategy[Any]:
    size, letter = SIZES[field.base]
    if letter == "f":
        return st.floats(width=32, allow_nan=True)
    low, high = (0, 2 ** (8 * size) - 1) if letter.isupper() else (-(2 ** (8 * size - 1)), 2 ** (8 * size - 1) - 1)
    return st.integers(low, high)


def value(field: MessageField) -> st.SearchStrategy[Any]:
    if field.is_text:
        letters = st.characters(min_codepoint=1, max_codepoint=0x24F)
        return st.text(letters, max_size=field.count).filter(lambda text: len(text.encode()) <= field.count)
    if field.count:
        return st.tuples(*[element(field)] * field.count)
    return element(field)


@settings(max_examples=25)  # of each of so many messages
@given(st.data())
@pytest.mark.parametrize("message", MESSAGES, ids=lambda each: each.name)
def test_values_come_back(message: MavlinkMessage, data: st.DataObject) -> None:
    values = data.draw(st.fixed_dictionaries({field.name: value(field) for field in message.fields}))
    (packet,) = MavlinkParser().feed(PacketWriter(1, 2).write(message.name, values))
    assert packet[:3] == (1, 2, message)
    for name, was in values.items():
        assert repr(packet.values[name]) == repr(was)  # NaN is no NaN's equal


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("HEARTBEAT", {"speed": 1}, "HEARTBEAT has no field speed"),
        ("HEARTBEAT", {"type": 256}, "HEARTBEAT.type is of type uint8_t, got 256"),
        ("HEARTBEAT", {"type": 1.5}, "uint8_t, got 1.5"),
        ("HEARTBEAT", {"type": None, "autopilot": "x"}, "got 'x'"),
        ("ATTITUDE", {"roll": 1e39}, "float, got 1e"),
        ("ODOMETRY", {"q": (1, 0, 0)}, "4 elements, got 3"),
        ("STATUSTEXT", {"text": "a" * 51}, "50 bytes, got 51"),
    ],
)
def test_what_does_not_fit_is_refused(name: str, values: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        PacketWriter(1, 1).write(name, values)


@pytest.mark.parametrize(("system", "component"), [(0, 1), (256, 1), (1, 0), (1, 256)])
def test_a_sender_has_a_number(system: int, component: int) -> None:
    with pytest.raises(ValueError, match=r"within 1 ... 255"):
        PacketWriter(system, component)


def some_packets(count: int) -> list[bytes]:
    writer, chance = PacketWriter(1, 1), random.Random(3)
    return [writer.write(chance.choice(MESSAGES).name, {}) for _ in range(count)]


@given(st.integers(1, 300), st.integers(1, 64))
def test_packets_are_found_however_they_are_cut(count: int, step: int) -> None:
    stream = b"".join(some_packets(count))
    parser, found = MavlinkParser(), []
    for start in range(0, len(stream), step):
        found += parser.feed(stream[start : start + step])
    assert len(found) == parser.received == count
    assert parser.lost == parser.bad == parser.unknown == 0


@given(st.binary(max_size=400))
def test_no_bytes_upset_the_parser_and_it_finds_what_follows(noise: bytes) -> None:
    parser = MavlinkParser()
    parser.feed(noise)
    found = parser.feed(bytes(300) + PacketWriter(1, 1).write("HEARTBEAT", HEART) + bytes(300))
    assert any(packet.values == {**dict.fromkeys(packet.values, 0), **HEART} for packet in found)


@given(st.data())
def test_damaged_packets_are_never_read_as_others(data: st.DataObject) -> None:
    good = bytearray(PacketWriter(1, 1).write("ATTITUDE", {"roll": 0.5, "yawspeed": -1.0}))
    for _ in range(data.draw(st.integers(1, 3))):
        good[data.draw(st.integers(0, len(good) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    found = MavlinkParser().feed(bytes(good))
    assert not found or found[0].values["roll"] == 0.5


def test_every_single_bit_error_is_noticed() -> None:
    good = PacketWriter(1, 1).write("MANUAL_CONTROL", {"target": 1, "x": 300, "y": -20, "z": 570, "r": 5})
    for bit in range(8 * len(good)):
        broken = bytearray(good)
        broken[bit // 8] ^= 1 << bit % 8
        assert MavlinkParser().feed(bytes(broken)) == []


def test_lost_packets_are_counted_and_late_ones_are_not() -> None:
    parser, packets = MavlinkParser(), some_packets(600)
    for number, packet in enumerate(packets):
        if number % 10 != 5:
            parser.feed(packet)
    assert (parser.received, parser.lost) == (540, 60)
    parser.feed(packets[598])  # again
    assert parser.lost == 60


def test_senders_are_counted_apart() -> None:
    parser = MavlinkParser()
    for system in (1, 2):
        writer = PacketWriter(system, 1)
        writer.write("HEARTBEAT", {})
        for _ in range(3):
            parser.feed(writer.write("HEARTBEAT", {}))
    assert parser.lost == 0


def unknown(number: int, payload: bytes = b"\xfd\x01\x02") -> bytes:
    """A packet of a message that is not in the table; its payload looks like the beginning of one."""
    return bytes([0xFD, len(payload), 0, 0, number, 1, 1, 33, 0, 0]) + payload + b"\x12\x34"


def test_messages_that_are_not_in_the_table_are_skipped_and_counted() -> None:
    writer, parser = PacketWriter(1, 1), MavlinkParser()
    packets = [writer.write("HEARTBEAT", HEART) for _ in range(4)]
    found = parser.feed(packets[0] + unknown(1) + packets[2] + packets[3])
    assert len(found) == 3
    assert (parser.unknown, parser.lost, parser.bad) == (1, 0, 0)


def test_an_unknown_message_amid_noise_hides_nothing() -> None:
    noise = unknown(0)[:10]  # promises three bytes, and a heartbeat follows
    heart = PacketWriter(1, 1).write("HEARTBEAT", HEART)
    assert len(MavlinkParser().feed(noise + heart + heart)) == 2


def test_a_signed_packet_is_read_and_marked() -> None:
    plain = PacketWriter(1, 1).write("HEARTBEAT", HEART)
    body = plain[1:2] + b"\x01" + plain[3:-2]
    crc = accumulate(bytes([BY_NAME["HEARTBEAT"].crc_extra]), accumulate(body))
    signed = b"\xfd" + body + crc.to_bytes(2, "little") + bytes(13)
    found = MavlinkParser().feed(signed + plain)
    assert [packet.signed for packet in found] == [True, False]


def test_a_flag_that_nobody_knows_makes_it_another_format() -> None:
    plain = bytearray(PacketWriter(1, 1).write("HEARTBEAT", HEART))
    plain[2] = 0x02
    assert MavlinkParser().feed(bytes(plain)) == []


def test_a_heartbeat_of_the_old_version_is_noticed() -> None:
    payload = struct.pack("<IBBBBB", 0, 2, 3, 81, 4, 3)
    body = bytes([9, 0, 1, 1, 0]) + payload
    crc = accumulate(bytes([50]), accumulate(body))
    parser = MavlinkParser()
    assert parser.feed(b"\xfe" + body + crc.to_bytes(2, "little")) == []
    assert parser.old == 1


def test_zeros_at_the_end_are_left_out_but_never_the_first_byte() -> None:
    assert BY_NAME["ODOMETRY"].pack({}) == b"\0"
    assert BY_NAME["COMMAND_ACK"].pack({"command": 400}) == b"\x90\x01"


def test_fields_of_a_later_version_are_ignored() -> None:
    message = BY_NAME["TIMESYNC"]
    assert message.unpack(struct.pack("<qqB", 3, 4, 9)) == {"tc1": 3, "ts1": 4}


def test_numbers_go_on_from_zero_after_255() -> None:
    writer = PacketWriter(1, 1)
    numbers = [writer.write("HEARTBEAT", {})[4] for _ in range(300)]
    assert numbers == [k % 256 for k in range(300)]


def test_a_packet_is_a_value() -> None:
    assert MavlinkPacket(1, 1, MESSAGES[0], {}).signed is False
    attitude = BY_NAME["ATTITUDE"]
    assert math.isnan(attitude.unpack(attitude.pack({"roll": math.nan}))["roll"])
