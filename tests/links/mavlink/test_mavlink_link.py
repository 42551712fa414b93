"""The link with an autopilot: arming, refusals, modes, silence, landing, and whom it leaves alone."""

import copy
from typing import Any

import pytest
from fake_autopilot import FORCE, LOITER, PX4, RTL, STABILIZE, FakeAutopilot, Together
from fakes import Clock

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.mavlink.mavlink_link import MavlinkLink
from matchset.links.mavlink.packet import PacketWriter

URI = "mavlink:udpin:0.0.0.0:14550"
FLIGHT = Command(roll=0.1, pitch=-0.2, yaw=0.3, throttle=0.57)


def opened(pilot: Any = None, uri: str = URI) -> tuple[MavlinkLink, FakeAutopilot]:
    pilot = pilot or FakeAutopilot()
    clock = pilot.members[0].clock if isinstance(pilot, Together) else pilot.clock
    return MavlinkLink(uri, pilot, clock=clock, sleep=clock.sleep), pilot


def armed(**facts: Any) -> tuple[MavlinkLink, FakeAutopilot]:
    link, pilot = opened(FakeAutopilot(**facts))
    link.arm()
    return link, pilot


def fly(link: MavlinkLink, pilot: FakeAutopilot, seconds: float, command: Command = FLIGHT) -> Command:
    end = pilot.clock() + seconds
    sent = Command()
    while pilot.clock() < end:
        sent = link.send(command)
        pilot.clock.sleep(0.033)
    return sent


def test_it_takes_the_mode_and_arms_with_neutral_sticks() -> None:
    link, pilot = armed()
    assert (pilot.mode, pilot.armed) == (STABILIZE, True)
    assert link.status().state == "armed"
    assert link.status().version == "ArduPilot, vehicle 1"
    assert len(pilot.sticks) > 10
    assert set(pilot.sticks) == {(0, 0, 0, 0)}


def test_sticks_go_where_they_belong() -> None:
    link, pilot = armed()
    assert link.send(FLIGHT) == Command(0.1, -0.2, 0.3, 0.57)
    assert pilot.sticks[-1] == (-200, 100, 570, 300)  # x forward, y right, z throttle, r clockwise
    assert link.send(Command(throttle=0.12345)).throttle == 0.123


def test_px4_takes_its_own_mode() -> None:
    _, pilot = armed(autopilot=PX4, mode=3 << 16)
    assert pilot.mode == 7 << 16


def test_another_mode_can_be_asked_for() -> None:
    link, pilot = opened(uri=URI + "?mode=2")
    link.arm()
    assert pilot.mode == 2
    fly(link, pilot, 2.0)
    assert link.status().state == "armed"


def test_a_refusal_to_arm_is_passed_on_with_its_reason() -> None:
    link, pilot = opened(FakeAutopilot(refusal="PreArm: Battery 1 below minimum arming voltage"))
    with pytest.raises(LinkError, match=r"arming refused by ArduPilot \(failed\): PreArm: Battery 1 below minimum"):
        link.arm()
    sticks = len(pilot.sticks)
    assert link.send(FLIGHT) == Command()
    assert len(pilot.sticks) == sticks
    assert link.status().state == "locked"
    pilot.refusal = ""
    link.arm()
    assert link.send(FLIGHT).throttle == 0.57


def test_a_reason_in_pieces_is_put_together() -> None:
    link, pilot = opened()
    words = "PreArm: the compass is inconsistent with the others, turn the vehicle or calibrate it anew"
    pilot.say("STATUSTEXT", severity=3, text=words[:50], id=7, chunk_seq=0)
    pilot.say("STATUSTEXT", severity=3, text=words[50:], id=7, chunk_seq=1)
    assert link.status().warnings == (words,)


def test_a_piece_that_got_lost_is_shown_as_dots() -> None:
    link, pilot = opened()
    pilot.say("STATUSTEXT", severity=3, text="a" * 50, id=7, chunk_seq=0)
    pilot.say("STATUSTEXT", severity=3, text="end", id=7, chunk_seq=2)
    assert link.status().warnings == ("a" * 50 + " ... end",)


@pytest.mark.parametrize(("fact", "words"), [("deaf", "it does not answer"), ("stubborn", "accepted, but not done")])
def test_an_autopilot_that_does_nothing_is_an_error(fact: str, words: str) -> None:
    link, pilot = opened()
    setattr(pilot, fact, True)
    with pytest.raises(LinkError, match=f"the mode Stabilize refused by ArduPilot .{words}"):
        link.arm()
    assert not pilot.armed
    assert link.send(FLIGHT) == Command()


