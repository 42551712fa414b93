import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms


def test_a_right_angle() -> None:
    camera = ms.CameraModel.from_fov(640, 480, math.pi / 2)
    assert (camera.width, camera.height) == (640, 480)
    assert camera.fx == camera.fy == pytest.approx(320.0)
    assert (camera.cx, camera.cy) == (319.5, 239.5)


@given(st.integers(1, 8000), st.integers(1, 8000), st.floats(0.01, 3.13))
def test_the_edges_of_the_picture_are_half_the_field_of_view_away(width: int, height: int, fov: float) -> None:
    camera = ms.CameraModel.from_fov(width, height, fov)
    for edge in (-0.5, width - 0.5):
        assert abs(math.atan((edge - camera.cx) / camera.fx)) == pytest.approx(fov / 2)


@pytest.mark.parametrize("fov", [0.0, -1.0, math.pi, math.nan, math.inf])
def test_a_field_of_view_is_less_than_half_a_turn(fov: float) -> None:
    with pytest.raises(ValueError, match=f"got {fov}"):
        ms.CameraModel.from_fov(640, 480, fov)


@pytest.mark.parametrize("size", [(0, 480), (640, 0), (-640, 480)])
def test_a_picture_has_a_size(size: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match=f"got {size[0]} x {size[1]}"):
        ms.CameraModel.from_fov(*size, 1.0)


GOOD: dict[str, Any] = {"width": 640, "height": 480, "fx": 450.0, "fy": 450.0, "cx": 319.5, "cy": 239.5}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("width", 0),
        ("width", 640.0),
        ("width", True),
        ("height", 10**9),
        ("fx", 0.0),
        ("fx", -450.0),
        ("fy", math.nan),
        ("fy", math.inf),
        ("fy", "450"),
        ("cx", -1000.0),
        ("cy", 5000.0),
        ("cy", None),
        ("distortion", (0.0,) * 4),
        ("distortion", (0.0,) * 8),
        ("distortion", [0.0] * 5),
        ("intrinsics_covariance", ((1.0,) * 9,) * 8),
        ("intrinsics_covariance", ((-1.0,) + (0.0,) * 8, *((0.0,) * 9,) * 8)),
        ("intrinsics_covariance", ((1.0, 0.5) + (0.0,) * 7, *((0.0,) * 9,) * 8)),
        ("intrinsics_covariance", ((math.nan,) * 9,) * 9),
        ("intrinsics_covariance", "large"),
    ],
)
def test_impossible_numbers_are_named(name: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"^{name} must"):
        ms.CameraModel(**(GOOD | {name: value}))


@pytest.mark.parametrize(("place", "name"), list(enumerate(("k1", "k2", "p1", "p2", "k3"))))
@pytest.mark.parametrize("value", [math.nan, 1e12, "0"])
def test_impossible_coefficients_are_named(place: int, name: str, value: Any) -> None:
    values: Any = tuple(value if i == place else 0.0 for i in range(5))
    with pytest.raises(ValueError, match=f"^{name} must"):
        ms.CameraModel(**GOOD, distortion=values)


def test_the_numbers_for_kernels() -> None:
    camera = ms.CameraModel(**GOOD, distortion=(-0.3, 0.1, 0.01, 0.02, 0.5))
    assert camera.intrinsics.tolist() == [450.0, 450.0, 319.5, 239.5, -0.3, 0.1, 0.01, 0.02, 0.5]
    assert camera.intrinsics is camera.intrinsics
    assert not camera.intrinsics.flags.writeable
    assert camera.covariance is None
    assert camera == ms.CameraModel(**GOOD, distortion=(-0.3, 0.1, 0.01, 0.02, 0.5))


def test_known_uncertainty() -> None:
    rows = tuple(tuple(float(v) for v in row) for row in np.diag(np.arange(9.0)))
    camera = ms.CameraModel(**GOOD, intrinsics_covariance=rows)
    assert camera.covariance == pytest.approx(np.diag(np.arange(9.0)))


