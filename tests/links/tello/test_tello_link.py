"""The link with a Tello: taking off and landing by throttle, silence, refusals, and whom it leaves alone."""

import copy
import socket
import time
from collections.abc import Iterator

import pytest
from fake_tello import FakeTello, ServedTello

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.connect import connect
from matchset.links.tello.tello_client import TelloAddress, TelloParameters, UdpSockets, parse_tello
from matchset.links.tello.tello_link import TelloLink, speeds
from matchset.links.tello.tello_state import parse_state

HOLD = Command(throttle=0.5)


def opened(tello: FakeTello | None = None) -> tuple[TelloLink, FakeTello]:
    tello = tello or FakeTello()
    return TelloLink("tello:", tello, clock=tello.clock, sleep=tello.clock.sleep), tello


def fly(link: TelloLink, tello: FakeTello, seconds: float, command: Command = HOLD) -> Command:
    end, sent = tello.clock() + seconds, Command()
    while tello.clock() < end:
        sent = link.send(command)
        tello.clock.sleep(0.033)
    return sent


def flying() -> tuple[TelloLink, FakeTello]:
    link, tello = opened()
    link.arm()
    fly(link, tello, 3.0)
    assert tello.height == pytest.approx(0.8, abs=0.02)
    return link, tello


def test_sticks_become_speeds() -> None:
    assert speeds(Command(0.25, -0.5, 0.75, 0.5)) == (25, -50, 0, 75)
    assert [speeds(Command(throttle=throttle))[2] for throttle in (0.0, 0.25, 0.5, 0.75, 1.0)] == [
        -100,
        -50,
        0,
        50,
        100,
    ]


def test_it_waits_on_the_floor_until_the_first_throttle_then_takes_off_by_itself() -> None:
    link, tello = opened()
    link.arm()
    assert fly(link, tello, 1.0, Command()) == Command()
    assert tello.heard == ["command"]
    assert link.status().state == "armed"
    assert fly(link, tello, 0.5, Command(roll=1.0, throttle=0.9)) == HOLD
    assert tello.heard == ["command", "takeoff"]
    fly(link, tello, 2.0)
    assert link.send(Command(0.254, -0.5, 0.75, 0.6)) == Command(0.25, -0.5, 0.75, 0.6)
    assert tello.heard[-1] == "rc 25 -50 20 75"


def test_it_goes_where_the_sticks_say() -> None:
    link, tello = flying()
    fly(link, tello, 1.0, Command(roll=0.5, pitch=-0.2, yaw=0.3, throttle=0.75))
    fly(link, tello, 0.1)
    right, forward = tello.place
    assert (right, forward, tello.height, tello.yaw) == pytest.approx((0.5, -0.2, 1.3, 30.0), abs=0.05, rel=0.1)


def test_zero_throttle_in_the_air_lands_and_disarms() -> None:
    link, tello = flying()
    fly(link, tello, 3.0, Command())
    assert (tello.motors, tello.height) == (False, 0.0)
    assert tello.heard[-1] == "land"
    assert tello.heard.count("land") == 1
    assert (link.status().state, link.status().refusal) == ("locked", "the transmitter is disarmed")
    fly(link, tello, 1.0)
    assert not tello.motors
    link.arm()
    fly(link, tello, 3.0)
    assert tello.motors


def test_unarmed_nothing_flies() -> None:
    link, tello = opened()
    assert fly(link, tello, 1.0) == Command()
    link.land()
    link.cut()
    assert "takeoff" not in tello.heard


def test_a_refused_take_off_is_passed_on() -> None:
    link, tello = opened(FakeTello(refusal="error Motor stop"))
    link.arm()
    assert fly(link, tello, 1.0) == Command()
    status = link.status()
    assert (status.state, status.refusal) == ("failsafe", "it did not take off: error Motor stop")


def test_a_take_off_that_is_never_answered_ends() -> None:
    link, tello = opened()
    link.arm()
    link.send(HOLD)
    tello.answers = list  # type: ignore[method-assign]
    fly(link, tello, 21.0)
    assert link.status().refusal == "it did not take off: no answer"


def test_answers_to_sticks_are_not_taken_for_others() -> None:
    link, tello = opened(FakeTello(chatty=True))
    link.arm()
    fly(link, tello, 3.0)
    link.land()
    assert tello.height == 0.0
    assert not tello.motors


def test_landing_waits_until_it_has_landed() -> None:
    link, tello = flying()
    start = tello.clock()
    link.land()
    assert (tello.motors, tello.height) == (False, 0.0)
    assert 1.0 < tello.clock() - start < 3.0
    assert link.send(HOLD) == Command()


def test_a_landing_while_it_takes_off_is_repeated() -> None:
    link, tello = opened()
    link.arm()
    fly(link, tello, 0.5)
    link.land()
    assert not tello.motors


