"""Two emulators and a build for this computer put the same packets on the air, one by one."""

import random

from nrf24 import Nrf24
from sessions import Session, in_avr8js, in_simavr, on_host, slot
from syma import BIND_ADDRESS

from flight import FULL, frame
from matchset.control.command import Command
from matchset.links.arduino.messages import STATUS, Config, bind_frame, read_config_frame, write_config_frame
from matchset.links.crsf_frame import CrsfParser

END = 720  # slots, 2.9 s


def session() -> Session:
    """Binding; arming; a flight with noise in it; a failsafe; a new id; binding again."""
    chance = random.Random(42)
    events = [(slot(4), read_config_frame())]
    events += [(slot(360 + 8 * turn), frame(Command(), armed=False)) for turn in range(4)]
    events += [(slot(392 + 8 * turn), frame(Command())) for turn in range(2)]
    for turn in range(10):
        roll, pitch, yaw = (chance.uniform(-1, 1) for _ in range(3))
        events.append((slot(408 + 8 * turn), frame(Command(roll, pitch, yaw, chance.random()))))
    events.append((slot(488), bytes(chance.randrange(256) for _ in range(20))))
    broken = bytearray(frame())
    broken[9] ^= 4
    events += [(slot(496), bytes(broken)), (slot(504), frame(FULL))]
    events += [(slot(600), frame(FULL))]  # after the failsafe: in vain
    events += [(slot(608, 2100), write_config_frame(Config(id=bytes.fromhex("9a01020304"), reversed=("yaw",))))]
    events += [(slot(616 + 8 * turn), frame(Command(), armed=False)) for turn in range(4)]
    events += [(slot(648), frame(Command())), (slot(656), frame(FULL)), (slot(664), frame(FULL, armed=False))]
    events += [(slot(672), bind_frame())]
    return events


def on_air(radio: Nrf24) -> list[tuple[int, bytes, bytes]]:
    return [(packet.channel, packet.address, packet.payload) for packet in radio.packets]


def test_the_same_packets_in_simavr_in_avr8js_and_on_this_computer() -> None:
    end = slot(END, 1500)
    simavr, said = in_simavr(session(), end)
    avr8js, said_there = in_avr8js(session(), end)
    host, said_here = on_host(session(), end)
    for radio in (simavr, avr8js, host):
        assert radio.refusals == []
    assert len(simavr.packets) > 700
    assert on_air(simavr) == on_air(avr8js) == on_air(host)
    assert simavr.commands == avr8js.commands == host.commands
    throttles = {payload[0] for _, address, payload in on_air(simavr) if address != BIND_ADDRESS}
    assert len(throttles) > 8  # it did fly
    assert {address for _, address, _ in on_air(simavr)} >= {BIND_ADDRESS, bytes.fromhex("9a01020304")}
    reports = [[p for kind, p in CrsfParser().feed(words) if kind == STATUS] for words in (said, said_there, said_here)]
    assert len({report[-1] for report in reports}) == 1
