import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import matchset as ms
from balls import BARREL, PINHOLE, Floats, ball, dot, rim, square, track
from matchset.localization.attitude import AttitudeParameters
from matchset.localization.ball_target import BALLOON
from matchset.localization.cone import BallParameters
from matchset.localization.localizer import LocalizerParameters, direction_on_ball
from matchset.localization.marker_identification import assignments
from matchset.localization.pose import UNOBSERVED_VARIANCE

EXACT = LocalizerParameters(ball=BallParameters(edge_shift_px=0.0))


def seen_at(turn_deg: float, rise_deg: float) -> tuple[float, float, float]:
    turn, rise = math.radians(turn_deg), math.radians(rise_deg)
    return math.sin(turn) * math.cos(rise), -math.sin(rise), math.cos(turn) * math.cos(rise)


THREE = ms.BallTarget(markers=((0.0, 0.0, 1.0), seen_at(50.0, 20.0), seen_at(-50.0, -15.0)))


def upright(yaw_deg: float, nod_deg: float = 0.0, roll_deg: float = 0.0) -> Rotation:
    """Marker 0 looks at a camera straight ahead for yaw 0."""
    return Rotation.from_euler("yxz", (180.0 + yaw_deg, nod_deg, roll_deg), degrees=True)


def dots(
    camera: ms.CameraModel, target: ms.BallTarget, position: Floats, turn: Rotation, within_deg: float = 65.0
) -> list["ms.Track[ms.Circle]"]:
    """Tracks of the markers that can be seen, without error."""
    sight = -position / np.linalg.norm(position)
    each = (turn.apply(marker) for marker in target.markers)
    return [
        dot(camera, position + target.marker_distance * direction)
        for direction in each
        if direction @ sight > math.cos(math.radians(within_deg))
    ]


def angle_deg(pose: "ms.Pose | ms.Lost[ms.Pose]", truth: Rotation) -> float:
    assert isinstance(pose, ms.Pose)
    assert pose.rotation is not None
    return math.degrees((truth * pose.rotation.inv()).magnitude())


def test_lost_in_lost_out() -> None:
    pose = ms.Localizer(PINHOLE, BALLOON).update(ms.Lost("it left the picture", 1.5))
    assert isinstance(pose, ms.Lost)
    assert (pose.reason, pose.time, bool(pose)) == ("it left the picture", 1.5, False)


def test_a_ball_that_is_none_is_lost_with_a_reason() -> None:
    straight = np.column_stack((np.linspace(100.0, 500.0, 40), np.full(40, 200.0)))
    pose = ms.Localizer(PINHOLE, BALLOON).update(track(straight, time=2.0))
    assert isinstance(pose, ms.Lost)
    assert pose.time == 2.0
    assert "ball" in pose.reason


def test_without_a_marker_only_the_position_is_observed() -> None:
    pose = ms.Localizer(PINHOLE, BALLOON, EXACT).update(ball(PINHOLE, (0.3, -0.2, 1.5)), [ms.Lost("hidden", 0.0)])
    assert isinstance(pose, ms.Pose)
    assert (pose.observed, pose.rotation) == ("position", None)
    assert (pose.side, pose.height, pose.heading, pose.yaw) == (None,) * 4
    np.testing.assert_allclose(pose.position, (0.3, -0.2, 1.5), atol=1e-7)
    np.testing.assert_allclose(pose.covariance[3:, 3:], UNOBSERVED_VARIANCE * np.eye(3))
    assert not pose.covariance[3:, :3].any()
    assert pose.distance == pytest.approx(math.sqrt(0.09 + 0.04 + 2.25))


