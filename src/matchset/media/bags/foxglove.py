"""Pictures as Foxglove's programs store them, `foxglove.CompressedImage` and `CompressedVideo`, from their bytes.

They come as JSON, as Protocol Buffers, or packed as messages of ROS 1 and ROS 2. Layouts: foxglove-sdk (MIT), schemas
CompressedImage and CompressedVideo; the encoding of Protocol Buffers 3.
"""

from collections.abc import Iterator

import msgspec

from matchset.media.bags.packed_fields import CDR, JSON, NANO, PROTOBUF, ROS1, Fields, PackedPicture

IMAGE, VIDEO = "foxglove.CompressedImage", "foxglove.CompressedVideo"
KINDS = {IMAGE: IMAGE, VIDEO: VIDEO, "foxglove_msgs/CompressedImage": IMAGE, "foxglove_msgs/CompressedVideo": VIDEO}
# format: numbers of the fields of each message: data, format; 1 is the time in both
DATA, FORM = {IMAGE: 2, VIDEO: 3}, {IMAGE: 3, VIDEO: 4}
TIME, SECONDS, NANOSECONDS = 1, 1, 2  # format: fields of both messages, and of google.protobuf.Timestamp
VARINT, FIXED64, LENGTH, FIXED32 = 0, 1, 2, 5  # format: kinds of fields
LONGEST_VARINT = 10  # format: bytes


class _Time(msgspec.Struct, frozen=True):
    sec: int = 0
    nsec: int = 0


class _Message(msgspec.Struct, frozen=True):
    """Either message in JSON; the data are in base64 there."""

    data: bytes
    format: str = ""
    timestamp: _Time = _Time()


def read_foxglove(data: bytes, kind: str, packing: str) -> PackedPicture:
    """Read a message.

    Parameters
    ----------
    data : bytes
    kind : str
        One of `KINDS`.
    packing : str
        `JSON`, `PROTOBUF`, `ROS1` or `CDR`.

    Raises
    ------
    ValueError
        If it is none.
    """
    if packing == JSON:
        return _from_json(data)
    if packing == PROTOBUF:
        return _from_protobuf(data, KINDS[kind])
    if packing not in (ROS1, CDR):
        raise ValueError(f"a message is packed as {packing!r}, not as JSON, Protocol Buffers, ROS 1 or CDR")
    fields = Fields(data, packing == ROS1)
    stamp = fields.uint32() * NANO + fields.uint32()
    fields.octets()  # the name of the frame of coordinates
    octets = bytes(fields.octets())
    return PackedPicture(stamp, fields.string(), octets)


def _from_json(data: bytes) -> PackedPicture:
    try:
        message = msgspec.json.decode(data, type=_Message)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"a message is no picture of Foxglove in JSON: {error}") from None
    return PackedPicture(message.timestamp.sec * NANO + message.timestamp.nsec, message.format, message.data)


def _from_protobuf(data: bytes, kind: str) -> PackedPicture:
    found = dict(_fields(memoryview(data)))
    octets, form = found.get(DATA[kind], b""), found.get(FORM[kind], b"")
    time = found.get(TIME, b"")
    if isinstance(octets, int) or isinstance(form, int) or isinstance(time, int):
        raise ValueError("a message is no picture of Foxglove: its fields are of another kind")
    parts = dict(_fields(memoryview(time)))
    seconds, nanoseconds = parts.get(SECONDS, 0), parts.get(NANOSECONDS, 0)
    if not isinstance(seconds, int) or not isinstance(nanoseconds, int):
        raise ValueError("a message is no picture of Foxglove: its time is of another kind")
    return PackedPicture(seconds * NANO + nanoseconds, bytes(form).decode("utf-8", "replace"), bytes(octets))


def _fields(data: memoryview) -> Iterator[tuple[int, int | memoryview | bytes]]:
    """Yield number and content of the fields of a message of Protocol Buffers; ValueError if it ends too early."""
    place = 0
    while place < len(data):
        key, place = _varint(data, place)
        kind = key & 7
        value: int | memoryview = 0
        if kind == VARINT:
            value, place = _varint(data, place)
        else:
            size = {FIXED64: 8, FIXED32: 4}.get(kind, -1)
            if kind == LENGTH:
                size, place = _varint(data, place)
            if size < 0 or place + size > len(data):
                raise ValueError(f"a message of {len(data)} bytes is damaged, or no Protocol Buffers")
            value, place = data[place : place + size], place + size
        yield key >> 3, value


def _varint(data: memoryview, place: int) -> tuple[int, int]:
    """Return an integer of seven bits a byte, the lowest first, and the place behind it."""
    value = 0
    for count in range(LONGEST_VARINT):
        if place + count >= len(data):
            break
        value |= (data[place + count] & 0x7F) << 7 * count
        if data[place + count] < 0x80:
            return value, place + count + 1
    raise ValueError(f"a message of {len(data)} bytes is damaged, or no Protocol Buffers")
