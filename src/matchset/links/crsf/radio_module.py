"""The dialog with a transmitter module: channels at a fixed rate, telemetry, and the end of a silent caller."""

import contextlib
import math
import threading
import time
from collections.abc import Callable
from typing import NamedTuple, TypeVar

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links import crsf_frame as crsf
from matchset.links.crsf import telemetry
from matchset.links.crsf.frame_timer import FrameTimer
from matchset.links.crsf.parameters import CrsfParameters
from matchset.links.crsf.sticks import channels
from matchset.links.link import State
from matchset.links.serial_port import Port

PING_PERIOD = 1.0  # format: s between questions for the name of the module
FRAME_BITS = 260  # format: of a frame of channels, 26 bytes with start and stop bit each
_T = TypeVar("_T", bound=telemetry.Message)


class WantedCommand(NamedTuple):
    """What the caller wants to be sent, and since when, s."""

    command: Command
    armed: bool
    time: float


class RadioModule:
    """Sends the newest command again and again, and reads what the module says.

    Frames leave at the rate of the radio, whatever the rate of the caller: `turn` is one look at the port, and a thread
    calls it (`start`) but where the caller's clock is not that of the computer. If the caller falls silent while armed,
    the sticks become neutral, then the arm switch is low for a while, then nothing is sent: the failsafe of the
    receiver is a second way to the same end, if the arm channel is another one than the flight controller's.

    Parameters
    ----------
    name : str
        Name of the port in error messages.
    port : Port
    parameters : CrsfParameters
    clock : callable
        The time, s.

    Attributes
    ----------
    sent : int
        Channel frames so far.
    strange, echoes : int
        Frames with a good checksum that make no sense; own frames that came back on a wire for both directions.
    silent, stopped : bool
        The caller fell silent while armed; the motors were stopped by `stop`.
    ended : State or None
        How the flight controller ended the flight, by `alike` messages in a row: ``locked`` or ``failsafe``.
    """

    def __init__(self, name: str, port: Port, parameters: CrsfParameters, clock: Callable[[], float]) -> None:
        self.name, self.parameters = name, parameters
        self.sent = self.strange = self.echoes = 0
        self.silent = self.stopped = self._watched = False
        self.ended: State | None = None
        self._endings: tuple[State | None, int] = None, 0  # what the last messages say of the flight, how many alike
        self._port, self._clock = port, clock
        self._parser = crsf.CrsfParser(telemetry.ADDRESSES)
        self._latest: dict[type, tuple[telemetry.Message, float]] = {}
        self._pinged_at = self._resumed_at = now = clock()
        shortest = max(parameters.shortest, FRAME_BITS / parameters.baud)
        period = max(1.0 / parameters.rate, shortest)
        self.timer = FrameTimer(period, shortest, parameters.longest, parameters.step, now)
        self._wanted = WantedCommand(Command(), False, now)
        self._heard_at: float | None = None
        self._vehicle_at: float | None = None
        self._quiet_from = math.inf
        self._error: Exception | None = None
        self._end, self._thread = threading.Event(), threading.Thread(target=self._run, daemon=True)

    @property
    def bad(self) -> int:
        """Frames that were damaged or make no sense."""
        return self._parser.bad + self.strange

    @property
    def may_fly(self) -> bool:
        """Whether nothing has ended the flight since `resume`."""
        return not (self.silent or self.stopped or self.ended)

    @property
    def broken(self) -> bool:
        """Whether nothing can be sent any more."""
        return self._error is not None

    @property
    def mute(self) -> bool:
        """Whether the module has been silent for too long; one that is sent nothing may be."""
        return self._silence > self.parameters.timeout and self._quiet_from > self._clock()

    @property
    def sent_age(self) -> float:
        """Time since the caller's last command, s."""
        return self._clock() - self._wanted.time

    @property
    def vehicle_age(self) -> float:
        """Time since the last news of the vehicle, s; inf if there never was any."""
        return math.inf if self._vehicle_at is None else self._clock() - self._vehicle_at

    def latest(self, kind: type[_T]) -> _T | None:
        """Return the last message of a kind."""
        found = self._latest.get(kind)
        return found[0] if found else None  # type: ignore[return-value]

    def heard_since(self, kind: type[telemetry.Message], begin: float) -> bool:
        """Whether a message of a kind came after a time, s."""
        found = self._latest.get(kind)
        return found is not None and found[1] > begin

    def check(self) -> None:
        """Raise LinkError if the port is gone or the module is silent."""
        if self._error is not None:
            known = isinstance(self._error, OSError)
            words = f" has gone (unplugged?): {self._error}" if known else f": {self._error!r}"
            raise LinkError(self.name + words) from self._error
        if self.mute:
            raise LinkError(f"{self.name}: the module has been silent for {self._silence:.1f} s{self._garbage()}")

    def want(self, command: Command, armed: bool) -> None:
        """Send this from now on; after a silence, a stop, or the end of the flight nothing is armed until `resume`."""
        now = self._clock()
        if self._quiet_from <= now:
            self._resumed_at = now
        self._quiet_from = math.inf
        self._wanted = WantedCommand(command, armed, now)

    def watch(self, watched: bool) -> None:
        """Look whether the flight controller ends the flight, or no longer."""
        self._watched, self._endings = watched, (None, 0)

    def resume(self) -> None:
        """Forget what has ended the flight; nothing is armed."""
        self.want(Command(), False)
        self.silent, self.stopped, self.ended = False, False, None

    def stop(self) -> None:
        """Send a frame with the arm switch low at once, and only such from now on; never waits."""
        self.stopped = True
        with contextlib.suppress(OSError):  # the next look at the port says it
            self._write()

    def wait_ready(self, sleep: Callable[[float], None]) -> None:
        """Wait for the first frame of the module.

        Raises
        ------
        LinkError
            If there is none within `CrsfParameters.startup_timeout`.
        """
        start = self._clock()
        while self._heard_at is None:
            self.check()
            if self._clock() - start > self.parameters.startup_timeout:
                echo = "; own frames come back, as on a wire for both directions" if self.echoes else self._garbage()
                limit = self.parameters.startup_timeout
                raise LinkError(f"{self.name}: no module answers (waited {limit:g} s){echo}")
            sleep(self.parameters.poll_period)

    def start(self) -> None:
        """Let a thread do it."""
        self._thread.start()

    def close(self) -> None:
        """Stop the thread and close the port."""
        self._end.set()
        if self._thread.is_alive():
            self._thread.join()
        self._port.close()

    def turn(self) -> None:
        """Read what has come, and send a frame if one is due; never waits."""
        try:
            self._read()
            now = self._clock()
            if now >= self.timer.due:
                self._end_silence(now)
                if now < self._quiet_from:
                    self._write()
                    self._ask(now)
                self.timer.sent(now)
        except Exception as error:  # `check` raises it where the caller is
            self._error = error

    @property
    def _silence(self) -> float:
        """Of the module, s; 0 before its first frame."""
        return 0.0 if self._heard_at is None else self._clock() - max(self._heard_at, self._resumed_at)

    def _run(self) -> None:
        while not self._end.is_set() and self._error is None:
            self.turn()
            pause = min(self.timer.due - self._clock(), self.parameters.poll_period)
            if pause > 0.0:
                time.sleep(pause)

    def _write(self) -> None:
        command, armed, since = self._wanted
        armed = armed and self.may_fly
        if armed and self._clock() - since > self.parameters.hold_after:
            command = Command(throttle=command.throttle)
        values = channels(command, armed, self.parameters.arm_channel)
        self._port.write(crsf.frame(crsf.CHANNELS_PACKED, crsf.pack_channels(values)))
        self.sent += 1

    def _end_silence(self, now: float) -> None:
        wanted = self._wanted
        if wanted.armed and not self.silent and now - wanted.time > self.parameters.cut_after:
            self.silent, self._quiet_from = True, now + self.parameters.disarm_time

    def _ask(self, now: float) -> None:
        """Tell the module its receiver and ask for its name, until that is known."""
        if telemetry.Device not in self._latest and not self._wanted.armed and now - self._pinged_at >= PING_PERIOD:
            self._pinged_at = now
            if self.parameters.receiver is not None:
                select = telemetry.select_receiver(self.parameters.receiver)
                self._port.write(crsf.frame(telemetry.COMMAND, select))
            self._port.write(crsf.frame(telemetry.PING, telemetry.PING_PAYLOAD))

    def _read(self) -> None:
        for kind, payload in self._parser.feed(self._port.read()):
            if kind in (crsf.CHANNELS_PACKED, telemetry.PING, telemetry.COMMAND):
                self.echoes += 1
                continue
            try:
                message = telemetry.decode(kind, payload)
            except ValueError:
                self.strange += 1
                continue
            self._note(kind, message, self._clock())

    def _note(self, kind: int, message: telemetry.Message | None, now: float) -> None:
        self._heard_at = now
        answers = isinstance(message, telemetry.LinkStatistics) and message.quality > 0
        if answers or kind in telemetry.FROM_VEHICLE:
            self._vehicle_at = now
        if isinstance(message, telemetry.FrameTiming):
            self.timer.correct(message.interval, message.early)
        if isinstance(message, telemetry.FlightMode) and self._watched:
            state: State | None = "failsafe" if message.failsafe else "locked" if message.disarmed else None
            before, count = self._endings
            self._endings = state, (count if state == before else 0) + 1
            if state is not None and self._endings[1] >= self.parameters.alike:
                self.ended = state
        if message is not None:
            self._latest[type(message)] = message, now

    def _garbage(self) -> str:
        count = self._parser.skipped
        return f"; {count} bytes came that are no frames: another baud rate, or an inverted line?" if count else ""
