"""CRSF frames: how the host and the transmitter talk.

A frame is ``C8 | n | type | n - 2 bytes of payload | CRC-8``; the CRC (polynomial 0xD5, start 0) covers type and
payload. The one frame of the published standard that is used here is RC_CHANNELS_PACKED, type 0x16: sixteen
channels of 11 bits, least significant bit first, 172 ... 1811 with the center at 992.
"""

from collections.abc import Sequence

SYNC = 0xC8
CHANNELS_PACKED = 0x16
CHANNEL_LOW, CHANNEL_CENTER, CHANNEL_HIGH = 172, 992, 1811
CHANNEL_COUNT = 16
SHORTEST, LONGEST = 2, 62  # what the byte behind the sync may say


def _crc_table() -> bytes:
    table = bytearray()
    for byte in range(256):
        for _ in range(8):
            byte = (byte << 1) ^ (0x1D5 if byte & 0x80 else 0)
        table.append(byte)
    return bytes(table)


_TABLE = _crc_table()


def crc8(data: bytes) -> int:
    """Return the CRC-8 (polynomial 0xD5, start 0) of some bytes."""
    crc = 0
    for byte in data:
        crc = _TABLE[crc ^ byte]
    return crc


def frame(kind: int, payload: bytes = b"") -> bytes:
    """Return a whole frame of this type.

    Raises
    ------
    ValueError
        If the payload is longer than 60 bytes or the type no byte.
    """
    if len(payload) + 2 > LONGEST or not 0 <= kind <= 0xFF:
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
    for place, channel in enumerate(channels):
        if not CHANNEL_LOW <= channel <= CHANNEL_HIGH:
            raise ValueError(f"channel {place + 1} must be within {CHANNEL_LOW} ... {CHANNEL_HIGH}, got {channel}")
        pool |= channel << 11 * place
    return pool.to_bytes(22, "little")


def unpack_channels(payload: bytes) -> list[int]:
    """Return the sixteen channels of a payload of 22 bytes, 0 ... 2047 each.

    Raises
    ------
    ValueError
        If the payload has another size.
    """
    if len(payload) != 22:
        raise ValueError(f"sixteen channels take 22 bytes, got {len(payload)}")
    pool = int.from_bytes(payload, "little")
    return [pool >> 11 * place & 0x7FF for place in range(CHANNEL_COUNT)]


class Parser:
    """Finds frames in a stream of bytes, also after noise.

    Attributes
    ----------
    bad : int
        Frames with a wrong CRC so far.
    """

    def __init__(self) -> None:
        self._bytes = bytearray()
        self.bad = 0

    def feed(self, data: bytes) -> list[tuple[int, bytes]]:
        """Take the next bytes of the stream; returns type and payload of every frame that is whole by now."""
        self._bytes += data
        found: list[tuple[int, bytes]] = []
        start, stream = 0, self._bytes
        while len(stream) - start >= 2:
            length = stream[start + 1]
            if stream[start] != SYNC or not SHORTEST <= length <= LONGEST:
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
                start += 1
        del stream[:start]
        return found
