"""A signal to a program that flies lands: real signals, real processes, a transmitter behind a pseudo-terminal."""

import itertools
import signal
import subprocess
import sys
import threading
import time

import pytest
from pty_transmitter import Moment, PtyTransmitter

from matchset.control.command import Command
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.link import Link, LinkStatus

pytestmark = pytest.mark.usefixtures("signals_end_programs")

PROGRAM = """
import sys
import time
{before}
from matchset.control.command import Command
from matchset.links.connect import connect

with connect("serial://" + sys.argv[1]) as link:
    link.arm()
    while True:
        link.send(Command(throttle=0.6))
        time.sleep(1 / 30)
"""
HOVER = 150  # of 255
LANDING = 1.5  # s


def start(*words: str) -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def land_after(
    transmitter: PtyTransmitter, process: subprocess.Popen[str], *numbers: int, pause: float = 0.3
) -> tuple[list[Moment], float, int]:
    """Send signals to a program that hovers; returns what the transmitter did from then on, when, and the exit code."""
    transmitter.wait_for(HOVER)
    time.sleep(0.2)
    begin = time.monotonic()
    for number in numbers:
        process.send_signal(number)
        time.sleep(pause if len(numbers) > 1 else 0.0)
    code = process.wait(timeout=30)
    process.communicate()
    time.sleep(0.3)
    return transmitter.since(begin), begin, code


def ramps_down(moments: list[Moment], begin: float) -> None:
    """The throttle came down over the time of a landing, without the failsafe, and the transmitter is disarmed."""
    falling = [each.throttle for each in moments if each.state == "armed"]
    assert len(falling) > 15, moments
    assert falling == sorted(falling, reverse=True)
    assert max(a - b for a, b in itertools.pairwise(falling)) < HOVER / 3
    assert "failsafe" not in {each.state for each in moments[:-1]}
    zero = next(each.time for each in moments if each.throttle == 0)
    assert LANDING - 0.3 < zero - begin < LANDING + 1.0
    assert moments[-1].throttle == 0


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGINT, -2)])
def test_a_program_of_ones_own_lands(transmitter: PtyTransmitter, number: signal.Signals, code: int) -> None:
    begin_of_python = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    process = start("-c", PROGRAM.format(before=begin_of_python), transmitter.path)
    moments, begin, ended = land_after(transmitter, process, number)
    ramps_down(moments, begin)
    assert ended == code


def test_a_second_signal_does_not_break_off_the_landing(transmitter: PtyTransmitter) -> None:
    process = start("-c", PROGRAM.format(before=""), transmitter.path)
    moments, begin, ended = land_after(transmitter, process, signal.SIGTERM, signal.SIGHUP)
    ramps_down(moments, begin)
    assert ended in (129, 143)


def test_an_ignored_signal_stays_ignored_as_under_nohup(transmitter: PtyTransmitter) -> None:
    ignored = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)"
    process = start("-c", PROGRAM.format(before=ignored), transmitter.path)
    transmitter.wait_for(HOVER)
    process.send_signal(signal.SIGHUP)
    time.sleep(0.4)
    assert process.poll() is None
    assert transmitter.port.throttle >= HOVER
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=30) == 143
    process.communicate()


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_the_motor_test_stops_the_motors_at_once(
    transmitter: PtyTransmitter, number: signal.Signals, code: int
) -> None:
    words = ("-m", "matchset.app.cli", "radio", "test-sticks", transmitter.path, "--arm", "--countdown", "3")
    process = start(*words)
    transmitter.wait_for(20)
    time.sleep(0.1)
    begin = time.monotonic()
    process.send_signal(number)
    assert process.wait(timeout=30) == code
    process.communicate()
    zero = next(each for each in transmitter.since(begin) if each.throttle == 0)
    assert zero.state == "locked"  # disarmed, not the failsafe
    assert zero.time - begin < 0.2


class Counting(Link):
    """A link that counts its landings, and is sent signals while it lands."""

    def __init__(self, number: int = 0) -> None:
        self.uri, self.closed, self._number = "counting://", 0, number

    def arm(self) -> None: ...

    def send(self, command: Command) -> Command:
        return command

    def status(self) -> LinkStatus:
        return LinkStatus("armed", "", 0, 0.0)

    def land(self, duration: float = 1.5) -> None: ...

    def cut(self) -> None: ...

    def close(self) -> None:
        if self._number:
            signal.raise_signal(self._number)
        self.closed += 1


def handlers() -> list[object]:
    return [signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)]


def test_the_handlers_of_before_come_back_also_after_nested_blocks() -> None:
    before = handlers()
    with Counting(), Counting():
        assert signal.getsignal(signal.SIGTERM) is not before[0]
    assert handlers() == before
    with pytest.raises(RuntimeError), Counting():
        raise RuntimeError
    assert handlers() == before


def test_every_block_lands_when_a_signal_comes() -> None:
    links = Counting(), Counting()
    with pytest.raises(SystemExit, match="143"), links[0], links[1]:
        signal.raise_signal(signal.SIGTERM)
    assert [link.closed for link in links] == [1, 1]


@pytest.mark.parametrize(
    ("number", "error"), [(signal.SIGTERM, SystemExit), (signal.SIGHUP, SystemExit), (signal.SIGINT, KeyboardInterrupt)]
)
def test_a_signal_while_it_lands_waits_until_that_is_done(number: int, error: type[BaseException]) -> None:
    link, before = Counting(number), handlers()
    with pytest.raises(error), link:
        pass
    assert link.closed == 1
    assert handlers() == before


def test_a_handler_of_the_program_stays() -> None:
    came: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, _frame: came.append(number))
    try:
        with Counting():
            signal.raise_signal(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert came == [signal.SIGTERM]


def test_a_block_in_another_thread_changes_nothing() -> None:
    seen: list[object] = []

    def fly() -> None:
        with Counting():
            seen.append(handlers())

    before = handlers()
    thread = threading.Thread(target=fly)
    thread.start()
    thread.join()
    assert seen == [before]


def test_an_arduino_link_is_such_a_block(transmitter: PtyTransmitter) -> None:
    link = ArduinoLink(transmitter.path)
    link.arm()
    with pytest.raises(SystemExit, match="129"), link:
        signal.raise_signal(signal.SIGHUP)
    assert transmitter.port.state == "locked"
