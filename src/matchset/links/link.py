"""What every link to a vehicle offers: a URI, five methods, and a `with` block that lands when it is left."""

from types import TracebackType
from typing import Literal, Protocol, Self

import msgspec

from matchset.control.command import Command

State = Literal["binding", "locked", "armed", "holding", "failsafe"]
"""How things stand at the far end.

``binding``: it makes itself known to the vehicle. ``locked``: motors off, may be armed. ``armed``: commands fly.
``holding``: armed, but commands have stopped coming; sticks neutral, throttle as it was. ``failsafe``: commands
have been missing too long, or the far end restarted; motors off until `Link.arm`.
"""


class LinkStatus(msgspec.Struct, frozen=True):
    """What the far end last said of itself.

    Attributes
    ----------
    state : State
        How things stand.
    version : str
        Of its program.
    errors : int
        Messages that it could not read, since it started (it may count modulo some power of two).
    age : float
        Age of the last good command when it said so, s.
    warnings : tuple of str
        What is wrong with it, in words.
    """

    state: State
    version: str
    errors: int
    age: float
    warnings: tuple[str, ...] = ()


class Link(Protocol):
    """A vehicle that takes commands.

    Used in a `with` block: however the block is left, the vehicle lands and its motors stop. Where the link
    itself is broken nothing can be sent any more, and the far end has to act on its own.

    Attributes
    ----------
    uri : str
        Where it leads, e.g. ``serial:///dev/ttyUSB0``.

    Raises
    ------
    LinkError
        By every method, when the device is gone or does not answer.
    """

    uri: str

    def arm(self) -> None:
        """Make the vehicle take throttle; the motors stay off until a command asks for more."""

    def send(self, command: Command) -> Command:
        """Send the sticks of this moment; returns what the vehicle gets: quantized, and all zero unless armed."""

    def status(self) -> LinkStatus:
        """Return what the far end last said of itself; never waits."""

    def land(self, duration: float = 1.5) -> None:
        """Bring the throttle to zero over so many seconds, sticks neutral, then disarm; 0 cuts at once."""

    def close(self) -> None:
        """Let go of the device; lands first."""

    def __enter__(self) -> Self:
        """Return the link."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Land and let go of the device."""
