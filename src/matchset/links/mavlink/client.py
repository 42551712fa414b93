"""The dialog with an autopilot over a port: heartbeats, clocks, commands and their answers, `AutopilotClient`."""

import itertools
from collections.abc import Callable, Sequence

import msgspec

from matchset.image.errors import LinkError
from matchset.links.link import wait_until
from matchset.links.mavlink.address import Address
from matchset.links.mavlink.autopilots import Autopilot, autopilot_of
from matchset.links.mavlink.message import Values
from matchset.links.mavlink.packet import MavlinkPacket, MavlinkParser, PacketWriter
from matchset.links.mavlink.ports import MavlinkPort
from matchset.links.mavlink.telemetry import AutopilotTelemetry

STATION, ONBOARD = 6, 18  # format: MAV_TYPE of a ground station, of a computer on board
NO_AUTOPILOT, ACTIVE, VERSION = 8, 4, 3  # format: of a heartbeat: MAV_AUTOPILOT, MAV_STATE, MAVLink
STATION_COMPONENT = 190  # format: MAV_COMP_ID_MISSIONPLANNER, of a ground station
ODOMETRY_COMPONENT = 197  # format: MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY
SET_INTERVAL = 511  # format: MAV_CMD_SET_MESSAGE_INTERVAL
ASKED = {30: 0.05, 1: 1.0, 147: 2.0}  # format: ATTITUDE, SYS_STATUS, BATTERY_STATUS: asked for every so many s
RESULTS = {  # format: MAV_RESULT
    1: "not now",
    2: "denied",
    3: "it does not know the command",
    4: "failed",
    6: "canceled",
}
ACCEPTED, IN_PROGRESS = 0, 5  # format: MAV_RESULT


class MavlinkParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Times of the link; all chosen by hand, `tests/links/mavlink` shows a change.

    Parameters
    ----------
    timeout : float
        Longest time without any message from the autopilot, s; then the link is broken. Two heartbeats of it and a
        half: shorter detects a fault sooner but fails when one packet is lost and nothing else is sent.
    telemetry_timeout : float
        Longest time without an attitude, s, after which a warning says so, if attitudes came before.
    startup_timeout : float
        How long the autopilot may take to be heard, s. It sends a heartbeat every second; a radio may take longer.
    census : float
        How long is listened for other vehicles and stations after the first heartbeat, s. More than a second, since
        each sends one a second.
    heartbeat_period : float
        Time between our heartbeats and questions for the clock, s; autopilots expect one a second.
    frame_period : float
        Time between sticks while arming and landing, s. PX4 takes 0.5 s of silence for a loss.
    arm_timeout : float
        How long a mode, arming or disarming may take until the heartbeat shows it, s.
    repeat_period : float
        Time after which a command that was not answered is sent again, s.
    reason_time : float
        How long words are awaited after a refusal, s; the reason comes before or after it. More tells more.
    poll_period : float
        Time between looks for messages while waiting, s.
    """

    timeout: float = 2.5
    telemetry_timeout: float = 1.0
    startup_timeout: float = 5.0
    census: float = 1.3
    heartbeat_period: float = 1.0
    frame_period: float = 0.03
    arm_timeout: float = 4.0
    repeat_period: float = 0.5
    reason_time: float = 0.5
    poll_period: float = 0.01


class AutopilotClient:
    """Hears one autopilot and speaks to it; it knows nothing of sticks.

    Our heartbeats leave when somebody calls: a program that hangs is silent, and the autopilot's failsafe acts.

    Parameters
    ----------
    name : str
        Name of the link in error messages.
    address : Address
        Which vehicle is meant, and who we are.
    port : MavlinkPort
    parameters : MavlinkParameters
    clock, sleep : callables
        The time, s, and a function that waits.

    Attributes
    ----------
    system, component : int
        Of the autopilot; 0 before it is found.
    autopilot : Autopilot
    kind : int
        Type of the vehicle, MAV_TYPE.
    telemetry : AutopilotTelemetry
    stations : set of int
        Numbers of the other ground stations that are heard.
    round_trip : float or None
        Of the last question for the clock, s.
    clock_offset : float or None
        The autopilot's clock minus ours, s, from the fastest answer.
    broken : bool
        The port is gone or the autopilot silent.
    """

    def __init__(
        self,
        name: str,
        address: Address,
        port: MavlinkPort,
        parameters: MavlinkParameters,
        clock: Callable[[], float],
        sleep: Callable[[float], None],
    ) -> None:
        self.name, self.address, self.parameters = name, address, parameters
        self.system = self.component = self.kind = 0
        self.autopilot: Autopilot = autopilot_of(0)
        self.telemetry, self.stations = AutopilotTelemetry(), set[int]()
        self.round_trip: float | None = None
        self.clock_offset: float | None = None
        self.broken = False
        self._port, self._clock, self._sleep = port, clock, sleep
        self._writer = PacketWriter(address.system, STATION_COMPONENT)
        self._type = STATION
        self._parsers: dict[str, MavlinkParser] = {}
        self._hearts: dict[tuple[int, str], tuple[int, Values]] = {}  # vehicle and sender: component, heartbeat
        self._beat_at: float | None = None
        self._asked_at, self._best_trip = 0, float("inf")
        self._signed = False

    @property
    def lost(self) -> int:
        """Packets that are missing by their sequence numbers, and those with a wrong CRC."""
        return sum(parser.lost + parser.bad for parser in self._parsers.values())

    def find(self, on_board: bool = False) -> None:
        """Wait for the autopilot, and for others that may be there.

        Parameters
        ----------
        on_board : bool
            Be a part of the vehicle, by its number, instead of a ground station.

        Raises
        ------
        LinkError
            If nobody is heard in time, if it is not clear which vehicle is meant, if it is no multicopter, if its
            messages are signed, or if another ground station has our number.
        """
        p = self.parameters
        if on_board:  # never a heartbeat of a ground station that then is silent: that would be a failsafe
            self._writer, self._type = PacketWriter(self.address.vehicle or 1, ODOMETRY_COMPONENT), ONBOARD
        self.wait(lambda: bool(self._hearts), p.startup_timeout, self._nobody)
        first = self._clock()
        self.wait(lambda: self._clock() - first >= p.census, 2.0 * p.census, lambda: "")
        wanted = self.address.vehicle
        found = [each for each in self._hearts if wanted in (0, each[0])]
        if len(found) != 1:
            raise LinkError(f"{self.name}: {self._which(found)}")
        if not on_board and self.address.system in self.stations:
            raise LinkError(
                f"{self.name}: another ground station has the number {self.address.system}: choose another, ?system=254"
            )
        if self._signed:
            raise LinkError(f"{self.name}: it signs its messages, which is not supported: switch signing off")
        self.system, sender = found[0]
        self.component, heart = self._hearts[found[0]]
        if on_board:
            self._writer = PacketWriter(self.system, ODOMETRY_COMPONENT)
        self._port.choose(sender)
        self.autopilot, self.kind = autopilot_of(heart["autopilot"]), heart["type"]
        self.telemetry.note("HEARTBEAT", heart, self._clock())
        self.telemetry.integers_as_bytes = self.autopilot.packed
        for message, period in ASKED.items():
            self.ask(SET_INTERVAL, (message, 1e6 * period))
        self.ask_settings()

    def receive(self) -> None:
        """Read what has arrived, and send a heartbeat when it is time; never waits.

        Raises
        ------
        LinkError
            If the port is gone.
        """
        try:
            arrived = self._port.read()
        except OSError as error:
            raise self._gone(error) from error
        for sender, data in arrived:
            for packet in self._parsers.setdefault(sender, MavlinkParser()).feed(data):
                self._note(packet, sender)
        now = self._clock()
        if self._beat_at is None or now - self._beat_at >= self.parameters.heartbeat_period:
            self._beat_at, self._asked_at = now, round(1e9 * now)
            kinds = {"type": self._type, "autopilot": NO_AUTOPILOT, "system_status": ACTIVE, "mavlink_version": VERSION}
            self.write("HEARTBEAT", kinds)
            if self.system:
                self.write("TIMESYNC", {"ts1": self._asked_at})

    def check(self) -> AutopilotTelemetry:
        """Receive, and return what the autopilot said; never waits.

        Raises
        ------
        LinkError
            If the port is gone or the autopilot silent for too long.
        """
        self.receive()
        silence = self._clock() - (self.telemetry.heard_at or 0.0)
        if silence > self.parameters.timeout:
            self.broken = True
            raise LinkError(f"{self.name}: vehicle {self.system} has been silent for {silence:.1f} s")
        return self.telemetry

    def write(self, name: str, values: Values) -> None:
        """Send a message.

        Raises
        ------
        LinkError
            If the port is gone.
        """
        try:
            self._port.write(self._writer.write(name, values))
        except OSError as error:
            raise self._gone(error) from error

    def ask(self, command: int, parameters: Sequence[float], repetition: int = 0) -> None:
        """Send a command without waiting for its answer, with up to seven parameters."""
        values: Values = {"target_system": self.system, "target_component": self.component, "command": command}
        values |= {f"param{k}": value for k, value in enumerate(parameters, 1)}
        self.write("COMMAND_LONG", values | {"confirmation": repetition % 256})

    def ask_settings(self) -> None:
        """Ask for the autopilot's parameters that decide what silence does, without waiting for the answers."""
        for setting in self.autopilot.silence:
            whom = {"target_system": self.system, "target_component": self.component, "param_index": -1}
            self.write("PARAM_REQUEST_READ", whom | {"param_id": setting.name})

    def command(self, command: int, parameters: Sequence[float], what: str, during: Callable[[], None]) -> None:
        """Send a command until it is answered.

        Parameters
        ----------
        command : int
        parameters : sequence of float
        what : str
            What it does, in words for the error.
        during : callable
            Called all the time meanwhile.

        Raises
        ------
        LinkError
            If it is refused, with the reason that the autopilot gives, or not answered.
        """
        start, p = self._clock(), self.parameters
        for repetition in itertools.count():
            self.ask(command, parameters, repetition)
            until = self._clock() + p.repeat_period
            while self._clock() < until:
                during()
                self._sleep(p.poll_period)
                at, result = self.check().acks.get(command, (-1.0, IN_PROGRESS))
                if at < start or result == IN_PROGRESS:
                    continue
                if result != ACCEPTED:
                    raise self.refused(what, RESULTS.get(result, f"result {result}"), start)
                return
            if self._clock() - start > p.arm_timeout:
                raise self.refused(what, "it does not answer", start)

    def refused(self, what: str, result: str, since: float) -> LinkError:
        """Return the error of a refusal, with what the autopilot says about it within `reason_time`."""
        until = self._clock() + self.parameters.reason_time
        while self._clock() < until:
            self._pause()
        said = "; ".join(self.telemetry.said_since(since)) or "it does not say why"
        return LinkError(f"{self.name}: {what} refused by {self.autopilot.name} ({result}): {said}")

    def wait(self, done: Callable[[], bool], limit: float, message: Callable[[], str]) -> None:
        """Receive until a condition holds; LinkError with the message after `limit`, s."""
        self.receive()
        if not wait_until(done, limit, self._clock, self._pause):
            raise LinkError(f"{self.name}: {message()} (waited {limit:g} s)")

    def _pause(self) -> None:
        self._sleep(self.parameters.poll_period)
        self.receive()

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def _note(self, packet: MavlinkPacket, sender: str) -> None:
        name, values, now = packet.message.name, packet.values, self._clock()
        if name == "HEARTBEAT" and values["autopilot"] == NO_AUTOPILOT:
            if values["type"] == STATION:
                self.stations.add(packet.system)
            return
        if not self.system:
            if name == "HEARTBEAT":
                self._hearts[packet.system, sender] = packet.component, values
                self._signed = self._signed or packet.signed
            return
        if (packet.system, packet.component) != (self.system, self.component):
            return
        if name == "TIMESYNC":
            self._compare_clocks(values, now)
        elif name == "COMMAND_ACK" and values["target_system"] not in (0, self._writer.system):
            return
        self.telemetry.note(name, values, now)

    def _compare_clocks(self, values: Values, now: float) -> None:
        """Answer a question for our clock, or take an answer to ours."""
        if values["tc1"] == 0:
            self.write("TIMESYNC", {"tc1": round(1e9 * now), "ts1": values["ts1"]})
        elif values["ts1"] == self._asked_at:
            self.round_trip = now - values["ts1"] / 1e9
            if self.round_trip <= self._best_trip:
                self._best_trip = self.round_trip
                self.clock_offset = values["tc1"] / 1e9 - (now + values["ts1"] / 1e9) / 2.0

    def _nobody(self) -> str:
        """Say why no autopilot was found."""
        if any(parser.old for parser in self._parsers.values()):
            return "it speaks MAVLink 1: switch it to MAVLink 2 (ArduPilot: SERIALn_PROTOCOL = 2)"
        return "bytes come, but no heartbeat: wrong baud rate?" if self._parsers else "no autopilot is heard"

    def _which(self, found: list[tuple[int, str]]) -> str:
        """Say why it is not clear which vehicle is meant."""
        heard = ", ".join(f"{system} at {sender}" for system, sender in sorted(found or self._hearts))
        if not found:
            return f"vehicle {self.address.vehicle} is not heard, only {heard}"
        if self.address.vehicle:
            return f"several vehicles have the number {self.address.vehicle}: {heard}; give each one of its own"
        return f"several vehicles are heard: {heard}; say which one is meant, ?vehicle={found[0][0]}"

    def _gone(self, error: OSError) -> LinkError:
        self.broken = True
        return LinkError(f"{self.name} has gone (unplugged, network down?): {error.strerror or error}")