def test_a_picture_of_another_size_is_refused() -> None:
    camera = ms.CameraModel(**GOOD)
    pictures: list[Any] = [np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint8), (640, 480)]
    for picture in pictures:
        camera.check(picture)
    camera.check(ms.Frame(pictures[0]))
    for wrong in (np.zeros((640, 480), np.uint8), (480, 640), ms.Frame(np.zeros((640, 480), np.uint8))):
        with pytest.raises(ValueError, match="the picture is 480 x 640 px, the camera's are 640 x 480 px"):
            camera.check(wrong)


def test_what_is_in_the_picture() -> None:
    camera = ms.CameraModel(**GOOD)
    points = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.0, 0.0, 0.0), (0.7, 0.0, 1.0), (0.72, 0.0, 1.0), (0.0, -0.6, 1.0)]
    assert camera.visible(points).tolist() == [True, False, False, True, False, False]


@pytest.mark.parametrize("points", [[(0.0, 0.0, 0.0)], [(1.0, 1.0, -2.0)]])
def test_what_is_not_before_the_camera_has_no_pixel(points: Any) -> None:
    with pytest.raises(ValueError, match="cannot see the point"):
        ms.CameraModel(**GOOD).project(points)


def test_misuse_shows_the_value() -> None:
    camera = ms.CameraModel(**GOOD)
    with pytest.raises(ValueError, match=r"shape \(n, 2\), got \(2,\)"):
        camera.rays((1.0, 2.0))
    with pytest.raises(ValueError, match=r"shape \(n, 3\), got \(1, 2\)"):
        camera.project([(1.0, 2.0)])
    for method, point in ((camera.rays, (1.0, math.nan)), (camera.project, (1.0, math.nan, 1.0))):
        with pytest.raises(ValueError, match="must be finite, got"):
            method([point])
    with pytest.raises(ValueError, match="must be finite, got"):
        camera.visible([(math.inf, 0.0, 1.0)])
    assert camera.rays(np.zeros((0, 2))).shape == (0, 3)


def test_a_focal_length_is_known_to_a_share(tmp_path: Path) -> None:
    exact = ms.CameraModel.from_fov(640, 480, 1.0)
    assert (exact.focal_sigma, exact.covariance) == (0.0, None)
    assert ms.CameraModel.from_fov(640, 480, 1.0, focal_sigma=0.0) == exact
    told = ms.CameraModel.from_fov(640, 480, 1.0, focal_sigma=0.05)
    assert told.focal_sigma == pytest.approx(0.05)
    assert told.covariance is not None
    assert told.covariance[:2, :2] == pytest.approx((0.05 * told.fx) ** 2 * np.ones((2, 2)))  # both are off alike
    assert not told.covariance[2:].any()
    assert np.array_equal(told.intrinsics, exact.intrinsics)
    assert told.with_focal_sigma(0.0) == exact
    told.save(tmp_path / "camera.toml")
    back = ms.CameraModel.load(tmp_path / "camera.toml")
    assert back.focal_sigma == pytest.approx(0.05)


def test_another_focal_sigma_leaves_the_rest_as_it_is() -> None:
    spread = np.diag((4.0, 4.0, 2.0, 2.0, 0.01, 0.02, 5e-4, 5e-4, 0.0)) ** 2
    spread[0, 2] = spread[2, 0] = 3.0
    rows = tuple(tuple(row) for row in spread.tolist())
    camera = ms.CameraModel(**(GOOD | {"fy": 455.0, "intrinsics_covariance": rows}))
    assert camera.focal_sigma == pytest.approx(4.0 / 450.0)
    other = camera.with_focal_sigma(0.03)
    assert other.covariance is not None
    assert np.array_equal(other.covariance[2:, 2:], spread[2:, 2:])
    assert not other.covariance[:2, 2:].any()
    assert np.sqrt(np.diag(other.covariance)[:2]) == pytest.approx((13.5, 13.65))


@pytest.mark.parametrize("share", [-0.01, 1.0, math.nan, math.inf, "0.1", None])
def test_a_share_of_a_focal_length_is_less_than_all_of_it(share: Any) -> None:
    with pytest.raises(ValueError, match=rf"focal_sigma .*got {share!r}"):
        ms.CameraModel.from_fov(640, 480, 1.0).with_focal_sigma(share)