def test_one_that_arms_without_a_word_is_disarmed_again() -> None:
    link, pilot = opened(FakeAutopilot(mode=STABILIZE))
    pilot._do = lambda command, *_: setattr(pilot, "armed", True) if command == 400 else None  # type: ignore[method-assign]
    with pytest.raises(LinkError, match="does not answer"):
        link.arm()
    assert pilot.asked[-1] == (400, (0.0,) * 7)


def test_a_vehicle_that_somebody_else_flies_is_left_alone() -> None:
    link, pilot = opened(FakeAutopilot(armed=True, mode=LOITER))
    with pytest.raises(LinkError, match="armed already: somebody else flies it"):
        link.arm()
    assert link.send(FLIGHT) == Command()
    assert "somebody else has armed it" in link.status().warnings
    link.cut()
    fly(link, pilot, 1.5)
    link.land()
    link.close()
    assert pilot.armed
    assert pilot.sticks == []
    assert all(command not in (400, 176) for command, _ in pilot.asked)


def test_when_the_autopilot_takes_over_it_is_left_to_it() -> None:
    link, pilot = armed()
    fly(link, pilot, 1.0)
    pilot.say_text("Battery failsafe", 3)
    pilot.mode = RTL
    fly(link, pilot, 1.2)
    status, sticks = link.status(), len(pilot.sticks)
    assert status.state == "failsafe"
    assert status.refusal == "ArduPilot is in RTL, by itself or by another pilot's switch; Battery failsafe"
    assert fly(link, pilot, 1.0) == Command()
    link.close()
    assert len(pilot.sticks) == sticks
    assert pilot.armed


@pytest.mark.parametrize("landed_first", [False, True])
def test_but_the_motors_can_still_be_stopped(landed_first: bool) -> None:
    link, pilot = armed(flying=True)
    pilot.mode = RTL
    fly(link, pilot, 1.2)
    if landed_first:
        link.land()
    assert pilot.armed
    link.cut()
    assert not pilot.armed


def test_a_disarmed_vehicle_is_not_flown_until_it_is_armed_again() -> None:
    link, pilot = armed()
    fly(link, pilot, 0.5)
    pilot.say_text("Crash: Disarming", 0)
    pilot.armed = False
    assert fly(link, pilot, 1.2) == Command()
    assert link.status().refusal == "ArduPilot disarmed; Crash: Disarming"
    pilot.armed = True  # somebody else arms it
    assert fly(link, pilot, 1.2) == Command()
    pilot.armed = False
    fly(link, pilot, 1.2)
    link.arm()
    assert fly(link, pilot, 0.1).throttle == 0.57


def test_landing_is_a_ramp_then_it_disarms() -> None:
    link, pilot = armed()
    fly(link, pilot, 0.5)
    before = len(pilot.sticks)
    link.land(1.0)
    throttles = [z for _, _, z, _ in pilot.sticks[before:]]
    assert throttles == sorted(throttles, reverse=True)
    assert len(set(throttles)) > 10
    assert throttles[0] > 500
    assert throttles[-1] == 0
    assert {(x, y, r) for x, y, _, r in pilot.sticks[before:]} == {(0, 0, 0)}
    assert not pilot.armed
    assert pilot.asked[-1] == (400, (0.0,) * 7)
    assert link.status().state == "locked"


def test_an_autopilot_that_believes_it_flies_is_disarmed_by_force_at_last() -> None:
    link, pilot = armed(flying=True)
    fly(link, pilot, 0.5)
    start = pilot.clock()
    link.land(1.0)
    assert not pilot.armed
    assert pilot.clock() - start < 5.0
    assert pilot.asked[-1][1][:2] == (0.0, FORCE)


def test_landing_at_once_is_by_force() -> None:
    link, pilot = armed(flying=True)
    link.land(0)
    assert not pilot.armed


def test_one_that_cannot_be_disarmed_is_an_error() -> None:
    link, pilot = armed()
    pilot.stubborn = True
    with pytest.raises(LinkError, match="it did not disarm"):
        link.land(0)