def test_a_landing_right_after_the_take_off_began_waits_for_the_floor() -> None:
    link, tello = opened()
    link.arm()
    fly(link, tello, 3.0, Command())  # on the floor all the time
    fly(link, tello, 0.2)
    link.land()
    assert not tello.motors


def test_a_landing_that_gets_lost_is_repeated() -> None:
    link, tello = flying()
    heard, tello.send = tello.send, lambda data: None if data == b"land" else heard(data)  # type: ignore[method-assign]
    pass_time = tello.clock.sleep

    def hear_again(seconds: float) -> None:
        pass_time(seconds)
        if tello.clock() > until:
            tello.send = heard  # type: ignore[method-assign]

    until, link._sleep = tello.clock() + 0.5, hear_again
    link.land()
    assert not tello.motors


def test_a_late_answer_is_not_that_of_the_landing() -> None:
    link, tello = flying()
    link.send(Command())
    tello.out.append(b"ok")  # of a command before
    tello.clock.sleep(0.2)
    assert link.status().state == "armed"
    tello.clock.sleep(3.0)
    assert link.status().state == "locked"


def test_one_that_does_not_land_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    link, tello = flying()
    monkeypatch.setattr(tello, "_do", lambda _: "error Not joystick")
    with pytest.raises(LinkError, match="it did not land: error Not joystick"):
        link.land()


def test_a_cut_is_at_once_and_repeated() -> None:
    link, tello = flying()
    link.cut()
    assert tello.heard[-1] == "emergency"
    assert not tello.motors
    fly(link, tello, 1.0)
    assert tello.heard.count("emergency") == 11
    assert "takeoff" not in tello.heard[3:]
    assert link.status().state == "locked"


def test_landing_at_once_is_a_cut() -> None:
    link, tello = flying()
    link.land(0)
    assert tello.heard[-1] == "emergency"


def test_silence_of_the_program_holds_then_lands() -> None:
    link, tello = flying()
    fly(link, tello, 0.3, Command(pitch=1.0, throttle=0.5))
    before, commands = tello.place, len(tello.heard)
    for _ in range(40):
        tello.clock.sleep(0.1)
        link.watch()
        tello.move()
    assert tello.heard[commands:] == ["rc 0 0 0 0", "land"]
    assert tello.place[1] - before[1] < 0.5
    assert not tello.motors
    status = link.status()
    assert status.state == "failsafe"
    assert status.refusal.startswith("no command came for 2.")
    assert link.send(HOLD) == Command()


def test_silence_while_it_takes_off_lands_too() -> None:
    link, tello = opened()
    link.arm()
    link.send(HOLD)
    assert tello.heard[-1] == "takeoff"
    for _ in range(80):
        tello.clock.sleep(0.1)
        link.watch()
        tello.move()
    assert tello.heard[-2:] == ["rc 0 0 0 0", "land"]
    assert not tello.motors


def test_without_the_link_s_thread_it_lands_by_itself_after_15_s() -> None:
    link, tello = flying()
    for _ in range(200):
        tello.clock.sleep(0.1)
        tello.move()
    assert not tello.motors
    fly(link, tello, 2.0)
    assert link.status().refusal == "it has landed by itself (battery 87 %)"


def test_commands_keep_it_in_the_air() -> None:
    link, tello = flying()
    fly(link, tello, 60.0)
    assert tello.motors
    assert link.status().state == "armed"


def test_a_battery_that_is_low_is_said_and_one_that_is_empty_not_armed() -> None:
    link, tello = opened(FakeTello(battery=15))
    assert link.status().warnings == ("battery 15 %",)
    tello.battery = 9
    tello.clock.sleep(0.2)
    with pytest.raises(LinkError, match="arming refused: battery 9 %"):
        link.arm()


def test_one_that_flies_already_is_somebody_else_s() -> None:
    link, tello = opened(FakeTello(motors=True, height=0.8))
    with pytest.raises(LinkError, match=r"it is 0\.8 m up already: somebody else flies it"):
        link.arm()
    fly(link, tello, 1.0)
    link.land()
    link.close()
    assert tello.heard == ["command"]


def test_silence_of_the_tello_breaks_the_link_and_it_is_told_to_land() -> None:
    link, tello = flying()
    tello.mute = True
    start = tello.clock()
    with pytest.raises(LinkError, match=r"tello: has been silent for 1\.0 s"):
        fly(link, tello, 3.0)
    assert 0.9 < tello.clock() - start < 1.3
    link.close()
    assert tello.heard[-1] == "land"
    assert tello.closed


@pytest.mark.parametrize("moment", ["send", "status", "arm", "land"])
def test_a_network_that_is_gone_is_said(moment: str) -> None:
    link, tello = flying()
    tello.gone = True
    actions = {"send": lambda: link.send(HOLD), "status": link.status, "arm": link.arm, "land": link.land}
    with pytest.raises(LinkError, match=r"tello: has gone \(Wi-Fi\?\): Network is unreachable"):
        actions[moment]()
    link.cut()
    link.close()
    assert tello.closed


