"""An autopilot at the other end of a perfect cable: it arms, refuses, flies, changes its mode and falls silent.

`test_mavsdk.py` has one that others wrote.
"""

import errno
import struct
from dataclasses import dataclass, field
from typing import Any

from fakes import Clock

from matchset.links.mavlink.packet import MavlinkParser, PacketWriter

ARM, SET_MODE, FORCE = 400, 176, 21196
STABILIZE, LOITER, RTL = 0, 5, 6
QUADROTOR, ARDUPILOT, PX4 = 2, 3, 12


@dataclass
class FakeAutopilot:
    """Speaks as vehicle `system` from the address `sender`.

    Attributes
    ----------
    refusal : str
        What it says instead of arming.
    flying : bool
        It disarms by force only.
    mute, deaf, stubborn, unplugged : bool
        It does not speak; it does not hear; it accepts but does nothing; the port is gone.
    sticks : list
        x, y, z, r of every MANUAL_CONTROL.
    asked : list
        Every command with its parameters.
    """

    clock: Clock = field(default_factory=Clock)
    system: int = 1
    sender: str = "10.0.0.2:14550"
    kind: int = QUADROTOR
    autopilot: int = ARDUPILOT
    mode: int = LOITER
    armed: bool = False
    refusal: str = ""
    flying: bool = False
    mute: bool = False
    deaf: bool = False
    stubborn: bool = False
    unplugged: bool = False
    closed: bool = False
    offset: float = 1000.0
    settings: dict[str, float] = field(
        default_factory=lambda: {"RC_OVERRIDE_TIME": 0.5, "FS_THR_ENABLE": 3, "FS_GCS_ENABLE": 5, "COM_RC_LOSS_T": 0.5}
    )
    sticks: list[tuple[int, int, int, int]] = field(default_factory=list)
    asked: list[tuple[int, tuple[float, ...]]] = field(default_factory=list)
    heard: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._writer, self._parser, self._out = PacketWriter(self.system, 1), MavlinkParser(), bytearray()
        self._beat_at = self._attitude_at = -10.0
        self.attitudes = False

    def say(self, name: str, **values: Any) -> None:
        self._out += self._writer.write(name, values)

    def say_text(self, text: str, severity: int = 2) -> None:
        self.say("STATUSTEXT", severity=severity, text=text)

    def beat(self) -> None:
        self._beat_at = self.clock()
        self.say(
            "HEARTBEAT",
            type=self.kind,
            autopilot=self.autopilot,
            base_mode=1 | 128 * self.armed,
            custom_mode=self.mode,
            system_status=4 if self.armed else 3,
            mavlink_version=3,
        )

    def write(self, data: bytes) -> None:
        if self.unplugged:
            raise OSError(errno.ENODEV, "No such device")
        for packet in [] if self.deaf else self._parser.feed(data):
            self.heard.append(packet.message.name)
            self._hear(packet.message.name, packet.values)

    def read(self) -> list[tuple[str, bytes]]:
        if self.unplugged:
            raise OSError(errno.ENODEV, "No such device")
        if self.clock() - self._beat_at >= 1.0:
            self.beat()
        if self.attitudes and self.clock() - self._attitude_at >= 0.05:
            self._attitude_at = self.clock()
            self.say("ATTITUDE", time_boot_ms=5, roll=0.1, pitch=-0.2, yaw=0.3)
        data, self._out = bytes(self._out), bytearray()
        return [] if self.mute or not data else [(self.sender, data)]

    def choose(self, sender: str) -> None:
        assert sender == self.sender

    def close(self) -> None:
        self.closed = True

    def _hear(self, name: str, values: dict[str, Any]) -> None:
        if name == "MANUAL_CONTROL" and values["target"] == self.system:
            self.sticks.append((values["x"], values["y"], values["z"], values["r"]))
        elif name == "TIMESYNC" and values["tc1"] == 0:
            self.say("TIMESYNC", tc1=round(1e9 * (self.clock() + self.offset)), ts1=values["ts1"])
        elif name == "PARAM_REQUEST_READ" and values["param_id"] in self.settings:
            self._tell_setting(values["param_id"])
        elif name == "COMMAND_LONG" and values["target_system"] == self.system:
            parameters = tuple(values[f"param{k}"] for k in range(1, 8))
            self.asked.append((values["command"], parameters))
            result = self._do(values["command"], *parameters[:3])
            if result is not None:
                self.say("COMMAND_ACK", command=values["command"], result=result, target_system=255)

    def _tell_setting(self, name: str) -> None:
        """ArduPilot sends every number as a float, PX4 integers as their bytes."""
        value = self.settings[name]
        kind = 6 if isinstance(value, int) else 9
        if self.autopilot == PX4 and kind == 6:
            (value,) = struct.unpack("<f", struct.pack("<i", value))
        self.say("PARAM_VALUE", param_id=name, param_value=value, param_type=kind)

    def _do(self, command: int, first: float, second: float, third: float) -> int | None:
        if command == 511:
            self.attitudes = self.attitudes or first == 30
        elif command == SET_MODE and not self.stubborn:
            self.mode = int(second) if self.autopilot == ARDUPILOT else int(second) << 16 | int(third) << 24
        elif command == ARM and first == 1.0:
            if self.refusal:
                self.say_text(self.refusal)
                return 4
            self.armed = not self.stubborn
        elif command == ARM:
            if self.stubborn or (self.flying and second != FORCE):
                return 2
            self.armed = self.flying = False
        return 0


@dataclass
class Together:
    """Several autopilots at one UDP port."""

    members: tuple[FakeAutopilot, ...]
    chosen: str = ""
    closed: bool = False

    def write(self, data: bytes) -> None:
        for each in self.members:
            if each.sender == self.chosen:
                each.write(data)

    def read(self) -> list[tuple[str, bytes]]:
        return [pair for each in self.members for pair in each.read() if self.chosen in ("", each.sender)]

    def choose(self, sender: str) -> None:
        self.chosen = sender

    def close(self) -> None:
        self.closed = True
