"""The eight orientations: each pixel where the display matrix puts it, however they follow one another."""

import itertools

import numpy as np
import pytest

from matchset.media.upright.orientation import ALL, AS_STORED, Orientation, check_turn

PICTURE = np.arange(5 * 7 * 3, dtype=np.uint8).reshape(5, 7, 3)
EIGHT = sorted(ALL)


def placed(orientation: Orientation) -> np.ndarray:
    """Put every pixel to x' = a x + c y, y' = b x + d y, moved into the picture."""
    a, b, c, d = orientation
    height, width = PICTURE.shape[:2]
    places = {(a * x + c * y, b * x + d * y): PICTURE[y, x] for y in range(height) for x in range(width)}
    left, top = min(x for x, _ in places), min(y for _, y in places)
    size = (width, height) if orientation.transposed else (height, width)
    shown = np.empty((*size, 3), np.uint8)
    for (x, y), value in places.items():
        shown[y - top, x - left] = value
    return shown


def test_there_are_eight() -> None:
    assert len(EIGHT) == 8


@pytest.mark.parametrize("orientation", EIGHT)
def test_every_pixel_is_where_the_matrix_puts_it(orientation: Orientation) -> None:
    np.testing.assert_array_equal(orientation.apply(PICTURE), placed(orientation))
    np.testing.assert_array_equal(orientation.apply(PICTURE[..., 0]), placed(orientation)[..., 0])
    assert orientation.apply(PICTURE).flags.c_contiguous


@pytest.mark.parametrize(("first", "second"), list(itertools.product(EIGHT, EIGHT)))
def test_one_after_the_other(first: Orientation, second: Orientation) -> None:
    np.testing.assert_array_equal(first.then(second).apply(PICTURE), second.apply(first.apply(PICTURE)))


@pytest.mark.parametrize("turn", [0, 90, 180, 270])
def test_turns_are_clockwise_and_the_mirror_comes_after(turn: int) -> None:
    turned = np.rot90(PICTURE, -turn // 90)
    np.testing.assert_array_equal(Orientation.of_turn(turn).apply(PICTURE), turned)
    np.testing.assert_array_equal(Orientation.of_turn(turn, mirror=True).apply(PICTURE), turned[:, ::-1])


@pytest.mark.parametrize("orientation", EIGHT)
def test_of_a_matrix_of_any_scale(orientation: Orientation) -> None:
    a, b, c, d = orientation
    assert Orientation.of_matrix((3 * a, 3 * b, 5 * c, 5 * d)) == orientation
    assert Orientation.of_matrix((65536 * a + 1, 65536 * b, 65536 * c, 65536 * d - 1)) == orientation


@pytest.mark.parametrize(
    "matrix", [(0, 0, 0, 0), (1, 1, 1, 1), (65536, 0, 0, 0), (46341, 46341, -46341, 46341), (0, 1, 0, 1)]
)
def test_of_a_matrix_that_turns_by_no_quarters(matrix: tuple[int, int, int, int]) -> None:
    assert Orientation.of_matrix(matrix) is None


def test_nothing_is_copied_where_nothing_is_to_be_done() -> None:
    assert AS_STORED.apply(PICTURE) is PICTURE


@pytest.mark.parametrize("turn", [45, 1, -90, 360, True, 90.5])
def test_other_turns_are_refused(turn: int) -> None:
    with pytest.raises(ValueError, match=f"turn must be 0, 90, 180 or 270 degrees, clockwise, got {turn}"):
        check_turn(turn)
