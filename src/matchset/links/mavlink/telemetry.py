"""What an autopilot says, kept: `AutopilotTelemetry`. It knows no port; a packet and the time go in."""

import itertools
import struct
from collections import deque
from typing import NamedTuple

from matchset.links.mavlink.message import Values

ARMED = 128  # format: flag of `HEARTBEAT.base_mode`
WARNING = 4  # format: largest `STATUSTEXT.severity` that a pilot must read
PIECE = 50  # format: bytes of a piece of a long text that is not the last
UNKNOWN_VOLTAGE, UNKNOWN_SHARE = 65_535, -1  # format: of SYS_STATUS and BATTERY_STATUS
REAL = 9  # format: MAV_PARAM_TYPE_REAL32
KEPT = 20  # format: texts that are kept, and pieces of a text
BATTERY_STATES = {
    2: "low",
    3: "critical",
    4: "critical",
    5: "failed",
    6: "unhealthy",
}  # format: MAV_BATTERY_CHARGE_STATE
EMERGENCIES = {5: "critical", 6: "emergency", 8: "flight termination"}  # format: MAV_STATE


class AutopilotText(NamedTuple):
    """What the autopilot said, when, s, and how grave it is, 0 (emergency) ... 7 (for developers)."""

    time: float
    severity: int
    words: str


class AutopilotAttitude(NamedTuple):
    """The autopilot's estimate of its attitude, rad: right side down, nose up, clockwise from north; and when, s."""

    time: float
    roll: float
    pitch: float
    yaw: float


class AutopilotTelemetry:
    """The newest of what an autopilot said.

    Attributes
    ----------
    heard_at, heart_at : float or None
        When anything, or a heartbeat, was heard last, s.
    heart : dict
        Values of the last heartbeat; empty before the first.
    texts : deque of AutopilotText
        The last ones, oldest first.
    acks : dict of int to tuple
        Number of a command: when its last answer came, s, and the answer.
    attitude : AutopilotAttitude or None
    integers_as_bytes : bool
        Whether a parameter that is an integer comes as its bytes, as PX4 sends it.
    voltage : float or None
        Of the battery, V.
    charge : float or None
        Of the battery, 0 ... 1.
    settings : dict of str to float
        The autopilot's parameters that it was asked for.
    battery_state : str
        What the autopilot thinks of its battery, in words; empty if it is well.
    """

    def __init__(self) -> None:
        self.heard_at: float | None = None
        self.heart_at: float | None = None
        self.heart: Values = {}
        self.texts: deque[AutopilotText] = deque(maxlen=KEPT)
        self.acks: dict[int, tuple[float, int]] = {}
        self.attitude: AutopilotAttitude | None = None
        self.voltage: float | None = None
        self.charge: float | None = None
        self.battery_state = ""
        self.settings: dict[str, float] = {}
        self.integers_as_bytes = False
        self._pieces: dict[int, dict[int, str]] = {}

    @property
    def armed(self) -> bool:
        """Whether the last heartbeat says that the motors are enabled."""
        return bool(self.heart.get("base_mode", 0) & ARMED)

    @property
    def mode(self) -> int:
        """The autopilot's own number of its mode."""
        return int(self.heart.get("custom_mode", 0))

    @property
    def emergency(self) -> str:
        """What the last heartbeat says of a failsafe, in words; empty if there is none."""
        return EMERGENCIES.get(self.heart.get("system_status", 0), "")

    def note(self, name: str, values: Values, now: float) -> None:
        """Take a message of the autopilot at a time, s."""
        self.heard_at = now
        match name:
            case "HEARTBEAT":
                self.heart, self.heart_at = values, now
            case "STATUSTEXT":
                self._note_text(values, now)
            case "COMMAND_ACK":
                self.acks[values["command"]] = now, values["result"]
            case "PARAM_VALUE":
                self.settings[values["param_id"]] = self._setting(values)
            case "ATTITUDE":
                self.attitude = AutopilotAttitude(now, values["roll"], values["pitch"], values["yaw"])
            case "SYS_STATUS":
                if values["voltage_battery"] != UNKNOWN_VOLTAGE:
                    self.voltage = values["voltage_battery"] / 1e3
                self._note_charge(values["battery_remaining"])
            case "BATTERY_STATUS" if values["id"] == 0:
                self._note_charge(values["battery_remaining"])
                self.battery_state = BATTERY_STATES.get(values["charge_state"], "")

    def said_since(self, time: float) -> tuple[str, ...]:
        """Return the warnings and worse since a time, s, each once, oldest first."""
        words = (text.words for text in self.texts if text.time >= time and text.severity <= WARNING)
        return tuple(dict.fromkeys(words))

    def _setting(self, values: Values) -> float:
        """Return the number of a parameter."""
        number: float = values["param_value"]
        if self.integers_as_bytes and values["param_type"] != REAL:
            (number,) = struct.unpack("<i", struct.pack("<f", number))
        return number

    def _note_charge(self, percent: int) -> None:
        if percent != UNKNOWN_SHARE:
            self.charge = percent / 100

    def _note_text(self, values: Values, now: float) -> None:
        """Keep a text; one in pieces when its last one has come, with dots for those that are missing."""
        words: str = values["text"]
        if values["id"]:
            pieces = self._pieces.setdefault(values["id"], {})
            pieces[values["chunk_seq"]] = words
            if len(words.encode()) == PIECE and values["chunk_seq"] < KEPT:
                return
            words = "".join(pieces.get(k, " ... ") for k in range(values["chunk_seq"] + 1))
            self._pieces.pop(values["id"])
            for stale in list(itertools.islice(self._pieces, max(0, len(self._pieces) - KEPT))):
                del self._pieces[stale]
        if words.strip():
            self.texts.append(AutopilotText(now, values["severity"], words.strip()))
