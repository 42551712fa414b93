import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.links.arduino import crsf

CHANNELS = st.lists(st.integers(crsf.CHANNEL_LOW, crsf.CHANNEL_HIGH), min_size=16, max_size=16)


@given(CHANNELS)
def test_channels_come_back(values: list[int]) -> None:
    payload = crsf.pack_channels(values)
    assert len(payload) == 22
    assert crsf.unpack_channels(payload) == values


def test_the_published_example() -> None:
    assert crsf.frame(0x16, crsf.pack_channels([992] * 16)).hex() == "c81816" + 2 * "e0031ff8c0073ef0810f7c" + "ad"


@pytest.mark.parametrize("values", [[992] * 15, [992] * 15 + [171], [992] * 15 + [1812]])
def test_what_is_no_channel_is_refused(values: list[int]) -> None:
    with pytest.raises(ValueError, match="channel"):
        crsf.pack_channels(values)


def test_a_frame_that_is_too_long_is_refused() -> None:
    with pytest.raises(ValueError, match="61 bytes"):
        crsf.frame(0xE0, bytes(61))
    with pytest.raises(ValueError, match="22 bytes"):
        crsf.unpack_channels(bytes(21))


@given(st.lists(st.tuples(st.integers(0, 255), st.binary(max_size=60)), max_size=5), st.integers(1, 40))
def test_frames_are_found_however_they_are_cut(frames: list[tuple[int, bytes]], step: int) -> None:
    stream = b"".join(crsf.frame(kind, payload) for kind, payload in frames)
    parser, found = crsf.Parser(), []
    for start in range(0, len(stream), step):
        found += parser.feed(stream[start : start + step])
    assert found == frames
    assert parser.bad == 0


@given(st.binary(max_size=300))
def test_no_bytes_upset_the_parser_and_it_finds_what_follows(noise: bytes) -> None:
    parser = crsf.Parser()
    parser.feed(noise)
    good = crsf.frame(0x16, crsf.pack_channels([992] * 16))
    found = parser.feed(bytes(64) + good + bytes(64))
    assert (good[2], good[3:-1]) in found


def test_every_single_bit_error_is_noticed() -> None:
    good = crsf.frame(0x16, crsf.pack_channels([random.Random(1).randrange(172, 1811) for _ in range(16)]))
    for bit in range(8 * len(good)):
        broken = bytearray(good)
        broken[bit // 8] ^= 1 << bit % 8
        assert crsf.Parser().feed(bytes(broken)) == []


@given(st.binary(max_size=40))
def test_the_table_computes_the_polynomial(data: bytes) -> None:
    slow = 0
    for byte in data:
        slow ^= byte
        for _ in range(8):
            slow = (slow << 1) ^ 0xD5 if slow & 0x80 else slow << 1
            slow &= 0xFF
    assert crsf.crc8(data) == slow
