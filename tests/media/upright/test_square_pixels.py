"""Square pixels: sizes, and where a point comes to."""

import cv2
import numpy as np
import pytest

from matchset.media.upright.orientation import AS_STORED, Orientation
from matchset.media.upright.square_pixels import square_size, squared
from matchset.media.upright.view import Wish, view_of


@pytest.mark.parametrize(
    ("size", "aspect", "wanted"),
    [
        ((720, 576), 64 / 45, (1024, 576)),
        ((720, 576), 16 / 15, (768, 576)),
        ((1440, 1080), 4 / 3, (1920, 1080)),
        ((720, 480), 8 / 9, (640, 480)),
        ((720, 480), 10 / 11, (655, 480)),
        ((640, 240), 1 / 2, (640, 480)),
        ((1920, 1080), 1.0, (1920, 1080)),
        ((1920, 1088), 1088 / 1080, (1920, 1088)),
    ],
)
def test_sizes(size: tuple[int, int], aspect: float, wanted: tuple[int, int]) -> None:
    assert square_size(*size, aspect) == wanted


@pytest.mark.parametrize("aspect", [64 / 45, 4 / 3, 10 / 11, 8 / 9, 0.5, 2.0])
def test_a_point_comes_to_where_the_equation_says(aspect: float) -> None:
    picture = np.zeros((96, 120), np.uint8)
    x, y = 50.0, 40.0
    picture[30:51, 40:61] = 200  # its middle is (x, y)
    shown = squared(picture, aspect)
    moments = cv2.moments(shown.astype(np.float32))
    scales = shown.shape[1] / 120, shown.shape[0] / 96
    expected = [(value + 0.5) * scale - 0.5 for value, scale in zip((x, y), scales, strict=True)]
    assert [moments["m10"] / moments["m00"], moments["m01"] / moments["m00"]] == pytest.approx(expected, abs=0.02)
    if aspect > 0.7:
        assert len(shown) == len(picture)


def test_square_pictures_are_not_copied() -> None:
    picture = np.zeros((4, 6, 3), np.uint8)
    assert squared(picture, 1.0) is picture


def test_a_turned_picture_has_its_pixels_made_square_first() -> None:
    view = view_of((4, 3), Orientation.of_turn(90), (60, 30), Wish())
    assert view.shape((30, 60, 3)) == (80, 30, 3)
    assert view.apply(np.zeros((30, 60, 3), np.uint8)).shape == (80, 30, 3)
    assert view.notes == ("pixels are not square, 4:3: pictures of 60 x 30 px are made 80 x 30 px",)


def test_stored_pixels_have_their_shape_also_when_they_are_turned() -> None:
    assert view_of((4, 3), AS_STORED, (60, 30), Wish(square=False)).pixel_aspect == pytest.approx(4 / 3)
    turned = view_of((4, 3), AS_STORED, (60, 30), Wish(square=False, turn=270))
    assert turned.pixel_aspect == pytest.approx(3 / 4)
    assert turned.shape((30, 60)) == (60, 30)


@pytest.mark.parametrize("ratio", [(10_000.0, 1.0), (1.0, 10_000.0), (4.5, 1.0)])
def test_ratios_of_no_camera_are_ignored_and_told(ratio: tuple[float, float]) -> None:
    view = view_of(ratio, AS_STORED, (60, 30), Wish())
    assert not view.changes
    assert view.pixel_aspect == 1.0
    (note,) = view.notes
    assert note.endswith("are not credible: ignored")


@pytest.mark.parametrize("ratio", [(0.0, 1.0), (1.0, 0.0), (0.0, 0.0), (1.0, 1.0), (50.0, 50.0)])
def test_nothing_said_is_square(ratio: tuple[float, float]) -> None:
    view = view_of(ratio, AS_STORED, (60, 30), Wish())
    assert not view.changes
    assert view.notes == ()


@pytest.mark.parametrize(
    ("wish", "words"),
    [
        ({"turn": 45}, "turn must be 0, 90, 180 or 270 degrees, clockwise, got 45"),
        ({"stream": -1}, "stream must be the number of a video stream, from 0, got -1"),
        ({"stream": True}, "stream must be the number"),
        ({"square": 1}, "square must be True or False, got 1"),
        ({"mirror": "yes"}, "mirror must be True or False, got 'yes'"),
        ({"damaged": 2}, "damaged must be True, False or None, got 2"),
    ],
)
def test_wishes_that_are_none(wish: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Wish(**wish)  # type: ignore[arg-type]
