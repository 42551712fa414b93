import math

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from matchset.camera.camera_model import CameraModel
from matchset.shapes.circle import Circle
from matchset.sim.clips.truth import SphereOutline, mean_circle, sphere_outline

CAMERA = CameraModel.from_fov(640, 480, 1.07)


def project(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.column_stack(
        (
            CAMERA.fx * points[:, 0] / points[:, 2] + CAMERA.cx,
            CAMERA.fy * points[:, 1] / points[:, 2] + CAMERA.cy,
        )
    )


def tangent_points(center: npt.NDArray[np.float64], radius: float) -> npt.NDArray[np.float64]:
    """The circle in which the tangent cone touches the sphere, sampled."""
    distance = np.linalg.norm(center)
    axis = center / distance
    side = np.cross(axis, [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    up = np.cross(axis, side)
    foot = axis * (distance - radius**2 / distance)
    reach = radius * math.sqrt(1.0 - (radius / distance) ** 2)
    phase = np.linspace(0.0, 2.0 * math.pi, 50)[:, None]
    return np.asarray(foot + reach * (np.cos(phase) * side + np.sin(phase) * up))


def off_ellipse(outline: SphereOutline, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """How far points are from the ellipse, in px to first order."""
    c, s = math.cos(outline.angle), math.sin(outline.angle)
    x, y = points[:, 0] - outline.x, points[:, 1] - outline.y
    level = np.hypot((c * x + s * y) / outline.a, (c * y - s * x) / outline.b)
    return (level - 1.0) * outline.b


@settings(max_examples=200)
@given(x=st.floats(-0.7, 0.7), y=st.floats(-0.7, 0.7), depth=st.floats(0.4, 20.0), radius=st.floats(0.01, 0.25))
def test_the_outline_is_the_projection_of_the_tangent_circle(x: float, y: float, depth: float, radius: float) -> None:
    center = np.array([x * depth, y * depth, depth])
    outline = sphere_outline(CAMERA, center, radius)
    assert outline.a >= outline.b > 0.0
    assert -math.pi / 2.0 <= outline.angle <= math.pi / 2.0
    scale = max(outline.a, 1.0)
    assert np.abs(off_ellipse(outline, project(tangent_points(center, radius)))).max() < 1e-6 * scale
    assert np.abs(off_ellipse(outline, outline.points(90))).max() < 1e-9 * scale
    assert (outline.projected_x, outline.projected_y) == pytest.approx(tuple(project(center[None])[0]))


def test_the_truth_circle_is_the_geometric_least_squares_circle() -> None:
    outline = sphere_outline(CAMERA, (0.75, -0.4, 1.1), 0.14)
    points = outline.points(360)

    def residuals(p: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.asarray(np.hypot(points[:, 0] - p[0], points[:, 1] - p[1]) - p[2])

    fit = least_squares(residuals, [outline.x + 3.0, outline.y - 2.0, outline.a], xtol=1e-14, ftol=1e-14)
    circle = outline.circle()
    assert (circle.x, circle.y, circle.radius) == pytest.approx(tuple(fit.x), abs=1e-6)


def test_center_of_the_ellipse_and_projected_center_differ_off_axis() -> None:
    outline = sphere_outline(CAMERA, (0.06, 0.0, 1.07), 0.14)
    assert 0.2 < outline.x - outline.projected_x < 0.8
    straight = sphere_outline(CAMERA, (0.0, 0.0, 1.07), 0.14)
    assert straight.x == pytest.approx(straight.projected_x)
    assert straight.a == pytest.approx(CAMERA.fx * 0.14 / math.sqrt(1.07**2 - 0.14**2))


@pytest.mark.parametrize(
    ("position", "radius"), [((0, 0, 0.1), 0.14), ((0, 0, -2), 0.14), ((0, 0, 1), 0.0), ((0, 1), 0.1)]
)
def test_a_sphere_that_is_not_in_front_is_misuse(position: tuple[float, ...], radius: float) -> None:
    with pytest.raises(ValueError, match=str(position[-1] if len(position) == 3 else "three")):
        sphere_outline(CAMERA, position, radius)


def test_mean_circle() -> None:
    assert mean_circle([Circle(0.0, 2.0, 3.0), Circle(1.0, 4.0, 5.0)]) == Circle(0.5, 3.0, 4.0)
    with pytest.raises(ValueError, match="0 circles"):
        mean_circle([])
