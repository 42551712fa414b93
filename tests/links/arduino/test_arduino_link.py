import random

import pytest
from fakes import Clock, FakePort
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links import crsf_frame as crsf
from matchset.links.arduino import channels
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.arduino.messages import Config
from matchset.links.arduino.protocol import ArduinoParameters
from matchset.links.connect import connect
from matchset.links.link import Link

FLIGHT = Command(throttle=0.5, roll=0.25, pitch=-0.25, yaw=1.0)


def link_to(port: FakePort) -> ArduinoLink:
    port.clock.sleep(0.2)  # the first status has been said
    return ArduinoLink("serial:///fake", port, clock=port.clock, sleep=port.clock.sleep)


@pytest.fixture
def port() -> FakePort:
    return FakePort()


@pytest.fixture
def link(port: FakePort) -> ArduinoLink:
    return link_to(port)


def fly(link: ArduinoLink, port: FakePort, seconds: float, command: Command = FLIGHT) -> Command:
    sent = Command()
    for _ in range(round(30 * seconds)):
        sent = link.send(command)
        port.clock.sleep(1 / 30)
    return sent


def test_it_keeps_the_contract(link: ArduinoLink) -> None:
    kept: Link = link
    assert kept.uri == "serial:///fake"
    assert kept.status().version == "1.0"


def test_without_arming_only_zero_is_sent(link: ArduinoLink, port: FakePort) -> None:
    assert fly(link, port, 1.0) == Command()
    assert {(values[2], values[4]) for values in port.heard} == {(crsf.CHANNEL_LOW, crsf.CHANNEL_LOW)}
    assert link.status().state == "locked"


