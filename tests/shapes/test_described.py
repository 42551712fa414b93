"""What every shape says of itself: one line, a dictionary for JSON, a center and a box that hold for its outline."""

import json
import re
from typing import Any

import numpy as np
import pytest
from families import SHAPES, dense
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.shapes.described import drawing_of

every_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=list(SHAPES))


@every_shape
def test_its_box_is_the_least_around_its_outline(shape: Any) -> None:
    points = dense(shape)
    found = np.array(shape.bbox)
    assert found[:2] == pytest.approx(points.min(axis=0), abs=1e-2)
    assert found[2:] == pytest.approx(points.max(axis=0), abs=1e-2)


@every_shape
def test_its_center_is_in_its_box_and_is_that_of_its_state(shape: Any) -> None:
    (x, y), (left, top, right, bottom) = shape.center, shape.bbox
    assert left < x < right
    assert top < y < bottom
    assert [x, y] == shape.state[:2].tolist()


@every_shape
def test_its_dictionary_is_plain_numbers_under_its_parameters(shape: Any) -> None:
    named = json.loads(json.dumps(shape.to_dict()))
    assert list(named) == list(type(shape).parameters)
    assert [named[name] for name in named] == [getattr(shape, name) for name in named]
    if not isinstance(shape, ms.Quadrilateral):
        assert type(shape)(**named) == shape


@every_shape
def test_it_is_one_short_line_of_rounded_numbers(shape: Any) -> None:
    words = repr(shape)
    assert words.startswith(type(shape).__name__ + "(")
    assert "\n" not in words
    assert len(words) < 110
    assert max((len(digits) for digits in re.findall(r"\.(\d+)", words)), default=0) <= 5


@every_shape
def test_one_that_is_half_built_has_a_line_too(shape: Any) -> None:
    family: Any = type(shape)
    half = family.__new__(family)
    assert repr(half) == f"<{type(shape).__name__}, incomplete: AttributeError>"


@given(st.floats(-1e4, 1e4), st.floats(1e-3, 1e6))
def test_any_circle_is_one_line_that_is_near_it(x: float, radius: float) -> None:
    read = eval(repr(ms.Circle(x, -x, radius)), {"Circle": ms.Circle})
    assert read.x == pytest.approx(x, rel=1e-3, abs=5e-3)
    assert read.radius == pytest.approx(radius, rel=1e-3)


@every_shape
def test_its_drawing_holds_every_point(shape: Any) -> None:
    points = dense(shape)[::100] + 3.0
    drawing = drawing_of(shape, points)
    places = [float(each) for each in re.findall(r"c[xy]='([-\d.]+)'", drawing)]
    assert len(places) == 2 * len(points)
    assert min(places) >= 0.0
    assert max(places) <= 150.0
