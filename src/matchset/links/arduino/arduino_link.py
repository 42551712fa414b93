"""``serial:///dev/ttyUSB0``: an Arduino with a radio, which runs ``firmware/syma_transmitter``.

On the wire, 115200 baud, 8N1: to the board one RC_CHANNELS_PACKED frame of CRSF per command, 26 bytes, whose
channels `matchset.links.arduino.channels` defines; from the board a status frame for each of them and at least ten a
second, defined with the few other frames in `matchset.links.arduino.messages`.

The firmware has a failsafe that nothing here can switch off: without a good frame for 100 ms sticks go neutral,
within 250 ms the throttle is zero and stays there until the host disarms and arms again.
"""

import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

import msgspec

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.arduino import channels
from matchset.links.arduino import messages as transmitter
from matchset.links.arduino.messages import Config, Report, Result
from matchset.links.arduino.protocol import FirmwareClient
from matchset.links.arduino.serial_port import Port, SerialPort
from matchset.links.link import LinkStatus

SCHEME = "serial://"


class ArduinoParameters(msgspec.Struct, frozen=True):
    """How the link behaves.

    Attributes
    ----------
    timeout : float
        Longest time without a word from the board, s; then the link is broken. It speaks every 33 ms while
        commands flow and every 100 ms otherwise; shorter notices sooner but trips over a busy computer.
    startup_timeout : float
        How long a fresh board may take to say its first word, s. A boot loader waits 1 to 2 s.
    frame_period : float
        Time between frames while arming and landing, s.
    arm_timeout : float
        How long arming may take, s.
    high_rate : bool
        Fly with the toy's high rate: more tilt, less fine.
    """

    timeout: float = 0.5
    startup_timeout: float = 4.0
    frame_period: float = 0.03
    arm_timeout: float = 2.0
    high_rate: bool = False


class ArduinoLink:
    """A toy quadcopter behind an Arduino; implements `matchset.links.link.Link`.

    Parameters
    ----------
    uri : str
        ``serial:///dev/ttyUSB0``, ``serial://COM3``, or a bare path.
    port : Port, optional
        What to talk to instead of the serial port of that name.
    parameters : ArduinoParameters
        How to behave.
    clock, sleep : callables
        Time, s, and how to let it pass.

    Attributes
    ----------
    firmware : FirmwareClient
        The conversation: frames sent and answered, round trip.

    Raises
    ------
    LinkError
        If the port cannot be opened or nobody answers there.
    """

    def __init__(
        self,
        uri: str,
        port: Port | None = None,
        parameters: ArduinoParameters | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.uri = uri if uri.startswith(SCHEME) else SCHEME + uri
        self.parameters = parameters or ArduinoParameters()
        self._clock, self._sleep = clock, sleep
        self._armed, self._throttle, self._open = False, 0.0, True
        port = SerialPort(self.uri.removeprefix(SCHEME)) if port is None else port
        self.firmware = FirmwareClient(self.uri, port, self.parameters.timeout, clock, sleep)
        try:
            self.firmware.wait_ready(self.parameters.startup_timeout)
        except BaseException:
            port.close()
            raise

    @property
    def report(self) -> Report:
        """The last word of the firmware, in full; never waits."""
        return self.firmware.report

    def status(self) -> LinkStatus:
        """Return what the firmware last said of itself; never waits."""
        report = self.report
        return LinkStatus(report.state, report.version, report.bad, report.age_ms / 1e3, report.warnings)

    def send(self, command: Command) -> Command:
        """Send the sticks of this moment; returns what goes on the air, all zero unless armed.

        When the firmware is no longer armed, by its failsafe or a reset, the link disarms too: `arm` begins anew.
        """
        _ = self.report  # raises if the board is gone or silent
        self._armed = self._armed and not self.firmware.refused
        if not self._armed:
            command = Command()
        self.firmware.send_channels(channels.channels(command, self._armed, self.parameters.high_rate), self._armed)
        self._throttle = command.throttle
        return channels.on_air(command)

    def arm(self) -> None:
        """Arm: arm switch low, throttle zero, then arm switch high, each until the firmware has seen it.

        Raises
        ------
        LinkError
            If it does not follow.
        """
        self._armed = False
        self._repeat(lambda: self.report.may_arm, "it cannot be armed")
        self._armed = True
        try:
            self._repeat(lambda: self.report.state == "armed", "it did not arm")
        except BaseException:
            self._armed = False
            raise

    def send_disarmed(self, command: Command) -> Command:
        """Send sticks with the arm switch low: the firmware hears them, the motors stay off.

        Returns the command as the firmware would put it on the air; what it did hear is in `report`.
        """
        self._armed, self._throttle = False, 0.0
        _ = self.report
        self.firmware.send_channels(channels.channels(command), armed=False)
        return channels.on_air(command)

    def land(self, duration: float = 1.5) -> None:
        """Bring the throttle to zero over so many seconds, sticks neutral, then disarm; 0 cuts at once.

        It flies blind, for nothing measures the height: best begun low.
        """
        start, top = self._clock(), self._throttle
        while self._armed and top > 0 and (past := self._clock() - start) < duration:
            self.send(Command(throttle=top * (1.0 - past / duration)))
            self._sleep(self.parameters.frame_period)
        self._armed = False
        self._repeat(lambda: self.report.state not in ("armed", "holding"), "it did not disarm")

    def bind(self) -> None:
        """Begin to send bind packets, for 1.38 s; refused by the firmware while armed."""
        self.firmware.write(transmitter.bind_frame())

    def read_config(self) -> tuple[Result, Config]:
        """Return whether the firmware's configuration is stored or its default, and the configuration."""
        return self.firmware.ask(transmitter.read_config_frame())

    def write_config(self, config: Config) -> Result:
        """Store a configuration; returns whether the firmware took it, once it is in its EEPROM.

        A new id needs a new binding.
        """
        result, _ = self.firmware.ask(transmitter.write_config_frame(config))
        self.firmware.wait(lambda: not self.report.storing, 2.0, "the configuration is not stored")
        return result

    def close(self) -> None:
        """Land and let go of the device; where the device is broken nothing is left to be done from here."""
        if not self._open:
            return
        self._open = False
        try:
            if not self.firmware.broken:
                self.land()
        finally:
            self.firmware.close()

    def __enter__(self) -> Self:
        """Return the link."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Land and let go of the device."""
        self.close()

    def _repeat(self, done: Callable[[], bool], complaint: str) -> None:
        """Send neutral frames, with the arm switch as it is, until something is so."""
        start = self._clock()
        while True:
            self.send(Command())
            self._sleep(self.parameters.frame_period)
            if done():
                return
            if self._clock() - start > self.parameters.arm_timeout:
                raise LinkError(f"{self.uri}: {complaint}; it is {self.report.state}")
