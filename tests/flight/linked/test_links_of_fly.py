"""Links other than the Arduino's under `matchset fly`, and an Arduino's faults: flights by vehicles in numbers."""

from collections.abc import Callable, Iterator

import pytest
from fake_autopilot import RTL, STABILIZE, FakeAutopilot
from fake_tello import FakeTello
from fakes import Clock, FakePort

from linked_world import WORLD, WorldClock, believing, made
from matchset.control.command import Command
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked import opening
from matchset.flight.linked.briefing import assumed
from matchset.flight.linked.linked_flight import LinkedFlight
from matchset.flight.linked.vehicle_kind import for_links
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.link import Link
from matchset.links.mavlink.mavlink_link import MavlinkLink
from matchset.links.simulated import SimulatedChain
from matchset.links.tello.tello_client import TelloParameters
from matchset.links.tello.tello_link import TelloLink

AUTOPILOT = "mavlink:udpin:0.0.0.0:14550"
FLIES = 235  # of 1000, what no other test's throttle reaches
STREAM = 511  # format: MAV_CMD_SET_MESSAGE_INTERVAL


@pytest.fixture
def chain() -> Iterator[SimulatedChain]:
    opened = SimulatedChain(WORLD)
    yield opened
    opened.close()


def by_autopilot(chain: SimulatedChain, duration: float = 10.0) -> tuple[LinkedFlight, FakeAutopilot]:
    clock = WorldClock(chain)
    pilot = FakeAutopilot(clock)
    link = MavlinkLink(AUTOPILOT, pilot, clock=clock, sleep=clock.sleep)
    return made(chain, link, flight=believing(FlightParameters(duration=duration))), pilot


def flown(flight: LinkedFlight, flies: Callable[[], bool], happens: Callable[[], None]) -> list[ChainStep]:
    """Fly to the end; once it flies, something happens."""
    steps, happened = [], False
    with flight:
        for step in flight:
            steps.append(step)
            if not happened and flies():
                happens()
                happened = True
    assert happened
    return steps


def test_an_autopilot_is_armed_flown_and_landed(chain: SimulatedChain) -> None:
    flight, pilot = by_autopilot(chain, duration=2.0)
    with flight:
        for _ in flight:
            pass
    assert max(z for _, _, z, _ in pilot.sticks) >= FLIES
    assert pilot.mode == STABILIZE
    assert not pilot.armed
    assert pilot.heard.count("HEARTBEAT") == pytest.approx(pilot.clock(), abs=2)  # one a second
    assert flight.in_time
    assert not flight.fault


def test_its_refusal_ends_the_flight_with_its_reason(chain: SimulatedChain) -> None:
    flight, pilot = by_autopilot(chain)
    pilot.refusal = "PreArm: Compass not calibrated"
    with flight:
        steps = list(flight)
    assert "arming refused by ArduPilot (failed): PreArm: Compass not calibrated" in flight.fault
    assert all(step.steps[0].command == Command() for step in steps)
    assert not pilot.armed


def test_when_it_takes_over_the_flight_ends_and_it_is_left_alone(chain: SimulatedChain) -> None:
    flight, pilot = by_autopilot(chain)

    def take_over() -> None:
        pilot.say_text("Battery failsafe", 3)
        pilot.mode = RTL

    steps = flown(flight, lambda: any(z >= FLIES for _, _, z, _ in pilot.sticks), take_over)
    assert steps[-1].steps[0].safety.phase == "cut"
    assert "ArduPilot is in RTL, by itself or by another pilot's switch" in steps[-1].steps[0].safety.reason
    assert not flight.fault
    assert pilot.armed


def test_one_that_falls_silent_ends_it_with_its_words(chain: SimulatedChain) -> None:
    flight, pilot = by_autopilot(chain)
    flown(flight, lambda: any(z >= FLIES for _, _, z, _ in pilot.sticks), lambda: setattr(pilot, "mute", True))
    assert "vehicle 1 has been silent for 2." in flight.fault


class BabblingPort(FakePort):
    """A transmitter that can begin to say nothing but noise."""

    babbles = False

    def read(self) -> bytes:
        said = super().read()
        return bytes(reversed(said)) if self.babbles else said


def test_a_transmitter_that_answers_garbage_ends_it_with_its_words(chain: SimulatedChain) -> None:
    clock = WorldClock(chain)
    port = BabblingPort(clock)
    clock.sleep(0.2)  # the first status has been said
    flight = made(chain, ArduinoLink("serial:///fake", port, clock=clock, sleep=clock.sleep))
    flown(flight, lambda: port.throttle > 60, lambda: setattr(port, "babbles", True))
    assert "has been silent" in flight.fault
    assert port.throttle == 0


def test_a_tello_takes_off_is_flown_and_lands_by_its_own_means(chain: SimulatedChain) -> None:
    clock = WorldClock(chain)
    tello = FakeTello(clock)
    link = TelloLink("tello:", tello, clock=clock, sleep=clock.sleep)
    duration = TelloParameters().takeoff_time + 2.5
    with made(chain, link, flight=believing(for_links(FlightParameters(duration=duration), ["tello:"]))) as flight:
        assert "it holds speeds, at full stick 1 m/s, upward 1 m/s" in assumed(flight.setup)
        for _ in flight:
            pass
    assert not flight.fault
    assert flight.in_time
    assert tello.heard.count("takeoff") == 1
    assert "emergency" not in tello.heard
    assert tello.heard.index("takeoff") < tello.heard.index("land")
    told = [tuple(map(int, each.split()[1:])) for each in tello.heard if each.startswith("rc")]
    assert len(told) > 60
    assert all(-100 <= each <= 100 for speeds in told for each in speeds)
    assert any(speeds != (0, 0, 0, 0) for speeds in told)
    assert not tello.motors
    assert tello.height == 0.0


def flown_dry(monkeypatch: pytest.MonkeyPatch, real: Link, clock: Clock) -> None:
    """Tell a link of a dry run for two seconds to fly."""
    monkeypatch.setattr(opening, "connect", lambda _: real)
    with opening.open_link(real.uri, dry=True) as link:
        link.arm()
        for _ in range(60):
            assert link.send(Command(throttle=0.5)) == Command()
            assert link.status().state == "armed"
            assert link.status().refusal == ""
            clock.sleep(1.0 / 30.0)


def test_in_a_dry_run_an_autopilot_is_sent_neither_sticks_nor_a_mode(monkeypatch: pytest.MonkeyPatch) -> None:
    pilot = FakeAutopilot()
    flown_dry(monkeypatch, MavlinkLink(AUTOPILOT, pilot, clock=pilot.clock, sleep=pilot.clock.sleep), pilot.clock)
    assert "HEARTBEAT" in pilot.heard
    assert pilot.sticks == []
    assert {number for number, _ in pilot.asked} == {STREAM}


def test_in_a_dry_run_a_tello_is_told_nothing_that_moves_it(monkeypatch: pytest.MonkeyPatch) -> None:
    tello = FakeTello()
    flown_dry(monkeypatch, TelloLink("tello:", tello, clock=tello.clock, sleep=tello.clock.sleep), tello.clock)
    assert tello.heard
    assert not tello.motors
    assert not [each for each in tello.heard if each.split()[0] in ("takeoff", "land", "emergency", "rc")]
