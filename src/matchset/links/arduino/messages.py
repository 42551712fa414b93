"""Messages of the transmitter's firmware beside the channels of CRSF: status, configuration, binding.

Types 0xE0 ... 0xE4 are defined by this project; numbers of several bytes are big-endian, as everywhere in CRSF but the
channels.

==== =========== ================================================================================
type direction   payload
==== =========== ================================================================================
E0   to the host protocol, version (2), state, flags, good frames (2), bad frames (2), lost bytes,
                 age of the last good frame in ms (2), its channel 16 (2), throttle on the air,
                 then throttle, pitch, yaw, roll of the last good frame
E1   to the host result (stored, default, refused: flying, refused: values), configuration (14)
E2   to it       none: asks for E1
E3   to it       ``SET``, configuration (14): stores it, sends E1 back
E4   to it       ``BIND``: 345 bind packets, refused while flying
==== =========== ================================================================================

The configuration is: layout (1), id (5), two bind channels, reversed axes, options, three trims, tail; see `Config`.
"""

import struct
from typing import Literal, get_args

import msgspec

from matchset.image.errors import LinkError
from matchset.links import crsf_frame as crsf
from matchset.links.link import State

PROTOCOL = 1  # format: version of these messages
STATUS, CONFIG, READ_CONFIG, WRITE_CONFIG, BIND = 0xE0, 0xE1, 0xE2, 0xE3, 0xE4  # format: types of frames
BIND_DURATION = 1.38  # format: s, 345 packets of 4 ms
BAND_END_MHZ = 83  # format: above 2400, the end of the license-free band
CONFIG_LAYOUT, CONFIG_BYTES = 1, 14  # format: version and size of a configuration
ID_BYTES, MAX_TRIM = 5, 31  # format: bytes of an address; five bits of a trim
TRIM_SIGN = 0x20  # format: sign bit of a trim

_STATUS = struct.Struct(">BBBBBHHBHHBBbbb")
_STATES: tuple[State, ...] = get_args(State)
# format: bits of the flags
_WARNINGS = {
    1: "the radio chip does not answer: look at its wires and its supply",
    2: "it was restarted by its watchdog",
    4: "it was reset without loss of power",
}
_DEFAULT_CONFIG, _STORING, _MAY_ARM = 8, 16, 32  # format: further bits of the flags

Result = Literal["stored", "default", "refused: it is flying", "refused: a value is out of range"]
_RESULTS: tuple[Result, ...] = get_args(Result)
Axis = Literal["roll", "pitch", "yaw"]
AXES: tuple[Axis, ...] = get_args(Axis)


class StatusReport(msgspec.Struct, frozen=True):
    """A decoded status frame.

    Attributes
    ----------
    version, state, warnings
        As in `LinkStatus`.
    default_config, storing, may_arm : bool
        No valid configuration is stored; one is being stored; the arm switch would arm now.
    good, bad : int
        Channel frames accepted, and frames rejected (wrong CRC, value out of range), modulo 65536.
    lost_bytes : int
        Bytes that the board's serial port lost, modulo 256.
    age_ms : int
        Age of the last good frame, ms; 65535 at most.
    echo : int
        Channel 16 of the last good frame.
    throttle_on_air : int
        Throttle of the radio packets, 0 ... 255.
    heard : tuple of four ints
        Throttle 0 ... 255, pitch, yaw, roll -127 ... 127 of the last good frame.
    """

    version: str
    state: State
    warnings: tuple[str, ...]
    default_config: bool
    storing: bool
    may_arm: bool
    good: int
    bad: int
    lost_bytes: int
    age_ms: int
    echo: int
    throttle_on_air: int
    heard: tuple[int, int, int, int]

    @classmethod
    def decode(cls, payload: bytes) -> "StatusReport":
        """Decode a payload of type E0.

        Raises
        ------
        LinkError
            If the firmware speaks another version of the protocol.
        """
        if payload[:1] != bytes([PROTOCOL]) or len(payload) != _STATUS.size:
            raise LinkError(f"the firmware speaks protocol {payload[:1].hex()}, this program speaks {PROTOCOL:02x}")
        _, major, minor, state, flags, good, bad, lost, age, echo, on_air, *heard = _STATUS.unpack(payload)
        if state >= len(_STATES):
            raise LinkError(f"the firmware is in an unknown state, {state}")
        return cls(
            version=f"{major}.{minor}",
            state=_STATES[state],
            warnings=tuple(words for bit, words in _WARNINGS.items() if flags & bit),
            default_config=bool(flags & _DEFAULT_CONFIG),
            storing=bool(flags & _STORING),
            may_arm=bool(flags & _MAY_ARM),
            good=good,
            bad=bad,
            lost_bytes=lost,
            age_ms=age,
            echo=echo,
            throttle_on_air=on_air,
            heard=(heard[0], heard[1], heard[2], heard[3]),
        )


