"""A pseudo-terminal between the host's serial port and the emulated board, with time either told or real."""

import os
import pty
import select
import termios
import threading
import time
import tty

from emulator import HZ, Board

from matchset.links.serial_port import SerialPort

SLICE = HZ // 500  # cycles
TRANSFER_TIMEOUT = 10.0  # s of real time that the kernel may take to move some bytes


class CountingPort(SerialPort):
    """The host's port; counts what it was given, so that the other end knows what must arrive."""

    def __init__(self, path: str) -> None:
        self.written = 0
        super().__init__(path)

    def write(self, data: bytes) -> None:
        super().write(data)
        self.written += len(data)

    @property
    def waiting(self) -> int:
        """Bytes that have arrived and were not read."""
        return int(self._serial.in_waiting)


class Cable:
    """The pseudo-terminal; `path` is what the host opens."""

    def __init__(self, board: Board) -> None:
        self.board = board
        self._end, slave = pty.openpty()
        tty.setraw(slave)
        self.path = os.ttyname(slave)
        os.set_blocking(self._end, False)
        self._slave = slave  # stays open, or the other end would hang up before the host opens it
        self._taken = 0

    def pull(self) -> None:
        """Unplug it."""
        os.close(self._slave)
        os.close(self._end)

    def to_board(self, at_least: int = 0) -> None:
        """Hand on what the host has sent; waits until that many bytes in all have come."""
        while True:
            try:
                data = os.read(self._end, 4096)
                self._taken += len(data)
                self.board.write(data)
            except BlockingIOError:
                if self._taken >= at_least:
                    return
                assert select.select([self._end], [], [], TRANSFER_TIMEOUT)[0], "the kernel lost bytes"

    def to_host(self, port: CountingPort | None = None) -> None:
        """Hand on what the board has said; with a port, waits until it is there."""
        data = self.board.read()
        if not data:
            return
        expected = len(data) + (port.waiting if port else 0)
        os.write(self._end, data)
        deadline = time.monotonic() + TRANSFER_TIMEOUT
        while port and port.waiting < expected and time.monotonic() < deadline:
            time.sleep(0)

    def step(self, port: CountingPort, seconds: float) -> None:
        """Let the board's time pass, bytes moving every 2 ms of it: lock-step, whatever the real time."""
        end = self.board.cycle + round(seconds * HZ)
        while self.board.cycle < end:
            self.to_board(port.written)
            self.board.run_to(min(self.board.cycle + SLICE, end))
            self.to_host(port)


class Paced:
    """Runs the board in a thread at the pace of the real time, or at a share of it."""

    def __init__(self, cable: Cable, pace: float = 1.0) -> None:
        self._pace = pace
        self._cable, self._stop = cable, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Paced":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        board, begin = self._cable.board, self._pace * time.monotonic() - self._cable.board.time
        while not self._stop.is_set():
            self._cable.to_board()
            behind = self._pace * time.monotonic() - begin - board.time
            if behind < 0.001:
                self._stop.wait(0.001)
                continue
            board.run(min(behind, 0.005))
            self._cable.to_host()


def hangs_up_on_close(descriptor: int) -> bool:
    """Whether the kernel would drop DTR when the port is closed."""
    return bool(termios.tcgetattr(descriptor)[2] & termios.HUPCL)