def test_a_cut_is_one_message_and_is_repeated_until_it_works() -> None:
    link, pilot = armed(flying=True)
    fly(link, pilot, 0.5)
    asked = len(pilot.asked)
    pilot.stubborn = True
    link.cut()
    assert pilot.asked[asked:] == [(400, (0.0, FORCE, 0.0, 0.0, 0.0, 0.0, 0.0))]
    assert fly(link, pilot, 0.5) == Command()
    assert len(pilot.asked) > asked + 5
    assert link.status().state == "failsafe"
    pilot.stubborn = False
    fly(link, pilot, 1.5)
    assert not pilot.armed
    assert link.status().state == "locked"
    asked = len(pilot.asked)
    fly(link, pilot, 1.0)
    assert len(pilot.asked) == asked


def test_a_cut_while_it_is_being_armed_ends_that() -> None:
    link, pilot = opened()
    pilot.clock.sleep = lambda seconds: (setattr(pilot.clock, "now", pilot.clock.now + seconds), link.cut())[0]  # type: ignore[method-assign,func-returns-value]
    link._sleep = pilot.clock.sleep
    link.client._sleep = pilot.clock.sleep
    with pytest.raises(LinkError, match="stopped while it was being armed"):
        link.arm()
    assert not pilot.armed


@pytest.mark.parametrize("closed", [False, True])
def test_a_cut_while_it_is_being_armed_is_repeated_where_it_gets_lost(closed: bool) -> None:
    link, pilot = opened()
    pass_time = pilot.clock.sleep

    def lose_what_follows_arming(seconds: float) -> None:
        pass_time(seconds)
        if pilot.armed and not pilot.deaf:
            pilot.deaf = True
            link.cut()

    link._sleep = link.client._sleep = lose_what_follows_arming
    with pytest.raises(LinkError, match="stopped while it was being armed"):
        link.arm()
    assert pilot.armed
    pilot.deaf, link._sleep = False, pass_time
    if closed:
        link.close()
    else:
        fly(link, pilot, 0.1)
    assert not pilot.armed


def test_one_that_is_asked_for_its_state_while_it_arms_stays_ours() -> None:
    link, pilot = opened()
    pass_time = pilot.clock.sleep
    link._sleep = link.client._sleep = lambda seconds: (pass_time(seconds), link.status())[0]
    link.arm()
    link.cut()
    assert not pilot.armed


def test_a_vehicle_in_another_mode_gets_no_sticks_when_it_is_disarmed() -> None:
    link, pilot = armed(flying=True)
    pilot.mode = RTL
    fly(link, pilot, 1.2)
    pilot.deaf = True
    link.cut()
    pilot.deaf, sticks = False, len(pilot.sticks)
    link.land()
    assert not pilot.armed
    assert len(pilot.sticks) == sticks


def test_another_part_of_the_vehicle_does_not_speak_for_it() -> None:
    link, pilot = armed()
    heart = {"type": pilot.kind, "autopilot": pilot.autopilot, "base_mode": 1, "custom_mode": RTL, "mavlink_version": 3}
    pilot._out += PacketWriter(pilot.system, 7).write("HEARTBEAT", heart)
    assert link.send(FLIGHT).throttle == 0.57
    assert link.status().state == "armed"


def test_an_answer_to_an_earlier_question_is_none() -> None:
    link, pilot = armed()
    link.land()
    pilot.deaf = True
    with pytest.raises(LinkError, match=r"arming refused by ArduPilot .it does not answer"):
        link.arm()


def test_silence_breaks_the_link_in_two_and_a_half_seconds() -> None:
    link, pilot = armed()
    pilot.mute = True
    start = pilot.clock()
    with pytest.raises(LinkError, match=r"vehicle 1 has been silent for 2\.5 s"):
        fly(link, pilot, 5.0)
    assert 2.4 < pilot.clock() - start < 2.7
    link.close()
    assert pilot.closed


def test_attitudes_that_stop_are_said() -> None:
    link, pilot = armed()
    fly(link, pilot, 0.5)
    assert link.status().warnings == ()
    pilot.attitudes = False
    fly(link, pilot, 1.5)
    (warning,) = link.status().warnings
    assert warning.startswith("no attitude for 1.")


