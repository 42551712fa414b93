"""The host's own code against the emulated board: directly, through a pseudo-terminal, and beside the fake port."""

import os
import time
from collections.abc import Callable

import pytest
from cable import Cable, CountingPort, Paced, hangs_up_on_close
from emulator import Board
from fakes import FakePort

from flight import BOUND
from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.arduino.messages import Config, StatusReport
from matchset.links.arduino.protocol import ArduinoParameters

LOCK_STEP_SECONDS = float(os.environ.get("MATCHSET_CABLE_SECONDS", "5"))  # 60: make bench-radio
REAL_SECONDS = float(os.environ.get("MATCHSET_REAL_SECONDS", "1"))  # 60: make bench-radio
UNHURRIED = ArduinoParameters(timeout=30.0, arm_timeout=30.0, startup_timeout=30.0)  # a busy machine is no broken link
FLIGHT = Command(throttle=0.4, roll=0.1, pitch=-0.2, yaw=0.3)


class DirectPort:
    """The emulated board without a cable."""

    def __init__(self, board: Board) -> None:
        self.board = board

    def write(self, data: bytes) -> None:
        self.board.write(data)

    def read(self) -> bytes:
        return self.board.read()

    def close(self) -> None:
        pass


def facts(report: StatusReport) -> dict[str, object]:
    """What must not depend on who plays the firmware."""
    names = ("version", "state", "may_arm", "default_config", "good", "bad", "echo", "heard")
    return {name: getattr(report, name) for name in names}


def journey(link: ArduinoLink, sleep: Callable[[float], None]) -> list[object]:
    """A session with everything in it; returns what the link reported on the way."""
    seen: list[object] = []

    def fly(command: Command, frames: int) -> None:
        for _ in range(frames):
            seen.append(link.send(command))
            sleep(0.0333)
        seen.append(facts(link.report))

    fly(FLIGHT, 5)
    link.arm()
    fly(FLIGHT, 10)
    sleep(0.15)
    seen.append(facts(link.report))  # holding
    fly(FLIGHT, 5)
    link.bind()  # refused
    fly(FLIGHT, 3)
    sleep(0.3)
    seen.append(facts(link.report))  # failsafe
    fly(FLIGHT, 5)
    link.arm()
    fly(Command(throttle=1.0, yaw=-1.0), 5)
    seen.append(link.write_config(Config(tail=3)))  # refused
    link.land(0)
    seen.append(facts(link.report))
    seen.append(link.write_config(Config(tail=3)))
    seen.append(link.read_config())
    link.bind()
    sleep(0.5)
    seen.append(facts(link.report))
    sleep(1.5)
    fly(FLIGHT, 2)
    return seen


def test_the_fake_port_behaves_as_the_firmware_does() -> None:
    with Board() as board:
        board.run(BOUND)

        def sleep(seconds: float) -> None:
            board.run(seconds)

        link = ArduinoLink("serial:///emulated", DirectPort(board), clock=lambda: board.time, sleep=sleep)
        real = journey(link, sleep)
    fake = FakePort()
    fake.clock.sleep(BOUND)
    link = ArduinoLink("serial:///fake", fake, clock=fake.clock, sleep=fake.clock.sleep)
    assert journey(link, fake.clock.sleep) == real


def test_no_frame_is_lost_through_a_pseudo_terminal_at_30_hz() -> None:
    with Board() as board:
        board.run(BOUND)
        cable = Cable(board)
        port = CountingPort(cable.path)
        link = ArduinoLink(cable.path, port, clock=lambda: board.time, sleep=lambda s: cable.step(port, s))
        with link:
            link.arm()
            before, frames = link.report.good, round(30 * LOCK_STEP_SECONDS)
            sent = link.firmware.sent
            trips = []
            for _ in range(frames):
                link.send(FLIGHT)
                for _ in range(5):
                    cable.step(port, 1 / 150)
                    link.status()
                trips.append(link.firmware.round_trip)
            report = link.report
            assert report.good - before & 0xFFFF == frames == link.firmware.sent - sent
            assert link.firmware.answered == link.firmware.sent
            assert (report.bad, report.lost_bytes, report.state) == (0, 0, "armed")
            assert None not in trips
        cable.pull()
        assert board.radio.refusals == []


def test_no_frame_is_lost_in_real_time() -> None:
    with Board() as board:
        board.run(BOUND)
        cable = Cable(board)
        with Paced(cable), ArduinoLink(cable.path, parameters=UNHURRIED) as link:
            frames = round(30 * REAL_SECONDS)
            begin = time.monotonic()
            trips = []
            for number in range(frames):
                link.send(FLIGHT)
                while time.monotonic() < begin + (number + 1) / 30:
                    time.sleep(0.001)
                    link.status()
                trips.append(1e3 * (link.firmware.round_trip or 0.0))
            while link.firmware.answered < link.firmware.sent and time.monotonic() < begin + REAL_SECONDS + 30:
                time.sleep(0.01)
                link.status()
            trips.sort()
            print(f"{link.firmware.answered} of {link.firmware.sent} answered; round trip, ms:")
            print(f"median {trips[frames // 2]:.1f}, 99 % {trips[frames * 99 // 100]:.1f}, worst {trips[-1]:.1f}")
            assert link.firmware.answered == link.firmware.sent >= frames
            assert link.report.bad == link.report.lost_bytes == 0
        cable.pull()


def test_a_pulled_cable_is_noticed_and_stops_the_motors() -> None:
    with Board() as board:
        board.run(BOUND)
        cable = Cable(board)
        port = CountingPort(cable.path)
        link = ArduinoLink(cable.path, port, clock=lambda: board.time, sleep=lambda s: cable.step(port, s))
        link.arm()
        for _ in range(10):
            link.send(FLIGHT)
            cable.step(port, 1 / 30)
        assert board.packets[-1].payload[0] > 0
        cable.pull()
        with pytest.raises(LinkError, match="unplugged"):
            link.send(FLIGHT)
        link.close()
        packets = board.run(0.25)
        assert packets[-1].payload[0] == 0


def test_closing_the_port_leaves_dtr_alone() -> None:
    with Board() as board:
        cable = Cable(board)
        port = CountingPort(cable.path)
        assert not hangs_up_on_close(cable._slave)
        with pytest.raises(LinkError, match="cannot open"):  # in use: two programs must not fly one drone
            CountingPort(cable.path)
        port.close()
        cable.pull()
