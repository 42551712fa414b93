"""Which pictures are wrong after an error, and pictures of H.264 that are missing as a whole."""

import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.media.bags.video_messages import VideoMessages
from matchset.media.damaged.damage import DEFAULT, Damage
from matchset.media.damaged.frame_numbers import FrameNumbers
from shown_clips import Picture, access_units, ball_picture

PICTURES = [ball_picture((160, 120), (40.0 + 2 * k, 60.0, 20.0)) for k in range(40)]


def test_what_comes_before_the_first_key_picture_is_wrong() -> None:
    damage = Damage()
    assert [damage.of(False, key) for key in (False, False, True, False)] == [True, True, False, False]


def test_an_error_lasts_until_the_next_whole_key_picture() -> None:
    damage = Damage()
    damage.of(False, True)
    seen = [(True, False), (False, False), (True, True), (False, False), (False, True), (False, False)]
    assert [damage.of(error, key) for error, key in seen] == [True, True, True, True, False, False]
    damage.note_loss()
    assert damage.of(False, False)
    assert not damage.of(False, True)


def test_a_stream_without_key_pictures_is_believed_in_the_end() -> None:
    damage = Damage()
    assert [damage.of(False, False) for _ in range(DEFAULT.longest)].count(False) == 1


@pytest.mark.parametrize("key", [5, 100])
def test_every_picture_that_is_missing_is_noticed(key: int) -> None:
    units = access_units(PICTURES, key=key)
    chance = random.Random(1)
    lost = set(chance.sample(range(2, 39), 8))
    kept = [number for number in range(40) if number not in lost]
    numbers = FrameNumbers()
    noticed = [number for number in kept if numbers.is_gap(units[number])]
    expected = [number for number in kept if number - 1 in lost and number % key]
    assert noticed == expected
    assert not any(map(FrameNumbers().is_gap, units))


def decoded(units: list[bytes], kept: list[int]) -> dict[int, tuple[Picture, bool]]:
    """Each picture of those that are kept, and whether it is damaged."""
    video = VideoMessages("h264")
    seen = [each for number in kept for each in video.decode(number, units[number])]
    return {each.number: (each.image, each.damaged) for each in (*seen, *video.finish())}


def test_pictures_that_are_made_anew_piece_by_piece_are_whole_when_all_is_new() -> None:
    units = access_units(PICTURES, own="intra-refresh=1", key=15)
    every = list(range(len(units)))
    whole = decoded(units, every)
    assert not any(damaged for _, damaged in whole.values())
    for lost in (8, 11, 16):
        seen = decoded(units, [number for number in every if number != lost])
        believed = [number for number, (_, is_damaged) in seen.items() if not is_damaged]
        assert believed == [*range(lost), *range(believed[lost], len(units))]
        assert believed[lost] - lost < 25  # what is left of a refresh, and a whole one
        for number in believed:
            np.testing.assert_array_equal(seen[number][0], whole[number][0])


def test_a_refresh_with_an_error_in_it_makes_no_picture_whole() -> None:
    units = access_units(PICTURES, own="intra-refresh=1", key=15)

    def first_whole(error: int | None) -> int:
        damage = Damage(FrameNumbers())
        seen = {}
        for number, unit in enumerate(units):
            if number != 8:
                damage.note_packet(unit)
                seen[number] = damage.of(number == error, number == 0)
        return max(number for number, damaged in seen.items() if damaged) + 1

    end = first_whole(None)
    assert first_whole(end - 3) == end + 15


def test_headers_may_come_before() -> None:
    units = access_units(PICTURES)
    numbers = FrameNumbers(units[0][:200])
    assert not numbers.is_gap(units[0])
    assert numbers.is_gap(units[2])


@given(
    st.lists(st.binary(max_size=40), max_size=6), st.sampled_from([b"", b"\0\0\1\x67", b"\0\0\1\x65", b"\0\0\1\x41"])
)
def test_any_bytes_are_taken(pieces: list[bytes], start: bytes) -> None:
    numbers = FrameNumbers()
    for piece in pieces:
        numbers.is_gap(start + piece)
