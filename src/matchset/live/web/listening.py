"""Where the server listens, and what is printed of it: `listen`, `own_address`, `qr_code`."""

import io
import socket

from matchset.numeric.imports import advice

SEND_BUFFER = 65536  # format: bytes that the system keeps of what a slow program has not read: decision 095
PORTS = 20  # format: ports that are tried, one after the other
LAST_PORT = 65535  # format: of TCP
WHITE_ON_BLACK, PLAIN = "\033[97;40m", "\033[0m"  # format: ANSI; phones read no code that is light on dark


def listen(host: str, port: int) -> tuple[socket.socket, int]:
    """Open a port, or the next one that is free.

    Raises
    ------
    ValueError
        If none of twenty is.
    """
    last = min(port + PORTS - 1, LAST_PORT)
    for number in range(port, last + 1):
        listener = socket.socket()
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        try:
            listener.bind((host, number))
            listener.listen()
        except OSError:
            listener.close()
            continue
        return listener, listener.getsockname()[1]
    raise ValueError(f"ports {port} to {last} are all in use, or may not be opened: choose another with --port")


def own_address() -> str:
    """Return the address of this computer in its network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # format: an address for documentation; nothing is sent
        except OSError:
            return "127.0.0.1"
        name: str = probe.getsockname()[0]
        return name


def qr_code(url: str) -> str:
    """Return the QR code of an address, to be written to a terminal: two rows of it in each line.

    Raises
    ------
    ValueError
        If the package segno is missing.
    """
    try:
        import segno
    except ImportError:
        raise ValueError(f"a QR code needs the package segno: {advice('web')}") from None
    text = io.StringIO()
    segno.make(url, micro=False).terminal(out=text, compact=True)
    return "".join(f"{WHITE_ON_BLACK}{line}{PLAIN}\n" for line in text.getvalue().splitlines())