@pytest.mark.parametrize(
    ("autopilot", "settings", "words"),
    [
        (3, {"RC_OVERRIDE_TIME": 3.0}, ["RC_OVERRIDE_TIME is 3: when sticks stop it flies on"]),
        (3, {"RC_OVERRIDE_TIME": -1.0}, ["RC_OVERRIDE_TIME is -1: "]),
        (3, {"FS_THR_ENABLE": 0, "FS_GCS_ENABLE": 0}, ["FS_THR_ENABLE is 0: it does nothing", "FS_GCS_ENABLE is 0: "]),
        (PX4, {"NAV_RCL_ACT": 0, "COM_RC_LOSS_T": 5.0}, ["COM_RC_LOSS_T is 5: ", "NAV_RCL_ACT is 0: it does nothing"]),
        (PX4, {"NAV_RCL_ACT": 3, "COM_RC_LOSS_T": 0.5}, []),
        (3, {}, []),
    ],
)
def test_a_failsafe_that_is_off_is_said(autopilot: int, settings: dict[str, float], words: list[str]) -> None:
    pilot = FakeAutopilot(autopilot=autopilot)
    pilot.settings |= settings
    link, _ = opened(pilot)
    warnings = link.status().warnings
    assert len(warnings) == len(words)
    assert all(warning.startswith(word) for warning, word in zip(warnings, words, strict=True))
    if words:
        pilot.settings.clear()
        pilot.settings |= dict.fromkeys(link.client.telemetry.settings, 1)
        link.arm()
        assert link.status().warnings == ()


def test_battery_and_health_are_said() -> None:
    link, pilot = armed()
    pilot.say("SYS_STATUS", voltage_battery=3512, battery_remaining=55)
    link.status()
    told = link.client.telemetry
    assert (told.voltage, told.charge, link.status().warnings) == (3.512, 0.55, ())
    pilot.say("BATTERY_STATUS", battery_remaining=14)
    assert link.status().warnings == ("battery low: 14 %",)
    pilot.say("BATTERY_STATUS", battery_remaining=9, charge_state=3)
    assert link.status().warnings == ("battery critical: 9 %",)
    pilot.say("HEARTBEAT", type=2, autopilot=3, base_mode=129, system_status=5)
    assert "the autopilot's state is critical" in link.status().warnings


def test_a_battery_that_is_not_measured_is_not_low() -> None:
    link, pilot = opened()
    pilot.say("SYS_STATUS", voltage_battery=65535, battery_remaining=-1)
    pilot.say("BATTERY_STATUS", id=1, battery_remaining=1)  # another battery
    assert link.status().warnings == ()
    assert link.client.telemetry.voltage is None


@pytest.mark.parametrize("moment", ["send", "status", "arm", "land"])
def test_a_port_that_is_gone_is_said(moment: str) -> None:
    link, pilot = armed()
    pilot.unplugged = True
    actions = {"send": lambda: link.send(FLIGHT), "status": link.status, "arm": link.arm, "land": link.land}
    with pytest.raises(LinkError, match=r"has gone \(unplugged, network down\?\): No such device"):
        actions[moment]()
    link.cut()
    link.close()
    assert pilot.closed


def test_heartbeats_leave_once_a_second_and_clocks_are_compared() -> None:
    link, pilot = opened()
    pilot.heard.clear()
    fly(link, pilot, 10.0)
    assert pilot.heard.count("HEARTBEAT") == pytest.approx(10, abs=1)
    assert link.client.clock_offset == pytest.approx(1000.0, abs=0.04)
    assert link.client.round_trip is not None
    assert 0.0 <= link.client.round_trip < 0.05
    known = link.client.clock_offset
    link.client.receive()
    for pause in (1.1, 0.8):  # an answer that comes late tells less
        pilot.clock.sleep(pause)
        link.client.receive()
    assert link.client.round_trip == pytest.approx(0.8)
    assert link.client.clock_offset == known


def test_the_autopilot_s_questions_for_the_clock_are_answered() -> None:
    link, pilot = opened()
    pilot.say("TIMESYNC", tc1=0, ts1=123456789)
    pilot.heard.clear()
    link.status()
    assert "TIMESYNC" in pilot.heard


def test_lost_packets_are_counted() -> None:
    link, pilot = opened()
    before = link.status().errors
    pilot._writer.write("HEARTBEAT", {})
    pilot._writer.write("HEARTBEAT", {})
    pilot.beat()
    assert link.status().errors == before + 2


def both(**facts: Any) -> Together:
    clock = Clock()
    return Together((FakeAutopilot(clock), FakeAutopilot(clock, sender="10.0.0.3:14550", **facts)))


