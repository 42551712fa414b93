"""What carries the bytes to and from an autopilot: a UDP socket or a serial port, `open_port`."""

import contextlib
import errno
import socket
from typing import Protocol

from matchset.image.errors import LinkError
from matchset.links.datagrams import arrived, quiet
from matchset.links.mavlink.address import Address
from matchset.links.serial_port import SerialPort
from matchset.numeric.copies import NotCopied


class MavlinkPort(Protocol):
    """The contract of a port. `write` and `read` raise `OSError` when the device is gone."""

    def write(self, data: bytes) -> None:
        """Send bytes to the sender that was chosen; without one, to whom the port was opened or who was heard."""

    def read(self) -> list[tuple[str, bytes]]:
        """Return who sent what, since the last time; never waits. A sender that was not chosen is left out."""

    def choose(self, sender: str) -> None:
        """Hear and speak to this sender alone from now on."""

    def close(self) -> None:
        """Close it."""


class UdpPort(NotCopied):
    """A UDP socket.

    Parameters
    ----------
    address : Address
        ``udpin`` waits at the port; one port is for one program. ``udpout`` speaks first.

    Attributes
    ----------
    strangers : int
        Datagrams from others than the sender that was chosen.

    Raises
    ------
    LinkError
        If the port is in use, or there is no such address.
    """

    def __init__(self, address: Address) -> None:
        self.strangers = 0
        self._senders: dict[str, tuple[str, int]] = {}
        self._chosen: tuple[str, int] | None = None
        place = address.place, address.number
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            if address.kind == "udpin":
                self._socket.bind(place)
            else:
                self._chosen = socket.gethostbyname(address.place), address.number
                self._socket.connect(self._chosen)
        except OSError as error:
            self._socket.close()
            in_use = error.errno == errno.EADDRINUSE
            words = "another program uses it" if in_use else error.strerror or str(error)
            raise LinkError(f"cannot open {address.kind} {address.place}:{address.number}: {words}") from error
        self._connected = address.kind == "udpout"

    def write(self, data: bytes) -> None:
        """Send bytes to the sender that was chosen, or whom the port was opened for.

        Before one is chosen, to all that were heard: some autopilots speak MAVLink 1 until they hear MAVLink 2.
        """
        receivers = list(self._senders.values()) if self._chosen is None else [self._chosen]
        for receiver in receivers:
            with quiet():
                if self._connected:
                    self._socket.send(data)
                else:
                    self._socket.sendto(data, receiver)

    def read(self) -> list[tuple[str, bytes]]:
        """Return the datagrams that have arrived, each with its sender; never waits."""
        found: list[tuple[str, bytes]] = []
        for data, sender in arrived(self._socket):
            if self._chosen not in (None, sender):
                self.strangers += 1
                continue
            name = f"{sender[0]}:{sender[1]}"
            self._senders[name] = sender
            found.append((name, data))
        return found

    def choose(self, sender: str) -> None:
        """Hear and speak to this sender alone from now on."""
        self._chosen = self._senders[sender]

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class SerialLine:
    """A serial port, with the one sender that it has.

    Parameters
    ----------
    path : str
    baud : int

    Raises
    ------
    LinkError
        If it cannot be opened or is in use.
    """

    def __init__(self, path: str, baud: int) -> None:
        self._port, self._path = SerialPort(path, baud), path

    def write(self, data: bytes) -> None:
        """Write all these bytes."""
        self._port.write(data)

    def read(self) -> list[tuple[str, bytes]]:
        """Return the bytes that have arrived; never waits."""
        data = self._port.read()
        return [(self._path, data)] if data else []

    def choose(self, sender: str) -> None:
        """Do nothing: there is one sender."""

    def close(self) -> None:
        """Close the device."""
        with contextlib.suppress(OSError):
            self._port.close()


def open_port(address: Address) -> MavlinkPort:
    """Open the port of an address.

    Raises
    ------
    LinkError
        If it cannot be opened or is in use.
    """
    return SerialLine(address.place, address.number) if address.kind == "serial" else UdpPort(address)
