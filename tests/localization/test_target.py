import math
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.localization.ball_target import BALLOON, NeighborBall

FRONT = ((0.0, 0.0, 1.0),)
COLOR = ms.ColorModel.hsv((132, 110, 20), (165, 255, 255))


@given(st.floats(1e-3, 100.0))
def test_a_ball_has_no_marker_unless_one_is_named(diameter: float) -> None:
    target = ms.BallTarget(diameter=diameter)
    assert (target.markers, target.marker_diameter, target.diameter_sigma) == ((), 0.0, 0.0)
    assert target.marker_distance == target.radius == 0.5 * diameter
    assert target.directions.shape == (0, 3)


def test_a_table_tennis_ball_is_one_of_them() -> None:
    assert ms.BallTarget(0.04) == ms.BallTarget(diameter=0.04, markers=(), marker_diameter=0.0)
    marked = ms.BallTarget(0.04, markers=FRONT, marker_diameter=0.01)
    assert marked.marker_distance == pytest.approx(math.sqrt(0.02**2 - 0.005**2))


def test_the_paper_s_balloon_is_the_one_with_a_marker_in_front() -> None:
    assert (BALLOON.diameter, BALLOON.markers, BALLOON.marker_diameter) == (0.28, ((0, 0, 1),), 0.06)
    assert ms.BallTarget(0.28, markers=((0.0, 0.0, 1.0),)) == BALLOON
    assert BALLOON.radius == 0.14
    assert BALLOON.marker_distance == pytest.approx(math.sqrt(0.14**2 - 0.03**2))


@pytest.mark.parametrize(
    "make",
    [
        lambda ball: ms.MarkerTracker(COLOR, ball),
        lambda ball: ms.Neighbors(ms.CameraModel.from_fov(64, 48, 1.0), ball, COLOR, COLOR),
    ],
    ids=["MarkerTracker", "Neighbors"],
)
def test_what_needs_a_marker_says_how_to_name_one(make: Any) -> None:
    with pytest.raises(ValueError, match=r"needs a ball with markers, got one of 0\.2 m without: name them.*markers="):
        make(ms.BallTarget(0.2))
    make(ms.BallTarget(0.2, markers=FRONT))


@pytest.mark.parametrize("diameter", [0.0, -0.28, math.nan, math.inf])
def test_a_ball_has_a_size(diameter: float) -> None:
    with pytest.raises(ValueError, match=f"got {diameter}"):
        ms.BallTarget(diameter=diameter)


@pytest.mark.parametrize("sigma", [-0.001, 0.28, 1.0, math.nan, math.inf])
def test_a_diameter_is_known_better_than_by_itself(sigma: float) -> None:
    with pytest.raises(ValueError, match=f"diameter_sigma must be 0 or more.*got {sigma}"):
        ms.BallTarget(diameter_sigma=sigma)


@pytest.mark.parametrize("marker", [-0.1, 0.28, 1.0, math.nan])
def test_a_marker_is_smaller_than_its_ball(marker: float) -> None:
    with pytest.raises(ValueError, match=f"smaller than its ball.*got {marker}"):
        ms.BallTarget(markers=FRONT, marker_diameter=marker)


@pytest.mark.parametrize("marker", [0.06, -0.1, math.nan])
def test_the_size_of_a_marker_that_is_nowhere_is_refused(marker: float) -> None:
    with pytest.raises(ValueError, match=rf"no marker is named.*got {marker} m: name them.*markers="):
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


@pytest.mark.parametrize(
    ("table", "markers", "across"),
    [
        ({}, FRONT, 0.06),
        ({"diameter": 0.25}, FRONT, 0.06),
        ({"diameter": 0.4, "marker_diameter": 0.1}, FRONT, 0.1),
        ({"diameter": 0.25, "markers": [[1.0, 0.0, 0.0]]}, ((1.0, 0.0, 0.0),), 0.06),
        ({"diameter": 0.28, "markers": [], "marker_diameter": 0.06}, (), 0.0),
    ],
)
def test_what_settings_of_a_flight_leave_out_is_as_on_the_balloon(table: Any, markers: Any, across: float) -> None:
    target = msgspec.convert(table, NeighborBall)
    assert (target.diameter, target.markers) == (table.get("diameter", 0.28), markers)
    assert (target.marker_diameter, target.diameter_sigma) == (across, 0.0)
    assert msgspec.msgpack.decode(msgspec.msgpack.encode(target), type=NeighborBall) == target
