"""A model of the nRF24L01+ as its data sheet describes it: it sends what the chip would send, and says why not.

It is driven from outside by the three things that reach the chip, each with its time in cycles of 16 MHz:
``select`` (CSN), ``enable`` (CE) and ``exchange`` (a byte on SPI).
"""

from dataclasses import dataclass, field

US = 16  # cycles
SETTLING = 130 * US  # from standby to the first bit
AWAKE = 4_500 * US  # from power down to standby, with the slowest crystal
PULSE = 10 * US  # shortest CE that starts a transmission

CONFIG, EN_AA, SETUP_AW, RF_CH, RF_SETUP, STATUS = 0x00, 0x01, 0x03, 0x05, 0x06, 0x07
TX_ADDR, FIFO_STATUS = 0x10, 0x17
WIDE = {0x0A: 5, 0x0B: 5, TX_ADDR: 5}
READ_ONLY = {0x08, 0x09, FIFO_STATUS}
RESET = {
    **dict.fromkeys(range(0x1E), 0),
    CONFIG: 0x08,
    EN_AA: 0x3F,
    0x02: 0x03,
    SETUP_AW: 0x03,
    0x04: 0x03,
    RF_CH: 0x02,
    RF_SETUP: 0x0E,
    0x0C: 0xC3,
    0x0D: 0xC4,
    0x0E: 0xC5,
    0x0F: 0xC6,
}
MAX_RT, TX_DS = 0x10, 0x20


@dataclass(frozen=True)
class Packet:
    """What went through the air; ``cycle`` is the start of its preamble."""

    cycle: int
    end: int
    channel: int
    address: bytes
    payload: bytes
    rate_kbit: int
    crc_bytes: int

    @property
    def time(self) -> float:
        """Start, s."""
        return self.cycle / (US * 1e6)


@dataclass(frozen=True)
class Refusal:
    """What a real chip would not have done, or done to our harm."""

    cycle: int
    reason: str


