import math

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.camera import lens

Floats = npt.NDArray[np.float64]
LENSES = [
    (0.0, 0.0, 0.0, 0.0, 0.0),
    (-0.3, 0.0, 0.0, 0.0, 0.0),
    (-0.3, 0.12, 0.0, 0.0, -0.02),
    (-0.28, 0.1, 0.002, -0.003, 0.0),
    (0.25, -0.4, -0.001, 0.001, 0.2),
]


def camera(distortion: tuple[float, ...]) -> ms.CameraModel:
    k1, k2, p1, p2, k3 = distortion
    return ms.CameraModel(
        width=640, height=480, fx=450.0, fy=455.0, cx=322.0, cy=236.5, distortion=(k1, k2, p1, p2, k3)
    )


def grid(step: int = 16) -> Floats:
    x, y = np.meshgrid(np.arange(0.0, 640.0, step), np.arange(0.0, 480.0, step))
    return np.column_stack((x.ravel(), y.ravel()))


def matrix(model: ms.CameraModel) -> Floats:
    return np.array([[model.fx, 0.0, model.cx], [0.0, model.fy, model.cy], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("distortion", LENSES)
def test_rays_are_those_of_opencv(distortion: tuple[float, ...]) -> None:
    model = camera(distortion)
    rays = model.rays(grid())
    seen = rays[:, 2] > 0.0
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 3000, 1e-14)
    slow = cv2.undistortPoints(grid()[seen][:, None], matrix(model), np.array(distortion), criteria=criteria)
    assert seen.mean() > 0.85
    assert np.abs(rays[seen, :2] / rays[seen, 2:] - slow[:, 0]).max() < 1e-9
    assert np.linalg.norm(rays[seen], axis=1) == pytest.approx(1.0, abs=1e-15)
    assert (rays[~seen] == 0.0).all()


@pytest.mark.parametrize("distortion", LENSES)
def test_pixels_are_those_of_opencv(distortion: tuple[float, ...]) -> None:
    model = camera(distortion)
    points = np.random.default_rng(1).uniform((-0.5, -0.4, 0.9), (0.5, 0.4, 2.0), (200, 3))
    slow, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix(model), np.array(distortion))
    assert np.abs(model.project(points) - slow[:, 0]).max() < 1e-9


def test_without_distortion_a_ray_is_the_pinhole() -> None:
    (ray,) = camera(LENSES[0]).rays([(322.0 + 450.0, 236.5)])
    assert ray == pytest.approx(np.array([1.0, 0.0, 1.0]) / math.sqrt(2.0), abs=1e-15)


def test_beyond_the_fold_there_is_no_ray() -> None:
    """With k1 = -0.3 alone r' = r - 0.3 r^3 is never above 0.703: the corners of such a picture show nothing."""
    model = camera(LENSES[1])
    radius = 450.0 * np.array([0.70, 0.71, 5.0, 1e6, 1e200])
    rays = model.rays(np.column_stack((322.0 + radius, np.full(5, 236.5))))
    assert (rays[1:] == 0.0).all()
    assert rays[0, 0] / rays[0, 2] == pytest.approx(0.991, abs=0.01)
    assert not model.visible([(1.2, 0.0, 1.0)])
    with pytest.raises(ValueError, match=r"cannot see the point \(1.2, 0, 1\)"):
        model.project([(1.2, 0.0, 1.0)])


coefficients = st.floats(-2.0, 2.0)
offsets = st.floats(-0.02, 0.02)


@given(coefficients, coefficients, offsets, offsets, coefficients, st.integers(0, 2**32 - 1))
def test_there_and_back(k1: float, k2: float, p1: float, p2: float, k3: float, seed: int) -> None:
    """Of any lens: what has a ray is projected back to where it was; nothing is NaN."""
    model = camera((k1, k2, p1, p2, k3))
    points = np.random.default_rng(seed).uniform((-100.0, -100.0), (740.0, 580.0), (60, 2))
    rays = model.rays(points)
    seen = rays[:, 2] > 0.0
    assert np.isfinite(rays).all()
    assert np.abs(model.project(rays[seen]) - points[seen]).max(initial=0.0) < 1e-6


@given(*[st.floats(-1e9, 1e9)] * 5, st.lists(st.tuples(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300)), max_size=9))
def test_no_lens_makes_a_ray_that_is_none(
    k1: float, k2: float, p1: float, p2: float, k3: float, points: list[tuple[float, float]]
) -> None:
    rays = camera((k1, k2, p1, p2, k3)).rays(np.array(points).reshape(-1, 2))
    assert (np.abs(np.linalg.norm(rays, axis=1) - 0.5) == pytest.approx(0.5)) or not len(rays)
    assert np.isfinite(rays).all()


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_the_fold_is_the_first_root_of_the_slope(k1: float, k2: float, k3: float) -> None:
    s = np.linspace(0.0, 100.0, 20_001)
    flat = np.flatnonzero(1.0 - lens.MIN_SLOPE + 3.0 * k1 * s + 5.0 * k2 * s**2 + 7.0 * k3 * s**3 < 0.0)
    found = lens.fold(k1, k2, k3)
    if len(flat):
        assert found <= s[flat[0]]
    before = s[s < found]
    assert ((3.0 * k1 * before + 5.0 * k2 * before**2 + 7.0 * k3 * before**3) > -1.0).all()


def test_kernels_write_into_what_they_are_given() -> None:
    model = camera(LENSES[3])
    rays, points = np.full((3, 3), np.nan), np.array([(10.0, 20.0), (np.nan, 5.0), (np.inf, 5.0)])
    assert lens.unproject(model.intrinsics, points, rays) == 2
    assert (rays[1:] == 0.0).all()
    assert rays[:1] == pytest.approx(model.rays(points[:1]))
