"""UDP sockets that never wait: `arrived` reads what is there, `quiet` passes over errors that mean silence."""

import contextlib
import errno
import socket
from collections.abc import Iterator

DATAGRAM = 65_535  # format: largest number of bytes of a UDP packet
LAST_PORT = 65_535  # format: largest number of a UDP port
NOTHING = (errno.EAGAIN, errno.EWOULDBLOCK)
SILENCE = (*NOTHING, errno.ECONNREFUSED, errno.ECONNRESET, errno.ENOBUFS)
"""Errors of a socket that mean silence: nothing is there, nobody listens yet, no room for now."""


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Pass over errors that mean silence; others are raised."""
    try:
        yield
    except OSError as error:
        if error.errno not in SILENCE:
            raise


def arrived(there: socket.socket) -> list[tuple[bytes, tuple[str, int]]]:
    """Return the datagrams that have arrived, each with the address of its sender; never waits.

    Parameters
    ----------
    there : socket
        One that does not block.

    Raises
    ------
    OSError
        If the network is gone.
    """
    found: list[tuple[bytes, tuple[str, int]]] = []
    while True:
        try:
            found.append(there.recvfrom(DATAGRAM))
        except OSError as error:
            if error.errno in NOTHING:
                return found
            if error.errno not in SILENCE:
                raise
