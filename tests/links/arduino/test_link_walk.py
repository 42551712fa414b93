"""The host's side of the link, walked through every sequence of what may happen, against a table of what must.

The transmitter is a script here: it says any state at any time. What the link may send, and what it must know, is
computed beside it from the rules alone.
"""

import itertools
import struct
from dataclasses import dataclass, field

import pytest
from fakes import STATES, Clock

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links import crsf_frame as crsf
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.arduino.messages import STATUS

FLIGHT = Command(throttle=0.5, yaw=0.2)
FLYING, GROUNDED = ("armed", "holding"), ("binding", "locked", "failsafe")
LENGTH = 4


@dataclass
class ScriptedPort:
    """Says what it is told to, and keeps the frames that come."""

    clock: Clock = field(default_factory=Clock)
    out: bytearray = field(default_factory=bytearray)
    frames: list[list[int]] = field(default_factory=list)
    closed: bool = False
    answers: str = ""  # a state to answer every frame with
    may_arm: bool = True

    def say(self, state: str) -> None:
        echo = self.frames[-1][15] if self.frames else 0
        values = STATES.index(state), 32 * self.may_arm, len(self.frames), 0, 0, 4, echo
        self.out += crsf.frame(STATUS, struct.pack(">BBBBBHHBHHBBbbb", 1, 1, 0, *values, *[0] * 5))

    def write(self, data: bytes) -> None:
        self.frames += [crsf.unpack_channels(payload) for _, payload in crsf.CrsfParser().feed(data)]
        if self.answers:
            self.say("armed" if self.answers == "as asked" and self.frames[-1][4] > 1500 else "locked")

    def read(self) -> bytes:
        data, self.out = bytes(self.out), bytearray()
        return data

    def close(self) -> None:
        self.closed = True


@dataclass
class Rules:
    """What the link must do, from the rules: `arm` alone arms it, two refusals alike in a row disarm it."""

    armed: bool = False
    shown: str = "locked"
    refusals: tuple[str, ...] = ()
    ends: tuple[str, ...] = ()
    frame_armed: bool = False  # the arm switch of the last frame

    def status(self, state: str) -> None:
        refuses = state in ("failsafe", "binding") or (state == "locked" and self.frame_armed)
        self.refusals = (*self.refusals, state)[-2:] if refuses else ()
        ends = state in GROUNDED and self.shown in FLYING
        self.ends = (*self.ends, state)[-2:] if ends else ()
        if not ends or self.ends == (state, state):
            self.shown, self.ends = state, ()

    @property
    def refused(self) -> bool:
        return len(self.refusals) == 2 and self.refusals[0] == self.refusals[1]


def opened() -> tuple[ArduinoLink, ScriptedPort, Rules]:
    port = ScriptedPort()
    port.say("locked")
    return ArduinoLink("serial:///scripted", port, clock=port.clock, sleep=port.clock.sleep), port, Rules()


def arm(link: ArduinoLink, port: ScriptedPort, rules: Rules) -> None:
    port.answers = "as asked"
    link.arm()
    port.answers = ""
    rules.armed, rules.shown, rules.frame_armed, rules.refusals, rules.ends = True, "armed", True, (), ()


def send(link: ArduinoLink, port: ScriptedPort, rules: Rules) -> None:
    rules.armed = rules.armed and not rules.refused
    sent = link.send(FLIGHT)
    arm_switch, throttle = port.frames[-1][4], port.frames[-1][2]
    assert (arm_switch > 1500) == rules.armed
    assert (throttle > crsf.CHANNEL_LOW) == rules.armed == (sent.throttle > 0)
    rules.frame_armed = rules.armed


def play(events: tuple[str, ...], fly_first: bool) -> None:
    link, port, rules = opened()
    if fly_first:
        arm(link, port, rules)
        send(link, port, rules)
    for event in events:
        port.clock.sleep(0.03)
        if event == "send":
            send(link, port, rules)
        elif event == "arm":
            arm(link, port, rules)
        else:
            port.say(event)
            rules.status(event)
            assert link.status().state == rules.shown


@pytest.mark.parametrize("fly_first", [False, True], ids=["from the ground", "in flight"])
def test_every_sequence_of_states_and_commands(fly_first: bool) -> None:
    for events in itertools.product([*STATES, "send", "arm"], repeat=LENGTH):
        try:
            play(events, fly_first)
        except AssertionError as error:
            raise AssertionError(f"{events}: {error}") from error


@pytest.mark.parametrize("state", GROUNDED)
def test_after_a_refusal_nothing_but_arm_arms(state: str) -> None:
    link, port, rules = opened()
    arm(link, port, rules)
    for _ in range(3):
        send(link, port, rules)
        port.say(state)
        rules.status(state)
    for later in [*STATES, *STATES]:  # whatever it says then
        port.clock.sleep(0.03)
        assert link.send(FLIGHT) == Command()
        assert port.frames[-1][4] == crsf.CHANNEL_LOW
        port.say(later)
    arm(link, port, rules)
    send(link, port, rules)


@pytest.mark.parametrize("armed", [False, True])
def test_silence_breaks_the_link_in_half_a_second_and_closing_sends_a_disarm(armed: bool) -> None:
    link, port, rules = opened()
    if armed:
        arm(link, port, rules)
    begin = port.clock()
    for _ in range(100):
        try:
            link.send(FLIGHT)
        except LinkError:
            break
        port.clock.sleep(0.01)
    assert 0.49 < port.clock() - begin < 0.53
    link.close()
    assert port.closed
    assert (port.frames[-1][4], port.frames[-1][2]) == (crsf.CHANNEL_LOW, crsf.CHANNEL_LOW)


@pytest.mark.parametrize("said", GROUNDED)
def test_arming_that_is_not_confirmed_is_an_error_and_leaves_the_switch_low(said: str) -> None:
    link, port, _ = opened()
    port.may_arm = said == "locked"
    port.answers = said
    with pytest.raises(LinkError, match="arm"):
        link.arm()
    assert link.send(FLIGHT) == Command()
    assert port.frames[-1][4] == crsf.CHANNEL_LOW


@pytest.mark.parametrize("said", FLYING)
def test_a_landing_that_is_not_confirmed_is_an_error(said: str) -> None:
    link, port, rules = opened()
    arm(link, port, rules)
    write = port.write

    def deaf(data: bytes) -> None:
        write(data)
        port.say(said)

    port.write = deaf  # type: ignore[method-assign]
    with pytest.raises(LinkError, match=f"did not disarm; it is {said}"):
        link.land(0)
    assert port.frames[-1][4] == crsf.CHANNEL_LOW
