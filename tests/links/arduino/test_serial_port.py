"""The real port on a pseudo-terminal: a write never waits, and only a port that takes no more is broken."""

import os
import pty
import time
import tty
from collections.abc import Iterator
from typing import NamedTuple

import pytest

from matchset.links.serial_port import SerialPort

FRAME = bytes(26)


class Wire(NamedTuple):
    """A port, and the descriptor of its other end."""

    port: SerialPort
    end: int


@pytest.fixture
def wire() -> Iterator[Wire]:
    end, slave = pty.openpty()
    tty.setraw(slave)
    port = SerialPort(os.ttyname(slave))
    yield Wire(port, end)
    port.close()
    os.close(slave)
    os.close(end)


def test_a_busy_computer_is_no_broken_port(wire: Wire, monkeypatch: pytest.MonkeyPatch) -> None:
    def late(*_: object) -> tuple[list[int], list[int], list[int]]:
        return [], [], []  # what select says when the time has passed

    monkeypatch.setattr("select.select", late)
    wire.port.write(FRAME)
    assert os.read(wire.end, 100) == FRAME


def test_a_port_that_takes_no_more_is_broken_at_once(wire: Wire) -> None:
    def fill() -> None:
        for _ in range(100_000):
            wire.port.write(FRAME)

    begin = time.thread_time()
    with pytest.raises(OSError, match="of 26 bytes"):
        fill()
    assert time.thread_time() - begin < 5.0
