"""MAVLink 2 packets: `PacketWriter` makes them, `MavlinkParser` finds them in a stream of bytes.

A packet is ``FD | n | flags that must be understood | other flags | sequence number | system | component | message id,
3 bytes | n bytes of payload | CRC, 2 bytes``, after a signed one 13 bytes of signature. The CRC covers all after FD and
then the message's CRC_EXTRA. Signatures are neither made nor checked.
"""

from typing import NamedTuple

from matchset.links.mavlink.checksum import accumulate
from matchset.links.mavlink.message import MavlinkMessage, Values
from matchset.links.mavlink.messages import BY_ID, BY_NAME, HEARTBEAT

MARK, OLD_MARK = 0xFD, 0xFE  # format: first byte of a packet of MAVLink 2, of MAVLink 1
HEADER, OLD_HEADER, CRC_BYTES, SIGNATURE = 10, 6, 2, 13  # format: bytes of each part
SIGNED = 0x01  # format: flag of a signed packet
NUMBERS = 256  # format: sequence numbers are modulo this
LATE = 128  # format: a sequence number that is farther ahead than this is one that came late


class MavlinkPacket(NamedTuple):
    """A packet that arrived whole.

    Attributes
    ----------
    system, component : int
        Who sent it.
    message : MavlinkMessage
    values : dict
        By the names of the message's fields.
    signed : bool
        It carries a signature, which nobody checked.
    """

    system: int
    component: int
    message: MavlinkMessage
    values: Values
    signed: bool = False


def checksum(body: bytes, extra: int) -> bytes:
    """Return the two last bytes of a packet, from all its bytes between the first and these."""
    return accumulate(bytes([extra]), accumulate(body)).to_bytes(CRC_BYTES, "little")


class PacketWriter:
    """Makes the packets of one sender, with sequence numbers.

    Parameters
    ----------
    system, component : int
        Of the sender, 1 ... 255.

    Raises
    ------
    ValueError
        If one of them is out of range.
    """

    def __init__(self, system: int, component: int) -> None:
        for name, value in (("system", system), ("component", component)):
            if not 1 <= value < NUMBERS:
                raise ValueError(f"{name} must be within 1 ... 255, got {value}")
        self.system, self.component, self._number = system, component, 0

    def write(self, name: str, values: Values) -> bytes:
        """Return the next packet.

        Parameters
        ----------
        name : str
            Of a message in `messages.MESSAGES`.
        values : dict
            By the names of its fields; what is missing is zero.

        Raises
        ------
        ValueError
            If a value does not fit into its field.
        """
        message = BY_NAME[name]
        payload = message.pack(values)
        header = bytes([len(payload), 0, 0, self._number, self.system, self.component])
        body = header + message.id.to_bytes(3, "little") + payload
        self._number = (self._number + 1) % NUMBERS
        return bytes([MARK]) + body + checksum(body, message.crc_extra)


class MavlinkParser:
    """Finds packets in a stream of bytes, and synchronizes again after noise.

    A message that is not in `messages.MESSAGES` cannot be checked. It is skipped as a whole if another packet, or
    nothing yet, follows where it would end; its number counts.

    Attributes
    ----------
    received, lost : int
        Packets so far, and those that are missing by their sequence numbers.
    bad : int
        Packets with a wrong CRC.
    unknown : int
        Packets of messages that are not in the table.
    old : int
        Heartbeats in MAVLink 1.
    """

    def __init__(self) -> None:
        self._bytes = bytearray()
        self._numbers: dict[tuple[int, int], int] = {}
        self.received = self.lost = self.bad = self.unknown = self.old = 0

    def feed(self, data: bytes) -> list[MavlinkPacket]:
        """Add the next bytes of the stream; returns every packet that is complete now."""
        self._bytes += data
        found: list[MavlinkPacket] = []
        start, stream = 0, self._bytes
        while start < len(stream):
            if stream[start] not in (MARK, OLD_MARK):
                start += 1
                continue
            end = self._end(start)
            if end > len(stream):
                break
            start = self._read(start, end, found)
        del stream[:start]
        return found

    def _end(self, start: int) -> int:
        """Where a packet that begins here would end; beyond the stream if that is not known yet."""
        stream = self._bytes
        if len(stream) - start < 3:
            return len(stream) + 1
        if stream[start] == OLD_MARK:
            return start + OLD_HEADER + stream[start + 1] + CRC_BYTES
        signature = SIGNATURE if stream[start + 2] & SIGNED else 0
        return start + HEADER + stream[start + 1] + CRC_BYTES + signature

    def _read(self, start: int, end: int, found: list[MavlinkPacket]) -> int:
        """Read what may be a packet; returns where to read on."""
        data = bytes(self._bytes[start:end])
        if data[0] == OLD_MARK:
            is_heartbeat = data[5] == HEARTBEAT.id and checksum(data[1:-2], HEARTBEAT.crc_extra) == data[-2:]
            self.old += is_heartbeat
            return end if is_heartbeat else start + 1
        body = HEADER + data[1]
        message = BY_ID.get(int.from_bytes(data[7:10], "little"))
        if data[2] & ~SIGNED:  # a flag that must be understood
            return start + 1
        if message is None:
            if end < len(self._bytes) and self._bytes[end] not in (MARK, OLD_MARK):
                return start + 1
            self.unknown += 1
            self._count(data)
            return end
        if checksum(data[1:body], message.crc_extra) != data[body : body + CRC_BYTES]:
            self.bad += 1
            return start + 1
        self._count(data)
        signed = bool(data[2] & SIGNED)
        found.append(MavlinkPacket(data[5], data[6], message, message.unpack(data[HEADER:body]), signed))
        return end

    def _count(self, data: bytes) -> None:
        sender, number = (data[5], data[6]), data[4]
        self.received += 1
        missing = (number - self._numbers.get(sender, number - 1) - 1) % NUMBERS
        if missing < LATE:
            self.lost += missing
            self._numbers[sender] = number
