import math

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
