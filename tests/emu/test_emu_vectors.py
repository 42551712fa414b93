"""What real handsets sent, and what the formats say: codec, C code and emulated firmware agree with it."""

import ctypes
from typing import Any

import pytest
import syma
from emulator import Board
from firmware_in_c import Pilot, Sticks, hear, library, parse
from vectors import HOPS, VECTORS, channel_lists, octets

from matchset.links import crsf_frame as crsf
from matchset.links.arduino import channels
from matchset.links.arduino.messages import Config


@pytest.mark.parametrize("case", VECTORS["data"])
def test_a_data_packet_of_the_firmware_is_the_known_one(case: dict[str, Any]) -> None:
    pitch, yaw, roll = case["sticks"]
    wanted = Sticks(case["throttle"], pitch, yaw, roll, case.get("fast", False), case.get("flip", False))
    packet = ctypes.create_string_buffer(10)
    library().syma_data_packet(packet, octets(str(case["config"])), ctypes.byref(wanted))
    assert packet.raw == octets(str(case["packet"]))


@pytest.mark.parametrize("case", VECTORS["bind"])
def test_a_bind_packet_of_the_firmware_is_the_known_one(case: dict[str, str]) -> None:
    packet = ctypes.create_string_buffer(10)
    library().syma_bind_packet(packet, Config(id=octets(case["id"])).encode())
    assert packet.raw == octets(case["packet"])


@pytest.mark.parametrize("case", [*VECTORS["data"], *VECTORS["bind"]])
def test_the_receiver_s_codec_reads_known_packets(case: dict[str, object]) -> None:
    packet = octets(str(case["packet"]))
    assert packet[9] == syma.checksum(packet)
    assert (syma.bound_id(packet) is None) == ("throttle" in case)
    if "throttle" in case:
        said = syma.sticks(packet)
        assert said is not None
        assert said.throttle == case["throttle"]
        reverse = -1 if octets(str(case["config"]))[8] else 1
        assert [reverse * axis for axis in (said.pitch, said.yaw, said.roll)] == case["sticks"]
    else:
        assert syma.bound_id(packet) == octets(str(case["id"]))


def test_captured_trims_are_read_as_they_were_set() -> None:
    at_rest = syma.sticks(octets(VECTORS["data"][0]["packet"]))
    assert at_rest is not None
    assert at_rest.trims == (-4, 0, 3)


def test_every_row_of_the_hop_table() -> None:
    for id0 in range(256):
        hops = ctypes.create_string_buffer(4)
        library().syma_channels(ctypes.c_uint8(id0), hops)
        assert list(hops.raw) == HOPS[id0 % 32], id0
    for id0, captured in VECTORS["hops_captured"].items():
        hops_of = HOPS[int(id0, 16) % 32]
        turns = [hops_of[turn:] + hops_of[:turn] for turn in range(4)]
        assert [int(channel, 16) for channel in captured] in turns


@pytest.mark.parametrize(("values", "frame"), channel_lists())
def test_channel_frames_are_the_known_ones_on_both_sides(values: list[int], frame: bytes) -> None:
    assert crsf.frame(crsf.CHANNELS_PACKED, crsf.pack_channels(values)) == frame
    assert crsf.CrsfParser().feed(frame) == [(crsf.CHANNELS_PACKED, frame[3:-1])]
    assert crsf.unpack_channels(frame[3:-1]) == values
    found, parser = parse(frame)
    assert found == [(crsf.CHANNELS_PACKED, frame[3:-1])]
    assert list(parser.channels) == values


def test_host_and_firmware_round_alike() -> None:
    pilot = Pilot()
    library().pilot_begin(ctypes.byref(pilot), False, False)
    for value in range(crsf.CHANNEL_LOW, crsf.CHANNEL_HIGH + 1):
        hear(pilot, [value] * 16)
        heard = pilot.heard
        assert heard.throttle == channels.throttle_byte(value)
        assert heard.pitch == heard.yaw == heard.roll == channels.stick_byte(value)


def test_the_firmware_sets_up_its_radio_as_a_handset_does() -> None:
    with Board() as board:
        board.run(0.1)
    expected = [octets(words) for words in VECTORS["radio"]["set_up"]]
    writes = [words for words in board.radio.commands if words[0] & 0xE0 == 0x20]
    assert writes[: len(expected)] == expected
    assert writes[len(expected)] == octets("200e")
    assert board.radio.refusals == []


def test_the_firmware_loads_every_packet_as_a_handset_does() -> None:
    known = octets(VECTORS["bind"][0]["packet"])
    with Board() as board:
        board.run(1.0)
    commands = board.radio.commands
    sends = [place for place, words in enumerate(commands) if words[0] == 0xA0]
    assert len(sends) > 200
    for place in sends:
        status, clear, tune, flush, load = commands[place - 4 : place + 1]
        assert [status, clear, flush] == [octets("0700"), octets("272e"), octets("e100")]
        assert tune[0] == 0x25
        assert load == b"\xa0" + known


def test_bind_channels_follow_the_handset_and_the_fourth_alternates() -> None:
    with Board() as board:
        board.run(1.0)
    tuned = [packet.channel for packet in board.packets[:32]]
    agreed = [channel for channel in VECTORS["radio"]["bind_channels"] for _ in range(2)]
    assert tuned == 2 * [*agreed, 0x20, 0x20, *agreed, 0x09, 0x09]
    assert {packet.address for packet in board.packets[:32]} == {octets(VECTORS["radio"]["bind_address"])}
