"""What a transmitter module says: link statistics, battery, attitude, flight mode, timing, its name; `decode`.

Numbers of several bytes are big-endian. Frames of other types (GPS, barometer, parameters) are ignored.

==== ================== ================================================================================
type what               payload
==== ================== ================================================================================
08   battery            voltage (2, 0.1 V), current (2, 0.1 A), used (3, mAh), left (1, %)
14   link statistics    rssi of two antennas (-dBm), quality (%), snr (dB), antenna, rate, power, then
                        rssi, quality, snr of the way back
1E   attitude           pitch, roll, yaw (2 each, 1e-4 rad)
21   flight mode        text, ended by 0
29   device             to, from, name ended by 0, serial, hardware, software (4 each), 2 more
32   command, sent      to, from, realm, command, number of the receiver, a checksum of its own
3A   timing             to, from, 10, interval (4, 100 ns), how much too early (4, signed, 100 ns)
==== ================== ================================================================================
"""

import struct

import msgspec

BATTERY, LINK, ATTITUDE, FLIGHT_MODE = 0x08, 0x14, 0x1E, 0x21  # format: types of frames from the vehicle
PING, DEVICE, COMMAND, TIMING = 0x28, 0x29, 0x32, 0x3A  # format: types of frames to and from the module
FROM_VEHICLE = (0x02, 0x07, BATTERY, 0x09, ATTITUDE, FLIGHT_MODE)  # format: with GPS, climb rate, barometer
ADDRESSES = bytes((0xC8, 0xEA, 0xEE, 0xEC, 0x00))  # format: first bytes of frames: who it is for
HANDSET, MODULE, EVERYBODY = 0xEA, 0xEE, 0x00  # format: addresses
PING_PAYLOAD = bytes((EVERYBODY, HANDSET))  # format: to, from
TICK = 1e-7  # format: s, unit of the timing
_TIMING_SUBTYPE = 0x10  # format: of frame 3A
_SELECT_RECEIVER = bytes((MODULE, HANDSET, 0x10, 0x05))  # format: to, from, realm and command of frame 32
_COMMAND_POLYNOMIAL = 0xBA  # format: of the second checksum of frame 32
_ARMABLE, _REFUSES = "*", "!"  # format: what a flight controller adds to its mode while it is disarmed
_GROUNDED = ("OK", "WAIT", "!ERR")  # format: modes of INAV that are shown only while it is disarmed
_FAILSAFE = "!FS!"  # format: mode while the receiver hears nothing
_RATE_MODES = ("ACRO", "AIR")  # format: modes in which a stick commands a rate, not an angle


class LinkStatistics(msgspec.Struct, frozen=True):
    """How well vehicle and module hear each other.

    Attributes
    ----------
    rssi : int
        Strength at the receiver, dBm.
    quality, quality_back : int
        Share of packets that arrive at the vehicle, and at the module, percent.
    snr : int
        Signal to noise at the receiver, dB.
    """

    rssi: int
    quality: int
    snr: int
    quality_back: int


class Battery(msgspec.Struct, frozen=True):
    """Battery of the vehicle: V, A, charge used in Ah, and what is left, 0 ... 1."""

    voltage: float
    current: float
    used: float
    left: float


class CrsfAttitude(msgspec.Struct, frozen=True):
    """Attitude by the flight controller, rad: roll to the right, nose up, clockwise seen from above."""

    roll: float
    pitch: float
    yaw: float


class FlightMode(msgspec.Struct, frozen=True):
    """Mode of the flight controller, as it names it.

    Attributes
    ----------
    text : str
        E.g. ``ANGL`` in flight, ``ANGL*`` when it may be armed, ``ANGL!`` when it may not.
    """

    text: str

    @property
    def failsafe(self) -> bool:
        """Whether the receiver hears nothing."""
        return self.text == _FAILSAFE

    @property
    def refuses(self) -> bool:
        """Whether the flight controller refuses to be armed."""
        return self.text == "!ERR" or (self.text.endswith(_REFUSES) and not self.failsafe)

    @property
    def disarmed(self) -> bool:
        """Whether the motors are off."""
        return self.refuses or self.text.endswith((_ARMABLE, "?")) or self.text in _GROUNDED

    @property
    def commands_rates(self) -> bool:
        """Whether a stick commands a rate: a follower's sticks command angles."""
        return self.text.rstrip("*!?") in _RATE_MODES


