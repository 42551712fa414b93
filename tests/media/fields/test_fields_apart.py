"""Two half-frames of a frame: all its rows, each in the half-frame of its time, nothing mixed."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from interlaced_videos import frames_of
from matchset.image.frame import Frame
from matchset.media.fields.half_frames import First, HalfFrames

PARITY = {"top": 0, "bottom": 1}
sizes = st.tuples(st.integers(4, 21), st.integers(4, 9), st.sampled_from([(), (3,)]))


def random_pictures(size: tuple[int, int, tuple[int, ...]], count: int, seed: int) -> list[npt.NDArray[np.uint8]]:
    height, width, channels = size
    return list(np.random.default_rng(seed).integers(0, 256, (count, height, width, *channels), np.uint8))


def halves(pictures: list[npt.NDArray[np.uint8]], first: First = "top", fps: float | None = 30.0) -> list[Frame]:
    splitter = HalfFrames(first, fps)
    return [half for frame in frames_of(tuple(pictures)) for half in splitter.of(frame)]


@settings(max_examples=60, deadline=None)
@given(size=sizes, count=st.integers(1, 5), seed=st.integers(0, 99), first=st.sampled_from(["top", "bottom"]))
def test_every_row_is_new_once_and_the_others_are_those_before(
    size: tuple[int, int, tuple[int, ...]], count: int, seed: int, first: First
) -> None:
    pictures = random_pictures(size, count, seed)
    found, originals = halves(pictures, first), [picture.copy() for picture in pictures]
    assert [half.index for half in found] == list(range(2 * count))
    for k, half in enumerate(found):
        new, picture = PARITY[half.rows], pictures[k // 2]
        assert half.image.shape == picture.shape
        np.testing.assert_array_equal(half.image[new::2], picture[new::2])
        if k:
            np.testing.assert_array_equal(half.image[1 - new :: 2], found[k - 1].image[1 - new :: 2])
    for early, late, picture in zip(found[::2], found[1::2], pictures, strict=True):
        assert (early.rows, late.rows) == (("top", "bottom") if first == "top" else ("bottom", "top"))
        union = np.zeros_like(picture)
        for half in (early, late):
            union[PARITY[half.rows] :: 2] = half.image[PARITY[half.rows] :: 2]
        np.testing.assert_array_equal(union, picture)
        np.testing.assert_array_equal(late.image, picture)
    for picture, original in zip(pictures, originals, strict=True):
        np.testing.assert_array_equal(picture, original)  # what was handed in is never written to


def test_each_has_the_time_of_its_field() -> None:
    found = halves(random_pictures((8, 6, ()), 3, 1))
    assert [half.time for half in found] == pytest.approx([(k - 0.5) / 60.0 for k in range(6)])


def test_without_a_rate_the_times_tell_the_period() -> None:
    found = halves(random_pictures((8, 6, ()), 6, 1), fps=None)
    assert np.diff([half.time for half in found[4:]]) == pytest.approx(1 / 60, abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(gaps=st.lists(st.floats(1e-4, 0.2), min_size=2, max_size=12), later=st.booleans())
def test_times_run_forward_whatever_the_stamps_do(gaps: list[float], later: bool) -> None:
    pictures = random_pictures((8, 6, ()), len(gaps), 3)
    splitter, times = HalfFrames("top", 30.0, later=later), np.cumsum(gaps)
    found = [
        half.time for k, picture in enumerate(pictures) for half in splitter.of(Frame(picture, float(times[k]), k))
    ]
    assert (np.diff(found) > 0.0).all()
    if later:
        assert found[-1] == pytest.approx(times[-1]) or found[-1] > times[-1]


def with_rows(picture: npt.NDArray[np.uint8], parity: int, rows: Any) -> npt.NDArray[np.uint8]:
    changed = picture.copy()
    changed[parity::2] = np.asarray(rows, np.uint8)
    return changed


@pytest.mark.parametrize("kind", ["repeated", "black", "blue", "doubled"])
def test_a_field_that_is_missing_is_left_out_and_not_woven_in(kind: str) -> None:
    pictures = random_pictures((24, 32, (3,)), 4, 7)
    missing = {
        "repeated": pictures[1][1::2],
        "black": np.uint8(0),
        "blue": np.array((255, 0, 0), np.uint8),
        "doubled": pictures[2][0::2],
    }[kind]
    pictures[2] = with_rows(pictures[2], 1, missing)
    splitter = HalfFrames("top", 30.0)
    found = [half for frame in frames_of(tuple(pictures)) for half in splitter.of(frame)]
    assert [half.index for half in found] == [0, 1, 2, 3, 4, 6, 7]
    assert splitter.missing == 1
    np.testing.assert_array_equal(found[4].image[0::2], pictures[2][0::2])
    np.testing.assert_array_equal(found[4].image[1::2], pictures[1][1::2])
    np.testing.assert_array_equal(found[5].image[0::2], pictures[3][0::2])
    np.testing.assert_array_equal(found[5].image[1::2], pictures[1][1::2])  # the last rows that were there
    np.testing.assert_array_equal(found[6].image, pictures[3])


def test_the_earlier_field_may_be_missing_too() -> None:
    pictures = random_pictures((24, 32, (3,)), 3, 8)
    pictures[1] = with_rows(pictures[1], 0, pictures[0][0::2])
    splitter = HalfFrames("top", 30.0)
    found = [half for frame in frames_of(tuple(pictures)) for half in splitter.of(frame)]
    assert [(half.index, half.rows) for half in found[2:]] == [(3, "bottom"), (4, "top"), (5, "bottom")]
    np.testing.assert_array_equal(found[2].image[1::2], pictures[1][1::2])
    np.testing.assert_array_equal(found[2].image[0::2], pictures[0][0::2])


def test_a_frame_that_is_repeated_whole_is_no_missing_field() -> None:
    (picture,) = random_pictures((24, 32, (3,)), 1, 9)
    splitter = HalfFrames("bottom", 30.0)
    found = [half for frame in frames_of((picture, picture, picture)) for half in splitter.of(frame)]
    assert (len(found), splitter.missing) == (6, 0)