def test_armed_it_sends_what_it_says(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    assert port.throttle == 0
    sent = fly(link, port, 1.0)
    assert sent == channels.on_air(FLIGHT)
    assert sent.throttle == pytest.approx(0.5, abs=1 / 255)
    assert port.throttle == 128
    assert link.status().state == "armed"
    assert link.status().age <= 0.034
    assert link.firmware.answered >= link.firmware.sent - 1


@given(st.builds(Command, *[st.floats(-1, 1)] * 3, st.floats(0, 1)))
def test_what_goes_on_the_air_is_the_command_rounded(command: Command) -> None:
    sent = channels.on_air(command)
    for axis in ("roll", "pitch", "yaw"):
        assert getattr(sent, axis) == pytest.approx(getattr(command, axis), abs=1 / 127)
    assert sent.throttle == pytest.approx(command.throttle, abs=1 / 255)


def test_leaving_the_block_lands(port: FakePort) -> None:
    with link_to(port) as link:
        link.arm()
        fly(link, port, 0.5)
        begin = port.clock()
    throttles = [values[2] for values in port.heard[-40:]]
    assert throttles == sorted(throttles, reverse=True)
    assert 1.4 < port.clock() - begin < 1.8
    assert (port.state, port.throttle, port.closed) == ("locked", 0, True)


def test_an_error_in_the_block_lands_too_even_another_device_s(port: FakePort) -> None:
    def flight() -> None:
        with link_to(port) as link:
            link.arm()
            fly(link, port, 0.5)
            raise LinkError("the camera has gone")

    with pytest.raises(LinkError, match="camera"):
        flight()
    assert (port.state, port.throttle, port.closed) == ("locked", 0, True)


def test_landing_in_no_time_cuts(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    fly(link, port, 0.5)
    link.land(0)
    assert port.heard[-1][4] == crsf.CHANNEL_LOW
    assert (port.state, port.throttle) == ("locked", 0)


def test_closing_twice_is_once(link: ArduinoLink, port: FakePort) -> None:
    link.close()
    count = len(port.heard)
    link.close()
    assert len(port.heard) == count


def test_unplugged_in_flight_is_noticed_at_the_next_call(port: FakePort) -> None:
    def flight() -> None:
        with link_to(port) as link:
            link.arm()
            fly(link, port, 0.5)
            port.unplugged = True
            link.send(FLIGHT)

    with pytest.raises(LinkError, match="unplugged"):
        flight()
    assert port.closed
    port.clock.sleep(0.25)
    port.unplugged = False
    assert (port.throttle, port.state) == (0, "failsafe")


def test_unplugged_is_noticed_by_status_alone(link: ArduinoLink, port: FakePort) -> None:
    port.unplugged = True
    with pytest.raises(LinkError, match="unplugged"):
        link.status()


def test_silence_is_noticed(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    port.mute = True
    with pytest.raises(LinkError, match=r"silent for 0\.5 s"):
        fly(link, port, 1.0)
    link.close()
    assert port.heard[-1][4] == crsf.CHANNEL_LOW  # in case it still hears us


def test_after_the_failsafe_the_link_is_disarmed(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    fly(link, port, 0.5)
    port.clock.sleep(0.3)
    assert link.status().state == "failsafe"
    assert fly(link, port, 0.2) == Command()
    assert link.status().state == "locked"
    assert fly(link, port, 0.2) == Command()
    link.arm()
    assert fly(link, port, 0.2).throttle > 0


@pytest.mark.parametrize("state", ["locked", "binding", "failsafe"])
def test_a_board_that_restarts_in_flight_disarms_the_link(link: ArduinoLink, port: FakePort, state: str) -> None:
    link.arm()
    fly(link, port, 0.5)
    port.state = state  # type: ignore[assignment]
    fly(link, port, 0.1)
    assert fly(link, port, 0.1) == Command()
    assert port.throttle == 0


def test_a_board_that_does_not_arm_is_an_error(link: ArduinoLink, port: FakePort) -> None:
    port.stubborn = True
    with pytest.raises(LinkError, match="it did not arm; it is locked"):
        link.arm()
    assert link.send(FLIGHT) == Command()


def test_arming_waits_for_the_end_of_binding(link: ArduinoLink, port: FakePort) -> None:
    link.bind()
    port.clock.sleep(0.1)
    assert link.status().state == "binding"
    link.arm()
    assert link.status().state == "armed"


def test_nobody_there_is_an_error(port: FakePort) -> None:
    port.mute = True
    with pytest.raises(LinkError, match="nobody answers"):
        link_to(port)
    assert port.closed


def test_the_configuration_is_read_and_written(link: ArduinoLink, port: FakePort) -> None:
    assert link.read_config() == ("default", Config())
    wish = Config(id=b"\1\2\3\4\5", trims=(1, -2, 3))
    assert link.write_config(wish) == "stored"
    assert link.read_config() == ("stored", wish)
    link.arm()
    assert link.write_config(Config()) == "refused: it is flying"
    assert port.config == wish


def test_the_second_answer_about_the_configuration_is_not_the_first_one_again(
    link: ArduinoLink, port: FakePort
) -> None:
    read = port.read
    late: list[bytes] = []

    def slow() -> bytes:  # each answer arrives with the next look
        late.append(read())
        return late.pop(0) if len(late) > 1 else b""

    port.read = slow  # type: ignore[method-assign]
    assert link.read_config() == ("default", Config())
    wish = Config(id=b"\1\2\3\4\5")
    assert link.write_config(wish) == "stored"
    assert link.read_config() == ("stored", wish)


def test_nobody_is_waited_for_longer_than_the_parameters_say(port: FakePort) -> None:
    parameters, begin = ArduinoParameters(), port.clock()
    port.mute = True
    with pytest.raises(LinkError, match="nobody answers"):
        ArduinoLink("serial:///fake", port, clock=port.clock, sleep=port.clock.sleep)
    assert port.clock() - begin == pytest.approx(parameters.startup_timeout, abs=0.05)
    port.mute = False
    link, write = link_to(port), port.write
    port.write = lambda data: write(data) if data[2] == crsf.CHANNELS_PACKED else None  # type: ignore[method-assign]
    begin = port.clock()
    with pytest.raises(LinkError, match="no answer to a question"):
        link.read_config()
    assert port.clock() - begin == pytest.approx(parameters.answer_timeout, abs=0.05)
    port.stubborn, begin = True, port.clock()
    with pytest.raises(LinkError, match="did not arm"):
        link.arm()
    assert port.clock() - begin == pytest.approx(parameters.arm_timeout, abs=0.25)  # and the frames before


def test_warnings_are_words(port: FakePort) -> None:
    port.warnings = 3
    assert link_to(port).status().warnings == (
        "the radio chip does not answer: look at its wires and its supply",
        "it was restarted by its watchdog",
    )


def test_noise_between_frames_is_survived(link: ArduinoLink, port: FakePort) -> None:
    chance = random.Random(7)
    link.arm()
    for _ in range(60):
        link.send(FLIGHT)
        port._out += bytes(chance.randrange(256) for _ in range(9)) + b"\xc8"
        port.clock.sleep(1 / 30)
    assert link.status().state == "armed"


@pytest.mark.parametrize("uri", ["zigbee://", "/dev/ttyUSB0", ""])
def test_an_unknown_scheme_is_refused(uri: str) -> None:
    with pytest.raises(ValueError, match="serial:///dev/ttyUSB0"):
        connect(uri)


def test_a_port_that_does_not_exist_is_one_line() -> None:
    with pytest.raises(LinkError, match="cannot open /dev/does-not-exist"):
        connect("serial:///dev/does-not-exist")


def test_without_pyserial_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "serial", None)
    with pytest.raises(LinkError, match=r"pip install 'pyserial"):
        connect("serial:///dev/ttyUSB0")


def test_the_clock_of_the_fake_is_its_own() -> None:
    assert Clock()() == 0.0


def test_a_cut_is_one_frame_and_lasts_until_it_is_armed_again(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    fly(link, port, 0.5)
    assert port.throttle > 0
    frames = len(port.heard)
    link.cut()
    assert (len(port.heard) - frames, port.state, port.throttle) == (1, "locked", 0)
    assert fly(link, port, 0.5) == Command()
    assert port.state == "locked"
    assert link.status().refusal
    link.arm()
    assert fly(link, port, 0.2).throttle > 0.0


def test_a_frame_that_leaves_after_a_cut_does_not_turn_the_motors(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    fly(link, port, 0.5)
    send = link.firmware.send_channels

    def cut_first(values: list[int], armed: bool) -> None:
        if not link._cut:
            link.cut()
        send(values, armed)

    link.firmware.send_channels = cut_first  # type: ignore[method-assign]
    link.send(FLIGHT)
    assert (port.state, port.throttle) == ("locked", 0)
    assert fly(link, port, 0.2) == Command()


def test_a_cut_while_it_arms_leaves_it_disarmed(link: ArduinoLink, port: FakePort) -> None:
    sleep = port.clock.sleep

    def interrupted(seconds: float) -> None:
        sleep(seconds)
        link.cut()

    link._sleep = interrupted
    with pytest.raises(LinkError, match="did not arm"):
        link.arm()
    assert (port.state, port.throttle) == ("locked", 0)


def test_a_cut_of_a_link_that_has_gone_raises_with_the_next_command(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    port.unplugged = True
    link.cut()
    with pytest.raises(LinkError, match="unplugged"):
        link.send(FLIGHT)


def test_a_landing_lowers_the_throttle_in_a_straight_line_with_neutral_sticks(
    link: ArduinoLink, port: FakePort
) -> None:
    link.arm()
    fly(link, port, 0.5)
    before, begin = len(port.heard), port.clock()
    link.land(1.5)
    flown = [values for values in port.heard[before:] if values[4] == crsf.CHANNEL_HIGH]
    top = port.heard[before - 1][2] - crsf.CHANNEL_LOW
    assert 45 <= len(flown) <= 51
    for number, values in enumerate(flown):
        share = 1.0 - number * link.parameters.frame_period / 1.5
        assert values[2] - crsf.CHANNEL_LOW == pytest.approx(top * share, abs=1.0)
        assert (values[0], values[1], values[3]) == (crsf.CHANNEL_CENTER,) * 3
    assert 1.5 < port.clock() - begin < 1.7


@pytest.mark.parametrize("high_rate", [False, True])
def test_switches_are_where_they_should_be_in_every_frame(port: FakePort, high_rate: bool) -> None:
    port.clock.sleep(0.2)
    parameters = ArduinoParameters(high_rate=high_rate)
    link = ArduinoLink("serial:///fake", port, parameters, clock=port.clock, sleep=port.clock.sleep)
    link.send_disarmed(FLIGHT)
    link.arm()
    fly(link, port, 0.3)
    link.land(0.3)
    assert {values[6] for values in port.heard} == {crsf.CHANNEL_LOW}  # never a flip
    assert {values[5] for values in port.heard[4:-3]} == {crsf.CHANNEL_HIGH if high_rate else crsf.CHANNEL_LOW}
    assert {values[4] for values in port.heard} == {crsf.CHANNEL_LOW, crsf.CHANNEL_HIGH}
    assert {tuple(values[7:15]) for values in port.heard} == {(crsf.CHANNEL_CENTER,) * 8}
    assert [values[15] - crsf.CHANNEL_LOW for values in port.heard] == list(range(len(port.heard)))


def test_sticks_and_throttle_go_into_their_channels_with_their_signs() -> None:
    command = Command(roll=0.5, pitch=-0.25, yaw=1.0, throttle=0.75)
    assert channels.channels(command)[:4] == [992 + 410, 992 - 205, 172 + 1229, 1811]
    assert channels.channels(Command(), armed=True)[4] == crsf.CHANNEL_HIGH
    said = channels.on_air(command)
    assert (said.roll, said.pitch, said.yaw, said.throttle) == (64 / 127, -32 / 127, 1.0, 191 / 255)


def test_frames_are_numbered_beyond_a_thousand(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    fly(link, port, 61.0)
    assert link.firmware.sent > crsf.CHANNEL_HIGH  # more than a channel can say
    numbers = [values[15] - crsf.CHANNEL_LOW for values in port.heard]
    assert numbers == [count % 1024 for count in range(len(numbers))]
    assert link.firmware.answered >= link.firmware.sent - 1
    assert link.firmware.round_trip is not None
    assert 0.0 <= link.firmware.round_trip < 0.05
    assert link.firmware.sent == len(port.heard)


def test_what_is_sent_disarmed_has_the_arm_switch_low_also_after_arming(link: ArduinoLink, port: FakePort) -> None:
    link.arm()
    fly(link, port, 0.2)
    for _ in range(10):
        assert link.send_disarmed(FLIGHT) == channels.on_air(FLIGHT)
        port.clock.sleep(1 / 30)
        assert (port.heard[-1][4], port.throttle) == (crsf.CHANNEL_LOW, 0)
    assert link.send(FLIGHT) == Command()  # and it does not arm again by itself
    assert port.heard[-1][4] == crsf.CHANNEL_LOW


def test_arming_that_is_interrupted_leaves_the_link_disarmed(port: FakePort) -> None:
    def sleep(seconds: float) -> None:
        port.clock.sleep(seconds)
        if port.state == "armed":
            raise KeyboardInterrupt

    port.clock.sleep(0.2)
    link = ArduinoLink("serial:///fake", port, clock=port.clock, sleep=sleep)
    with pytest.raises(KeyboardInterrupt):
        link.arm()
    assert link.send(FLIGHT) == Command()
    assert (port.heard[-1][4], port.throttle) == (crsf.CHANNEL_LOW, 0)
