"""What every family of shapes must do, whatever it looks like."""

import math
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from families import SHAPES, Points, apart, begin_at, dense, fit, page_example
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.shapes.family_check import check_contract
from matchset.shapes.shape import places
from matchset.shapes.template import Affine

Floats = npt.NDArray[np.float64]
OPEN = ("rectangle", "square", "flat rectangle", "quadrilateral", "triangle")  # a hidden side may be anywhere

every_shape = pytest.mark.parametrize("name", [*SHAPES, "of the page"])


def shape_of(name: str) -> Any:
    return page_example().Pick(301.3, 208.8, 57.7) if name == "of the page" else SHAPES[name]


@pytest.fixture(scope="module")
def shapes() -> dict[str, Any]:
    return {**SHAPES, "of the page": shape_of("of the page")}


@every_shape
def test_it_keeps_the_contract(shapes: dict[str, Any], name: str) -> None:
    check_contract(type(shapes[name]))


@every_shape
def test_its_own_outline_has_no_residual_and_normals_point_out(shapes: dict[str, Any], name: str) -> None:
    shape = shapes[name]
    family, state = type(shape), shape.state
    rows = np.zeros((64, 4 + len(state)))
    family.trace(state, places(family, 64), rows)
    assert apart(shape, dense(shape)) < 0.01
    beyond, within = rows.copy(), rows.copy()
    beyond[:, :2] += 2.0 * rows[:, 2:4]
    within[:, :2] -= 2.0 * rows[:, 2:4]
    corners = np.asarray(dense(shape), np.float32).reshape(-1, 1, 2)
    for x, y in beyond[:, :2].tolist():
        assert cv2.pointPolygonTest(corners, (x, y), False) < 0
    for x, y in within[:, :2].tolist():
        assert cv2.pointPolygonTest(corners, (x, y), False) > 0


@every_shape
@pytest.mark.parametrize("push", [(2.0, -1.5, 1.03), (-3.0, 1.0, 0.97)])
def test_fitting_an_outline_returns_the_shape(
    shapes: dict[str, Any], name: str, push: tuple[float, float, float]
) -> None:
    shape = shapes[name]
    family, state = type(shape), shape.state
    size = float(family.half_width(state))
    start = family.from_coarse(state[0] + push[0], state[1] + push[1], push[2] * size, state)
    found = fit(family, Points(dense(shape)), start)
    assert apart(found.shape, dense(shape)) < 0.02
    if name != "round ellipse":  # a circle's angle may be any
        names = family.parameters
        got, true = ([getattr(each, n) for n in names] for each in (found.shape, shape))
        scale = [0.01 / size if n == "angle" else 0.02 for n in names]
        assert (np.abs(np.subtract(got, true)) < scale).all(), (got, true)


@every_shape
@given(shift=st.tuples(st.floats(-80, 80), st.floats(-80, 80)), turn=st.floats(-3.1, 3.1), scale=st.floats(0.6, 1.7))
@settings(max_examples=6)
def test_moving_turning_and_scaling_the_points_does_so_to_the_answer(
    shapes: dict[str, Any], name: str, shift: tuple[float, float], turn: float, scale: float
) -> None:
    shape = shapes[name]
    turn = 0.0 if name == "of the page" else turn  # it hangs with its tip down
    c, s = scale * math.cos(turn), scale * math.sin(turn)
    corners = np.array([300.0, 200.0]) + (dense(shape) - (300.0, 200.0)) @ np.array([[c, s], [-s, c]]) + shift
    found = fit(type(shape), Points(corners), begin_at(type(shape), corners))
    assert apart(found.shape, corners) < 0.02 * max(scale, 1.0)


@every_shape
def test_covariance_shrinks_as_points_are_added(shapes: dict[str, Any], name: str) -> None:
    shape = shapes[name]
    few, many = (
        fit(type(shape), Points(dense(shape), noise=0.3), shape, lines=lines).covariance for lines in (64, 512)
    )
    assert (np.linalg.eigvalsh(many) > 0.0).all()
    ratio = np.trace(many) / np.trace(few)
    assert 1.0 / 25.0 < ratio < 1.0 / 3.0  # about 1 / 8
    assert (np.diag(many) < np.diag(few)).all()


@every_shape
@pytest.mark.parametrize("hidden", [0.2, 0.4])
def test_a_missing_arc_does_not_bias(shapes: dict[str, Any], name: str, hidden: float) -> None:
    shape = shapes[name]
    family, state = type(shape), shape.state
    start = family.from_coarse(state[0] + 1.0, state[1] - 1.0, float(family.half_width(state)), state)
    found = fit(family, Points(dense(shape), hidden=hidden), start, spread=3.0)
    seen = np.arange(64) >= hidden * 64
    assert np.abs(found.residual[seen]).max() < 0.05
    # What no point tells stays where it was expected; all else is told by the rest.
    assert np.abs(found.residual[~seen]).max() < (2.0 if name in OPEN or isinstance(shape, Affine) else 0.2)


@every_shape
def test_the_nearest_of_equal_states_is_taken(shapes: dict[str, Any], name: str) -> None:
    shape = shapes[name]
    family, state = type(shape), shape.state
    if not hasattr(family, "nearest"):
        pytest.skip("a state of this family is the only one of its outline")
    assert np.allclose(family.nearest(state, state), state, atol=1e-9 * np.abs(state).max())
    moved = state + 0.5
    for other in (begin_at(family, dense(shape)).state, moved):
        again = family.nearest(other, state)
        assert np.linalg.norm(again - state) <= np.linalg.norm(other - state) + 1e-9
        assert apart(family.from_state(again), dense(family.from_state(other))) < 0.5
