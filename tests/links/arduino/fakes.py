"""A port that speaks the transmitter's protocol without any transmitter, and breaks on demand.

It is the firmware once more, in Python and in steps of 4 ms; `tests/emu/test_emu_link.py` plays the same session to it
and to the emulated firmware.
"""

import errno
import struct
from dataclasses import dataclass, field

from matchset.links import crsf_frame as crsf
from matchset.links.arduino import channels
from matchset.links.arduino.messages import BIND, CONFIG, READ_CONFIG, STATUS, WRITE_CONFIG, Config
from matchset.links.link import State

TICK = 0.004  # s
STICK_STEP, THROTTLE_STEP, STEP_TICKS = 48, 38, 10  # as in pilot.h
STATES: tuple[State, ...] = ("binding", "locked", "armed", "holding", "failsafe")


@dataclass
class Clock:
    """Time that passes only when somebody sleeps."""

    now: float = 0.0

    def __call__(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@dataclass
class FakePort:
    """The transmitter at the other end of a perfect cable.

    Attributes
    ----------
    clock : Clock
        Its time.
    state, config, throttle
        Of the firmware; `throttle` is what would be on the air, 0 ... 255.
    unplugged, mute, stubborn : bool
        Faults: the device is gone; it hears but does not speak; it never arms.
    warnings : int
        Flags to report.
    heard : list
        The channels of every good frame.
    """

    clock: Clock = field(default_factory=Clock)
    state: State = "locked"
    config: Config = field(default_factory=Config)
    stored: bool = False
    unplugged: bool = False
    mute: bool = False
    stubborn: bool = False
    warnings: int = 0
    closed: bool = False
    heard: list[list[int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._parser, self._out = crsf.CrsfParser(), bytearray()
        self._tick, self._age, self._status_age = 0, 16384, 0
        self._lows = self._bind_left = self._good = self._refused = 0
        self._sticks = self._before = self._flown = (0, 0, 0, 0)
        self._told: State = self.state
        self._told_times = 0

    # ---- Port ----

    def write(self, data: bytes) -> None:
        self._check()
        self._pass()
        for kind, payload in self._parser.feed(data):
            if kind == crsf.CHANNELS_PACKED:
                self._channels(crsf.unpack_channels(payload))
            elif kind == BIND and payload == b"BIND" and self.state not in ("armed", "holding"):
                self.state, self._bind_left, self._lows = "binding", 345, 0
            elif kind == READ_CONFIG:
                self._say(CONFIG, bytes([not self.stored]) + self.config.encode())
            elif kind == WRITE_CONFIG and payload[:3] == b"SET":
                flying = self.state in ("armed", "holding")
                if not flying:
                    self.config, self.stored = Config.decode(payload[3:]), True
                self._say(CONFIG, bytes([2 if flying else 0]) + self.config.encode())

    def read(self) -> bytes:
        self._check()
        self._pass()
        data, self._out = bytes(self._out), bytearray()
        return b"" if self.mute else data

    def close(self) -> None:
        self.closed = True

    # ---- firmware ----

    @property
    def throttle(self) -> int:
        self._pass()
        return self._flown[0] if self.state in ("armed", "holding") else 0

    def _check(self) -> None:
        if self.unplugged:
            raise OSError(errno.EIO, "Input/output error")

    def _pass(self) -> None:
        while (self._tick + 1) * TICK <= self.clock() + 1e-9:
            self._tick += 1
            self._age = min(self._age + 1, 16384)
            self._status_age += 1
            if self._age >= 61:
                self._lows = 0
                if self.state in ("armed", "holding"):
                    self.state = "failsafe"
            elif self._age >= 26 and self.state == "armed":
                self.state = "holding"
            due = self._status_age >= 25 or self.state != self._told or self._told_times < 2
            if self.state == "binding":
                self._bind_left -= 1
                self.state = "binding" if self._bind_left > 0 else "locked"
            if due:
                self._status()

    def _channels(self, values: list[int]) -> None:
        if any(not crsf.CHANNEL_LOW <= value <= crsf.CHANNEL_HIGH for value in values):
            self._refused += 1
            return
        self.heard.append(values)
        roll, pitch, throttle, yaw, arm = values[:5]
        top, sticks = channels.throttle_byte(throttle), map(channels.stick_byte, (pitch, yaw, roll))
        before, self._sticks = self._sticks, (top, *sticks)  # type: ignore[assignment]
        self._believe(before)
        self._before = before
        self._good, self._age = self._good + 1, 0
        if self.state in ("armed", "holding"):
            self.state, self._lows = ("armed" if arm >= 1500 else "locked"), 0
        elif self.state != "binding" and arm <= 500:
            self.state, self._lows = "locked", 0 if top else min(self._lows + 1, 3)
        elif self.state != "binding":
            if arm >= 1500 and top == 0 and self._lows == 3 and not self.stubborn:
                self.state, self._flown = "armed", (0, 0, 0, 0)
            else:
                self._lows = 0
        self._status()

    def _believe(self, before: tuple[int, int, int, int]) -> None:
        steps = 1 + self._age // STEP_TICKS
        bounds = [THROTTLE_STEP * steps] + [STICK_STEP * steps] * 3
        believed = []
        for said, step, *known in zip(self._sticks, bounds, before, self._before, self._flown, strict=True):
            believed.append(min(max(said, min(*known, 0) - step), max(*known, 0) + step))
        self._flown = (believed[0], believed[1], believed[2], believed[3])

    def _status(self) -> None:
        may_arm = self.state == "locked" and self._lows == 3
        flags = self.warnings | (0 if self.stored else 8) | (32 if may_arm else 0)
        echo = self.heard[-1][15] if self.heard else 0
        age_ms = min(self._age * 4, 65535)
        counts = self._good & 0xFFFF, self._parser.bad + self._refused & 0xFFFF, 0, age_ms, echo
        on_air = self._flown[0] if self.state in ("armed", "holding") else 0
        state = STATES.index(self.state)
        self._say(STATUS, struct.pack(">BBBBBHHBHHBBbbb", 1, 1, 0, state, flags, *counts, on_air, *self._sticks))
        self._told_times = min(self._told_times + 1, 2) if self.state == self._told else 1
        self._told, self._status_age = self.state, 0

    def _say(self, kind: int, payload: bytes) -> None:
        self._out += crsf.frame(kind, payload)
