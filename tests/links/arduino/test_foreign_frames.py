"""A damaged frame has a good CRC once in 256 times: one status alone ends no flight, two alike do, in time."""

import struct

import pytest
from fakes import STATES, FakePort
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links import crsf_frame as crsf
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.arduino.messages import CONFIG, STATUS
from matchset.links.arduino.protocol import ArduinoParameters
from matchset.links.link import State

FLIGHT = Command(throttle=0.5, roll=0.25)
ANYTHING = st.binary(max_size=40) | st.binary(min_size=18, max_size=18).map(lambda rest: b"\1" + rest)
GROUNDED: tuple[State, ...] = ("binding", "locked", "failsafe")


def status(state: int, echo: int = 0, protocol: int = 1) -> bytes:
    """A status as the firmware would send it."""
    return crsf.frame(STATUS, struct.pack(">BBBBBHHBHHBBbbb", protocol, 1, 0, state, 0, 9, 0, 0, 4, echo, *[0] * 5))


def flying(alike: int = 2) -> tuple[ArduinoLink, FakePort]:
    port = FakePort()
    port.clock.sleep(0.2)
    parameters = ArduinoParameters(alike=alike)
    link = ArduinoLink("serial:///fake", port, parameters, clock=port.clock, sleep=port.clock.sleep)
    link.arm()
    for _ in range(10):
        fly(link, port)
    return link, port


def fly(link: ArduinoLink, port: FakePort) -> Command:
    sent = link.send(FLIGHT)
    port.clock.sleep(1 / 30)
    return sent


@pytest.mark.parametrize("state", GROUNDED)
def test_one_foreign_status_ends_no_flight_and_is_not_shown(state: State) -> None:
    link, port = flying()
    for _ in range(20):
        port._out += status(STATES.index(state), echo=port.heard[-1][15])
        assert link.status().state == "armed"
        assert fly(link, port).throttle > 0
        assert fly(link, port).throttle > 0
    assert port.throttle == 128


@pytest.mark.parametrize("state", GROUNDED)
def test_two_alike_end_it_at_the_next_command(state: State) -> None:
    link, port = flying()
    port.state = state
    frames = 0
    while fly(link, port) != Command():
        frames += 1
    assert frames <= 2
    assert link.status().state in GROUNDED


@pytest.mark.parametrize("alike", [1, 3])
def test_how_many_must_agree_is_a_parameter(alike: int) -> None:
    link, port = flying(alike)
    for count in range(1, alike + 1):
        assert link.status().state == "armed", count
        port._out += status(1)
    assert link.status().state == "locked"
    with pytest.raises(ValueError, match="got alike 0"):
        ArduinoParameters(alike=0)


def test_two_that_differ_are_not_two_alike() -> None:
    link, port = flying()
    port._out += status(0) + status(1) + status(4) + status(1)
    assert link.status().state == "armed"
    assert fly(link, port).throttle > 0


def test_a_failsafe_is_known_when_it_happens_since_the_firmware_says_it_twice() -> None:
    link, port = flying()
    port.clock.sleep(0.256)
    assert (port.throttle, port.state) == (0, "failsafe")
    assert link.status().state == "failsafe"
    assert link.send(FLIGHT) == Command()


def test_a_refusal_is_noticed_however_seldom_commands_come() -> None:
    link, port = flying()
    port.state = "locked"
    sent = []
    for _ in range(4):
        sent.append(link.send(FLIGHT).throttle)
        port.clock.sleep(0.22)
    assert sent[-1] == 0.0


@given(st.lists(ANYTHING, max_size=12))
def test_no_single_foreign_message_ends_a_flight(payloads: list[bytes]) -> None:
    link, port = flying()
    for number, payload in enumerate(payloads):
        port._out += crsf.frame(CONFIG if number % 4 == 3 else STATUS, payload)
        fly(link, port)
        assert link.status().state not in GROUNDED
        assert fly(link, port).throttle > 0


def test_messages_that_make_no_sense_are_counted_and_silence_is_still_noticed() -> None:
    link, port = flying()
    port.mute = True
    read, port.read = port.read, lambda: read() + status(2, protocol=2)  # type: ignore[method-assign]
    for _ in range(14):
        fly(link, port)
    port.clock.sleep(0.05)
    with pytest.raises(LinkError, match="silent"):
        link.send(FLIGHT)
    assert link.firmware.strange > 5


def test_a_cut_goes_on_until_two_agree_that_the_motors_are_off() -> None:
    link, port = flying()
    lost: list[bytes] = []
    write = port.write

    def lose_the_first(data: bytes) -> None:
        if lost:
            write(data)
        else:
            lost.append(data)
            port._out += status(1)  # and a damaged status says what was hoped for

    port.write = lose_the_first  # type: ignore[method-assign]
    link.land(0)
    assert (port.state, port.throttle) == ("locked", 0)


def test_another_firmware_is_said_at_the_start_and_one_damaged_frame_is_not_another_firmware() -> None:
    port = FakePort()
    port._out += status(2, protocol=2)
    port.clock.sleep(0.2)
    ArduinoLink("serial:///fake", port, clock=port.clock, sleep=port.clock.sleep)
    other = FakePort(mute=True)
    said = [status(2, protocol=2)] * 2
    other.read = lambda: said.pop() if said else b""  # type: ignore[method-assign]
    with pytest.raises(LinkError, match="speaks protocol 02"):
        ArduinoLink("serial:///fake", other, clock=other.clock, sleep=other.clock.sleep)
    assert other.closed


def test_a_configuration_nobody_asked_for_is_not_read() -> None:
    link, port = flying()
    port._out += crsf.frame(CONFIG, b"\x77")
    assert fly(link, port).throttle > 0
    link.land(0)
    port._out += crsf.frame(CONFIG, b"\x77")
    with pytest.raises(LinkError, match="unknown result"):
        link.read_config()


def test_nor_is_one_that_comes_after_the_answer_to_a_question() -> None:
    link, port = flying()
    link.land(0)
    assert link.read_config()[0] == "default"
    link.arm()
    port._out += crsf.frame(CONFIG, b"\x77")
    assert fly(link, port).throttle > 0


def test_a_status_that_answers_no_frame_of_this_program_refuses_nothing() -> None:
    link, port = flying()
    for echo in (0, crsf.CHANNEL_HIGH):  # it heard nothing yet, or somebody else
        for _ in range(3):
            port._out += status(STATES.index("locked"), echo)
        assert link.status().state == "locked"
        assert not link.firmware.refused
        assert fly(link, port).throttle > 0
        assert fly(link, port).throttle > 0