@dataclass
class Nrf24:
    """The chip.

    Attributes
    ----------
    packets, refusals
        Everything since it was made.
    commands : list of bytes
        What each selection of the chip brought, in order.
    present : bool
        False: nobody is on the bus, and MISO floats high.
    """

    packets: list[Packet] = field(default_factory=list)
    refusals: list[Refusal] = field(default_factory=list)
    commands: list[bytes] = field(default_factory=list)
    present: bool = True

    def __post_init__(self) -> None:
        self.power_cycle(0)
        self._selected = self._enabled = False
        self._bytes = bytearray()

    def power_cycle(self, cycle: int) -> None:
        """Lose and regain the supply: registers and queue are as new."""
        self.registers = dict(RESET)
        self.wide = {0x0A: b"\xe7" * 5, 0x0B: b"\xc2" * 5, TX_ADDR: b"\xe7" * 5}
        self._queue: list[bytes] = []
        self._flags = 0
        self._ready_at: int | None = None
        self._raised_at = cycle
        self._start: int | None = None  # of the preamble on its way

    # ---- pins ----

    def select(self, low: bool, cycle: int) -> None:
        """CSN."""
        self.advance(cycle)
        if low and not self._selected:
            self._bytes = bytearray()
        elif not low and self._selected and self._bytes:
            self.commands.append(bytes(self._bytes))
            if self.present:
                self._execute(bytes(self._bytes), cycle)
        self._selected = low

    def enable(self, high: bool, cycle: int) -> None:
        """CE."""
        self.advance(cycle)
        if high and not self._enabled:
            self._raised_at = cycle
            if self._ready_at is not None and cycle < self._ready_at and self._queue:
                self._refuse(cycle, "CE raised before the crystal runs")
        elif not high and self._enabled and self._queue and cycle - self._raised_at < PULSE:
            self._refuse(cycle, "CE pulse shorter than 10 us")
            self._start = None
        self._enabled = high
        self._try(cycle)

    def exchange(self, byte: int, cycle: int) -> int:
        """Exchange a byte on SPI; the first answer of a selection is STATUS."""
        self.advance(cycle)
        if not self._selected:
            self._refuse(cycle, "a byte while the chip is not selected")
            return 0xFF
        self._bytes.append(byte)
        if not self.present:
            return 0xFF
        first, place = self._bytes[0], len(self._bytes) - 1
        if place == 0:
            return self.status()
        if first < 0x20:
            return self._read(first, place - 1)
        return 0

    # ---- inside ----

    def status(self) -> int:
        """STATUS: flags, receive queue empty, transmit queue full."""
        return self._flags | 0x0E | (len(self._queue) == 3)

    def _read(self, register: int, place: int) -> int:
        if register in self.wide:
            return self.wide[register][place] if place < 5 else 0
        if register == STATUS:
            return self.status()
        if register == FIFO_STATUS:
            return 0x01 | (0x10 if not self._queue else 0x20 if len(self._queue) == 3 else 0)
        return self.registers.get(register, 0)

    def _execute(self, words: bytes, cycle: int) -> None:
        command, data = words[0], words[1:]
        if command & 0xE0 == 0x20:
            self._write(command & 0x1F, data, cycle)
        elif command == 0xA0:
            if not 1 <= len(data) <= 32:
                self._refuse(cycle, f"a payload of {len(data)} bytes")
            elif len(self._queue) == 3:
                self._refuse(cycle, "transmit queue full")
            else:
                self._queue.append(data)
                self._try(cycle)
        elif command == 0xE1:
            if self._start is not None:
                self._refuse(cycle, "flushed while on the air")
            self._queue.clear()
            self._start = None
        elif command not in (0xFF, 0xE2, 0x60, 0x61) and command >= 0x20:
            self._refuse(cycle, f"unknown command {command:02X}")

    def _write(self, register: int, data: bytes, cycle: int) -> None:
        if register == STATUS:
            self._flags &= ~data[0]
            self._try(cycle)
            return
        if self._start is not None:
            self._refuse(cycle, f"register {register:02X} written while on the air")
        if register in self.wide:
            self.wide[register] = data[:5] + self.wide[register][len(data) :]
        elif register in READ_ONLY or register not in self.registers:
            return
        else:
            was = self.registers[register]
            self.registers[register] = data[0]
            if register == CONFIG:
                self._power(was, data[0], cycle)
        self._try(cycle)

    def _power(self, was: int, now: int, cycle: int) -> None:
        if now & 2 and not was & 2:
            self._ready_at = cycle + AWAKE
        elif not now & 2:
            self._ready_at = None

    def _try(self, cycle: int) -> None:
        """Begin to send if the chip would."""
        if self._start is not None or not self._queue or not self._enabled:
            return
        config = self.registers[CONFIG]
        if self._ready_at is None:
            self._give_up(cycle, "powered down")
        elif cycle < self._ready_at:
            self._give_up(cycle, "the crystal does not run yet")
        elif config & 1:
            self._give_up(cycle, "it is set to receive")
        elif self.registers[EN_AA] & 1:
            self._give_up(cycle, "it would wait for an acknowledgement")
        elif self.registers[SETUP_AW] & 3 == 0:
            self._give_up(cycle, "illegal width of address")
        elif self.registers[RF_CH] > 125:
            self._give_up(cycle, f"channel {self.registers[RF_CH]}")
        elif not self._flags & MAX_RT:
            self._start = cycle + SETTLING

    def _give_up(self, cycle: int, reason: str) -> None:
        self._refuse(cycle, reason)
        self._queue.clear()

    def _refuse(self, cycle: int, reason: str) -> None:
        self.refusals.append(Refusal(cycle, reason))

    @property
    def _rate_kbit(self) -> int:
        setup = self.registers[RF_SETUP]
        return 250 if setup & 0x20 else 2000 if setup & 0x08 else 1000

    def advance(self, cycle: int) -> None:
        """Let time pass: a packet whose last bit is sent by then has been sent."""
        while self._start is not None:
            payload, crc = self._queue[0], (0, 0, 1, 2)[self.registers[CONFIG] >> 2 & 3]
            width = (self.registers[SETUP_AW] & 3) + 2
            bits = 8 * (1 + width + len(payload) + crc)
            end = self._start + bits * US * 1000 // self._rate_kbit
            if cycle < end:
                return
            address = self.wide[TX_ADDR][:width]
            channel, rate = self.registers[RF_CH], self._rate_kbit
            self.packets.append(Packet(self._start, end, channel, address, payload, rate, crc))
            self._flags |= TX_DS
            self._queue.pop(0)
            self._start = None
            self._try(end)
