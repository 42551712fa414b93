"""The fake autopilot of tests/links/mavlink behind a real UDP socket, in real time."""

import socket
import threading
import time
from types import TracebackType
from typing import Any, Self

from fake_autopilot import FakeAutopilot
from fakes import Clock


class RealClock(Clock):
    """The time of this computer."""

    def __call__(self) -> float:
        return time.monotonic()


class ServedAutopilot:
    """Speaks to whoever speaks to its port.

    Attributes
    ----------
    pilot : FakeAutopilot
    uri : str
        Of a link to it.
    """

    def __init__(self) -> None:
        self.pilot = FakeAutopilot(RealClock())
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.01)
        self.uri = f"mavlink:udpout:127.0.0.1:{self._socket.getsockname()[1]}"
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def has_flown(self, throttle: int) -> bool:
        """Whether a throttle, of 1000, has come."""
        return any(z >= throttle for _, _, z, _ in list(self.pilot.sticks))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._done.set()
        self._thread.join()
        self._socket.close()

    def _serve(self) -> None:
        sender: Any = None
        while not self._done.is_set():
            try:
                data, sender = self._socket.recvfrom(2000)
                self.pilot.write(data)
            except OSError:  # nothing came, or nobody listens
                pass
            for _, data in self.pilot.read() if sender is not None else []:
                self._socket.sendto(data, sender)
