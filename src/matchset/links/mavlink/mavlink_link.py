"""``mavlink:udpin:0.0.0.0:14550``: a vehicle with ArduPilot or PX4, flown by sticks; `MavlinkLink`.

Each command is a MANUAL_CONTROL. The autopilot flies in the mode in which sticks are angles and the throttle is the
thrust (Stabilize, Stabilized). Arming is by its rules: it may refuse, and says why. So are its failsafes: when it
leaves that mode by itself or by another pilot's switch, or disarms, no more sticks are sent until `arm`.
"""

import contextlib
import time
from collections.abc import Callable

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.link import DeviceLink, LinkStatus, State, wait_until
from matchset.links.mavlink.address import parse_address
from matchset.links.mavlink.autopilots import COPTERS
from matchset.links.mavlink.client import AutopilotClient, MavlinkParameters
from matchset.links.mavlink.ports import MavlinkPort, open_port
from matchset.links.mavlink.telemetry import AutopilotTelemetry

FULL = 1000  # format: of a stick in MANUAL_CONTROL
ARM_DISARM, SET_MODE = 400, 176  # format: MAV_CMD_COMPONENT_ARM_DISARM, MAV_CMD_DO_SET_MODE
BY_FORCE = 21_196  # format: parameter 2 of ARM_DISARM: also in flight
LOW = 0.2  # format: charge of a battery that is called low where the autopilot says nothing


def sticks(command: Command) -> dict[str, int]:
    """Return a command as the fields of MANUAL_CONTROL: 1000 steps on each side of a stick, 1000 of throttle."""
    return {
        "x": round(command.pitch * FULL),
        "y": round(command.roll * FULL),
        "z": round(command.throttle * FULL),
        "r": round(command.yaw * FULL),
    }


