"""Foxglove's messages in an MCAP file, read by the package mcap and decoded by the definitions, for tests."""

import struct
from pathlib import Path
from typing import Any, NamedTuple

from mcap.reader import make_reader

from matchset.app.viewers.foxglove_definitions import DEFINITIONS
from matchset.app.viewers.protobuf import LENGTH, TYPES, members

Message = dict[str, Any]
NUMBERS = {"double": "<d", "fixed32": "<I"}
ZERO = {"string": "", "bytes": b"", "double": 0.0}


class Read(NamedTuple):
    topic: str
    time: int  # ns
    number: int
    message: Message


def read_foxglove_file(path: Path) -> list[Read]:
    """All messages, in the order of their times."""
    with path.open("rb") as file:
        found = []
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("protobuf", "protobuf")
            assert message.log_time == message.publish_time
            decoded = decoded_message(message.data, schema.name)
            found.append(Read(channel.topic, message.log_time, message.sequence, decoded))
        return found


def decoded_message(data: bytes, kind: str) -> Message:
    """Members by name; numbers that are left out are zero, messages that are left out are not there."""
    known = {each.number: each for each in members(kind, DEFINITIONS)}
    out: Message = {each.name: [] for each in known.values() if each.many}
    out |= {each.name: ZERO.get(each.kind, 0) for each in known.values() if not each.many and each.kind in TYPES}
    place = 0
    while place < len(data):
        key, place = _varint(data, place)
        member = known[key >> 3]
        size = {1: 8, 5: 4}.get(key & 7, 0)
        value: Any = None
        if key & 7 == 0:
            value, place = _varint(data, place)
        elif key & 7 == LENGTH:
            size, place = _varint(data, place)
        part = data[place : place + size]
        assert len(part) == size
        place += size
        if member.many and member.kind in NUMBERS:
            value = [each for (each,) in struct.iter_unpack(NUMBERS[member.kind], part)]
        elif member.kind in NUMBERS:
            (value,) = struct.unpack(NUMBERS[member.kind], part)
        elif value is None:
            value = _text(part, member.kind)
        if not member.many:
            out[member.name] = value
        else:
            out[member.name] += value if isinstance(value, list) else [value]
    return out


def _text(part: bytes, kind: str) -> Any:
    return part.decode() if kind == "string" else part if kind == "bytes" else decoded_message(part, kind)


def _varint(data: bytes, place: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        value |= (data[place] & 0x7F) << shift
        place, shift = place + 1, shift + 7
        if data[place - 1] < 0x80:
            return value, place