@given(st.sampled_from([PINHOLE, BARREL]), st.floats(-0.4, 0.4), st.floats(-0.25, 0.25), st.floats(-55.0, 55.0))
@settings(max_examples=60)
def test_one_marker_and_level_vehicles_give_the_whole_pose(
    camera: ms.CameraModel, x: float, y: float, yaw: float
) -> None:
    target, position = BALLOON, 1.4 * np.array((x, y, 1.0))
    turn = Rotation.from_euler("y", math.degrees(math.atan2(x, 1.0)), degrees=True) * upright(yaw)
    pose = ms.Localizer(camera, target, EXACT).update(
        ball(camera, position), dots(camera, target, position, turn, 90.0)
    )
    assert isinstance(pose, ms.Pose)
    assert pose.observed == "level"
    assert angle_deg(pose, turn) < 1e-3
    camera_in_ball = turn.inv().apply(-position)
    assert pose.side is not None
    assert pose.height is not None
    assert pose.heading is not None
    found = (pose.side, pose.height, pose.heading)
    np.testing.assert_allclose(found, camera_in_ball * (1.0, -1.0, 1.0), atol=1e-4)


def test_the_signs_of_the_paper() -> None:
    target, position = BALLOON, np.array((0.2, 0.0, 2.0))
    localizer = ms.Localizer(PINHOLE, target, EXACT)
    turn = Rotation.from_matrix(np.diag((-1.0, 1.0, -1.0)))  # marker 0 looks back along the camera's axis
    pose = localizer.update(ball(PINHOLE, position), dots(PINHOLE, target, position, turn))
    assert isinstance(pose, ms.Pose)
    assert pose.yaw == pytest.approx(math.atan2(0.2, 2.0))  # > 0: the ball is to the right
    assert pose.heading == pytest.approx(2.0, abs=1e-4)  # the camera is before the marker
    assert pose.side == pytest.approx(0.2, abs=1e-4)  # the ball's x looks to the camera's left
    lifted = np.array((0.0, 0.3, 2.0))
    pose = localizer.update(ball(PINHOLE, lifted), dots(PINHOLE, target, lifted, turn))
    assert isinstance(pose, ms.Pose)
    assert pose.height == pytest.approx(0.3, abs=1e-4)  # the camera is above the ball


@given(
    st.sampled_from([PINHOLE, BARREL]),
    st.tuples(st.floats(-0.4, 0.4), st.floats(-0.25, 0.25)),
    st.tuples(st.floats(-12.0, 12.0), st.floats(-25.0, 25.0), st.floats(-40.0, 40.0)),
    st.permutations((0, 1, 2)),
)
@settings(max_examples=60)
def test_three_markers_give_the_full_rotation_in_any_order(
    camera: ms.CameraModel, at: tuple[float, float], angles: tuple[float, float, float], order: list[int]
) -> None:
    position = 1.3 * np.array((*at, 1.0))
    turn = Rotation.from_euler("y", math.degrees(math.atan2(at[0], 1.0)), degrees=True) * upright(*angles)
    seen = dots(camera, THREE, position, turn, 70.0)  # farther round a ray only grazes the ball and tells nothing
    if len(seen) < 3:
        return
    pose = ms.Localizer(camera, THREE, EXACT).update(ball(camera, position), [seen[k] for k in order])
    assert isinstance(pose, ms.Pose)
    assert pose.observed == "full"
    assert angle_deg(pose, turn) < 1e-3


def test_the_rotation_agrees_with_scipy_s_where_all_directions_weigh_the_same() -> None:
    rng = np.random.default_rng(4)
    position, turn = np.array((0.1, 0.05, 1.2)), upright(4.0, 5.0, -6.0)
    seen = dots(PINHOLE, THREE, position, turn, 80.0)
    noisy = []
    for each in seen:
        x, y = rng.normal((each.shape.x, each.shape.y), 0.2)
        noisy.append(ms.Track(ms.Circle(x, y, 5.0), each.covariance, 1.0, each.match_set, 0.0))
    settings_ = LocalizerParameters(
        ball=BallParameters(edge_shift_px=0.0),
        attitude=AttitudeParameters(marker_sigma=1.0),  # swamps the weights
    )
    pose = ms.Localizer(PINHOLE, THREE, settings_).update(ball(PINHOLE, position), noisy)
    directions = []
    for each in noisy:
        direction = direction_on_ball(PINHOLE, (each.shape.x, each.shape.y), position, THREE.marker_distance)
        assert direction is not None
        directions.append(direction)
    theirs, _ = Rotation.align_vectors(directions, THREE.markers)
    assert angle_deg(pose, theirs) < 0.05


