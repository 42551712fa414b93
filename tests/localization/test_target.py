import math

import pytest

import matchset as ms


def test_the_paper_s_balloon_is_the_default() -> None:
    target = ms.BallTarget()
    assert (target.diameter, target.markers, target.marker_diameter) == (0.28, ((0, 0, 1),), 0.06)
    assert target.radius == 0.14
    assert target.marker_distance == pytest.approx(math.sqrt(0.14**2 - 0.03**2))


@pytest.mark.parametrize("diameter", [0.0, -0.28, math.nan, math.inf])
def test_a_ball_has_a_size(diameter: float) -> None:
    with pytest.raises(ValueError, match=f"got {diameter}"):
        ms.BallTarget(diameter=diameter)


@pytest.mark.parametrize("marker", [0.0, -0.1, 0.28, 1.0, math.nan])
def test_a_marker_is_smaller_than_its_ball(marker: float) -> None:
    with pytest.raises(ValueError, match=f"got {marker}"):
        ms.BallTarget(marker_diameter=marker)


@pytest.mark.parametrize("marker", [(0.0, 0.0, 2.0), (0.0, 0.0, 0.0), (math.nan, 0.0, 1.0), (0.0, 1.0)])
def test_a_marker_s_place_is_a_unit_vector(marker: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="unit vectors"):
        ms.BallTarget(markers=(marker,))  # type: ignore[arg-type]


def test_markers_are_few_and_apart() -> None:
    near = (0.0, math.sin(0.1), math.cos(0.1))
    with pytest.raises(ValueError, match="10 degrees apart"):
        ms.BallTarget(markers=((0.0, 0.0, 1.0), near))
    ring = tuple((math.cos(k), 0.0, math.sin(k)) for k in range(7))
    with pytest.raises(ValueError, match="got 7"):
        ms.BallTarget(markers=ring)