class Config(msgspec.Struct, frozen=True):
    """What differs between series of the toy; the firmware keeps it in its EEPROM.

    Attributes
    ----------
    id : bytes
        Five bytes, the radio address in flight. The first one selects the radio channels; the last is A2 for the X5C,
        A1 for the X5SC and X5SW. Transmitters in one room need different ones.
    bind_channels : tuple of two ints
        The fourth bind channel, MHz above 2400. Handsets use different ones; these two alternate.
    reversed : tuple of str
        Axes whose direction is reversed: their sign bit means positive instead of negative.
    bind_at_power_on : bool
        Bind at every power-on, as a handset does.
    trim_follows_stick : bool
        A quarter of each stick is sent as its trim, which gives more range; replaces `trims`.
    trims : tuple of three ints
        Pitch, yaw, roll, -31 ... 31, for a vehicle that drifts.
    tail : int
        Byte 8 of a packet: 0; the X5SW was seen to send 1.

    Raises
    ------
    ValueError
        If a value is out of range.
    """

    id: bytes = bytes.fromhex("7a9b0800a2")
    bind_channels: tuple[int, int] = (0x20, 0x09)
    reversed: tuple[Axis, ...] = ()
    bind_at_power_on: bool = True
    trim_follows_stick: bool = False
    trims: tuple[int, int, int] = (0, 0, 0)
    tail: int = 0

    def __post_init__(self) -> None:
        if len(self.id) != ID_BYTES:
            raise ValueError(f"an id has five bytes, got {self.id.hex(' ')!r}")
        if any(not 0 <= channel <= BAND_END_MHZ for channel in self.bind_channels) or len(self.bind_channels) != 2:
            raise ValueError(f"two bind channels of 0 ... {BAND_END_MHZ} are needed, got {self.bind_channels}")
        if unknown := set(self.reversed) - set(AXES):
            raise ValueError(f"axes are {', '.join(AXES)}, got {', '.join(sorted(unknown))}")
        if any(not -MAX_TRIM <= trim <= MAX_TRIM for trim in self.trims) or len(self.trims) != 3:
            raise ValueError(f"three trims of -31 ... 31 are needed, got {self.trims}")
        if not 0 <= self.tail <= 255:
            raise ValueError(f"the tail is a byte, got {self.tail}")

    def encode(self) -> bytes:
        """Return the 14 bytes that the firmware stores."""
        axes = sum(1 << AXES.index(axis) for axis in set(self.reversed))
        options = self.bind_at_power_on | self.trim_follows_stick << 1
        trims = bytes(abs(trim) | (TRIM_SIGN if trim < 0 else 0) for trim in self.trims)
        return (
            bytes([CONFIG_LAYOUT]) + self.id + bytes([*self.bind_channels, axes, options]) + trims + bytes([self.tail])
        )

    @classmethod
    def decode(cls, data: bytes) -> "Config":
        """Decode the 14 bytes.

        Raises
        ------
        LinkError
            If their layout is unknown, or a value is out of range.
        """
        if len(data) != CONFIG_BYTES or data[0] != CONFIG_LAYOUT:
            raise LinkError(f"the firmware's configuration has an unknown layout: {data.hex(' ')}")
        pitch, yaw, roll = ((byte & MAX_TRIM) * (-1 if byte & TRIM_SIGN else 1) for byte in data[10:13])
        try:
            return cls(
                id=data[1:6],
                bind_channels=(data[6], data[7]),
                reversed=tuple(axis for bit, axis in enumerate(AXES) if data[8] >> bit & 1),
                bind_at_power_on=bool(data[9] & 1),
                trim_follows_stick=bool(data[9] & 2),
                trims=(pitch, yaw, roll),
                tail=data[13],
            )
        except ValueError as error:
            raise LinkError(f"the firmware's configuration makes no sense: {error}") from error


def decode_config(payload: bytes) -> tuple[Result, Config]:
    """Decode a payload of type E1: the result of the request, and the configuration that is used."""
    if not payload or payload[0] >= len(_RESULTS):
        raise LinkError(f"the firmware answers with an unknown result: {payload.hex(' ')}")
    return _RESULTS[payload[0]], Config.decode(payload[1:])


def read_config_frame() -> bytes:
    """Return the frame that requests the configuration."""
    return crsf.frame(READ_CONFIG)


def write_config_frame(config: Config) -> bytes:
    """Return the frame that stores a configuration."""
    return crsf.frame(WRITE_CONFIG, b"SET" + config.encode())


def bind_frame() -> bytes:
    """Return the frame that starts binding."""
    return crsf.frame(BIND, b"BIND")
