"""Doubles of a transmitter module with its vehicle: a port with a clock of its own, and behind a pseudo-terminal.

The bytes of the telemetry are built here by hand, from the tables of the protocol, not by the code that reads them.
"""

import contextlib
import errno
import os
import pty
import select
import struct
import threading
import time
import tty
from dataclasses import dataclass, field
from typing import Self

SYNC_PERIOD, LINK_PERIOD, MODE_PERIOD = 0.2, 0.32, 0.5  # s between messages
LOST_AFTER = 0.5  # s without a frame until the flight controller's failsafe acts


def crc(data: bytes) -> int:
    value = 0
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value << 1 ^ 0xD5) & 0xFF if value & 0x80 else value << 1
    return value


def message(kind: int, payload: bytes, first: int = 0xEA) -> bytes:
    """A frame as a module sends it."""
    return bytes((first, len(payload) + 2, kind)) + payload + bytes((crc(bytes((kind,)) + payload),))


def channels_of(payload: bytes) -> list[int]:
    """Sixteen channels, bit by bit."""
    bits = "".join(f"{byte:08b}"[::-1] for byte in payload)
    return [int(bits[11 * k : 11 * k + 11][::-1], 2) for k in range(16)]


def link_statistics(quality: int = 100, rssi: int = 60, snr: int = 10) -> bytes:
    return message(0x14, struct.pack(">BBBbBBBBBb", rssi, rssi + 5, quality, snr, 0, 7, 2, 55, 99, 9))


def timing(interval: float, early: float) -> bytes:
    return message(0x3A, struct.pack(">BBBIi", 0xEA, 0xEE, 0x10, round(interval * 1e7), round(early * 1e7)))


def flight_mode(text: str) -> bytes:
    return message(0x21, text.encode() + b"\0")


@dataclass
class Module:
    """A module, its receiver, and a flight controller that arms by channel 5 with the throttle low.

    Attributes
    ----------
    now : float
        Its time, s.
    armed : bool
        Of the flight controller.
    heard : list
        Time and channels of every good frame.
    vehicle, telemetry, says_mode, stubborn, refuses, unplugged, mute, garbage
        Faults and kinds: no vehicle near; a vehicle without any news; without its mode; it never arms, it says that it
        will not; the port is gone; the module is silent; other bytes than frames.
    """

    now: float = 0.0
    armed: bool = False
    vehicle: bool = True
    telemetry: bool = True
    says_mode: bool = True
    stubborn: bool = False
    refuses: bool = False
    unplugged: bool = False
    mute: bool = False
    garbage: bytes = b""
    mode: str = "ANGL"
    interval: float = 0.004
    early: float = 0.0
    arm_channel: int = 5
    closed: bool = False
    heard: list[tuple[float, list[int]]] = field(default_factory=list)
    pings: int = 0
    receiver: int = -1

    def __post_init__(self) -> None:
        self._out, self._in = bytearray(), bytearray()
        self._due = {"sync": 0.0, "link": 0.0, "mode": 0.0}
        self._heard_at, self._may_arm = 0.0, False

    def __call__(self) -> float:
        return self.now

    @property
    def throttle(self) -> int:
        """What the motors get: the third channel, or nothing."""
        return self.heard[-1][1][2] if self.armed else 0

    def write(self, data: bytes) -> None:
        self._check()
        self._in += data
        while len(self._in) >= 2 and len(self._in) >= self._in[1] + 2:
            size = self._in[1] + 2
            one, self._in = bytes(self._in[:size]), self._in[size:]
            assert one[0] == 0xC8, one.hex()
            assert crc(one[2:-1]) == one[-1], one.hex()
            if one[2] == 0x16:
                self._channels(channels_of(one[3:-1]))
            elif one[2] == 0x32:
                self.receiver = one[7]
            elif one[2] == 0x28:
                self.pings += 1
                name = b"\xea\xeeBench TX\0" + b"ELRS" + bytes((0, 0, 0, 0)) + bytes((0, 3, 5, 2)) + b"\x10\0"
                self._out += message(0x29, name)

    def read(self) -> bytes:
        self._check()
        self._speak()
        data, self._out = bytes(self._out) + self.garbage, bytearray()
        return self.garbage if self.mute else data

    def close(self) -> None:
        self.closed = True

    def pass_time(self) -> None:
        """What the flight controller does without any frame."""
        if self.armed and self.now - self._heard_at > LOST_AFTER:
            self.armed = False

    def _check(self) -> None:
        if self.unplugged:
            raise OSError(errno.EIO, "Input/output error")
        self.pass_time()

    def _channels(self, values: list[int]) -> None:
        self.heard.append((self.now, values))
        self._heard_at = self.now
        high = values[self.arm_channel - 1] > 1500
        if not high:
            self.armed, self._may_arm = False, True
        elif not self.armed and self._may_arm and values[2] < 260 and not (self.stubborn or self.refuses):
            self.armed = True
        self._may_arm = self._may_arm and (not high or self.armed)

    def _speak(self) -> None:
        for name, period in (("sync", SYNC_PERIOD), ("link", LINK_PERIOD), ("mode", MODE_PERIOD)):
            if self.now < self._due[name]:
                continue
            self._due[name] = self.now + period
            if name == "sync":
                self._out += timing(self.interval, self.early)
            elif self.vehicle and self.telemetry:
                self._out += link_statistics() if name == "link" else self._vehicle_says()

    def _vehicle_says(self) -> bytes:
        text = self.mode + ("" if self.armed else "!" if self.refuses else "*")
        if self._heard_at and self.now - self._heard_at > LOST_AFTER:
            text = "!FS!"
        battery = message(0x08, struct.pack(">HHBHB", 38, 52, 0, 120, 80))
        attitude = message(0x1E, struct.pack(">hhh", -100, 200, 15708))
        return (flight_mode(text) if self.says_mode else b"") + battery + attitude


class PtyModule:
    """A `Module` behind a pseudo-terminal, in real time, until the end of a `with` block."""

    def __init__(self, module: Module | None = None) -> None:
        self._end, self._slave = pty.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._end, False)
        self.path = os.ttyname(self._slave)
        self.module = module or Module()
        self._begin = time.monotonic()
        self._stop, self._thread = threading.Event(), threading.Thread(target=self._run, daemon=True)

    @property
    def uri(self) -> str:
        return f"crsf://{self.path}"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def unplug(self) -> None:
        """Take the device away."""
        if not self._stop.is_set():
            self._stop.set()
            self._thread.join()
            os.close(self._slave)
            os.close(self._end)

    def wait(self, armed: bool, timeout: float = 20.0) -> None:
        """Wait until the flight controller is armed, or is not."""
        end = time.monotonic() + timeout
        while self.module.armed != armed:
            assert time.monotonic() < end, f"not armed={armed} within {timeout} s"
            time.sleep(0.002)

    def wait_for_throttle(self, throttle: int, timeout: float = 20.0) -> None:
        """Wait until the motors get so much."""
        end = time.monotonic() + timeout
        while self.module.throttle != throttle:
            assert time.monotonic() < end, f"no throttle of {throttle} within {timeout} s"
            time.sleep(0.002)

    def _run(self) -> None:
        while not self._stop.is_set():
            ready = select.select([self._end], [], [], 0.001)[0]
            self.module.now = time.monotonic() - self._begin
            if ready:
                self.module.write(os.read(self._end, 4096))
            said = self.module.read()
            with contextlib.suppress(BlockingIOError):
                while said:
                    said = said[os.write(self._end, said) :]
