"""The dialog with the transmitter's firmware over a port: `FirmwareClient`."""

import contextlib
from collections.abc import Callable

import msgspec

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links import crsf_frame as crsf
from matchset.links.arduino import channels, messages
from matchset.links.arduino.messages import Config, Result, StatusReport
from matchset.links.link import State, wait_until
from matchset.links.serial_port import Port

GROUNDED = ("binding", "locked", "failsafe")  # format: states in which the motors are off


class ArduinoParameters(msgspec.Struct, frozen=True):
    """Times of the link; all chosen by hand, `tests/links/arduino` and `tests/emu` show a change.

    Parameters
    ----------
    timeout : float
        Longest time without a message from the board, s; then the link is broken. It sends one every 33 ms while
        commands arrive and every 100 ms otherwise; shorter detects a fault sooner but fails on a busy computer.
    startup_timeout : float
        How long a board may take to send its first message, s. A boot loader waits 1 to 2 s.
    frame_period : float
        Time between frames while arming and landing, s. Much shorter than the firmware's failsafe.
    arm_timeout : float
        How long arming may take, s.
    answer_timeout : float
        How long the answer to a question about the configuration may take, s.
    store_timeout : float
        How long storing a configuration may take, s: 30 bytes of an EEPROM take 0.1 s.
    poll_period : float
        Time between looks for messages while waiting, s.
    alike : int
        Status frames in a row, 1 or more, that must say that the motors are off until it is believed in flight: a CRC
        of 8 bits lets one damaged frame of 256 pass. More is surer and later, by a frame each; the firmware sends two
        at once when its state changes, and stops the motors whatever the host believes. Derived: two damaged frames in
        a row pass once in 65536 times.
    high_rate : bool
        Fly with the toy's high rate: more tilt, less resolution.
    """

    timeout: float = 0.5
    startup_timeout: float = 4.0
    frame_period: float = 0.03
    arm_timeout: float = 2.0
    answer_timeout: float = 1.0
    store_timeout: float = 2.0
    poll_period: float = 0.01
    alike: int = 2
    high_rate: bool = False

    def __post_init__(self) -> None:
        if self.alike < 1:
            raise ValueError(f"at least one status frame must be believed, got alike {self.alike}")


