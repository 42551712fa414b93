"""The contract of every link to a vehicle: a URI, six methods, and a `with` block that lands when it ends.

`DeviceLink` is what the links have in common that hold a device.
"""

from collections.abc import Callable, Iterator
from types import TracebackType
from typing import Literal, Protocol, Self

import msgspec

from matchset.control.command import Command
from matchset.links import landing_signals
from matchset.numeric.copies import NotCopied

State = Literal["binding", "locked", "armed", "holding", "failsafe"]
"""State of the transmitter.

``binding``: it sends its address to the vehicle. ``locked``: motors off, may be armed. ``armed``: commands are flown.
``holding``: armed, but no commands arrive; sticks neutral, throttle unchanged. ``failsafe``: no commands for too long,
or the transmitter restarted; motors off until `Link.arm`.
"""


REFUSALS: dict[State, str] = {
    "failsafe": "the transmitter stopped the motors: it heard nothing for too long, or was restarted",
    "locked": "the transmitter is disarmed",
    "binding": "the transmitter is binding",
}
"""Why a link that was armed flies no command, by the state of its transmitter."""


class LinkStatus(msgspec.Struct, frozen=True):
    """The last status of the transmitter.

    Attributes
    ----------
    state : State
    version : str
        Of its firmware.
    errors : int
        Messages that it could not read since it started; the counter may wrap.
    age : float
        Age of the last good command at the time of the status, s.
    warnings : tuple of str
        Its faults, in words.
    reason : str
        Why it flies no command although it was armed, in the words of a vehicle that gives a reason; else empty.
    """

    state: State
    version: str
    errors: int
    age: float
    warnings: tuple[str, ...] = ()
    reason: str = ""

    @property
    def refusal(self) -> str:
        """Why the commands of a link that was armed are not flown, in words; empty if they are."""
        return self.reason or REFUSALS.get(self.state, "")


class Link(Protocol):
    """The connection to a vehicle that accepts commands; a class of the same methods need not be derived from it.

    Used in a `with` block: at its end, also after an error, the vehicle lands and its motors stop. If the link itself
    is broken nothing can be sent any more, and the failsafe of the transmitter has to act. In the block, if the main
    thread has entered it, SIGTERM and SIGHUP raise `SystemExit` in place of ending the program: `landing_signals`.

    Attributes
    ----------
    uri : str
        Its address, e.g. ``serial:///dev/ttyUSB0``.

    Raises
    ------
    LinkError
        By every method, when the device is gone or does not answer.
    """

    uri: str

    def arm(self) -> None:
        """Enable the throttle; the motors stay off until a command raises it."""

    def send(self, command: Command) -> Command:
        """Send a command; returns what the vehicle receives: quantized, and all zero unless armed."""

    def status(self) -> LinkStatus:
        """Return the last status of the transmitter; never waits."""

    def land(self, duration: float = 1.5) -> None:
        """Lower the throttle to zero over so many seconds, sticks neutral, then disarm; 0 stops the motors at once."""

    def cut(self) -> None:
        """Stop the motors at once and disarm; never waits, so another thread or a signal handler may call it."""

    def close(self) -> None:
        """Land, then close the device."""

    def __enter__(self) -> Self:
        """Return the link; SIGTERM and SIGHUP land from now on."""
        landing_signals.enter()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Land and close the device; a signal that comes meanwhile waits until that is done."""
        try:
            self.close()
        finally:
            landing_signals.leave()


landing_signals.LANDING.add(Link.__exit__.__code__)


class LinkDevice(Protocol):
    """The dialog of a link with what it holds."""

    @property
    def broken(self) -> bool:
        """Whether it is gone, or silent for too long."""

    def close(self) -> None:
        """Let go of it."""


class DeviceLink(NotCopied, Link):
    """What links have in common that hold a device."""

    instead = "one program flies a vehicle; pass the commands on"
    _open = True
    _armed: bool
    _throttle: float
    _clock: Callable[[], float]

    def _close(self, device: LinkDevice) -> None:
        """Land and close the device, once; a broken device is only closed."""
        if not self._open:
            return
        self._open = False
        try:
            if not device.broken:
                self.land()
        finally:
            device.close()

    def _lowering(self, duration: float) -> Iterator[Command]:
        """Commands, sticks neutral, whose throttle falls to zero over so many seconds, while it is armed."""
        start, top = self._clock(), self._throttle
        while self._armed and top > 0 and (past := self._clock() - start) < duration:
            yield Command(throttle=top * (1.0 - past / duration))


def wait_until(done: Callable[[], bool], limit: float, clock: Callable[[], float], step: Callable[[], None]) -> bool:
    """Wait for a condition; False if it does not hold in time.

    Parameters
    ----------
    done : callable
        Whether it holds.
    limit : float
        For how long to wait, s.
    clock : callable
        The time, s.
    step : callable
        Called again and again meanwhile; it takes a while.
    """
    start = clock()
    while not done():
        if clock() - start > limit:
            return False
        step()
    return True
