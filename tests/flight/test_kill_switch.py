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
from pty_transmitter import Packet, PtyTransmitter

from matchset.control.command import Command
from matchset.flight.kill_switch import KillSwitch
from matchset.links.arduino.arduino_link import ArduinoLink

pytestmark = pytest.mark.usefixtures("signals_end_programs")

PACKET = 0.033  # s between two commands
ON_THE_WAY = 2  # packets that may have been sent before the switch acts
MOTORS = 20  # of 255: the test's motors turn
PROGRAM = """
import functools
from matchset import cli
from matchset.flight.radio import stick_test
stick_test.MotorTestParameters = functools.partial(stick_test.MotorTestParameters, min_countdown=1)
cli.main()
"""  # `matchset`, whose motor test may count down from 1
MOTOR_TEST = (sys.executable, "-c", PROGRAM, "radio", "test-sticks")
FLY = (
    sys.executable,
    "-m",
    "matchset.cli",
    "fly",
    "sim://chain?vehicles=2&seed=5&width=320&height=240",
    "--real-time",
    "--duration",
    "60",
)


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
            words,
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


def ended(process: "subprocess.Popen[str]") -> tuple[int, str, str]:
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err


def stopped(transmitter: PtyTransmitter, begin: float) -> Packet:
    """Return the packet that stopped the motors: not the failsafe, and after no more packets than were on their way."""
    since = transmitter.packets_since(begin)
    count = next(k for k, packet in enumerate(since) if packet.throttle == 0)
    assert count <= ON_THE_WAY
    assert since[count].state == "locked"
    return since[count]


def still_turns(transmitter: PtyTransmitter) -> None:
    """See that the next packets turn the motors."""
    begin, end = time.monotonic(), time.monotonic() + 60.0
    while len(since := transmitter.packets_since(begin)) <= ON_THE_WAY:
        assert time.monotonic() < end
        time.sleep(0.001)
    assert min(packet.throttle for packet in since) >= MOTORS


def wait_for_line(stream: IO[str] | None, words: str) -> None:
    assert stream is not None
    while words not in (line := stream.readline()):
        assert line, f"the program ended before it said {words!r}"


def test_the_space_key_stops_the_motor_test_within_a_packet(terminal: Terminal, transmitter: PtyTransmitter) -> None:
    process = terminal.start(*MOTOR_TEST, transmitter.path, "--arm", "--countdown", "1")
    transmitter.wait_for(MOTORS)
    assert not terminal.is_as_before
    terminal.press(b"xyz\n")
    still_turns(transmitter)
    begin = time.monotonic()
    terminal.press(b" ")
    code, out, err = ended(process)
    stopped(transmitter, begin)
    assert (code, err) == (1, "error: the motors are off: the space key was pressed\n")
    assert "The space key and Ctrl-C stop the motors" in out
    assert terminal.is_as_before


def test_the_signal_stops_the_motor_test_within_a_packet_without_a_terminal(transmitter: PtyTransmitter) -> None:
    process = subprocess.Popen(
        [*MOTOR_TEST, transmitter.path, "--arm", "--countdown", "1"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    transmitter.wait_for(MOTORS)
    assert process.stdin is not None
    process.stdin.write("   ")  # no terminal: these are no keys
    process.stdin.flush()
    still_turns(transmitter)
    begin = time.monotonic()
    process.send_signal(signal.SIGUSR1)
    code, out, err = ended(process)
    stopped(transmitter, begin)
    assert (code, err) == (1, "error: the motors are off: SIGUSR1 came\n")
    assert "space" not in out


def test_a_flight_is_cut_by_the_space_key(terminal: Terminal) -> None:
    process = terminal.start(*FLY)
    wait_for_line(process.stderr, "space stops all motors at once")
    terminal.press(b" ")
    code, out, _ = ended(process)
    assert code == 1
    assert "vehicle 1 was cut: the space key was pressed" in out
    assert terminal.is_as_before


def test_a_stopped_flight_restores_the_terminal(terminal: Terminal) -> None:
    process = terminal.start(*FLY)
    wait_for_line(process.stderr, "space stops all motors at once")
    process.send_signal(signal.SIGHUP)
    assert ended(process)[0] == 128 + signal.SIGHUP
    assert terminal.is_as_before


def test_the_signal_cuts_while_the_main_thread_is_in_a_long_call(transmitter: PtyTransmitter) -> None:
    before, came = signal.getsignal(signal.SIGUSR1), list[float]()

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
        returned = time.monotonic()
        timer.join()
        assert stopped(transmitter, came[0]).time < returned
        assert (kill.reason, kill.reads_keys) == ("SIGUSR1 came", False)
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