class MavlinkLink(DeviceLink):
    """A vehicle with an autopilot; implements `matchset.links.link.Link`.

    Only a vehicle that this link arms is ever sent sticks, landed or cut: one that somebody else flies is left alone.

    Parameters
    ----------
    uri : str
        See `matchset.links.mavlink.address`.
    port : MavlinkPort, optional
        Used instead of the port that the URI names.
    parameters : MavlinkParameters, optional
    clock, sleep : callables
        The time, s, and a function that waits; tests replace them.

    Attributes
    ----------
    client : AutopilotClient
        The dialog with the autopilot: attitude, battery, words, round trip, lost packets.

    Raises
    ------
    ValueError
        If the URI has another form.
    LinkError
        If the port cannot be opened, or the vehicle is not found there: see `AutopilotClient.find`.
    """

    def __init__(
        self,
        uri: str,
        port: MavlinkPort | None = None,
        parameters: MavlinkParameters | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.uri, self.parameters = uri, parameters or MavlinkParameters()
        self._clock, self._sleep = clock, sleep
        self._armed = self._arming = self._ours = self._cut = False
        self._throttle, self._sent_at, self._end = 0.0, clock(), ""
        self._changed_at = clock()  # what heartbeats said before does not tell what became of arming or a cut
        address = parse_address(uri)
        port = open_port(address) if port is None else port
        self.client = AutopilotClient(uri, address, port, self.parameters, clock, sleep)
        try:
            self.client.find()
            self._mode = self._flying_mode(address.mode)
        except BaseException:
            port.close()
            raise

    def status(self) -> LinkStatus:
        """Return what the autopilot said last; never waits."""
        told = self.client.check()
        state = self._state(told)
        age = self._clock() - self._sent_at
        version = f"{self.client.autopilot.name}, vehicle {self.client.system}"
        return LinkStatus(state, version, self.client.lost, age, self._warnings(told), self._end)

    def send(self, command: Command) -> Command:
        """Send a command; returns what the autopilot receives, all zero unless armed.

        When the autopilot is no longer armed, or flies in another mode, the link disarms too and sends nothing; then
        call `arm` again.
        """
        told = self.client.check()
        self._follow(told)
        if self._cut:
            self._disarm_by_force()
        if not self._armed:
            self._throttle = 0.0
            return Command()
        return self._send(command)

    def arm(self) -> None:
        """Choose the mode and arm, with neutral sticks, until the heartbeat shows both.

        Raises
        ------
        LinkError
            If the autopilot refuses, with its reason; if it does not do so in time; if it is armed already, since then
            somebody else flies it; or if `cut` came meanwhile.
        """
        told, name = self.client.check(), self.uri
        if told.armed and not self._ours:
            raise LinkError(f"{name}: vehicle {self.client.system} is armed already: somebody else flies it")
        self.client.ask_settings()  # what was asked for at first may be lost, or changed since
        self._armed = self._cut = False
        self._arming, self._ours, self._end = True, True, ""
        try:
            if told.mode != self._mode:
                what = f"the mode {self.client.autopilot.mode_name(self._mode)}"
                parameters = self.client.autopilot.mode_parameters(self._mode)
                self.client.command(SET_MODE, parameters, what, self._neutral)
                self._repeat(lambda: told.mode == self._mode, what)
            self.client.command(ARM_DISARM, (1.0,), "arming", self._neutral)
            self._repeat(lambda: told.armed, "arming")
            self._check_cut()
        except BaseException:
            with contextlib.suppress(LinkError):
                self.client.ask(ARM_DISARM, (0.0,))  # it may have armed, and its answer got lost
            self._ours = self._cut
            raise
        finally:
            self._arming, self._changed_at = False, self._clock()
        self._armed = True

    def land(self, duration: float = 1.5) -> None:
        """Lower the throttle to zero over so many seconds, sticks neutral, then disarm; 0 stops the motors at once.

        Nothing measures the height meanwhile: begin low. If the autopilot believes that it still flies it is disarmed
        by force. A vehicle that the autopilot or another pilot has taken over is left to them.
        """
        for command in self._lowering(duration):
            self.send(command)
            self._sleep(self.parameters.frame_period)
        if self._armed or (self._cut and self._ours):
            self._disarm(by_force=duration == 0 or self._cut)
            self._ours = False
        self._armed = False

    def cut(self) -> None:
        """Disarm by force, by one message that is sent at once; never waits for an answer.

        Another thread or a signal handler may call it. `send` repeats it until the heartbeat says that it is disarmed.
        """
        self._cut, self._armed, self._changed_at = True, False, self._clock()
        with contextlib.suppress(LinkError):  # the next `send` raises it
            self._disarm_by_force()

    def close(self) -> None:
        """Land and close the port; a broken one is only closed."""
        self._close(self.client)

    def _flying_mode(self, asked: int | None) -> int:
        """Return the mode that is flown in, once the vehicle is known."""
        client = self.client
        if client.kind not in COPTERS:
            raise LinkError(f"{self.uri}: vehicle {client.system} is no multicopter (type {client.kind})")
        mode = client.autopilot.stick_mode if asked is None else asked
        if mode is None:
            words = "neither ArduPilot nor PX4: say in which mode sticks are angles, ?mode=NUMBER"
            raise LinkError(f"{self.uri}: {client.autopilot.name} is {words}")
        return mode

    def _follow(self, told: AutopilotTelemetry) -> None:
        """Disarm when the autopilot has disarmed or flies in another mode."""
        if self._armed and not (told.armed and told.mode == self._mode):
            mode = self.client.autopilot.mode_name(told.mode)
            what = "disarmed" if not told.armed else f"is in {mode}, by itself or by another pilot's switch"
            said = told.said_since(self._clock() - self.parameters.timeout)
            self._end = f"{self.client.autopilot.name} {'; '.join((what, *said))}"
            self._armed = False
        if self._is_disarmed(told) and not self._arming:
            self._ours = self._cut = False

    def _state(self, told: AutopilotTelemetry) -> State:
        self._follow(told)
        if self._end or (self._cut and told.armed):
            return "failsafe"
        return "armed" if told.armed else "locked"

    def _warnings(self, told: AutopilotTelemetry) -> tuple[str, ...]:
        """Return all that a pilot must read, in words."""
        now, p = self._clock(), self.parameters
        found = list(told.said_since(now - p.timeout))
        low = told.charge is not None and told.charge < LOW
        if told.battery_state or low:
            found.append(f"battery {told.battery_state or 'low'}: {100 * (told.charge or 0.0):.0f} %")
        for setting in self.client.autopilot.silence:
            complaint = setting.complaint(told.settings[setting.name]) if setting.name in told.settings else ""
            found += [complaint] if complaint else []
        if told.emergency:
            found.append(f"the autopilot's state is {told.emergency}")
        if told.attitude is not None and now - told.attitude.time > p.telemetry_timeout:
            found.append(f"no attitude for {now - told.attitude.time:.1f} s")
        if told.armed and not self._ours:
            found.append("somebody else has armed it")
        if self.client.stations:
            numbers = ", ".join(map(str, sorted(self.client.stations)))
            found.append(f"other ground stations are connected: {numbers} (this one is {self.client.address.system})")
        return tuple(found)

    def _send(self, command: Command) -> Command:
        """Send sticks to the vehicle, whatever its state."""
        fields = sticks(command)
        self.client.write("MANUAL_CONTROL", {"target": self.client.system, **fields})
        self._throttle, self._sent_at = command.throttle, self._clock()
        return Command(fields["y"] / FULL, fields["x"] / FULL, fields["r"] / FULL, fields["z"] / FULL)

    def _neutral(self) -> None:
        """Send neutral sticks and no throttle, at the pace of frames."""
        self._check_cut()
        if self._clock() - self._sent_at >= self.parameters.frame_period:
            self._send(Command())

    def _check_cut(self) -> None:
        if self._cut:
            raise LinkError(f"{self.uri}: the motors were stopped while it was being armed")

    def _repeat(self, done: Callable[[], bool], what: str) -> None:
        """Send neutral sticks until a condition holds."""

        def wait() -> None:
            self._neutral()
            self._sleep(self.parameters.poll_period)
            self.client.check()

        start = self._clock()
        if not wait_until(done, self.parameters.arm_timeout, self._clock, wait):
            raise self.client.refused(what, "accepted, but not done", start)

    def _disarm(self, by_force: bool) -> None:
        """Disarm until the heartbeat shows it; by force at last."""
        start, told, p = self._clock(), self.client.telemetry, self.parameters
        asked_at = -p.repeat_period
        while not self._is_disarmed(self.client.check()):
            past = self._clock() - start
            if past > 2.0 * p.arm_timeout:
                said = "; ".join(told.said_since(start)) or "it does not say why"
                raise LinkError(f"{self.uri}: it did not disarm: {said}")
            if past - asked_at >= p.repeat_period:
                asked_at = past
                forced = by_force or past > p.arm_timeout / 2.0
                self.client.ask(ARM_DISARM, (0.0, float(BY_FORCE)) if forced else (0.0,))
            if told.mode == self._mode:
                self._send(Command())
            self._sleep(p.frame_period)

    def _is_disarmed(self, told: AutopilotTelemetry) -> bool:
        """Whether a heartbeat says so that came since the last change."""
        return not told.armed and (told.heart_at or 0.0) >= self._changed_at

    def _disarm_by_force(self) -> None:
        if self._ours:
            self.client.ask(ARM_DISARM, (0.0, float(BY_FORCE)))
