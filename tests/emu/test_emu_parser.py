"""The firmware's parser, built for this computer: what noise cannot hide from it."""

import pytest
from firmware_in_c import library, parse
from hypothesis import given
from hypothesis import strategies as st

from flight import FULL, frame
from matchset.links import crsf_frame as crsf
from matchset.links.arduino.messages import BIND, READ_CONFIG, WRITE_CONFIG, Config, bind_frame, write_config_frame

DISARM = frame(FULL, armed=False)
ANY = st.binary(max_size=60)
SIZES = {crsf.CHANNELS_PACKED: 22, WRITE_CONFIG: 17, BIND: 4}


@pytest.fixture(autouse=True, scope="module")
def _built() -> None:
    library()


def overlapped(kind: int) -> bytes:
    """A frame whose CRC is right and whose content makes no sense, then DISARM, which begins within it."""
    size = SIZES[kind]
    head = bytes([crsf.SYNC, size + 2, kind])
    for filler in range(65536):
        begin = b"\xff" * (size - 3) + filler.to_bytes(2, "big")
        body = bytes([kind]) + begin + DISARM[:1]
        if crsf.crc8(body) == DISARM[1]:
            return head + begin + DISARM
    raise AssertionError("one of 256 has the right CRC")


@pytest.mark.parametrize("kind", SIZES, ids=["channels out of range", "no SET", "no BIND"])
def test_a_frame_within_one_that_makes_no_sense_is_found(kind: int) -> None:
    found, parser = parse(overlapped(kind))
    assert found == [(crsf.CHANNELS_PACKED, DISARM[3:-1])]
    assert parser.bad == 1


@given(ANY, st.sampled_from([DISARM, bind_frame(), write_config_frame(Config()), crsf.frame(READ_CONFIG)]))
def test_a_good_frame_after_noise_is_found_as_soon_as_it_is_whole(noise: bytes, good: bytes) -> None:
    quiet = noise.replace(bytes([crsf.SYNC]), b"\0")
    assert parse(quiet + good)[0] == [(good[2], good[3:-1])]


@pytest.mark.parametrize("first", [0x00, 0xC9, 0xEE])
def test_a_frame_begins_with_its_first_byte_and_no_other(first: int) -> None:
    found, parser = parse(bytes([first]) + DISARM[1:] + DISARM)
    assert found == [(crsf.CHANNELS_PACKED, DISARM[3:-1])]
    assert parser.bad == 0


def test_a_checksum_like_a_first_byte_begins_no_frame() -> None:
    numbered = (frame(FULL, ch16=number) for number in range(crsf.CHANNEL_LOW, crsf.CHANNEL_HIGH))
    good = next(each for each in numbered if each[-1] == crsf.SYNC)
    found, parser = parse(good + DISARM[1:] + good)  # what follows the checksum would be the rest of a frame
    assert found == [(crsf.CHANNELS_PACKED, good[3:-1])] * 2
    assert parser.bad == 0


@given(st.lists(ANY | st.just(DISARM) | st.just(bind_frame()), max_size=8).map(b"".join))
def test_the_parser_and_its_struct_stay_within_bounds(stream: bytes) -> None:
    found, parser = parse(stream)
    assert parser.count <= 26
    assert all(crsf.frame(kind, payload) in stream for kind, payload in found)


@given(st.integers(0, 15), st.sampled_from([0, 171, 1812, 2047]))
def test_any_channel_out_of_range_makes_it_a_bad_frame(which: int, value: int) -> None:
    values = [992] * 16
    values[which] = value
    payload = sum(value << 11 * place for place, value in enumerate(values)).to_bytes(22, "little")
    found, parser = parse(crsf.frame(crsf.CHANNELS_PACKED, payload))
    assert (found, parser.bad) == ([], 1)
