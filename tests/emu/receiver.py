"""Model of the quadcopter's receiver: it binds, hops between channels, keeps the last sticks, and has a timeout.

It receives a packet only if a real radio would: right channel, address, rate, CRC and size, and tuned in time. Its
clock has an error of `clock_ppm`. How long a real X5C waits for packets before its motors stop is not known;
`motor_timeout` is a guess that no test relies on.
"""

from collections.abc import Sequence

from nrf24 import US, Packet
from syma import BIND_ADDRESS, Sticks, bound_id, data_channels, sticks

SLOT = 4_000 * US
RETUNE = 130 * US
HZ = US * 1_000_000


class Quadcopter:
    """Receives packets in the order of their time.

    Parameters
    ----------
    fourth_bind_channel : int
        Differs between series: 0x20, or 0x09 as one was captured.
    clock_ppm : float
        Error of its clock.
    motor_timeout : float
        Time without a packet after which the motors stop, s.
    blocked_channels : sequence of int
        Channels on which it receives nothing, e.g. because of Wi-Fi.

    Attributes
    ----------
    id : bytes or None
        The address it is bound to.
    heard, missed : int
        Data packets received, and slots without one since the first.
    last : Sticks or None
        Sticks of the last packet.
    """

    def __init__(
        self,
        fourth_bind_channel: int = 0x20,
        clock_ppm: float = 0.0,
        motor_timeout: float = 1.0,
        blocked_channels: Sequence[int] = (),
    ) -> None:
        self.bind_channels = [0x4B, 0x30, 0x40, fourth_bind_channel]
        self.motor_timeout, self.blocked_channels = motor_timeout, set(blocked_channels)
        self._slot = round(SLOT * (1 + clock_ppm * 1e-6))
        self.id: bytes | None = None
        self.heard = self.missed = 0
        self.last: Sticks | None = None
        self.last_time = 0.0
        self._place, self._uses = 0, 0
        self._slot_ends: int | None = None  # of the slot in which it expects a packet, once in step
        self._silent = 0  # slots in a row

    @property
    def channels(self) -> list[int]:
        """What it hops over now."""
        return self.bind_channels if self.id is None else data_channels(self.id[0])

    def motors(self, time: float) -> int:
        """Throttle in force at a time, 0 ... 255."""
        if self.last is None or time - self.last_time > self.motor_timeout:
            return 0
        return self.last.throttle

    def listen(self, packets: Sequence[Packet]) -> None:
        """Take what went through the air, in order."""
        for packet in packets:
            self._pass(packet.cycle)
            if self._hears(packet):
                self._take(packet)

    def _pass(self, cycle: int) -> None:
        """Let slots go by in which nothing was heard."""
        while self._slot_ends is not None and cycle > self._slot_ends:
            self.missed += self.id is not None
            self._silent += 1
            self._slot_ends += self._slot
            self._step()
            if self._silent > 100:  # out of step: wait on one channel until something comes
                self._slot_ends = None

    def _step(self) -> None:
        self._uses += 1
        if self._uses == 2:
            self._uses, self._place = 0, (self._place + 1) % 4

    def _hears(self, packet: Packet) -> bool:
        address = BIND_ADDRESS if self.id is None else self.id
        return (
            packet.channel == self.channels[self._place]
            and packet.channel not in self.blocked_channels
            and packet.address == address
            and (packet.rate_kbit, packet.crc_bytes, len(packet.payload)) == (250, 2, 10)
        )

    def _take(self, packet: Packet) -> None:
        if self.id is None:
            self.id = bound_id(packet.payload)
            self._place = self._uses = 0
            return
        said = sticks(packet.payload)
        if said is None:
            return
        self.heard += 1
        self.last, self.last_time = said, packet.time
        if self._slot_ends is None:
            # The first of its channel or the second? Only the next packet tells: take it for the first.
            self._uses = 0
        self._silent = 0
        self._step()
        # The next packet begins one slot after this one; half a slot of grace.
        self._slot_ends = packet.cycle + self._slot + self._slot // 2
