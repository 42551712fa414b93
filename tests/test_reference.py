"""The paper's equations by hand, against a literal transcription in sets, and by their symmetries."""
# ruff: noqa: N806  (the paper's names)

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import naive
from matchset import reference
from matchset.reference import Direction, Edges, Mask
from matchset.shapes.circle import Circle
from naive import OPPOSITE, ORDER, disc, pixels

images = arrays(np.bool_, st.tuples(st.integers(1, 9), st.integers(1, 9)))
margins = st.integers(1, 4)
thresholds = st.sampled_from([0, 0.1, 1, 2, 3])
coordinates = st.one_of(st.integers(-2, 10).map(float), st.floats(-3.0, 11.0))


def row(*pixels: int) -> Mask:
    return np.array([pixels], bool)


def no_edges(shape: tuple[int, int]) -> Edges:
    return {direction: np.zeros(shape, bool) for direction in ORDER}


# Eq. 1


def test_white_within_counts_both_sides_and_the_pixel_itself() -> None:
    count = reference.white_within(row(1, 1, 0, 1, 1, 1), 2)
    assert count["right"].tolist() == [[2, 2, 2, 3, 2, 1]]
    assert count["left"].tolist() == [[1, 2, 2, 2, 2, 3]]
    assert count["upper"].tolist() == count["lower"].tolist() == [[1, 1, 0, 1, 1, 1]]


def test_right_edge_has_white_on_its_left() -> None:
    # left counts 1 2 3 2 1 0, right counts 3 2 1 0 0 0
    assert reference.edge_difference(row(1, 1, 1, 0, 0, 0), 2)["right"].tolist() == [[-2, 0, 2, 2, 1, 0]]
    E = reference.edge_points(row(1, 1, 1, 0, 0, 0), 2, 1)
    assert pixels(E["right"]) == {(2, 0), (3, 0)}
    assert pixels(E["left"]) == {(0, 0)}  # outside the picture is black


def test_upper_edge_has_white_below_it() -> None:
    column = row(0, 0, 0, 1, 1, 1).T
    assert reference.edge_difference(column, 2)["upper"].tolist() == [[0], [1], [2], [2], [0], [-2]]
    E = reference.edge_points(column, 2, 1)
    assert pixels(E["upper"]) == {(0, 2), (0, 3)}
    assert pixels(E["lower"]) == {(0, 5)}


def test_the_threshold_is_exclusive() -> None:
    edge = row(0, 0, 0, 0, 1, 1, 1, 1)
    assert pixels(reference.edge_points(edge, 3, 2)["left"]) == {(3, 0), (4, 0)}
    assert not reference.edge_points(edge, 3, 3)["left"].any()


def test_margin_minus_one_keeps_the_two_pixels_beside_a_clean_boundary() -> None:
    edge = row(*[1] * 10, *[0] * 10)
    for margin in range(1, 6):
        assert pixels(reference.edge_points(edge, margin, margin - 1)["right"]) == {(9, 0), (10, 0)}


def test_a_uniform_middle_has_no_edges_and_a_black_picture_none_at_all() -> None:
    E = reference.edge_points(np.ones((9, 9)), 2, 0)
    assert not reference.union(E)[2:-2, 2:-2].any()
    assert not reference.union(reference.edge_points(np.zeros((9, 9)), 2, 0)).any()


@given(images, margins, thresholds)
@settings(max_examples=40)
def test_edge_points_are_the_sets_of_the_print(image: Mask, margin: int, threshold: float) -> None:
    E = reference.edge_points(image, margin, threshold)
    expected = naive.edges(image, margin, threshold)
    assert {direction: pixels(E[direction]) for direction in ORDER} == expected
    assert pixels(reference.union(E)) == set().union(*expected.values())


@given(images, margins)
def test_edge_difference_turns_with_the_picture(image: Mask, margin: int) -> None:
    was = reference.edge_difference(image, margin)
    mirrored = reference.edge_difference(image[:, ::-1], margin)
    upside_down = reference.edge_difference(image[::-1], margin)
    turned = reference.edge_difference(np.rot90(image), margin)  # counterclockwise: right becomes upper
    images_of: tuple[tuple[Direction, Direction, Direction, Direction], ...] = (
        ("right", "left", "right", "upper"),
        ("left", "right", "left", "lower"),
        ("upper", "upper", "lower", "left"),
        ("lower", "lower", "upper", "right"),
    )
    for before, in_mirror, on_head, after_turn in images_of:
        np.testing.assert_array_equal(mirrored[in_mirror], was[before][:, ::-1])
        np.testing.assert_array_equal(upside_down[on_head], was[before][::-1])
        np.testing.assert_array_equal(turned[after_turn], np.rot90(was[before]))