def test_nobody_there_and_no_states_are_said() -> None:
    with pytest.raises(LinkError, match="nobody answers: is this computer in its Wi-Fi"):
        opened(silent := FakeTello(mute=True))
    assert silent.closed
    blocked = FakeTello()
    blocked.states = list  # type: ignore[method-assign]
    with pytest.raises(LinkError, match="it answers but sends no state to port 8890: a firewall"):
        opened(blocked)


@pytest.mark.parametrize(
    "data",
    [b"", b"ok", b"\xff\xfe\x00", b"pitch:1;roll:2", b"pitch:x;roll:0;yaw:0;tof:10;h:0;bat:87;temph:62;time:0;"],
)
def test_what_is_no_state_is_counted(data: bytes) -> None:
    assert parse_state(data) is None
    link, tello = opened()
    tello.states = lambda: [data, FakeTello.state(tello)]  # type: ignore[method-assign]
    assert link.status().errors == 1


def test_a_state_has_units() -> None:
    state = parse_state(b"mid:-1;x:0;pitch:-90;roll:180;yaw:90;tof:123;h:110;bat:55;temph:70;time:12;\r\n")
    assert state is not None
    assert (state.pitch, state.roll, state.yaw) == pytest.approx((-1.5708, 3.1416, 1.5708), abs=1e-3)
    assert (state.height, state.distance, state.battery, state.temperature) == (1.1, 1.23, 0.55, 70.0)


@pytest.mark.parametrize(
    ("uri", "address"),
    [
        ("tello:", TelloAddress("192.168.10.1")),
        ("tello:10.0.0.7", TelloAddress("10.0.0.7")),
        ("tello:10.0.0.7?states=8891&video=11112", TelloAddress("10.0.0.7", 8889, 8891, 11112)),
    ],
)
def test_a_uri_says_where(uri: str, address: TelloAddress) -> None:
    assert parse_tello(uri) == address


@pytest.mark.parametrize(
    "uri", ["tello", "tello://", "tello:a:8889", "tello:?speed=3", "tello:?states=0", "tello:?states=x"]
)
def test_what_is_no_address_is_refused(uri: str) -> None:
    with pytest.raises(ValueError, match="a Tello is named like tello:, tello:192"):
        parse_tello(uri)


def test_other_ports_are_asked_for() -> None:
    tello = FakeTello()
    TelloLink("tello:?states=8891", tello, clock=tello.clock, sleep=tello.clock.sleep)
    assert tello.heard == ["command", "port 8891 11111"]


def test_pictures_are_asked_for_and_a_refusal_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    link, tello = opened()
    assert link.start_video() == "udp://0.0.0.0:11111"
    assert tello.heard[-1] == "streamon"
    monkeypatch.setattr(tello, "_do", lambda _: "error")
    with pytest.raises(LinkError, match="'streamon' refused: error"):
        link.start_video()
    monkeypatch.setattr(tello, "_do", lambda _: None)
    with pytest.raises(LinkError, match=r"silent|not answered"):
        link.start_video()


def test_the_block_lands() -> None:
    link, tello = flying()
    with pytest.raises(RuntimeError), link:
        raise RuntimeError
    assert not tello.motors
    assert tello.closed
    link.close()
    with pytest.raises(TypeError, match="one program flies a vehicle"):
        copy.copy(link)


@pytest.fixture
def served() -> Iterator[tuple[ServedTello, int]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        states = int(probe.getsockname()[1])
    there = ServedTello(states)
    try:
        yield there, states
    finally:
        there.close()


def test_over_real_sockets_it_flies_and_is_for_one_program(served: tuple[ServedTello, int]) -> None:
    there, states = served
    uri = f"tello:127.0.0.1?commands={there.port}&states={states}"
    link = TelloLink(uri, parameters=TelloParameters(silence_time=0.6))
    with pytest.raises(LinkError, match=f"cannot reach the Tello 127.0.0.1: another program uses port {states}"):
        connect(uri)
    link.arm()
    end = time.monotonic() + 20.0
    while not any(words.startswith("rc 0 50") for words in there.tello.heard) and time.monotonic() < end:
        link.send(Command(pitch=0.5, throttle=0.5))
        time.sleep(0.03)
    end = time.monotonic() + 20.0
    while there.tello.motors and time.monotonic() < end:  # the program is silent, the link's thread lands
        time.sleep(0.05)
    assert there.tello.heard[-2:] == ["rc 0 0 0 0", "land"]
    link.close()


def test_an_address_that_does_not_exist_is_said() -> None:
    with pytest.raises(LinkError, match=r"cannot reach the Tello nobody\.invalid"):
        UdpSockets(TelloAddress("nobody.invalid", states=0))
