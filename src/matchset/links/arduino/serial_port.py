"""A serial port, opened without resetting the board behind it; the only file that needs pyserial."""

import contextlib
import os
from typing import Any, Protocol

from matchset.image.errors import LinkError

BAUD = 115_200
WRITE_TIMEOUT = 0.1  # s; a frame takes 2.3 ms, so a port that is stuck for longer is no port


class Port(Protocol):
    """What the link needs of a port. Both sides raise `OSError` when the device has gone."""

    def write(self, data: bytes) -> None:
        """Send all these bytes."""

    def read(self) -> bytes:
        """Return the bytes that have arrived; never waits."""

    def close(self) -> None:
        """Let go of the device."""


class SerialPort:
    """A port of this computer.

    An Arduino resets when its DTR line falls from idle to active, and Linux activates it on every opening.
    So DTR is told to stay active when the port is closed: only the first opening after the board was plugged in
    resets it, and that one finds nothing in the air. Elsewhere DTR is kept idle altogether.

    Parameters
    ----------
    path : str
        E.g. ``/dev/ttyUSB0``.

    Raises
    ------
    LinkError
        If pyserial is missing, or the port cannot be opened or is in use.
    """

    def __init__(self, path: str) -> None:
        try:
            import serial
        except ImportError:
            raise LinkError("the serial link needs pyserial: pip install 'matchset[serial]'") from None
        self._serial: Any = serial.Serial()
        self._serial.port, self._serial.baudrate = path, BAUD
        self._serial.timeout, self._serial.write_timeout = 0, WRITE_TIMEOUT
        if os.name == "posix":
            self._serial.exclusive = True
        else:
            self._serial.dtr = False
        try:
            self._serial.open()
            self._keep_dtr()
        except (OSError, ValueError) as error:
            self.close()
            raise LinkError(f"cannot open {path}: {error}") from error
        # FTDI bridges hold bytes back for 16 ms otherwise. Not every driver, or system, knows how.
        with contextlib.suppress(OSError, ValueError, NotImplementedError, AttributeError):
            self._serial.set_low_latency_mode(True)

    def _keep_dtr(self) -> None:
        if os.name != "posix":
            return
        import termios

        descriptor = self._serial.fileno()
        try:
            flags = termios.tcgetattr(descriptor)
            flags[2] &= ~termios.HUPCL
            termios.tcsetattr(descriptor, termios.TCSANOW, flags)
        except termios.error as error:  # is no OSError
            raise OSError(str(error)) from error

    def write(self, data: bytes) -> None:
        """Send all these bytes."""
        self._serial.write(data)

    def read(self) -> bytes:
        """Return the bytes that have arrived; never waits."""
        return bytes(self._serial.read(4096))

    def close(self) -> None:
        """Let go of the device."""
        self._serial.close()
