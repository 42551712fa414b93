"""``serial:///dev/ttyUSB0``: an Arduino with a radio, which runs ``firmware/syma_transmitter``.

The serial port runs at 115200 baud, 8N1. To the board goes one RC_CHANNELS_PACKED frame of CRSF per command, 26 bytes,
whose channels `channels.py` defines; back comes a status frame for each of them and at least ten a second, defined
with the other messages in `messages.py`.

The firmware has a failsafe that the host cannot switch off: without a good frame for 100 ms the sticks become neutral,
within 250 ms the throttle is zero and stays so until the host disarms and arms again.
"""

import contextlib
import time
from collections.abc import Callable

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.arduino import channels, messages
from matchset.links.arduino.messages import Config, Result, StatusReport
from matchset.links.arduino.protocol import ArduinoParameters, FirmwareClient
from matchset.links.link import DeviceLink, LinkStatus
from matchset.links.serial_port import Port, SerialPort

SCHEME = "serial://"


class ArduinoLink(DeviceLink):
    """A toy quadcopter behind an Arduino; implements `matchset.links.link.Link`.

    Parameters
    ----------
    uri : str
        ``serial:///dev/ttyUSB0``, ``serial://COM3``, or a bare path.
    port : Port, optional
        Used instead of the serial port of that name.
    parameters : ArduinoParameters, optional
    clock, sleep : callables
        The time, s, and a function that waits; tests replace them.

    Attributes
    ----------
    firmware : FirmwareClient
        The dialog with it: frames sent and answered, round trip time.

    Raises
    ------
    LinkError
        If the port cannot be opened or nothing answers there.
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
        self._armed, self._throttle, self._cut = False, 0.0, False
        port = SerialPort(self.uri.removeprefix(SCHEME)) if port is None else port
        self.firmware = FirmwareClient(self.uri, port, self.parameters, clock, sleep)
        try:
            self.firmware.wait_ready()
        except BaseException:
            port.close()
            raise

    @property
    def report(self) -> StatusReport:
        """The last status of the firmware with all its fields; never waits."""
        return self.firmware.report

    def status(self) -> LinkStatus:
        """Return the last status of the firmware; never waits."""
        report = self.report
        return LinkStatus(report.state, report.version, report.bad, report.age_ms / 1e3, report.warnings)

    def send(self, command: Command) -> Command:
        """Send a command; returns what the radio sends, all zero unless armed.

        When the firmware is no longer armed, after its failsafe or a reset, the link disarms too; then call `arm`
        again.
        """
        _ = self.report  # raises if the board is gone or silent
        self._armed = self._armed and not self.firmware.refused and not self._cut
        if not self._armed:
            command = Command()
        self.firmware.send_channels(channels.channels(command, self._armed, self.parameters.high_rate), self._armed)
        self._throttle = command.throttle
        return channels.on_air(command)

    def arm(self) -> None:
        """Arm: arm switch low and throttle zero, then arm switch high, each until the firmware confirms it.

        Raises
        ------
        LinkError
            If the firmware does not confirm it in time, or `cut` came meanwhile.
        """
        self._armed = self._cut = False
        self._repeat(lambda: self.report.may_arm, "it cannot be armed")
        self._armed = True
        try:
            self._repeat(lambda: self.report.state == "armed", "it did not arm")
        except BaseException:
            self._armed = False
            raise

    def send_disarmed(self, command: Command) -> Command:
        """Send a command with the arm switch low: the firmware receives it, the motors stay off.

        Returns the command as the radio would send it; what the firmware received is in `report`.
        """
        self._armed, self._throttle = False, 0.0
        _ = self.report
        self.firmware.send_channels(channels.channels(command), armed=False)
        return channels.on_air(command)

    def land(self, duration: float = 1.5) -> None:
        """Lower the throttle to zero over so many seconds, sticks neutral, then disarm; 0 stops the motors at once.

        Nothing measures the height meanwhile: begin low.
        """
        for command in self._lowering(duration):
            self.send(command)
            self._sleep(self.parameters.frame_period)
        self._armed = False
        self._repeat(lambda: self.report.state not in ("armed", "holding"), "it did not disarm")

    def cut(self) -> None:
        """Stop the motors by one frame with the arm switch low, sent at once; never waits for an answer.

        Another thread or a signal handler may call it. A frame of another thread that leaves after it cannot arm: for
        that the firmware wants three frames with the switch low.
        """
        self._cut = True
        with contextlib.suppress(LinkError):  # the next `send` raises it
            self.firmware.disarm()

    def bind(self) -> None:
        """Start sending bind packets, for 1.38 s; the firmware refuses while armed."""
        self.firmware.write(messages.bind_frame())

    def read_config(self) -> tuple[Result, Config]:
        """Return whether the firmware's configuration is stored or its default, and the configuration."""
        return self.firmware.request(messages.read_config_frame())

    def write_config(self, config: Config) -> Result:
        """Store a configuration; returns the result once it is in the EEPROM.

        After a new id the vehicle must be bound again.
        """
        result, _ = self.firmware.request(messages.write_config_frame(config))
        self.firmware.wait(
            lambda: not self.report.storing, self.parameters.store_timeout, "the configuration is not stored"
        )
        return result

    def close(self) -> None:
        """Land and close the device; a broken device is only closed."""
        self._close(self.firmware)

    def _repeat(self, done: Callable[[], bool], message: str) -> None:
        """Send neutral frames, with the arm switch unchanged, until a condition holds."""
        start = self._clock()
        while True:
            self.send(Command())
            self._sleep(self.parameters.frame_period)
            if done():
                return
            if self._clock() - start > self.parameters.arm_timeout:
                raise LinkError(f"{self.uri}: {message}; it is {self.report.state}")
