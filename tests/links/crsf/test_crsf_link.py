"""The link through a transmitter module: how it arms, what ends a flight, and what is said of each fault."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.connect import connect
from matchset.links.crsf.crsf_link import CrsfLink
from matchset.links.crsf.parameters import CrsfParameters, parse_uri
from matchset.links.crsf.sticks import channels
from matchset.links.link import Link
from radio_modules import Module, link_statistics

HOVER = Command(roll=0.1, pitch=-0.2, yaw=0.3, throttle=0.5)
LOW, HIGH = 172, 1811


class Bench:
    """A link and its module, on a clock that passes in steps of 1 ms, with a look at the port in each."""

    def __init__(self, query: str = "", **kinds: bool | str | float | bytes) -> None:
        self.module = Module(**kinds)  # type: ignore[arg-type]
        self.link = CrsfLink(f"crsf:///dev/module{query}", self.module, self.module, self.sleep, threaded=False)

    def sleep(self, seconds: float) -> None:
        for _ in range(max(round(seconds / 0.001), 1)):
            self.module.now += 0.001
            self.module.pass_time()
            if hasattr(self, "link"):
                self.link.module.turn()

    def fly(self, seconds: float, command: Command = HOVER) -> Command:
        end, sent = self.module.now + seconds, Command()
        while self.module.now < end:
            sent = self.link.send(command)
            self.sleep(0.033)
        return sent

    def since(self, begin: float) -> list[tuple[float, list[int]]]:
        return [each for each in self.module.heard if each[0] > begin]


def flying(query: str = "", **kinds: bool | str | float | bytes) -> Bench:
    bench = Bench(query, **kinds)
    bench.link.arm()
    bench.fly(1.0)
    assert bench.module.armed
    return bench


def test_it_keeps_the_contract() -> None:
    bench = Bench()
    kept: Link = bench.link
    bench.sleep(2.0)
    assert kept.uri == "crsf:///dev/module"
    assert (kept.status().version, kept.status().state) == ("Bench TX 3.5.2", "locked")
    assert bench.module.pings == 1


def test_without_arming_only_zero_is_sent() -> None:
    bench = Bench()
    assert bench.fly(1.0) == Command()
    assert {(values[2], max(values[4:])) for _, values in bench.module.heard} == {(LOW, LOW)}


def test_armed_it_sends_what_it_says_at_its_rate() -> None:
    bench = flying("?rate=250")
    begin = bench.module.now
    sent = bench.fly(1.0)
    assert bench.link.status().state == "armed"
    assert bench.since(begin)[-1][1] == channels(HOVER, True, 5)
    assert sent.throttle == pytest.approx(0.5, abs=1e-3)
    assert sent.roll == pytest.approx(0.1, abs=1e-3)
    assert len(bench.since(begin)) == pytest.approx(250, rel=0.03)


def test_the_rate_is_the_module_s() -> None:
    bench = Bench(interval=0.02)
    bench.fly(1.0)
    begin = bench.module.now
    bench.fly(2.0)
    assert len(bench.since(begin)) == pytest.approx(100, abs=3)
    assert bench.link.module.timer.period == pytest.approx(0.02)


def test_arming_begins_with_the_switch_low_and_the_throttle_zero() -> None:
    bench = Bench()
    bench.link.arm()
    switch = [values[4] for _, values in bench.module.heard]
    first = switch.index(HIGH)
    assert set(switch[:first]) == {LOW}
    assert bench.module.heard[first][0] - bench.module.heard[0][0] > 0.29
    assert {values[2] for _, values in bench.module.heard} == {LOW}


def test_the_switch_is_low_for_a_while_where_nothing_says_what_became_of_it() -> None:
    bench = Bench(says_mode=False)
    bench.sleep(1.0)
    begin = bench.module.now
    bench.link.arm()
    assert next(now for now, values in bench.module.heard if values[4] == HIGH) - begin > 0.29


def test_sticks_turn_the_right_way() -> None:
    values = channels(Command(roll=1.0, pitch=-1.0, yaw=0.5, throttle=1.0), True, 5)
    assert values[:5] == [HIGH, 173, HIGH, 1402, HIGH]
    assert channels(Command(throttle=1.0), False, 5)[2:5] == [LOW, 992, LOW]


def test_another_channel_arms() -> None:
    bench = Bench("?arm_channel=8", arm_channel=8)
    bench.link.arm()
    assert bench.module.armed
    assert bench.module.heard[-1][1][4:9] == [LOW, LOW, LOW, HIGH, LOW]


def test_the_module_is_told_its_receiver_if_one_is_named() -> None:
    bench = Bench("?receiver=7")
    bench.sleep(1.5)
    assert bench.module.receiver == 7
    other = Bench()
    other.sleep(1.5)
    assert other.module.receiver == -1


def test_telemetry_is_read() -> None:
    bench = flying()
    news = bench.link.news
    assert news.battery is not None
    assert news.attitude is not None
    assert news.link is not None
    assert news.mode is not None
    assert (news.battery.voltage, news.battery.left, news.link.quality, news.mode.text) == (3.8, 0.8, 100, "ANGL")
    assert news.attitude.yaw == pytest.approx(1.5708)
    assert news.age < 0.6


# ---- the caller falls silent ----


def test_a_silent_caller_is_held_then_stopped_then_nothing_is_sent() -> None:
    bench = flying()
    begin = bench.module.now
    bench.sleep(2.0)
    frames = [(now - begin, values) for now, values in bench.since(begin)]
    neutral = [now for now, values in frames if values[:2] == [992, 992] and values[4] == HIGH]
    assert neutral[0] == pytest.approx(0.1 - 0.033, abs=0.04)
    assert {values[2] for now, values in frames if values[4] == HIGH} == {channels(HOVER, True, 5)[2]}
    low = [now for now, values in frames if values[4] == LOW]
    assert low[0] == pytest.approx(0.24 - 0.033, abs=0.04)
    assert low[-1] - low[0] == pytest.approx(0.5, abs=0.02)
    assert frames[-1][1][2] == LOW
    assert max(now for now, _ in frames) < 0.8
    assert not bench.module.armed


def test_after_a_silence_only_arming_helps() -> None:
    bench = flying()
    bench.sleep(1.5)
    assert bench.link.status().state == "failsafe"
    assert bench.link.status().refusal == "no command came for 0.24 s, so the motors were stopped"
    assert bench.fly(1.0) == Command()
    assert not bench.module.armed
    bench.link.arm()
    bench.fly(0.5)
    assert bench.module.armed
    assert bench.link.status().state == "armed"


def test_a_short_pause_of_the_caller_is_no_silence() -> None:
    bench = flying()
    for _ in range(10):
        bench.sleep(0.2)
        assert bench.link.status().state == "holding"
        bench.link.send(HOVER)
        bench.sleep(0.02)
        assert bench.link.status().state == "armed"
    assert bench.module.armed


def test_a_caller_that_has_not_armed_may_be_silent_for_ever() -> None:
    bench = Bench()
    bench.sleep(5.0)
    assert bench.link.status().state == "locked"
    assert bench.module.now - bench.module.heard[-1][0] < 0.01


# ---- ends of a flight ----


def test_landing_lowers_the_throttle_then_disarms() -> None:
    bench = flying()
    begin = bench.module.now
    with bench.link:
        pass
    frames = bench.since(begin)
    up = [values[2] for _, values in frames if values[4] == HIGH]
    assert sorted(up, reverse=True) == up
    assert len(set(up)) > 30
    assert {tuple(values[:2]) for now, values in frames if now > begin + 0.05} == {(992, 992)}
    assert next(now for now, values in frames if values[4] == LOW) - begin == pytest.approx(1.5, abs=0.05)
    assert not bench.module.armed
    assert bench.module.closed


def test_an_error_in_the_block_lands_too() -> None:
    bench = flying()

    def fail() -> None:
        with bench.link:
            raise RuntimeError("somebody's")

    with pytest.raises(RuntimeError, match="somebody's"):
        fail()
    assert not bench.module.armed
    assert bench.module.closed


def test_a_cut_is_one_frame_and_lasts_until_it_is_armed_again() -> None:
    bench = flying()
    count = len(bench.module.heard)
    bench.link.cut()
    assert bench.module.heard[count][1][4] == LOW
    assert not bench.module.armed
    assert bench.link.status().state == "locked"
    assert bench.fly(0.5) == Command()
    assert {values[4] for _, values in bench.module.heard[count:]} == {LOW}
    bench.link.arm()
    assert bench.module.armed


def test_a_flight_controller_that_disarms_ends_the_flight() -> None:
    bench = flying()
    bench.module.armed, bench.module.stubborn = False, True
    bench.fly(1.5)
    assert bench.link.status().state == "locked"
    assert bench.link.status().refusal == "the flight controller disarmed: its mode is 'ANGL*'"
    assert bench.fly(0.1) == Command()


def test_one_message_alone_ends_no_flight() -> None:
    bench = flying()
    bench.module.armed = False  # and arms again: only one message is wrong
    bench.module._may_arm = True
    bench.fly(2.0, Command(throttle=0.0))
    assert bench.link.status().state == "armed"


def test_a_receiver_in_failsafe_is_said() -> None:
    bench = flying()
    bench.module.mode = "!FS!"
    bench.fly(1.5)
    assert bench.link.status().state == "failsafe"
    assert "the receiver hears nothing" in bench.link.status().refusal


# ---- what cannot be armed ----


def arming_fails(bench: Bench, match: str) -> None:
    with pytest.raises(LinkError, match=match):
        bench.link.arm()
    assert not bench.module.armed
    bench.sleep(0.1)
    assert bench.module.heard[-1][1][4] == LOW


def test_a_refusal_of_the_flight_controller_is_passed_on() -> None:
    arming_fails(Bench(refuses=True), "the flight controller refuses, its mode is 'ANGL!'")


def test_one_that_does_not_arm_is_said() -> None:
    arming_fails(Bench(stubborn=True), r"it did not arm; its mode is 'ANGL\*'")


def test_sticks_that_command_rates_are_refused() -> None:
    arming_fails(Bench(mode="ACRO"), "sticks command rates")


def test_no_vehicle_is_said() -> None:
    arming_fails(Bench(vehicle=False), "no vehicle answers")


def test_a_vehicle_that_is_armed_by_another_is_not_flown() -> None:
    class Elsewhere(Module):
        def _channels(self, values: list[int]) -> None:
            super()._channels(values)
            self.armed = True

    module = Elsewhere(armed=True)

    def sleep(seconds: float) -> None:
        module.now += seconds

    link = CrsfLink("crsf:///dev/module", module, module, sleep, threaded=False)
    with pytest.raises(LinkError, match="by another transmitter, or another arm channel"):
        link.arm()
    assert {values[4] for _, values in module.heard} == {LOW}


def test_leaving_the_block_while_it_arms_sends_that_the_switch_is_low() -> None:
    bench = Bench(stubborn=True)

    def leave(seconds: float) -> None:
        bench.sleep(seconds)
        if bench.module.heard[-1][1][4] == HIGH:
            bench.link._sleep = bench.sleep
            raise KeyboardInterrupt

    bench.link._sleep = leave
    with pytest.raises(KeyboardInterrupt), bench.link:
        bench.link.arm()
    low = [now for now, values in bench.module.heard if values[4] == LOW and now > bench.module.now - 0.5]
    assert len(low) > 100


def test_without_messages_of_the_mode_it_is_armed_blindly() -> None:
    bench = Bench(says_mode=False)
    bench.link.arm()
    bench.fly(0.5)
    assert bench.module.armed
    bench.link.close()
    assert not bench.module.armed


def test_a_receiver_without_telemetry_flies_only_where_that_was_asked_for() -> None:
    arming_fails(Bench(telemetry=False), "no vehicle answers")
    bench = Bench("?vehicle_timeout=inf", telemetry=False)
    bench.link.arm()
    bench.fly(3.0)
    assert bench.module.armed


def test_a_cut_while_it_arms_ends_that() -> None:
    bench = Bench(stubborn=True)
    looks = []

    def cut_later(seconds: float) -> None:
        bench.sleep(seconds)
        looks.append(bench.module.now)
        if bench.module.heard[-1][1][4] == HIGH:
            bench.link.cut()

    bench.link._sleep = cut_later
    with pytest.raises(LinkError, match="stopped while it was armed"):
        bench.link.arm()
    assert bench.module.heard[-1][1][4] == LOW


# ---- faults ----


def test_nobody_answers() -> None:
    with pytest.raises(LinkError, match=r"no module answers \(waited 9 s\)$"):
        Bench(mute=True)


def test_garbage_is_counted_and_said() -> None:
    with pytest.raises(
        LinkError, match=r"no module answers .*; \d{4} bytes came that are no frames: another baud rate"
    ):
        Bench(mute=True, garbage=bytes((0x55, 0x11, 0xF3)))


def test_own_frames_that_come_back_are_no_module() -> None:
    class Wire(Module):
        def write(self, data: bytes) -> None:
            self._out += data

        def _speak(self) -> None:
            pass

    wire = Wire()

    def sleep(seconds: float) -> None:
        wire.now += seconds

    with pytest.raises(LinkError, match="own frames come back"):
        CrsfLink("crsf:///dev/module", wire, wire, sleep, threaded=False)
    assert wire.closed


def test_a_port_that_vanishes_is_said_at_the_next_command() -> None:
    bench = flying()
    bench.module.unplugged = True
    bench.sleep(0.01)
    with pytest.raises(LinkError, match=r"has gone \(unplugged\?\)"):
        bench.link.send(HOVER)
    with pytest.raises(LinkError, match="has gone"):
        bench.link.status()
    bench.link.close()
    assert bench.module.closed


def test_a_port_that_vanishes_within_the_block_ends_it_at_once() -> None:
    bench = flying()

    def fly() -> None:
        with bench.link:
            bench.module.unplugged = True
            bench.fly(1.0)

    begin = bench.module.now
    with pytest.raises(LinkError, match="has gone"):
        fly()
    assert bench.module.now - begin < 0.2


def test_a_module_that_falls_silent_breaks_the_link_but_is_sent_a_landing() -> None:
    bench = flying()

    def fly() -> None:
        with bench.link:
            bench.module.mute = True
            bench.fly(3.0)

    with pytest.raises(LinkError, match=r"silent for 1\.\d s"):
        fly()
    assert not bench.module.armed
    assert bench.module.heard[-1][1][4] == LOW


def test_telemetry_that_stops_breaks_the_link_which_lands() -> None:
    bench = flying()

    def fly() -> None:
        with bench.link:
            bench.module.telemetry = False
            bench.fly(5.0)

    with pytest.raises(LinkError, match=r"nothing has been heard of the vehicle for 2\.\d s"):
        fly()
    assert not bench.module.armed
    assert bench.module.heard[-2][1][4] == LOW


def test_a_module_that_alone_speaks_is_no_vehicle() -> None:
    bench = flying()
    bench.module.telemetry = False
    bench.module.garbage = link_statistics(quality=0)
    with pytest.raises(LinkError, match="nothing has been heard of the vehicle"):
        bench.fly(5.0)


def test_poor_quality_and_a_refusal_are_warnings() -> None:
    bench = Bench(refuses=True)
    bench.sleep(1.0)
    assert bench.link.status().warnings == ("the flight controller refuses to be armed: ANGL!",)


@settings(max_examples=60)
@given(st.lists(st.binary(max_size=40), max_size=30))
def test_no_noise_turns_a_motor_or_breaks_a_link(noise: list[bytes]) -> None:
    bench = Bench()
    for each in noise:
        bench.module.garbage = each
        bench.sleep(0.02)
        bench.module.garbage = b""
        bench.link.send(HOVER)
    assert {(values[2], values[4]) for _, values in bench.module.heard} == {(LOW, LOW)}
    assert bench.link.status().state in ("locked", "failsafe")


# ---- the name of a link ----


def test_a_uri_names_port_and_parameters() -> None:
    path, parameters = parse_uri("crsf:///dev/ttyUSB0?baud=400000&arm_channel=7&vehicle_timeout=inf")
    assert path == "/dev/ttyUSB0"
    assert (parameters.baud, parameters.arm_channel, parameters.vehicle_timeout) == (400_000, 7, float("inf"))
    assert parse_uri("crsf://COM3") == ("COM3", CrsfParameters())


@pytest.mark.parametrize(
    ("uri", "match"),
    [
        ("crsf://", "crsf:///dev/ttyUSB0"),
        ("crsf://?baud=400000", "crsf:///dev/ttyUSB0"),
        ("serial:///dev/ttyUSB0", "crsf:///dev/ttyUSB0"),
        ("crsf:///dev/x?speed=1", "speed"),
        ("crsf:///dev/x?baud=fast", "baud"),
        ("crsf:///dev/x?baud=300", "baud must be within"),
        ("crsf:///dev/x?arm_channel=4", "arm_channel must be within"),
        ("crsf:///dev/x?arm_channel=17", "arm_channel must be within"),
        ("crsf:///dev/x?rate=0", "rate must be within"),
        ("crsf:///dev/x?receiver=64", "receiver must be within"),
        ("crsf:///dev/x?hold_after=0", "hold_after must be positive"),
        ("crsf:///dev/x?hold_after=nan", "hold_after must be positive"),
        ("crsf:///dev/x?cut_after=0.05", "cut_after must be more than hold_after"),
        ("crsf:///dev/x?vehicle_timeout=0.1", "vehicle_timeout must be more"),
        ("crsf:///dev/x?arm_timeout=0.1", "arm_timeout must be more"),
        ("crsf:///dev/x?baud", "baud"),
    ],
)
def test_what_a_uri_gets_wrong_is_said(uri: str, match: str) -> None:
    with pytest.raises(ValueError, match=match):
        parse_uri(uri)


def test_connect_opens_it() -> None:
    with pytest.raises(LinkError, match="cannot open /nonexistent: No such file"):
        connect("crsf:///nonexistent")


def test_sticks_are_shown_with_the_arm_switch_low_and_the_throttle_zero() -> None:
    bench = Bench()
    bench.sleep(1.0)
    begin = bench.module.now
    bench.link.send_disarmed(Command(roll=0.3, throttle=0.7))
    bench.sleep(0.1)
    shown = bench.since(begin)[-1][1]
    assert shown[0] > 992
    assert (shown[2], shown[4]) == (LOW, LOW)
    assert not bench.module.armed
    bench.fly(0.1)
    assert bench.module.heard[-1][1][0] == 992


def test_sticks_are_not_shown_to_one_that_is_armed() -> None:
    bench = flying()
    with pytest.raises(ValueError, match="it is armed"):
        bench.link.send_disarmed(Command(roll=0.3))
    other = Bench(armed=True, stubborn=True)
    other.module._channels = lambda values: None  # type: ignore[method-assign]  # noqa: ARG005
    other.module.pass_time = lambda: None  # type: ignore[method-assign]
    other.sleep(1.0)
    with pytest.raises(LinkError, match="by another transmitter"):
        other.link.send_disarmed(Command(roll=0.3))
