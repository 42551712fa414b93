"""The space key and SIGUSR1 stop the motors within a packet: real processes, a terminal, a transmitter."""

import fcntl
import hashlib
import os
import pty
import signal
import subprocess
import sys
import termios
import threading
import time
from collections.abc import Iterator
from typing import IO

import pytest
from pty_transmitter import PtyTransmitter

from matchset.app.kill_switch import KillSwitch
from matchset.control.command import Command
from matchset.links.arduino.arduino_link import ArduinoLink

PACKET = 0.033  # s between two commands
MOTORS = 20  # of 255: the test's motors turn
FLY = ("fly", "sim://chain?vehicles=2&seed=5", "--real-time", "--duration", "60")


@pytest.fixture(autouse=True)
def _signals_end_programs() -> Iterator[None]:
    """Start programs as a shell does, although these tests may themselves run where SIGHUP or SIGINT is ignored."""
    hangup, interrupt = signal.signal(signal.SIGHUP, signal.SIG_DFL), signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGHUP, hangup)
    signal.signal(signal.SIGINT, interrupt)


class Terminal:
    """A terminal whose foreground a program has, and what the terminal was like before."""

    def __init__(self) -> None:
        self.keys, self.slave = pty.openpty()
        self.before = termios.tcgetattr(self.slave)

    def start(self, *words: str) -> "subprocess.Popen[str]":
        def take() -> None:
            os.setsid()
            fcntl.ioctl(self.slave, termios.TIOCSCTTY, 0)

        return subprocess.Popen(
            [sys.executable, "-m", "matchset.app.cli", *words],
            stdin=self.slave,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=take,
        )

    def press(self, key: bytes) -> None:
        os.write(self.keys, key)

    @property
    def is_as_before(self) -> bool:
        return termios.tcgetattr(self.slave) == self.before


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    opened = Terminal()
    yield opened
    os.close(opened.keys)
    os.close(opened.slave)


@pytest.fixture
def transmitter() -> Iterator[PtyTransmitter]:
    with PtyTransmitter() as opened:
        yield opened


def ended(process: "subprocess.Popen[str]") -> tuple[int, str, str]:
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err


def stopped_after(transmitter: PtyTransmitter, begin: float) -> float:
    """How long after a time the motors stopped, s; not by the failsafe."""
    zero = next(each for each in transmitter.since(begin) if each.throttle == 0)
    assert zero.state == "locked"
    return zero.time - begin


def wait_for_line(stream: IO[str] | None, words: str) -> None:
    assert stream is not None
    while words not in (line := stream.readline()):
        assert line, f"the program ended before it said {words!r}"


def test_the_space_key_stops_the_motor_test_within_a_packet(terminal: Terminal, transmitter: PtyTransmitter) -> None:
    process = terminal.start("radio", "test-sticks", transmitter.path, "--arm", "--countdown", "3")
    transmitter.wait_for(MOTORS)
    assert not terminal.is_as_before
    terminal.press(b"xyz\n")
    time.sleep(0.1)
    assert transmitter.port.throttle >= MOTORS
    begin = time.monotonic()
    terminal.press(b" ")
    code, out, err = ended(process)
    assert stopped_after(transmitter, begin) <= PACKET
    assert (code, err) == (1, "error: the motors are off: the space key was pressed\n")
    assert "The space key and Ctrl-C stop the motors" in out
    assert terminal.is_as_before


def test_the_signal_stops_the_motor_test_within_a_packet_without_a_terminal(transmitter: PtyTransmitter) -> None:
    words = ("radio", "test-sticks", transmitter.path, "--arm", "--countdown", "3")
    process = subprocess.Popen(
        [sys.executable, "-m", "matchset.app.cli", *words],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    transmitter.wait_for(MOTORS)
    assert process.stdin is not None
    process.stdin.write("   ")  # no terminal: these are no keys
    process.stdin.flush()
    time.sleep(0.1)
    assert transmitter.port.throttle >= MOTORS
    begin = time.monotonic()
    process.send_signal(signal.SIGUSR1)
    code, out, err = ended(process)
    assert stopped_after(transmitter, begin) <= PACKET
    assert (code, err) == (1, "error: the motors are off: SIGUSR1 came\n")
    assert "space" not in out


@pytest.mark.parametrize("key", [True, False])
def test_a_flight_is_cut(terminal: Terminal, key: bool) -> None:
    process = terminal.start(*FLY)
    wait_for_line(process.stderr, "space stops all motors at once")
    time.sleep(0.5)
    if key:
        terminal.press(b" ")
    else:
        process.send_signal(signal.SIGUSR1)
    code, out, _ = ended(process)
    assert code == 1
    assert f"vehicle 1 was cut: {'the space key was pressed' if key else 'SIGUSR1 came'}" in out
    assert terminal.is_as_before


def test_a_stopped_flight_restores_the_terminal(terminal: Terminal) -> None:
    process = terminal.start(*FLY)
    wait_for_line(process.stderr, "space stops all motors at once")
    process.send_signal(signal.SIGHUP)
    assert ended(process)[0] == 128 + signal.SIGHUP
    assert terminal.is_as_before


def cut_in_a_long_call(transmitter: PtyTransmitter) -> float:
    """How long after a signal, which comes in a long call of the main thread, the motors stop, s."""
    came: list[float] = []

    def send() -> None:
        came.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGUSR1)

    with ArduinoLink(transmitter.path) as link, KillSwitch(lambda _: link.cut(), terminal=-1) as kill:
        link.arm()
        while transmitter.port.throttle < 100:
            link.send(Command(throttle=0.6))
            time.sleep(PACKET)
        timer = threading.Timer(0.02, send)
        timer.start()
        hashlib.pbkdf2_hmac("sha256", b"", b"", 900_000)  # Python's handlers run only after it
        timer.join()
        assert time.monotonic() - came[0] > PACKET
        assert (kill.reason, kill.reads_keys) == ("SIGUSR1 came", False)
        return stopped_after(transmitter, came[0])


def test_the_signal_cuts_while_the_main_thread_is_in_a_long_call(transmitter: PtyTransmitter) -> None:
    """The least of three: a computer that is busy for longer than a packet is not the kill switch's delay."""
    before = signal.getsignal(signal.SIGUSR1)
    assert min(cut_in_a_long_call(transmitter) for _ in range(3)) <= PACKET
    assert signal.getsignal(signal.SIGUSR1) is before
    assert signal.set_wakeup_fd(-1) == -1


def test_it_may_be_closed_twice_and_used_in_another_thread() -> None:
    reasons: list[str] = []

    def use() -> None:
        with KillSwitch(reasons.append, terminal=-1) as kill:
            kill.close()

    thread = threading.Thread(target=use)
    thread.start()
    thread.join()
    use()
    assert reasons == []
