import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.links import crsf_frame as crsf

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
    parser, found = crsf.CrsfParser(), []
    for start in range(0, len(stream), step):
        found += parser.feed(stream[start : start + step])
    assert found == frames
    assert parser.bad == 0


@given(st.binary(max_size=300))
def test_no_bytes_upset_the_parser_and_it_finds_what_follows(noise: bytes) -> None:
    parser = crsf.CrsfParser()
    parser.feed(noise)
    good = crsf.frame(0x16, crsf.pack_channels([992] * 16))
    found = parser.feed(bytes(64) + good + bytes(64))
    assert (good[2], good[3:-1]) in found


def test_every_single_bit_error_is_noticed() -> None:
    good = crsf.frame(0x16, crsf.pack_channels([random.Random(1).randrange(172, 1811) for _ in range(16)]))
    for bit in range(8 * len(good)):
        broken = bytearray(good)
        broken[bit // 8] ^= 1 << bit % 8
        assert crsf.CrsfParser().feed(bytes(broken)) == []


@given(st.binary(max_size=40))
def test_the_table_computes_the_polynomial(data: bytes) -> None:
    slow = 0
    for byte in data:
        slow ^= byte
        for _ in range(8):
            slow = (slow << 1) ^ 0xD5 if slow & 0x80 else slow << 1
            slow &= 0xFF
    assert crsf.crc8(data) == slow


def test_a_good_frame_within_a_broken_one_is_found() -> None:
    good = crsf.frame(0x16, crsf.pack_channels([992] * 16))
    for cut in range(1, len(good)):
        parser = crsf.CrsfParser()
        assert parser.feed(good[:cut] + good + bytes(64)) == [(0x16, good[3:-1])], cut
    parser = crsf.CrsfParser()
    assert parser.feed(bytes([crsf.SYNC, len(good), 0]) + good) == [(0x16, good[3:-1])]
    assert parser.bad == 1


def test_the_longest_and_the_shortest_frame_are_found_and_no_others_are_waited_for() -> None:
    longest, shortest = crsf.frame(0xE0, bytes(range(60))), crsf.frame(0xE2)
    assert (len(longest), len(shortest)) == (64, 4)
    assert crsf.CrsfParser().feed(longest + shortest) == [(0xE0, bytes(range(60))), (0xE2, b"")]
    for length in (0, 1, 63, 64, 255):
        parser = crsf.CrsfParser()
        assert parser.feed(bytes([crsf.SYNC, length, 0]) + shortest) == [(0xE2, b"")], length
        assert parser.bad == 0


def test_a_frame_is_found_with_its_last_byte_and_what_follows_is_kept() -> None:
    one, two = crsf.frame(0xE2), crsf.frame(0xE4, b"BIND")
    parser = crsf.CrsfParser()
    assert parser.feed(one[:-1]) == []
    assert parser.feed(one[-1:] + two[:3]) == [(0xE2, b"")]
    assert parser.feed(two[3:]) == [(0xE4, b"BIND")]


@pytest.mark.parametrize("kind", [-1, 256])
def test_a_type_is_a_byte(kind: int) -> None:
    with pytest.raises(ValueError, match="no frame of type"):
        crsf.frame(kind)


@pytest.mark.parametrize("count", [0, 15, 17])
def test_sixteen_channels_no_fewer_and_no_more(count: int) -> None:
    with pytest.raises(ValueError, match="16 channels"):
        crsf.pack_channels([992] * count)
    with pytest.raises(ValueError, match="22 bytes"):
        crsf.unpack_channels(bytes(23))


def test_the_published_checksum() -> None:
    assert crsf.crc8(b"123456789") == 0xBC  # CRC-8/DVB-S2, from the catalogue of CRC algorithms


def test_a_checksum_like_a_first_byte_begins_no_frame() -> None:
    good = next(each for each in (crsf.frame(0xE2, bytes([byte])) for byte in range(256)) if each[-1] == crsf.SYNC)
    parser = crsf.CrsfParser()
    spurious = crsf.frame(0xE4, b"BIND")[1:]  # with the checksum before it, it would be a frame
    assert parser.feed(good + spurious + good) == [(0xE2, good[3:-1])] * 2
    assert parser.bad == 0
