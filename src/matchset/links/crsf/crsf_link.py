"""``crsf:///dev/ttyUSB0``: an ExpressLRS or Crossfire module, which flies any Betaflight, INAV or ArduPilot.

docs/crsf.md has the wiring, how the flight controller must be set up, and a first flight on a tether.
"""

import time
from collections.abc import Callable

import msgspec

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.crsf.parameters import SCHEME, parse_uri
from matchset.links.crsf.radio_module import RadioModule
from matchset.links.crsf.sticks import channels, on_air
from matchset.links.crsf.telemetry import Battery, CrsfAttitude, CrsfTelemetry, Device, FlightMode, LinkStatistics
from matchset.links.link import DeviceLink, LinkStatus, State
from matchset.links.serial_port import Port, SerialPort


class CrsfLink(DeviceLink):
    """A vehicle behind a transmitter module that speaks CRSF; implements `matchset.links.link.Link`.

    Parameters
    ----------
    uri : str
        ``crsf:///dev/ttyUSB0``, ``crsf://COM3``; after a question mark fields of `CrsfParameters`, e.g.
        ``?baud=400000&arm_channel=5``.
    port : Port, optional
        Used instead of the serial port of that name.
    clock, sleep : callables
        The time, s, and a function that waits.
    threaded : bool
        Frames leave from a thread of their own. If not, they leave while the link waits, and when the caller calls
        ``module.turn()``: for a clock that is not the computer's.

    Attributes
    ----------
    module : RadioModule
        The dialog with it: frames sent, errors, timing.

    Raises
    ------
    ValueError
        If the URI is no such URI, or names something unknown.
    LinkError
        If the port cannot be opened, another program uses it, or no module answers there.
    """

    def __init__(
        self,
        uri: str,
        port: Port | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
        threaded: bool = True,
    ) -> None:
        path, self.parameters = parse_uri(uri)
        self.uri = SCHEME + path
        self._clock, self._sleep, self._threaded = clock, sleep, threaded
        self._armed = self._was_armed = False  # now; since the last landing
        self._throttle = 0.0
        port = SerialPort(path, self.parameters.baud) if port is None else port
        self.module = RadioModule(self.uri, port, self.parameters, clock)
        if threaded:
            self.module.start()
        try:
            self.module.wait_ready(self._pause)
        except BaseException:
            self.module.close()
            raise

    @property
    def news(self) -> CrsfTelemetry:
        """What the vehicle and the module said last; never waits."""
        latest = self.module.latest
        return CrsfTelemetry(
            link=latest(LinkStatistics),
            battery=latest(Battery),
            attitude=latest(CrsfAttitude),
            mode=latest(FlightMode),
            module=latest(Device),
            age=self.module.vehicle_age,
        )

    def status(self) -> LinkStatus:
        """Return the state of the link, as far as the host and the telemetry know it; never waits."""
        self._check()
        news, module = self.news, self.module
        version = f"{news.module.name} {news.module.version}" if news.module else "unknown module"
        warnings = tuple(self._warnings(news))
        return LinkStatus(self._state(), version, module.bad, module.sent_age, warnings, self._reason())

    def send(self, command: Command) -> Command:
        """Send a command; returns what the channels carry, all zero unless armed.

        When the flight controller has disarmed, or this program was silent for too long, the link disarms too; then
        call `arm` again.

        Raises
        ------
        LinkError
            If the module is gone or silent, or the vehicle has not been heard for too long.
        """
        self._check()
        return self._send(command)

    def arm(self) -> None:
        """Arm: the arm switch low and throttle zero, then the arm switch high, until the flight controller says so.

        Without messages of the flight controller's mode it is taken for armed.

        Raises
        ------
        LinkError
            If no vehicle answers, the flight controller refuses or its sticks command rates, or `cut` came meanwhile.
        """
        self._armed, begin = False, self._clock()
        self.module.watch(False)
        self.module.resume()
        self._wait(self._hears_vehicle, "no vehicle answers: is it on, and bound to this module?")
        self._wait(lambda: self._clock() - begin >= self.parameters.arm_low_time, "")
        self._wait(lambda: self._may_arm(begin), "it cannot be armed")
        mode = self.news.mode
        if mode is not None and mode.commands_rates:
            raise LinkError(f"{self.uri}: sticks command rates in mode {mode.text!r}, not angles: docs/crsf.md")
        self._armed = self._was_armed = True
        begin = self._clock()
        try:
            self._wait(lambda: self._has_armed(begin), "it did not arm")
        except BaseException:
            self._armed = False
            self._send(Command())
            raise
        self.module.watch(True)

    def send_disarmed(self, command: Command) -> Command:
        """Send sticks with the arm switch low and the throttle zero: a flight controller shows them, no motor turns.

        Raises
        ------
        ValueError
            If this link has armed it.
        LinkError
            If the module is gone or silent, or the flight controller's mode says that the motors may turn.
        """
        if self._armed or self._was_armed:
            raise ValueError(f"{self.uri}: it is armed; sticks are shown with the motors off only")
        self._check()
        mode = self.news.mode
        if mode is not None and not mode.disarmed:
            raise LinkError(f"{self.uri}: no sticks are shown{self._what_it_says()}")
        command = msgspec.structs.replace(command, throttle=0.0)
        self.module.want(command, False)
        return on_air(channels(command, False, self.parameters.arm_channel))

    def land(self, duration: float = 1.5) -> None:
        """Lower the throttle to zero over so many seconds, sticks neutral, then disarm; 0 stops the motors at once.

        Nothing measures the height meanwhile: begin low.
        """
        self.module.watch(False)
        start = self._clock()
        for command in self._lowering(duration):
            self._send(command)
            self._pause(self.parameters.poll_period)
        self._armed, begin = False, self._clock()
        while self._was_armed and self._clock() - begin < self.parameters.disarm_time and not self.module.broken:
            self._send(Command())
            self._pause(self.parameters.poll_period)
        self._send(Command())
        said = self.module.heard_since(FlightMode, start - self.parameters.vehicle_timeout)
        if self._was_armed and said and not self.module.mute:
            self._wait(lambda: self._has_disarmed(begin), "it did not disarm")
        self._was_armed = False

    def cut(self) -> None:
        """Stop the motors by a frame with the arm switch low, sent at once, and all that follow; never waits."""
        self.module.stop()

    def close(self) -> None:
        """Land, then close the port; a port that is gone is closed only."""
        self._close(self.module)

    def _pause(self, seconds: float) -> None:
        self._sleep(seconds)
        if not self._threaded:
            self.module.turn()

    def _check(self) -> None:
        self.module.check()
        if self._armed and self.module.vehicle_age > self.parameters.vehicle_timeout:
            age = self.module.vehicle_age
            raise LinkError(f"{self.uri}: nothing has been heard of the vehicle for {age:.1f} s")

    def _send(self, command: Command) -> Command:
        self._armed = self._armed and self.module.may_fly and not self.module.broken
        if not self._armed:
            command = Command()
        self.module.want(command, self._armed)
        self._throttle = command.throttle
        return on_air(channels(command, self._armed, self.parameters.arm_channel))

    def _state(self) -> State:
        if self.module.silent:
            return "failsafe"
        if self.module.ended:
            return self.module.ended
        if not self._armed or self.module.stopped:
            return "locked"
        return "holding" if self.module.sent_age > self.parameters.hold_after else "armed"

    def _reason(self) -> str:
        """Say what has ended the flight, in words; empty if nothing has."""
        mode = self.news.mode
        if self.module.silent:
            return f"no command came for {self.parameters.cut_after:g} s, so the motors were stopped"
        if self.module.ended and mode is not None:
            what = "the receiver hears nothing" if self.module.ended == "failsafe" else "the flight controller disarmed"
            return f"{what}: its mode is {mode.text!r}"
        return ""

    def _warnings(self, news: CrsfTelemetry) -> list[str]:
        words = []
        if news.link is not None and news.link.quality < self.parameters.poor_quality:
            words.append(f"the vehicle hears only {news.link.quality} % of the packets")
        if news.mode is not None and news.mode.refuses:
            words.append(f"the flight controller refuses to be armed: {news.mode.text}")
        if self.module.echoes:
            words.append("own frames come back, as on a wire for both directions")
        return words

    def _hears_vehicle(self) -> bool:
        return self.module.vehicle_age <= self.parameters.vehicle_timeout

    def _may_arm(self, begin: float) -> bool:
        mode = self.news.mode
        return mode is None or (self.module.heard_since(FlightMode, begin) and mode.disarmed and not mode.refuses)

    def _has_armed(self, begin: float) -> bool:
        mode = self.news.mode
        if mode is None:
            return self._clock() - begin >= self.parameters.arm_low_time
        return self.module.heard_since(FlightMode, begin) and not mode.disarmed and not mode.failsafe

    def _has_disarmed(self, begin: float) -> bool:
        mode = self.news.mode
        return mode is None or (self.module.heard_since(FlightMode, begin) and mode.disarmed)

    def _wait(self, done: Callable[[], bool], problem: str) -> None:
        """Send neutral sticks, with the arm switch unchanged, until a condition holds."""
        start, armed = self._clock(), self._armed
        while not done():
            self._send(Command())
            self._pause(self.parameters.poll_period)
            self.module.check()
            if armed and not self._armed:
                raise LinkError(f"{self.uri}: the motors were stopped while it was armed")
            if self._clock() - start > self.parameters.arm_timeout:
                raise LinkError(f"{self.uri}: {problem}{self._what_it_says()}")

    def _what_it_says(self) -> str:
        """Say what the mode of the flight controller means, in words; empty if it is not known."""
        mode = self.news.mode
        if mode is None:
            return ""
        if mode.refuses:
            return f"; the flight controller refuses, its mode is {mode.text!r}: 'status' in its command line says why"
        if not mode.disarmed and not self._armed:
            return f"; its mode is {mode.text!r}, so it is armed: by another transmitter, or another arm channel?"
        return f"; its mode is {mode.text!r}"
