"""A signal to a program that flies lands: real signals, real processes, a transmitter behind a pseudo-terminal."""

import contextlib
import functools
import itertools
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

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
NUMBERS = (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)
PATIENT = 0.25  # pace of a transmitter's clock: its failsafe is not what is looked at, and this computer may be busy
LONG = 60.0  # s: whatever has not happened by then does not happen


class Landing(NamedTuple):
    """What a transmitter did from the first signal to its program on, and the program's exit code."""

    moments: list[Moment]
    code: int


@contextlib.contextmanager
def started(*words: str) -> Iterator[subprocess.Popen[str]]:
    """A program; if it does not end by itself it is killed."""
    with subprocess.Popen(
        [sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def reach(level: int, port: PtyTransmitter, process: subprocess.Popen[str]) -> None:
    """Wait until the throttle is so high; a program that has ended before says why."""
    wait_until(lambda: process.poll() is not None or (port.moments and port.moments[-1].throttle >= level))
    assert process.poll() is None, process.communicate()


def words_of(before: str) -> tuple[str, ...]:
    return ("-c", PROGRAM.format(before=before))


MOTORS = """
import functools
import sys
from matchset import cli
from matchset.flight.radio import stick_test

stick_test.MotorTestParameters = functools.partial(stick_test.MotorTestParameters, min_countdown=1)
sys.argv[1:] = ["radio", "test-sticks", "--arm", "--countdown", "1", sys.argv[1]]
cli.main()
"""
PROGRAMS: dict[str, tuple[tuple[str, ...], int, tuple[int, ...]]] = {
    **{
        f"own {number.name}": (
            words_of("import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"),
            HOVER,
            (number,),
        )
        for number in NUMBERS
    },
    "two signals": (words_of(""), HOVER, (signal.SIGTERM, signal.SIGHUP)),
    "nohup": (
        words_of("import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)"),
        HOVER,
        (signal.SIGHUP, signal.SIGTERM),
    ),
    **{f"motors {number.name}": (("-c", MOTORS), 20, (number,)) for number in NUMBERS[:2]},
}
"""Of each: how it is started, how high its throttle is when it gets its first signal, and its signals."""


def wait_until(done: Callable[[], object]) -> None:
    end = time.monotonic() + LONG
    while not done():
        assert time.monotonic() < end
        time.sleep(0.002)


@functools.cache
def landings() -> dict[str, Landing]:
    """Fly all programs at once and send each its signals: a landing takes its time, the computer has nothing to do."""
    with contextlib.ExitStack() as opened:
        ports = {name: opened.enter_context(PtyTransmitter(PATIENT)) for name in PROGRAMS}
        running = {
            name: opened.enter_context(started(*words, ports[name].path)) for name, (words, *_) in PROGRAMS.items()
        }
        begins = dict[str, float]()
        for name, (_, level, numbers) in PROGRAMS.items():
            reach(level, ports[name], running[name])
            begins[name] = time.monotonic()
            running[name].send_signal(numbers[0])
            if len(numbers) > 1:
                wait_for_the_second(name, ports[name], running[name])
                running[name].send_signal(numbers[1])
        codes = {name: each.wait(timeout=LONG) for name, each in running.items()}
        for name, each in running.items():
            each.communicate()
            wait_until(lambda port=ports[name]: port.moments[-1].throttle == 0)  # type: ignore[misc]
        return {name: Landing(ports[name].since(begins[name]), codes[name]) for name in PROGRAMS}


def wait_for_the_second(name: str, port: PtyTransmitter, process: subprocess.Popen[str]) -> None:
    """Wait until the first signal's landing has begun, or until it was ignored for a while."""
    if name == "two signals":
        wait_until(lambda: port.moments[-1].throttle < HOVER)
        assert port.moments[-1].throttle > 0
        return
    heard = len(port.packets)
    wait_until(lambda: len(port.packets) > heard + 10)
    assert process.poll() is None
    assert port.moments[-1].throttle >= HOVER


def ramps_down(moments: list[Moment]) -> None:
    """The throttle came down little by little, without the failsafe, and the transmitter is disarmed."""
    falling = [each.throttle for each in moments if each.state == "armed"]
    assert len(falling) > 15, moments
    assert falling == sorted(falling, reverse=True)
    assert max(a - b for a, b in itertools.pairwise(falling)) < HOVER / 3
    assert "failsafe" not in {each.state for each in moments[:-1]}
    assert moments[-1].throttle == 0


@pytest.mark.parametrize(("number", "code"), [*zip(NUMBERS, (143, 129, -2), strict=True)])
def test_a_program_of_ones_own_lands(number: signal.Signals, code: int) -> None:
    landing = landings()[f"own {number.name}"]
    ramps_down(landing.moments)
    assert landing.code == code


def test_a_second_signal_does_not_break_off_the_landing() -> None:
    landing = landings()["two signals"]
    ramps_down(landing.moments)
    assert landing.code in (129, 143)


def test_an_ignored_signal_stays_ignored_as_under_nohup() -> None:
    landing = landings()["nohup"]
    ramps_down(landing.moments)
    assert landing.code == 143


@pytest.mark.parametrize(("number", "code"), [*zip(NUMBERS[:2], (143, 129), strict=True)])
def test_the_motor_test_stops_the_motors_at_once(number: signal.Signals, code: int) -> None:
    landing = landings()[f"motors {number.name}"]
    zero = next(each for each in landing.moments if each.throttle == 0)
    assert zero.state == "locked"  # disarmed, not the failsafe
    assert len({each.throttle for each in landing.moments}) == 2, "no ramp"
    assert landing.code == code


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
