"""Alg. 1-3 of the paper: against the printed loop, on discs, and where there is no answer."""
# ruff: noqa: N806  (the paper's names)

import itertools

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from matchset import reference
from matchset.reference import Mask, Search
from matchset.shapes.circle import Circle
from naive import disc

# Alg. 2


@given(
    arrays(np.bool_, st.tuples(st.integers(2, 7), st.integers(2, 7))),
    st.integers(1, 2),
    st.floats(0.05, 0.95),
)
@settings(max_examples=25)
def test_init_circle_is_the_loop_of_the_print(image: Mask, margin: int, eps: float) -> None:
    E = reference.edge_points(image, margin, 0)
    best, circle = 0, None
    height, width = image.shape
    for x, y, r in itertools.product(range(width), range(height), range(1, max(image.shape) + 1)):
        C = Circle(x, y, r)
        size = int(np.count_nonzero(reference.match_set(E, C, eps)))
        if size > best:
            best, circle = size, C
    found = reference.init_circle(image, margin, 0, eps)
    if found is None:
        assert circle is None
    else:
        assert found[0] == circle
        assert len(found[1]) == best


@given(st.floats(17, 31), st.floats(17, 31), st.floats(6, 13))
@settings(max_examples=25)
def test_init_circle_finds_a_disc(x: float, y: float, radius: float) -> None:
    found = reference.init_circle(disc(x, y, radius))
    assert found is not None
    C, S = found
    assert max(abs(C.x - x), abs(C.y - y), abs(C.radius - radius)) <= 1.0
    assert len(S) >= 3 * radius


def test_init_circle_finds_a_disc_behind_the_border_and_beside_a_bar() -> None:
    image = disc(10, 20, 14)
    image[:, 36:40] = True
    found = reference.init_circle(image)
    assert found is not None
    assert reference.error(found[0], Circle(10, 20, 14)) <= 1.5


def test_init_circle_keeps_to_its_search() -> None:
    image = disc(14, 14, 9) | disc(36, 36, 6)
    found = reference.init_circle(image, search=Search(x=range(30, 40), y=[36, 35], radius=[5, 6.0, 7]))
    assert found is not None
    assert found[0] == Circle(36, 36, 6)
    assert reference.init_circle(image, search=Search(radius=[])) is None
    assert reference.init_circle(image, search=Search(x=())) is None


@pytest.mark.parametrize("image", [np.zeros((20, 30)), np.zeros((0, 0)), np.zeros((1, 1))])
def test_init_circle_of_a_picture_without_edges_is_none(image: npt.NDArray[np.float64]) -> None:
    assert reference.init_circle(image) is None


# Alg. 3


@given(
    st.floats(30, 66), st.floats(30, 66), st.floats(10, 20), st.floats(0, 2 * np.pi), st.floats(0, 2),
    st.floats(-1, 1),
)  # fmt: skip
@settings(max_examples=40)
def test_track_circle_follows_a_disc(x: float, y: float, radius: float, way: float, step: float, growth: float) -> None:
    last = Circle(x, y, radius)
    truth = Circle(x + step * np.cos(way), y + step * np.sin(way), radius + growth)
    shape = (96, 96)
    E = reference.edge_points(disc(x, y, radius, shape), 3, 2)
    H = reference.points(reference.match_set(E, last, 0.5))
    C, S = reference.track_circle(disc(truth.x, truth.y, truth.radius, shape), H, last)
    assert max(abs(C.x - truth.x), abs(C.y - truth.y), abs(C.radius - truth.radius)) <= 1.5
    assert reference.error(C, truth) <= 2.5
    assert (np.abs(np.hypot(S[:, 0] - C.x, S[:, 1] - C.y) - C.radius) <= 1.0 + 1e-12).all()
    C, S = reference.track_circle(disc(truth.x, truth.y, truth.radius, shape), S, C)
    assert reference.error(C, truth) <= 2.0  # it creeps on in a second look at the same picture


def test_track_circle_without_an_answer_keeps_the_last() -> None:
    R, H = Circle(20, 20, 8), np.array([[12.0, 20], [28, 20], [20, 28]])
    one_edge_row = np.zeros((40, 40))
    one_edge_row[30] = 1
    for image in (np.zeros((40, 40)), one_edge_row):
        assert reference.track_circle(image, H, R, 1, 0) == (R, H)
    assert reference.track_circle(disc(20, 20, 8), H[:0], R)[0] == R


@given(arrays(np.bool_, (12, 12)), st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=9))
def test_track_circle_survives_any_picture(image: Mask, match_points: list[tuple[int, int]]) -> None:
    H = np.array(match_points, float).reshape(-1, 2)
    C, S = reference.track_circle(image, H, Circle(5, 6, 3), 1, 0)
    assert C.radius > 0
    assert len(S) >= min(len(H), 3)


def test_circumcenters_of_a_right_angle_and_none_of_a_line() -> None:
    s1, s2, s3 = np.array([[0.0, 0], [0, 0]]), np.array([[4.0, 0], [1, 1]]), np.array([[0.0, 2], [2, 2]])
    assert reference.circumcenters(s1, s2, s3).tolist() == [[2.0, 1.0]]


@given(st.floats(-3, 11), st.floats(-3, 11), st.floats(1, 9))
def test_circumcenters_of_a_circle_are_its_center(x: float, y: float, radius: float) -> None:
    angles = np.array([[0.1, 2.0, 4.5], [1.0, 2.5, 3.0], [-1.0, 0.0, 3.0]])
    points = np.stack([x + radius * np.cos(angles), y + radius * np.sin(angles)], axis=-1)
    centers = reference.circumcenters(points[:, 0], points[:, 1], points[:, 2])
    np.testing.assert_allclose(centers, [[x, y]] * 3, atol=1e-9)


# Alg. 1


def wandering(frame: int) -> Circle:
    return Circle(60 + 30 * np.sin(frame / 20), 48 + 15 * np.cos(frame / 17), 20 + 4 * np.sin(frame / 23))


def test_circle_detection_follows_a_wandering_disc_in_noise() -> None:
    rng = np.random.default_rng(1)
    truths = [wandering(frame) for frame in range(150)]
    stream = (disc(*(t.x, t.y, t.radius), (96, 120)) ^ (rng.random((96, 120)) < 0.02) for t in truths)
    near = Search(range(50, 70), range(50, 75), range(15, 25))
    found = list(reference.circle_detection(stream, search=near))
    errors = [reference.error(C, t) for C, t in zip(found, truths, strict=True) if C is not None]
    assert len(errors) == len(truths)
    assert np.mean(errors) < 1.5
    assert max(errors) < 3.0


def test_circle_detection_waits_for_its_circle_and_then_keeps_it() -> None:
    black, ball = np.zeros((32, 32), bool), disc(15, 16, 8, (32, 32))
    found = list(reference.circle_detection([black, ball, ball, black, ball]))
    assert found[0] is None
    assert found[1] == Circle(15, 16, 8)
    assert found[2] is not None
    assert found[3] == found[2]
    assert found[4] is not None
    assert reference.error(found[4], Circle(15, 16, 8)) <= 1.5