@given(images, margins)
def test_opposite_edges_are_disjoint_and_within_the_margin(image: Mask, margin: int) -> None:
    for direction, difference in reference.edge_difference(image, margin).items():
        assert np.abs(difference).max() <= margin
        np.testing.assert_array_equal(difference, -reference.edge_difference(image, margin)[OPPOSITE[direction]])


def test_whatever_is_not_zero_is_white() -> None:
    image = disc(5, 5, 3, (11, 11))
    for same in (image.astype(np.uint8), image * 255, image * 1.0):
        np.testing.assert_equal(reference.white_within(same, 3), reference.white_within(image, 3))


# Eq. 2


def test_near_circle_keeps_the_closed_ring() -> None:
    E = no_edges((1, 9))
    E["right"][:] = True
    assert pixels(reference.near_circle(E, Circle(0, 0, 5), 0.9)) == {(5, 0)}
    assert pixels(reference.near_circle(E, Circle(0, 0, 5), 1.0)) == {(4, 0), (5, 0), (6, 0)}
    assert pixels(reference.near_circle(E, Circle(4.5, 0, 3), 0.5)) == {(1, 0), (2, 0), (7, 0), (8, 0)}


# Eq. 3


@pytest.mark.parametrize(
    ("p", "facing"),
    [
        ((9, 0), {"left", "lower"}),  # p is above and right of the point
        ((0, 0), {"right", "lower"}),  # above and left
        ((9, 9), {"left", "upper"}),  # below and right
        ((0, 9), {"right", "upper"}),  # below and left
        ((9, 5), {"left", "lower", "upper"}),  # level, right
        ((0, 5), {"right", "lower", "upper"}),  # level, left
        ((5, 0), {"left", "right", "lower"}),  # exactly above
        ((5, 9), {"left", "right", "upper"}),  # exactly below
        ((5, 5), {"left", "right", "lower", "upper"}),
    ],
)
def test_arc_segments_of_one_point(p: tuple[float, float], facing: set[str]) -> None:
    found = set()
    for direction in ORDER:
        E = no_edges((10, 10))
        E[direction][5, 5] = True
        if reference.arc_segments(E, p)[5, 5]:
            found.add(direction)
    assert found == facing


def test_white_faces_the_center_of_a_white_disc_and_not_of_a_black_one() -> None:
    white = reference.edge_points(disc(24, 24, 12), 3, 2)
    np.testing.assert_array_equal(reference.arc_segments(white, (24, 24)), reference.union(white))
    black = reference.edge_points(~disc(24, 24, 12), 3, 2)
    inside = disc(24, 24, 20)
    # only edges level with the center, or above or below it, count in a neighboring case
    rows, columns = np.nonzero(reference.arc_segments(black, (24.5, 24.5)) & inside)
    assert len(rows) < 0.1 * np.count_nonzero(reference.union(black) & inside)
    assert (np.minimum(np.abs(rows - 24.5), np.abs(columns - 24.5)) < 5).all()


@given(images, margins, thresholds, coordinates, coordinates)
@settings(max_examples=40)
def test_arc_segments_are_the_cases_of_the_print(
    image: Mask, margin: int, threshold: float, x: float, y: float
) -> None:
    A = pixels(reference.arc_segments(reference.edge_points(image, margin, threshold), (x, y)))
    expected = naive.arc_segments(naive.edges(image, margin, threshold), (x, y))
    assert expected == A


# Eq. 4


@given(images, margins, thresholds, coordinates, coordinates, st.floats(0.5, 8), st.floats(0.05, 1))
def test_match_set_is_the_intersection(
    image: Mask, margin: int, threshold: float, x: float, y: float, radius: float, eps: float
) -> None:
    E, C = reference.edge_points(image, margin, threshold), Circle(x, y, radius)
    S = pixels(reference.match_set(E, C, eps))
    near, arcs = reference.near_circle(E, C, eps), reference.arc_segments(E, (x, y))
    assert pixels(near) & pixels(arcs) == S
    assert all(radius - eps <= np.hypot(a - x, b - y) <= radius + eps for a, b in S)


# Eq. 10 and misuse


def test_error_sums_the_three_differences() -> None:
    assert reference.error(Circle(10, 20, 5), Circle(11.5, 18, 5.25)) == 3.75
    assert reference.error(Circle(1, 2, 3), Circle(1, 2, 3)) == 0.0


def test_misuse_is_told_with_its_value() -> None:
    with pytest.raises(ValueError, match=r"\(3, 3, 3\)"):
        reference.edge_difference(np.zeros((3, 3, 3)), 1)
    with pytest.raises(ValueError, match=r"margin .* got 0"):
        reference.edge_points(np.zeros((3, 3)), 0, 1)
    with pytest.raises(ValueError, match=r"threshold .* got -1"):
        reference.edge_points(np.zeros((3, 3)), 1, -1)
    with pytest.raises(ValueError, match=r"eps .* got 1\.5"):
        reference.init_circle(np.zeros((3, 3)), eps=1.5)
