"""The frames of a file forward and backward: the same ones, of the part that is used."""

import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pytest

import matchset as ms
from matchset.image.frame import Frame
from matchset.media.both_ways import BothWays, PicturesBothWays
from several_balls import FRAMES, picture, write_pictures


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("ways") / "balls")


def middle(frames: Iterable[Frame]) -> Iterator[Frame]:
    return itertools.islice(frames, 5, 15)


def test_all_frames_come_back_in_reverse(balls: Path) -> None:
    with ms.Video(balls) as video:
        ways = BothWays(video)
        forward, backward = list(ways.forward()), list(ways.backward())
    assert [each.index for each in forward] == list(range(FRAMES))
    assert len(ways) == FRAMES
    for one, other in zip(forward, reversed(backward), strict=True):
        assert (one.index, one.time) == (other.index, other.time)
        assert np.array_equal(one.image, other.image)


def test_only_the_part_that_is_used_comes_back(balls: Path) -> None:
    with ms.Video(balls) as video:
        ways = BothWays(video, middle)
        assert [each.index for each in ways.forward()] == list(range(5, 15))
        assert [each.index for each in ways.backward()] == list(range(14, 4, -1))


def test_what_was_stopped_comes_back_from_there(balls: Path) -> None:
    with ms.Video(balls) as video:
        ways = BothWays(video)
        assert [each.index for each in itertools.islice(ways.forward(), 7)] == list(range(7))
        assert [each.index for each in ways.backward()] == list(range(6, -1, -1))


def test_arrays_have_the_times_of_their_rate() -> None:
    ways = PicturesBothWays([picture(k) for k in range(3)], 10.0)
    assert [each.time for each in ways.forward()] == [0.0, 0.1, 0.2]
    assert [each.index for each in ways.backward()] == [2, 1, 0]
    with pytest.raises(ValueError, match="their times would not fit together"):
        PicturesBothWays([Frame(picture(0)), picture(1)], 10.0)