class FirmwareClient:
    """Sends frames to the firmware and receives its messages; it knows nothing of flying.

    Parameters
    ----------
    name : str
        Name of the device in error messages.
    port : Port
    parameters : ArduinoParameters
    clock, sleep : callables
        The time, s, and a function that waits.

    Attributes
    ----------
    sent, answered : int
        Channel frames so far, and those whose number a status has returned.
    round_trip : float or None
        From sending the last answered frame to the arrival of its answer, s.
    refused : bool
        The firmware received frames with the arm switch high and is not armed, by `alike` status frames in a row.
    strange : int
        Messages with a good CRC that make no sense: damaged, or another firmware's.
    broken : bool
        The device is gone or no longer answers.
    """

    def __init__(
        self,
        name: str,
        port: Port,
        parameters: ArduinoParameters,
        clock: Callable[[], float],
        sleep: Callable[[float], None],
    ) -> None:
        self.name, self.parameters = name, parameters
        self.sent = self.answered = self.strange = 0
        self.round_trip: float | None = None
        self.refused = self.broken = False
        self._port, self._clock, self._sleep = port, clock, sleep
        self._parser = crsf.CrsfParser()
        self._pending: dict[int, tuple[float, bool]] = {}  # frame number: when it was sent, arm switch
        self._config: tuple[Result, Config] | None = None
        self._report: StatusReport | None = None
        self._asked = False  # about the configuration
        self._echo: tuple[int, bool] = -1, False  # channel 16 of the last status, arm switch of that frame
        self._refusals: tuple[State | None, int] = None, 0  # state, status frames in a row that refuse with it
        self._ends: tuple[State | None, int] = None, 0  # state, status frames in a row that end a flight with it
        self._received_at = clock()

    @property
    def report(self) -> StatusReport:
        """The last status of the firmware; never waits."""
        self.receive()
        silence = self._clock() - self._received_at
        if silence > self.parameters.timeout:
            self.broken = True
            raise LinkError(f"{self.name} has been silent for {silence:.1f} s")
        assert self._report is not None  # `wait_ready` waited for it
        return self._report

    def wait_ready(self) -> None:
        """Wait for the first status.

        Raises
        ------
        LinkError
            If there is none within `ArduinoParameters.startup_timeout`.
        """
        self.wait(lambda: self._report is not None, self.parameters.startup_timeout, "nobody answers")

    def send_channels(self, values: list[int], armed: bool) -> None:
        """Send a channel frame; its number is written into the last channel."""
        number = self.sent % channels.FRAME_NUMBERS
        values[-1] = crsf.CHANNEL_LOW + number
        self._pending[number] = self._clock(), armed
        self.sent += 1
        self.write(crsf.frame(crsf.CHANNELS_PACKED, crsf.pack_channels(values)))

    def disarm(self) -> None:
        """Send one frame with the arm switch low and no number; neither reads nor waits."""
        self.write(crsf.frame(crsf.CHANNELS_PACKED, crsf.pack_channels(channels.channels(Command()))))

    def write(self, data: bytes) -> None:
        """Send bytes.

        Raises
        ------
        LinkError
            If the device is gone.
        """
        try:
            self._port.write(data)
        except OSError as error:
            raise self._lost(error) from error

    def receive(self) -> None:
        """Read and decode what has arrived; never waits."""
        try:
            data = self._port.read()
        except OSError as error:
            raise self._lost(error) from error
        for kind, payload in self._parser.feed(data):
            try:
                if kind == messages.STATUS:
                    self._update(StatusReport.decode(payload))
                elif kind == messages.CONFIG and self._asked:
                    self._config = messages.decode_config(payload)
            except LinkError:
                self.strange += 1
                another_firmware = self._report is None and self.strange >= self.parameters.alike
                if another_firmware or kind == messages.CONFIG:
                    raise

    def request(self, frame: bytes) -> tuple[Result, Config]:
        """Send a request about the configuration and wait for the answer."""
        self._config, self._asked = None, True
        self.write(frame)
        message = "no answer to a question about the configuration"
        try:
            self.wait(lambda: self._config is not None, self.parameters.answer_timeout, message)
        finally:
            self._asked = False
        assert self._config is not None
        return self._config

    def wait(self, done: Callable[[], bool], limit: float, message: str) -> None:
        """Receive until a condition holds; LinkError with the message after `limit`, s."""
        self.receive()
        if not wait_until(done, limit, self._clock, self._pause):
            raise LinkError(f"{self.name}: {message} (waited {limit:g} s)")

    def _pause(self) -> None:
        self._sleep(self.parameters.poll_period)
        self.receive()

    def close(self) -> None:
        """Close the device; one that stopped answering is sent a last frame that disarms."""
        if self.broken:  # it may still receive
            with contextlib.suppress(LinkError):
                self.disarm()
        self._port.close()

    def _update(self, report: StatusReport) -> None:
        self._received_at = self._clock()
        default = None, report.echo == self._echo[0] and self._echo[1]
        sent_at, armed = self._pending.pop(report.echo - crsf.CHANNEL_LOW, default)
        self._echo = report.echo, armed
        if sent_at is not None and report.good:
            self.answered += 1
            self.round_trip = self._received_at - sent_at
        refuses = report.state in ("failsafe", "binding") or (armed and report.state == "locked")
        self._refusals = _in_a_row(self._refusals, report.state if refuses else None)
        self.refused = self._refusals[1] >= self.parameters.alike
        flying = self._report is not None and self._report.state not in GROUNDED
        self._ends = _in_a_row(self._ends, report.state if flying and report.state in GROUNDED else None)
        if not self._ends[1] or self._ends[1] >= self.parameters.alike:
            self._report = report

    def _lost(self, error: OSError) -> LinkError:
        self.broken = True
        return LinkError(f"{self.name} has gone (unplugged?): {error}")


def _in_a_row(before: tuple[State | None, int], state: State | None) -> tuple[State | None, int]:
    """Count the status frames in a row with a state; None begins anew."""
    if state is None:
        return None, 0
    return state, before[1] + 1 if state == before[0] else 1
