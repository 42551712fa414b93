"""The transmitter of `fakes.py` at the other end of a pseudo-terminal, in real time, for other processes."""

import contextlib
import os
import pty
import select
import threading
import time
import tty
from typing import NamedTuple, Self

from fakes import FakePort

from matchset.links.link import State

LOOK = 0.002  # s between two looks at the transmitter


class Moment(NamedTuple):
    """What the transmitter did at a time, s on the monotonic clock; throttle 0 ... 255."""

    time: float
    state: State
    throttle: int


class Packet(NamedTuple):
    """A good packet of stick values, and what the transmitter did after it; s on the monotonic clock."""

    time: float
    state: State
    throttle: int


class RealClock:
    """The time since it was made, s; at a pace below 1 it runs slower than the real one."""

    def __init__(self, pace: float = 1.0) -> None:
        self._begin, self._pace = time.monotonic(), pace

    def __call__(self) -> float:
        return self._pace * (time.monotonic() - self._begin)

    def sleep(self, seconds: float) -> None:
        time.sleep(seconds)


class PtyTransmitter:
    """A transmitter that any process can open.

    Parameters
    ----------
    pace : float
        Of its clock. Less than 1 makes its failsafe more patient than the real one, for tests of something else on a
        busy computer.

    Attributes
    ----------
    path : str
        What to open.
    port : FakePort
    moments : list of Moment
        Whenever state or throttle changed.
    packets : list of Packet
        Of those that came together, only the last is of its own time.
    babble : bool
        Whether it says nothing but noise.
    """

    def __init__(self, pace: float = 1.0) -> None:
        self._end, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.path = os.ttyname(self._slave)
        os.set_blocking(self._end, False)
        self.port = FakePort(clock=RealClock(pace))  # type: ignore[arg-type]
        self.moments: list[Moment] = []
        self.packets: list[Packet] = []
        self.babble, self._gone = False, False
        self._stop, self._thread = threading.Event(), threading.Thread(target=self._run, daemon=True)

    def unplug(self) -> None:
        """Take the port away."""
        self._stop.set()
        self._thread.join()
        self._gone = True
        os.close(self._slave)
        os.close(self._end)

    def wait_for(self, throttle: int, timeout: float = 60.0) -> Moment:
        """Wait until the throttle is at least so high."""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            if self.moments and self.moments[-1].throttle >= throttle:
                return self.moments[-1]
            time.sleep(LOOK)
        raise AssertionError(f"no throttle of {throttle} within {timeout} s: {self.moments[-5:]}")

    def since(self, begin: float) -> list[Moment]:
        """What it did from a time on, the state at that time first."""
        before = [each for each in self.moments if each.time <= begin]
        return before[-1:] + [each for each in self.moments if each.time > begin]

    def packets_since(self, begin: float) -> list[Packet]:
        """What came after a time."""
        return [each for each in self.packets if each.time > begin]

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        if not self._gone:
            self.unplug()

    def _run(self) -> None:
        while not self._stop.is_set():
            if select.select([self._end], [], [], LOOK)[0]:
                self.port.write(os.read(self._end, 4096))
            said = self.port.read()
            said = bytes(reversed(said)) if self.babble else said
            if said:
                with contextlib.suppress(BlockingIOError):  # nobody reads: what is not heard is lost, as on a wire
                    os.write(self._end, said)
            throttle = self.port.throttle
            new = len(self.port.heard) - len(self.packets)
            self.packets += [Packet(time.monotonic(), self.port.state, throttle)] * new
            last = self.moments[-1] if self.moments else None
            if last is None or (last.state, last.throttle) != (self.port.state, throttle):
                self.moments.append(Moment(time.monotonic(), self.port.state, throttle))
