"""CRSF frames: the serial protocol between host and transmitter.

A frame is ``C8 | n | type | n - 2 bytes of payload | CRC-8``; the CRC (polynomial 0xD5, start 0) covers type and
payload. The one frame of the published standard that is used here is RC_CHANNELS_PACKED, type 0x16: sixteen
channels of 11 bits, least significant bit first, 172 ... 1811 with the center at 992.
"""

from collections.abc import Sequence

SYNC = 0xC8  # format: first byte of a frame
CHANNELS_PACKED = 0x16  # format: type of RC_CHANNELS_PACKED
CHANNEL_LOW, CHANNEL_CENTER, CHANNEL_HIGH = 172, 992, 1811  # format: range of a channel
CHANNEL_COUNT = 16  # format: channels of a frame
CHANNEL_BITS, CHANNEL_BYTES = 11, 22  # format: bits of a channel, bytes of all of them
MIN_LENGTH, MAX_LENGTH = 2, 62  # format: allowed values of the length byte
POLYNOMIAL = 0x1D5  # format: of the CRC-8, with its leading bit


def _crc_table() -> bytes:
    table = bytearray()
    for byte in range(256):
        for _ in range(8):
            byte = (byte << 1) ^ (POLYNOMIAL if byte & 0x80 else 0)
        table.append(byte)
    return bytes(table)


_TABLE = _crc_table()


def crc8(data: bytes) -> int:
    """Return the CRC-8 of some bytes: polynomial 0xD5, start value 0."""
    crc = 0
    for byte in data:
        crc = _TABLE[crc ^ byte]
    return crc


def frame(kind: int, payload: bytes = b"") -> bytes:
    """Return a complete frame.

    Raises
    ------
    ValueError
        If the payload is longer than 60 bytes or the type is no byte.
    """
    if len(payload) + 2 > MAX_LENGTH or not 0 <= kind <= 0xFF:
        raise ValueError(f"no frame of type {kind} can hold {len(payload)} bytes")
    body = bytes([kind]) + payload
    return bytes([SYNC, len(body) + 1]) + body + bytes([crc8(body)])


def pack_channels(channels: Sequence[int]) -> bytes:
    """Pack sixteen channels into the 22 bytes of a payload.

    Raises
    ------
    ValueError
        If there are not sixteen, or one is out of 172 ... 1811.
    """
    if len(channels) != CHANNEL_COUNT:
        raise ValueError(f"there must be {CHANNEL_COUNT} channels, got {len(channels)}")
    pool = 0
    for index, channel in enumerate(channels):
        if not CHANNEL_LOW <= channel <= CHANNEL_HIGH:
            raise ValueError(f"channel {index + 1} must be within {CHANNEL_LOW} ... {CHANNEL_HIGH}, got {channel}")
        pool |= channel << CHANNEL_BITS * index
    return pool.to_bytes(CHANNEL_BYTES, "little")


def unpack_channels(payload: bytes) -> list[int]:
    """Return the sixteen channels of a payload of 22 bytes, 0 ... 2047 each.

    Raises
    ------
    ValueError
        If the payload has another size.
    """
    if len(payload) != CHANNEL_BYTES:
        raise ValueError(f"sixteen channels take {CHANNEL_BYTES} bytes, got {len(payload)}")
    pool = int.from_bytes(payload, "little")
    return [pool >> CHANNEL_BITS * index & 0x7FF for index in range(CHANNEL_COUNT)]


class CrsfParser:
    """Finds frames in a stream of bytes, and synchronizes again after noise.

    Parameters
    ----------
    first : bytes
        What a frame may begin with.

    Attributes
    ----------
    bad : int
        Frames with a wrong CRC so far.
    skipped : int
        Bytes that belong to no frame so far.
    """

    def __init__(self, first: bytes = bytes((SYNC,))) -> None:
        self._bytes, self._first = bytearray(), first
        self.bad = self.skipped = 0

    def feed(self, data: bytes) -> list[tuple[int, bytes]]:
        """Add the next bytes of the stream; returns type and payload of every frame that is complete now."""
        self._bytes += data
        found: list[tuple[int, bytes]] = []
        start, stream = 0, self._bytes
        while len(stream) - start >= 2:
            length = stream[start + 1]
            if stream[start] not in self._first or not MIN_LENGTH <= length <= MAX_LENGTH:
                self.skipped += 1
                start += 1
                continue
            if len(stream) - start < length + 2:
                break
            body = bytes(stream[start + 2 : start + length + 1])
            if crc8(body) == stream[start + length + 1]:
                found.append((body[0], body[1:]))
                start += length + 2
            else:
                self.bad += 1
                self.skipped += 1
                start += 1
        del stream[:start]
        return found