class FrameTiming(msgspec.Struct, frozen=True):
    """When the module wants frames: its interval, and by how much the last one came too early, s."""

    interval: float
    early: float


class Device(msgspec.Struct, frozen=True):
    """Name of a device and version of its software."""

    name: str
    version: str


class CrsfTelemetry(msgspec.Struct, frozen=True):
    """What was said last; None where nothing came, age of the last news of the vehicle in s."""

    link: LinkStatistics | None
    battery: Battery | None
    attitude: CrsfAttitude | None
    mode: FlightMode | None
    module: Device | None
    age: float


Message = LinkStatistics | Battery | CrsfAttitude | FlightMode | FrameTiming | Device

_LINK, _BATTERY, _TIMING = struct.Struct(">BBBbBBBBBb"), struct.Struct(">HHBHB"), struct.Struct(">BBBIi")


def decode(kind: int, payload: bytes) -> Message | None:
    """Decode a frame; None if it is of another type or for somebody else.

    Raises
    ------
    ValueError
        If it is of a known type and makes no sense.
    """
    try:
        if kind == LINK:
            first, second, quality, snr, antenna, _, _, _, back, _ = _LINK.unpack(payload)
            return LinkStatistics(-(second if antenna else first), _percent(quality), snr, _percent(back))
        if kind == BATTERY:
            voltage, current, high, low, left = _BATTERY.unpack(payload)
            return Battery(voltage / 10, current / 10, (high << 16 | low) / 1000, _percent(left) / 100)
        if kind == ATTITUDE:
            pitch, roll, yaw = struct.unpack(">hhh", payload)
            return CrsfAttitude(roll / 1e4, pitch / 1e4, yaw / 1e4)
    except struct.error:
        raise ValueError(f"a frame of type {kind:02x} has no {len(payload)} bytes") from None
    if kind == FLIGHT_MODE:
        return FlightMode(_text(payload)[0])
    if kind == TIMING and payload[2:3] == bytes((_TIMING_SUBTYPE,)):
        return _timing(payload)
    if kind == DEVICE and payload[1:2] == bytes((MODULE,)):
        return _device(payload[2:])
    return None


def select_receiver(number: int) -> bytes:
    """Return the payload of a frame of type 32 that gives the module the number of its receiver, 0 ... 63."""
    payload = _SELECT_RECEIVER + bytes((number,))
    return payload + bytes((command_checksum(payload),))


def command_checksum(payload: bytes) -> int:
    """Return the checksum within a frame of type 32, over type and payload: polynomial 0xBA, start 0."""
    value = 0
    for byte in bytes((COMMAND,)) + payload:
        value ^= byte
        for _ in range(8):
            value = (value << 1 ^ (_COMMAND_POLYNOMIAL if value & 0x80 else 0)) & 0xFF
    return value


def _percent(value: int) -> int:
    if value > 100:
        raise ValueError(f"{value} is no percentage")
    return value


def _text(payload: bytes) -> tuple[str, bytes]:
    """Text up to its zero, and what follows."""
    text, zero, rest = payload.partition(b"\0")
    if not zero or not text.isascii() or not text.decode("ascii").isprintable():
        raise ValueError(f"{payload!r} is no text")
    return text.decode("ascii"), rest


def _timing(payload: bytes) -> FrameTiming:
    if len(payload) != _TIMING.size:
        raise ValueError(f"a frame of type {TIMING:02x} has no {len(payload)} bytes")
    *_, interval, early = _TIMING.unpack(payload)
    return FrameTiming(interval * TICK, early * TICK)


def _device(payload: bytes) -> Device:
    name, rest = _text(payload)
    if len(rest) < 12:
        raise ValueError(f"a frame of type {DEVICE:02x} has no {len(payload)} bytes")
    return Device(name, ".".join(map(str, rest[9:12])))