def test_two_of_three_markers_are_told_apart_by_where_they_were_a_moment_ago() -> None:
    localizer, position = ms.Localizer(PINHOLE, THREE, EXACT), np.array((0.0, 0.0, 1.2))
    for k, yaw in enumerate(np.arange(0.0, 41.0, 5.0)):
        turn = upright(float(yaw), 8.0)
        seen = dots(PINHOLE, THREE, position, turn)
        edge = ball(PINHOLE, position)
        pose = localizer.update(ms.Track(edge.shape, edge.covariance, 1.0, edge.match_set, k / 30), seen)
        assert angle_deg(pose, turn) < 1e-3
    assert len(seen) == 2


def test_a_patch_that_is_no_marker_is_left_out() -> None:
    position, turn = np.array((0.0, 0.0, 1.2)), upright(0.0)
    seen = dots(PINHOLE, THREE, position, turn, 80.0)
    stranger = dot(PINHOLE, position + 0.13 * np.array((0.1, 0.9, -0.4)) / math.hypot(0.1, 0.9, 0.4))
    pose = ms.Localizer(PINHOLE, THREE, EXACT).update(ball(PINHOLE, position), [stranger, *seen])
    assert isinstance(pose, ms.Pose)
    assert pose.observed == "full"
    assert angle_deg(pose, turn) < 1e-3


def test_markers_that_fit_no_rotation_leave_the_position() -> None:
    position = np.array((0.0, 0.0, 1.2))
    off = [dot(PINHOLE, position + 0.1 * np.array((x, y, -0.9))) for x, y in ((0.2, 0.0), (-0.1, 0.2))]
    pose = ms.Localizer(PINHOLE, THREE, EXACT).update(ball(PINHOLE, position), off)
    assert isinstance(pose, ms.Pose)
    assert pose.observed in ("position", "level")
    outside = ms.Track(ms.Circle(5.0, 5.0, 4.0), np.eye(3), 1.0, np.empty((0, 2)), 0.0)
    pose = ms.Localizer(PINHOLE, BALLOON, EXACT).update(ball(PINHOLE, position), [outside])
    assert isinstance(pose, ms.Pose)
    assert pose.observed == "position"


@pytest.mark.parametrize("target", [BALLOON, THREE])
def test_the_covariance_of_all_six_numbers_is_honest(target: ms.BallTarget) -> None:
    rng = np.random.default_rng(6)
    settings_ = LocalizerParameters(
        ball=BallParameters(edge_shift_px=0.0, inflation=1.0, center_sigma_px=1e-6, size_sigma_px=1e-6),
        attitude=AttitudeParameters(marker_sigma=1e-6, tilt_sigma=1e-3),
    )
    position, squares = np.array((0.25, -0.1, 1.3)), []
    for _ in range(300):
        roll = rng.normal(0.0, math.degrees(1e-3))
        turn = upright(20.0) * Rotation.from_euler("z", roll, degrees=True)  # about the marker
        points = PINHOLE.project(rim(position)) + rng.normal(0.0, 0.3, (64, 2))
        seen = []
        for each in dots(PINHOLE, target, position, turn, 75.0):
            x, y = rng.normal((each.shape.x, each.shape.y), 0.2)
            seen.append(ms.Track(ms.Circle(x, y, 5.0), each.covariance, 1.0, each.match_set, 0.0))
        pose = ms.Localizer(PINHOLE, target, settings_).update(track(points), seen)
        assert isinstance(pose, ms.Pose)
        assert pose.rotation is not None
        error = np.concatenate((position - pose.position, (turn * pose.rotation.inv()).as_rotvec()))
        squares.append(square(error, pose.covariance))
    assert 5.0 < np.mean(squares) < 7.6
    assert 0.90 < np.mean(np.array(squares) < 12.59) < 0.98


def test_ways_to_name_markers() -> None:
    ways, starts = assignments(2, 3)
    assert starts.tolist() == [0, 0, 3, 15]
    assert {tuple(way) for way in ways[3:].tolist()} == {(a, b) for a in (-1, 0, 1, 2) for b in (-1, 0, 1, 2) if a != b}
