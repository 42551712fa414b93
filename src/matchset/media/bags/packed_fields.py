"""How a message is packed, and its members one after the other: `Fields`; a picture taken out of one, still packed.

ROS 1 packs the members one behind the other; ROS 2 puts four bytes before them (CDR), aligns every integer to its size,
and ends strings with 0. Layout: OMG DDSI-RTPS 10.
"""

import struct
from typing import NamedTuple

ROS1, CDR, JSON, PROTOBUF = "ros1", "cdr", "json", "protobuf"  # as MCAP names them
NANO = 10**9  # format: nanoseconds in a second
LITTLE_ENDIAN = 1  # format: lowest bit of the second byte of a CDR message
PLAIN_CDR = (0, 1, 6, 7)  # format: second byte of a CDR message whose members follow each other, XCDR1 and XCDR2


class PackedPicture(NamedTuple):
    """A picture that is packed as JPEG, PNG, H.264 or the like.

    Attributes
    ----------
    stamp : int
        When it was taken, ns; 0 if the message does not say.
    form : str
        How it is packed, as the message names it.
    data : bytes
    """

    stamp: int
    form: str
    data: bytes


class Fields:
    """Reads the members of a message one after the other.

    Parameters
    ----------
    data : bytes
        A serialized message.
    ros1 : bool
        Whether it is packed as in ROS 1; otherwise it is CDR, as in ROS 2.

    Raises
    ------
    ValueError
        If the CDR is of a kind that no ROS writes; also while reading, if the message ends too early.
    """

    def __init__(self, data: bytes, ros1: bool) -> None:
        self._data, self._ros1 = memoryview(data), ros1
        self._start = self._at = 0 if ros1 else 4
        if not ros1 and (len(data) < 4 or data[0] != 0 or data[1] not in PLAIN_CDR):
            raise ValueError(f"a message begins with {bytes(data[:4]).hex()}, not with the header of plain CDR")
        little = ros1 or data[1] & LITTLE_ENDIAN
        self._uint32 = struct.Struct("<I" if little else ">I")

    def uint8(self) -> int:
        """Next byte."""
        return self._take(1)[0]

    def uint32(self) -> int:
        """Next unsigned integer of 32 bits."""
        if not self._ros1:
            self._at += (self._start - self._at) % self._uint32.size
        value: int = self._uint32.unpack(self._take(self._uint32.size))[0]
        return value

    def octets(self) -> memoryview:
        """Next sequence of bytes."""
        return self._take(self.uint32())

    def string(self) -> str:
        """Next string."""
        return bytes(self.octets()).rstrip(b"\0").decode("utf-8", "replace")

    def _take(self, count: int) -> memoryview:
        taken = self._data[self._at : self._at + count]
        if len(taken) != count:
            raise ValueError(f"a message of {len(self._data)} bytes ends too early")
        self._at += count
        return taken
