"""What tests of real processes share: a transmitter behind a pseudo-terminal, and signals as a shell leaves them."""

import signal
from collections.abc import Iterator

import pytest
from pty_transmitter import PtyTransmitter


@pytest.fixture
def transmitter() -> Iterator[PtyTransmitter]:
    with PtyTransmitter() as opened:
        yield opened


@pytest.fixture
def signals_end_programs() -> Iterator[None]:
    """Start programs as a shell does, although the tests may themselves run where SIGHUP or SIGINT is ignored."""
    hangup, interrupt = signal.signal(signal.SIGHUP, signal.SIG_DFL), signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGHUP, hangup)
    signal.signal(signal.SIGINT, interrupt)
