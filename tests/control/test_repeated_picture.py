"""A picture that came before is noticed, whatever its time stamp; nothing else is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.repeated_picture import PicturesSeen, RepeatedPictureParameters, note_picture
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker

DEFAULT = RepeatedPictureParameters()


def noisy(number: int, shape: tuple[int, ...] = (48, 64, 3)) -> np.ndarray:
    """Make a picture of an analog camera: gray with the least noise."""
    return (np.full(shape, 90) + np.random.default_rng(number).integers(0, 2, shape)).astype(np.uint8)


def repeats(numbers: list[int], parameters: RepeatedPictureParameters = DEFAULT) -> list[int]:
    """Note pictures one after the other; how many in a row had come before."""
    seen, counts = PicturesSeen(), []
    for number in numbers:
        seen = note_picture(noisy(number), seen, parameters)
        counts.append(seen.repeats)
    return counts


@given(st.lists(st.integers(0, 9), max_size=40))
def test_a_picture_counts_exactly_if_it_came_before(numbers: list[int]) -> None:
    expected: list[int] = []
    for k, number in enumerate(numbers):
        expected.append((expected[-1] if k else 0) + 1 if number in numbers[:k] else 0)
    assert repeats(numbers) == expected


def test_only_so_many_pictures_are_remembered() -> None:
    short = RepeatedPictureParameters(memory=3)
    assert repeats([1, 2, 3, 1, 4, 1, 5, 6, 7, 5], short) == [0, 0, 0, 1, 0, 0, 0, 0, 0, 1]
    assert repeats([1, 1, 2, 1], RepeatedPictureParameters(memory=1)) == [0, 1, 0, 0]
    seen = PicturesSeen()
    for number in range(200):
        seen = note_picture(noisy(number), seen, DEFAULT)
    assert len(seen.checksums) == DEFAULT.memory


@pytest.mark.parametrize(("numbers", "back"), [([1, 2, 2, 2], False), ([1, 2, 1], True), ([1, 2, 1, 2], True)])
def test_standing_still_is_told_from_going_back(numbers: list[int], back: bool) -> None:
    seen = PicturesSeen()
    for number in numbers:
        seen = note_picture(noisy(number), seen, DEFAULT)
    assert seen.went_back == back
    seen = note_picture(noisy(99), seen, DEFAULT)
    assert (seen.repeats, seen.went_back) == (0, False)


def test_a_new_picture_in_either_field_is_new() -> None:
    for field in range(2):
        seen = note_picture(noisy(1, (480, 64, 3)), PicturesSeen(), DEFAULT)
        half = noisy(1, (480, 64, 3))
        half[field::2] = noisy(2, (480, 64, 3))[field::2]
        assert note_picture(half, seen, DEFAULT).repeats == 0


@pytest.mark.parametrize("shape", [(1, 1), (1, 3, 3), (2, 5), (7, 9, 3), (480, 640, 3), (3, 640)])
def test_any_picture_will_do(shape: tuple[int, ...]) -> None:
    picture = noisy(3, shape)
    seen = note_picture(picture, PicturesSeen(), DEFAULT)
    assert note_picture(picture.copy(), seen, DEFAULT).repeats == 1
    assert note_picture(255 - picture, seen, DEFAULT).repeats == 0


def test_without_lines_nothing_counts() -> None:
    assert repeats([1] * 9, RepeatedPictureParameters(lines=0)) == [0] * 9


def test_a_tracker_follows_in_pictures_that_stand_still() -> None:
    picture = np.full((120, 160, 3), 90, np.uint8)
    y, x = np.mgrid[:120, :160]
    picture[(x - 70) ** 2 + (y - 50) ** 2 < 25**2] = (200, 60, 30)
    tracker = Tracker(Circle, ColorModel.pick(picture, 70, 50))
    assert all(isinstance(tracker.update(Frame(picture, k / 30, k)), Track) for k in range(20))


@pytest.mark.parametrize(("name", "value"), [("lines", -1), ("memory", 0), ("max_repeats", 0)])
def test_numbers_out_of_range_are_refused(name: str, value: int) -> None:
    with pytest.raises(ValueError, match=name):
        RepeatedPictureParameters(**{name: value})
