"""The Syma X protocol once more, from the receiver's side and independent of the firmware's code."""

from dataclasses import dataclass

from vectors import HOPS, VECTORS, octets

BIND_ADDRESS = octets(VECTORS["radio"]["bind_address"])
BIND_CHANNELS: list[int] = VECTORS["radio"]["bind_channels"]


def checksum(packet: bytes) -> int:
    """What byte 9 must be."""
    total = 0
    for byte in packet[:9]:
        total ^= byte
    return (total + 0x55) % 256


def data_channels(id0: int) -> list[int]:
    """The four channels in flight, MHz above 2400."""
    return HOPS[id0 % 32]


def bound_id(packet: bytes) -> bytes | None:
    """The id that a bind packet announces; None if it is none."""
    if len(packet) != 10 or packet[9] != checksum(packet) or packet[5:9] != b"\xaa\xaa\xaa\x00":
        return None
    return packet[4::-1]


@dataclass(frozen=True)
class Sticks:
    """What a data packet says; sticks -127 ... 127, trims -31 ... 31."""

    throttle: int
    pitch: int
    yaw: int
    roll: int
    fast: bool
    flip: bool
    trims: tuple[int, int, int]


def signed(byte: int, bits: int = 7) -> int:
    """Sign and magnitude."""
    size = byte & (1 << bits) - 1
    return -size if byte >> bits & 1 else size


def sticks(packet: bytes) -> Sticks | None:
    """Read a data packet; None if it is none."""
    if len(packet) != 10 or packet[9] != checksum(packet) or packet[5] & 0x40 == 0:
        return None
    trims = (signed(packet[5], 5), signed(packet[6], 5), signed(packet[7], 5))
    axes = [signed(byte) for byte in packet[1:4]]
    return Sticks(packet[0], axes[0], axes[1], axes[2], bool(packet[5] & 0x80), bool(packet[6] & 0x40), trims)
