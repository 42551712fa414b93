import json
from collections.abc import Callable

import pytest
from fakes import FakePort

from blue_ball import Matchset
from matchset.flight.radio import connection as radio_link
from matchset.links import crsf_frame as crsf
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.arduino.messages import Config

Out = pytest.CaptureFixture[str]


@pytest.fixture
def port(monkeypatch: pytest.MonkeyPatch) -> FakePort:
    """A transmitter, on whatever port a command opens."""
    fake = FakePort()

    def open_fake(uri: str) -> radio_link.Radio:
        fake.clock.sleep(0.2)
        link = ArduinoLink(uri, fake, clock=fake.clock, sleep=fake.clock.sleep)
        return radio_link.Radio(link, fake.clock, fake.clock.sleep)

    monkeypatch.setattr(radio_link, "open_radio", open_fake)
    return fake


def motors_turned(port: FakePort) -> bool:
    return any(values[4] != crsf.CHANNEL_LOW for values in port.heard)


@pytest.mark.parametrize("command", [(), ("bind",), ("monitor",), ("test-sticks",), ("config",)])
def test_every_command_has_help(matchset: Matchset, capsys: Out, command: tuple[str, ...]) -> None:
    assert matchset("radio", *command, "--help") == 0
    assert "Usage" in capsys.readouterr().out


def test_bind_sends_bind_packets_and_nothing_that_turns(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    assert matchset("radio", "bind", "/dev/x") == 0
    assert "bind packets were sent" in capsys.readouterr().out
    assert port.clock() > 1.38
    assert not motors_turned(port)
    assert port.closed


def test_monitor_shows_the_state_and_sends_no_throttle(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    port.warnings = 1
    assert matchset("radio", "monitor", "/dev/x", "--duration", "1") == 0
    shown = capsys.readouterr().err
    assert "locked" in shown
    assert "firmware 1.0" in shown
    assert not motors_turned(port)


def test_monitor_prints_lines_for_a_pipe(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    assert matchset("radio", "monitor", "/dev/x", "--duration", "0.95", "--print") == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len(lines) == 10
    assert {line["state"] for line in lines} == {"locked"}


def test_sticks_are_tested_with_the_motors_off(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    assert matchset("radio", "test-sticks", "/dev/x") == 0
    out = capsys.readouterr().out
    assert out.count(" ok") == 7
    assert "roll to the left        -64    -64   ok" in out
    assert not motors_turned(port)


def test_motors_turn_only_with_arm_and_after_the_countdown(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    before: list[float] = []
    channels = port._channels

    def note(values: list[int]) -> None:
        if values[4] != crsf.CHANNEL_LOW:
            before.append(port.clock())
        channels(values)

    port._channels = note  # type: ignore[method-assign]
    assert matchset("radio", "test-sticks", "/dev/x", "--arm", "--countdown", "4") == 0
    out = capsys.readouterr().out
    assert "the motors start in 4 s" in out
    assert before[0] > 4.0
    armed = [values for values in port.heard if values[4] != crsf.CHANNEL_LOW]
    assert max(values[2] for values in armed) == crsf.CHANNEL_LOW + 164
    assert {values[0] for values in armed} >= {992 + 410, 992 - 410}
    assert (port.state, port.throttle) == ("locked", 0)


def test_ctrl_c_in_the_motor_test_stops_the_motors_at_once(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    sleep: Callable[[float], None] = port.clock.sleep

    def interrupted(seconds: float) -> None:
        sleep(seconds)
        if port.throttle and not stopped:
            stopped.append(port.clock())
            raise KeyboardInterrupt

    stopped: list[float] = []
    port.clock.sleep = interrupted  # type: ignore[method-assign]
    assert matchset("radio", "test-sticks", "/dev/x", "--arm") == 130
    assert port.throttle == 0
    assert port.clock() - stopped[0] < 0.2


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("test-sticks", "/dev/x", "--arm", "--throttle", "0.5"), "--throttle must be"),
        (("test-sticks", "/dev/x", "--arm", "--countdown", "0"), "--countdown must be"),
        (("config", "/dev/x", "--id", "xyz"), "hexadecimal"),
        (("config", "/dev/x", "--id", "0102"), "four or five"),
        (("config", "/dev/x", "--trims", "1,2"), "takes 3 numbers"),
        (("config", "/dev/x", "--trims", "1,2,99"), "-31 ... 31"),
        (("config", "/dev/x", "--bind-channels", "a"), "whole numbers"),
        (("config", "/dev/x", "--reverse", "up"), "up"),
    ],
)
def test_bad_options_are_one_line_and_nothing_is_opened(
    matchset: Matchset, port: FakePort, capsys: Out, options: tuple[str, ...], words: str
) -> None:
    assert matchset("radio", *options) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert port.clock() == 0.0


def test_config_shows_without_writing(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    assert matchset("radio", "config", "/dev/x") == 0
    assert "nothing is stored" in capsys.readouterr().out
    assert not port.stored


def test_config_changes_what_is_named(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    options = ("--reverse", "yaw,roll", "--trims=-4,0,3", "--bind-channels", "0x20", "--no-bind-at-power-on")
    assert matchset("radio", "config", "/dev/x", "--id", "bc:11:22:33", *options) == 0
    assert port.config == Config(
        id=bytes.fromhex("bc112233a2"),
        bind_channels=(32, 32),
        reversed=("roll", "yaw"),
        trims=(-4, 0, 3),
        bind_at_power_on=False,
    )
    assert "bind again" in capsys.readouterr().out
    assert matchset("radio", "config", "/dev/x", "--defaults") == 0
    assert port.config == Config()


def test_a_new_id_is_random_and_keeps_the_last_byte(matchset: Matchset, port: FakePort) -> None:
    assert matchset("radio", "config", "/dev/x", "--new-id") == 0
    assert port.config.id != Config().id
    assert port.config.id[4] == 0xA2


def test_a_transmitter_that_goes_away_is_one_line(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    sleep: Callable[[float], None] = port.clock.sleep

    def pulled(seconds: float) -> None:
        sleep(seconds)
        port.unplugged = port.clock() > 1.0

    port.clock.sleep = pulled  # type: ignore[method-assign]
    assert matchset("radio", "bind", "/dev/x") == 3
    (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("error")]
    assert "unplugged" in line


def test_no_port_there_is_one_line(matchset: Matchset, capsys: Out) -> None:
    assert matchset("radio", "monitor", "/dev/not-there") == 3
    (line,) = capsys.readouterr().err.splitlines()
    assert "cannot open /dev/not-there" in line


def test_a_link_that_disarms_in_the_motor_test_is_said(matchset: Matchset, port: FakePort, capsys: Out) -> None:
    sleep: Callable[[float], None] = port.clock.sleep

    def stalled(seconds: float) -> None:
        sleep(seconds + (0.3 if port.throttle else 0.0))

    port.clock.sleep = stalled  # type: ignore[method-assign]
    assert matchset("radio", "test-sticks", "/dev/x", "--arm") == 1
    said = capsys.readouterr()
    assert said.err.startswith("error: the motors are off: the transmitter")
    assert "Motors off." not in said.out
    assert port.throttle == 0
