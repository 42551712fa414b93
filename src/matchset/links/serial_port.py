"""A serial port that does not reset the board when it is opened; the only file that needs pyserial."""

import contextlib
import errno
import os
from typing import Any, Protocol

from matchset.image.errors import LinkError
from matchset.numeric.copies import NotCopied
from matchset.numeric.imports import advice

BAUD = 115_200  # format: baud rate of the firmware
READ_BYTES = 4096  # format: largest number of bytes that one call reads
WRITE_TIMEOUT = 0.1  # format: s, where a write waits: not on POSIX; a frame takes 2.3 ms
IN_USE = "another program uses it"


class Port(Protocol):
    """The contract of a port. `write` and `read` raise `OSError` when the device is gone."""

    def write(self, data: bytes) -> None:
        """Write all these bytes."""

    def read(self) -> bytes:
        """Return the bytes that have arrived; never waits."""

    def close(self) -> None:
        """Close the device."""


class SerialPort(NotCopied):
    """A serial port of this computer.

    An Arduino resets when its DTR line becomes active, and Linux activates it whenever a port is opened. So the port is
    configured to keep DTR active after it is closed: only the first opening after the board was plugged in resets it,
    when nothing is flying yet. On other systems DTR is kept inactive.

    Parameters
    ----------
    path : str
        E.g. ``/dev/ttyUSB0``.
    baud : int
        Bits per second.

    Raises
    ------
    LinkError
        If pyserial is missing, or the port cannot be opened or is in use.
    """

    def __init__(self, path: str, baud: int = BAUD) -> None:
        try:
            import serial
        except ImportError:
            raise LinkError(f"the serial link needs pyserial: {advice('serial')}") from None
        self._serial: Any = serial.Serial()
        self._serial.port, self._serial.baudrate = path, baud
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
            number = getattr(error, "errno", None)
            words = os.strerror(number) if number else error
            raise LinkError(f"cannot open {path}: {IN_USE if number == errno.EAGAIN else words}") from error
        # FTDI converters delay bytes by up to 16 ms otherwise. Not every driver or system supports it.
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
        except termios.error as error:  # not an OSError
            raise OSError(str(error)) from error

    def write(self, data: bytes) -> None:
        """Write all these bytes; never waits on POSIX.

        Pyserial waits there until the port could take more, and counts a computer that was busy meanwhile as a broken
        port.
        """
        if os.name != "posix":
            self._serial.write(data)
            return
        try:
            written = os.write(self._serial.fileno(), data)
        except BlockingIOError:
            written = 0
        if written < len(data):
            raise OSError(f"it takes no more than {written} of {len(data)} bytes")

    def read(self) -> bytes:
        """Return the bytes that have arrived; never waits."""
        return bytes(self._serial.read(READ_BYTES))

    def close(self) -> None:
        """Close the device."""
        self._serial.close()
