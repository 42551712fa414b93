"""The conversation with the transmitter's firmware over a port: frames out, answers in, silence noticed."""

import contextlib
from collections.abc import Callable

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.arduino import channels, crsf
from matchset.links.arduino import messages as transmitter
from matchset.links.arduino.messages import Config, Report, Result
from matchset.links.arduino.serial_port import Port


class FirmwareClient:
    """Talks with the firmware; knows nothing of flying.

    Parameters
    ----------
    name : str
        What to call the device in messages.
    port : Port
        What to talk through.
    timeout : float
        Longest time without a word from the board, s.
    clock, sleep : callables
        Time, s, and how to let it pass.

    Attributes
    ----------
    sent, answered : int
        Channel frames so far, and those whose number came back.
    round_trip : float or None
        Time from the last answered frame to its answer's arrival, s.
    refused : bool
        The firmware has answered a frame with the arm switch high without being armed.
    broken : bool
        The device has gone or fallen silent.
    """

    def __init__(
        self, name: str, port: Port, timeout: float, clock: Callable[[], float], sleep: Callable[[float], None]
    ) -> None:
        self.name, self.timeout = name, timeout
        self.sent = self.answered = 0
        self.round_trip: float | None = None
        self.refused = self.broken = False
        self._port, self._clock, self._sleep = port, clock, sleep
        self._parser = crsf.Parser()
        self._on_way: dict[int, tuple[float, bool]] = {}  # frame number: when it was sent, arm switch
        self._config: tuple[Result, Config] | None = None
        self._report: Report | None = None
        self._heard_at = clock()

    @property
    def report(self) -> Report:
        """The last word of the firmware; never waits."""
        self.listen()
        silence = self._clock() - self._heard_at
        if silence > self.timeout:
            self.broken = True
            raise LinkError(f"{self.name} has been silent for {silence:.1f} s")
        assert self._report is not None  # `wait_ready` waited for it
        return self._report

    def wait_ready(self, startup_timeout: float) -> None:
        """Wait for the first word.

        Raises
        ------
        LinkError
            If there is none within `startup_timeout`, s.
        """
        self.wait(lambda: self._report is not None, startup_timeout, "nobody answers")

    def send_channels(self, values: list[int], armed: bool) -> None:
        """Send a channel frame; its number is put in."""
        number = self.sent % channels.NUMBERS
        values[-1] = crsf.CHANNEL_LOW + number
        self._on_way[number] = self._clock(), armed
        self.sent += 1
        self.write(crsf.frame(crsf.CHANNELS_PACKED, crsf.pack_channels(values)))

    def write(self, data: bytes) -> None:
        """Send bytes.

        Raises
        ------
        LinkError
            If the device has gone.
        """
        try:
            self._port.write(data)
        except OSError as error:
            raise self._gone(error) from error

    def listen(self) -> None:
        """Take in what has arrived; never waits."""
        try:
            data = self._port.read()
        except OSError as error:
            raise self._gone(error) from error
        for kind, payload in self._parser.feed(data):
            if kind == transmitter.STATUS:
                self._note(Report.decode(payload))
            elif kind == transmitter.CONFIG:
                self._config = transmitter.decode_config(payload)

    def ask(self, question: bytes) -> tuple[Result, Config]:
        """Send a question about the configuration and wait for the answer."""
        self._config = None
        self.write(question)
        self.wait(lambda: self._config is not None, 1.0, "no answer to a question about the configuration")
        assert self._config is not None
        return self._config

    def wait(self, done: Callable[[], bool], limit: float, complaint: str) -> None:
        """Listen until something is so; LinkError after `limit`, s."""
        start = self._clock()
        self.listen()
        while not done():
            if self._clock() - start > limit:
                raise LinkError(f"{self.name}: {complaint} (waited {limit:g} s)")
            self._sleep(0.01)
            self.listen()

    def close(self) -> None:
        """Let go of the device."""
        if self.broken:  # perhaps it still hears us: a last word that disarms
            last = channels.channels(Command())
            with contextlib.suppress(OSError):
                self._port.write(crsf.frame(crsf.CHANNELS_PACKED, crsf.pack_channels(last)))
        self._port.close()

    def _note(self, report: Report) -> None:
        self._report = report
        self._heard_at = self._clock()
        sent_at, armed = self._on_way.pop(report.echo - crsf.CHANNEL_LOW, (None, False))
        if sent_at is not None and report.good:
            self.answered += 1
            self.round_trip = self._heard_at - sent_at
        self.refused = report.state in ("failsafe", "binding") or (armed and report.state == "locked")

    def _gone(self, error: OSError) -> LinkError:
        self.broken = True
        return LinkError(f"{self.name} has gone (unplugged?): {error}")
