import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from kernels import Floats, trace, turns
from matchset.shapes.circle import Circle

N = 128
states = st.tuples(
    st.floats(-50, 700), st.floats(-50, 500), st.floats(3, 200), st.floats(-0.12, 0.12), st.floats(-0.12, 0.12)
).map(lambda each: np.array([each[0], each[1], each[2], each[3] * each[2], each[4] * each[2]]))


def outline(state: Floats, angle: Floats) -> Floats:
    """The docstring's rho(t), written out."""
    x, y, radius, c, s = state
    rho = radius + c * np.cos(2.0 * angle) + s * np.sin(2.0 * angle)
    rho += 0.75 * ((c * c - s * s) * np.cos(4.0 * angle) + 2.0 * c * s * np.sin(4.0 * angle)) / radius
    return np.column_stack((x + rho * np.cos(angle), y + rho * np.sin(angle)))


@given(states)
def test_the_trace_is_the_outline_with_its_outward_normals(state: Floats) -> None:
    angles = np.arctan2(*turns(N).T[::-1])
    points, normals, _ = trace(state, turns(N))
    np.testing.assert_allclose(points, outline(state, angles), atol=1e-9)
    np.testing.assert_allclose(np.hypot(*normals.T), 1.0)
    tangent = outline(state, angles + 1e-6) - outline(state, angles - 1e-6)
    tangent /= np.hypot(*tangent.T)[:, np.newaxis]
    np.testing.assert_allclose(np.sum(tangent * normals, axis=1), 0.0, atol=1e-5)
    assert (np.sum((points - state[:2]) * normals, axis=1) > 0.0).all()


@given(states)
def test_the_jacobian_is_how_the_outline_moves_along_its_normal(state: Floats) -> None:
    points, normals, jacobian = trace(state, turns(N))
    for k in range(5):
        moved = state.copy()
        moved[k] += 1e-5
        speed = (trace(moved, turns(N)).points - points) / 1e-5
        np.testing.assert_allclose(jacobian[:, k], np.sum(speed * normals, axis=1), atol=1e-4)


@given(st.floats(10.0, 150.0), st.floats(1.0, 1.22), st.floats(0.0, 3.2))
@settings(max_examples=30)
def test_the_answer_is_the_least_squares_circle_of_a_ball_off_axis(b: float, ratio: float, turn: float) -> None:
    """Up to the design's 22 %: the near-circle is nowhere far from the ellipse, and its circle is the truth's."""
    a, angles = ratio * b, 2.0 * np.pi * np.arange(360) / 360
    rho = a * b / np.hypot(b * np.cos(angles - turn), a * np.sin(angles - turn))
    modes = 2.0 * np.mean(rho * np.cos(2.0 * angles)), 2.0 * np.mean(rho * np.sin(2.0 * angles))
    state = np.array([7.0, 9.0, np.mean(rho), *modes])
    assert np.abs(np.hypot(*(outline(state, angles) - (7.0, 9.0)).T) - rho).max() < 0.002 * b
    ellipse = np.column_stack((a * np.cos(angles), b * np.sin(angles)))
    truth = least_squares(lambda p: np.hypot(*(ellipse - p[:2]).T) - p[2], [0.1, -0.1, b]).x
    circle = Circle.from_state(state)
    assert (circle.x, circle.y) == (7.0, 9.0)
    assert circle.radius == pytest.approx(truth[2], rel=1e-4, abs=2e-3)


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(1e-3, 1e3))
def test_a_circle_survives_being_a_state(x: float, y: float, radius: float) -> None:
    circle = Circle(x, y, radius)
    assert Circle.from_state(circle.state) == circle
    assert Circle.from_coarse(x, y, radius) == circle
    assert Circle.half_width(circle.state) == radius


@pytest.mark.parametrize(
    "state", [(0, 0, 0, 0, 0), (0, 0, -3, 1, 1), (math.nan, 0, 3, 0, 0), (0, 0, math.inf, 0, 0), (0, 0, 3, math.nan, 0)]
)
def test_a_state_that_is_no_circle(state: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="positive radius, got Circle"):
        Circle.from_state(np.array(state, float))