def test_of_two_vehicles_the_one_that_is_meant_is_flown() -> None:
    with pytest.raises(LinkError, match=r"several vehicles are heard: 1 at 10.0.0.2:14550, 2 at .*say which"):
        opened(both(system=2))
    pair = both(system=2)
    link, _ = opened(pair, URI + "?vehicle=2")
    link.arm()
    link.send(FLIGHT)
    assert (pair.members[0].armed, pair.members[0].sticks) == (False, [])
    assert pair.members[1].armed


def test_two_vehicles_of_one_number_are_refused() -> None:
    with pytest.raises(LinkError, match=r"several vehicles have the number 1: .*give each one of its own"):
        opened(both(system=1), URI + "?vehicle=1")


def test_a_vehicle_that_is_not_heard_is_said() -> None:
    with pytest.raises(LinkError, match=r"vehicle 9 is not heard, only 1 at 10"):
        opened(uri=URI + "?vehicle=9")


def test_commands_meant_for_another_station_are_not_taken_for_ours() -> None:
    link, pilot = opened()
    pilot.say("COMMAND_ACK", command=400, result=4, target_system=254)
    link.status()
    assert 400 not in link.client.telemetry.acks


def station(pilot: FakeAutopilot, system: int) -> None:
    pilot._out += PacketWriter(system, 190).write("HEARTBEAT", {"type": 6, "autopilot": 8, "mavlink_version": 3})


def test_another_ground_station_is_said_and_one_of_our_number_is_refused() -> None:
    pilot = FakeAutopilot()
    station(pilot, 254)
    link, _ = opened(pilot)
    assert link.status().warnings == ("other ground stations are connected: 254 (this one is 255)",)
    pilot = FakeAutopilot()
    station(pilot, 255)
    with pytest.raises(LinkError, match="another ground station has the number 255"):
        opened(pilot)


@pytest.mark.parametrize(
    ("facts", "words"),
    [
        ({"kind": 10}, "vehicle 1 is no multicopter .type 10"),
        ({"autopilot": 0}, "autopilot 0 is neither ArduPilot nor PX4"),
        ({"mute": True}, "no autopilot is heard .waited 5 s"),
        ({"unplugged": True}, "has gone"),
    ],
)
def test_what_is_no_autopilot_for_sticks_is_said_and_the_port_closed(facts: dict[str, Any], words: str) -> None:
    pilot = FakeAutopilot(**facts)
    with pytest.raises(LinkError, match=words):
        opened(pilot)
    assert pilot.closed


def test_an_unknown_autopilot_flies_in_the_mode_that_is_named() -> None:
    link, pilot = opened(FakeAutopilot(autopilot=0, mode=4), URI + "?mode=4")
    link.arm()
    assert pilot.armed


class Chatter(FakeAutopilot):
    """Something else on the line."""

    def read(self) -> list[tuple[str, bytes]]:
        return [(self.sender, self.said)]

    said = b"$GPGGA,123519,4807.038,N\r\n"


def test_garbage_is_said() -> None:
    with pytest.raises(LinkError, match="bytes come, but no heartbeat: wrong baud rate"):
        opened(Chatter())


def test_the_old_version_is_said() -> None:
    old = Chatter()
    old.said = bytes.fromhex("fe0900010100000000000203510403") + b""
    from matchset.links.mavlink.checksum import accumulate

    old.said += accumulate(b"\x32", accumulate(old.said[1:])).to_bytes(2, "little")
    with pytest.raises(LinkError, match="it speaks MAVLink 1: switch it"):
        opened(old)


def test_signed_messages_are_said() -> None:
    signing = Chatter()
    plain = PacketWriter(1, 1).write("HEARTBEAT", {"type": 2, "autopilot": 3})
    from matchset.links.mavlink.checksum import accumulate

    body = plain[1:2] + b"\x01" + plain[3:-2]
    signing.said = b"\xfd" + body + accumulate(b"\x32", accumulate(body)).to_bytes(2, "little") + bytes(13)
    with pytest.raises(LinkError, match="it signs its messages, which is not supported"):
        opened(signing)


def test_the_block_lands() -> None:
    link, pilot = armed()
    fly(link, pilot, 0.5)
    with pytest.raises(RuntimeError), link:
        raise RuntimeError
    assert not pilot.armed
    assert pilot.closed
    link.close()


def test_it_is_not_copied() -> None:
    link, _ = opened()
    with pytest.raises(TypeError, match="one program flies a vehicle"):
        copy.copy(link)
