"""Poses as messages: axes against hand-made cases, rotations against SciPy, covariances against differences."""

import math
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

from matchset.links.mavlink.axes import FRD_OF_RDF, CameraAxes, level_turn, quaternion
from matchset.links.mavlink.estimates import (
    landing_target,
    odometry_of_ball,
    odometry_of_camera,
    target_relative,
    velocity_target,
)
from matchset.links.mavlink.messages import BY_NAME
from matchset.links.mavlink.telemetry import AutopilotAttitude
from matchset.localization.pose import Pose

Floats = npt.NDArray[np.float64]
AHEAD = CameraAxes()
MOUNTS = [
    AHEAD,
    CameraAxes(pitch=-0.5, yaw=0.7, roll=0.2, forward=0.1, right=-0.04, down=0.03),
    CameraAxes(pitch=-math.pi / 2),
]


def pose(position: Any, rotation: Rotation | None = None, seed: int = 1) -> Pose:
    chance = np.random.default_rng(seed)
    root = chance.normal(0.0, 0.02, (6, 6))
    matrix = None if rotation is None else rotation.as_matrix()
    seen: Any = "position" if rotation is None else "full"
    where = np.asarray(position, float)
    return Pose(position=where, rotation_matrix=matrix, covariance=root @ root.T, observed=seen, time=3.0)


def rotation_of(values: Any) -> Rotation:
    w, x, y, z = values["q"]
    return Rotation.from_quat((x, y, z, w))


def position_of(values: Any) -> Floats:
    return np.array((values["x"], values["y"], values["z"]))


def test_right_down_forward_becomes_forward_right_down() -> None:
    assert (FRD_OF_RDF @ (1.0, 2.0, 3.0)).tolist() == [3.0, 1.0, 2.0]
    assert np.linalg.det(FRD_OF_RDF) == pytest.approx(1.0)
    assert np.allclose(FRD_OF_RDF @ FRD_OF_RDF.T, np.eye(3))


def test_a_vehicle_that_faces_north_has_its_axes_north_east_down() -> None:
    assert np.allclose(level_turn(0.0, 0.0, 0.0), np.eye(3))
    assert np.allclose(level_turn(0.0, 0.0, math.pi / 2) @ (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))  # faces east
    assert np.allclose(level_turn(0.0, 0.3, 0.0) @ (1.0, 0.0, 0.0), (math.cos(0.3), 0.0, -math.sin(0.3)))  # nose up
    assert (level_turn(0.3, 0.0, 0.0) @ (0.0, 1.0, 0.0))[2] > 0.0  # right side down


@pytest.mark.parametrize("seed", range(20))
def test_quaternions_are_those_of_scipy_with_w_first(seed: int) -> None:
    turn = Rotation.random(rng=np.random.default_rng(seed))
    w, x, y, z = quaternion(turn.as_matrix())
    assert w >= 0.0
    assert (Rotation.from_quat((x, y, z, w)) * turn.inv()).magnitude() < 1e-9


def test_a_camera_that_looks_down_sees_what_is_below() -> None:
    down = CameraAxes(pitch=-math.pi / 2, forward=0.1)
    values = landing_target(pose((0.0, 0.0, 2.0)), down, 0.28, 5.0)
    assert np.allclose(position_of(values), (0.1, 0.0, 2.0))
    assert (values["frame"], values["position_valid"], values["time_usec"]) == (12, 1, 5_000_000)
    right = landing_target(pose((0.5, 0.0, 2.0)), down, 0.28, 5.0)
    assert np.allclose(position_of(right), (0.1, 0.5, 2.0))
    assert right["angle_x"] == pytest.approx(math.atan2(0.5, 2.0))
    upper = landing_target(pose((0.0, -0.5, 2.0)), down, 0.28, 5.0)  # the upper border of the picture is ahead
    assert np.allclose(position_of(upper), (0.6, 0.0, 2.0))
    assert upper["angle_y"] < 0.0
    assert values["size_x"] == pytest.approx(2.0 * math.asin(0.07))


def test_a_camera_on_the_ground_sees_where_the_vehicle_is() -> None:
    """Marker 0 on the back of the vehicle looks at the camera; the vehicle faces away from it."""
    facing = Rotation.from_euler("y", 180.0, degrees=True)  # the ball's z toward the camera, its y down
    values = odometry_of_ball(pose((0.2, -0.1, 3.0), facing), AHEAD, math.pi, 7.0)
    assert np.allclose(position_of(values), (3.0, 0.2, -0.1))
    assert rotation_of(values).magnitude() < 1e-9
    front = odometry_of_ball(pose((0.2, -0.1, 3.0), facing), AHEAD, 0.0, 7.0)
    assert np.allclose(rotation_of(front).apply((1.0, 0.0, 0.0)), (-1.0, 0.0, 0.0))
    assert (values["frame_id"], values["child_frame_id"], values["time_usec"]) == (20, 12, 7_000_000)
    assert math.isnan(values["vx"])
    assert math.isnan(values["velocity_covariance"][0])


def test_a_ball_without_markers_gives_a_place_and_no_attitude() -> None:
    values = odometry_of_ball(pose((0.2, -0.1, 3.0)), AHEAD, math.pi, 7.0)
    assert all(math.isnan(part) for part in values["q"])
    assert values["pose_covariance"][20] == pytest.approx(math.pi**2 / 3.0)
    assert odometry_of_camera(pose((0.2, -0.1, 3.0)), AHEAD, 7.0) is None
    assert BY_NAME["ODOMETRY"].unpack(BY_NAME["ODOMETRY"].pack(values))["x"] == pytest.approx(3.0)


def test_a_camera_on_the_vehicle_knows_where_it_is_from_the_ball() -> None:
    """Two meters before marker 0, half a meter to the right of its axis as the ball looks, level."""
    facing = Rotation.from_euler("y", 180.0, degrees=True)
    values = odometry_of_camera(pose((0.5, 0.0, 2.0), facing), AHEAD, 7.0)
    assert values is not None
    assert np.allclose(position_of(values), (2.0, 0.5, 0.0))
    assert np.allclose(rotation_of(values).apply((1.0, 0.0, 0.0)), (-1.0, 0.0, 0.0))  # it looks back at the ball


@pytest.mark.parametrize("mount", MOUNTS)
def test_both_views_of_one_scene_agree(mount: CameraAxes) -> None:
    """The ball's place as seen and the camera's place as the ball sees it are each other's inverse."""
    seen = pose((0.3, -0.4, 2.5), Rotation.from_euler("xyz", (0.2, 2.8, -0.1)))
    ball = odometry_of_ball(seen, mount, 0.0, 1.0)  # the camera's vehicle as the reference
    camera = odometry_of_camera(seen, mount, 1.0)  # the ball as the reference
    assert camera is not None
    assert (rotation_of(ball) * rotation_of(camera)).magnitude() < 1e-9
    assert np.allclose(rotation_of(camera).apply(position_of(ball)) + position_of(camera), 0.0)
    assert np.allclose(position_of(landing_target(seen, mount, 0.28, 1.0)), position_of(ball))


def full(triangle: Any) -> Floats:
    matrix = np.zeros((6, 6))
    matrix[np.triu_indices(6)] = triangle
    return matrix + np.triu(matrix, 1).T


def moved(seen: Pose, error: Floats) -> Pose:
    assert seen.rotation is not None
    turned = (Rotation.from_rotvec(error[3:]) * seen.rotation).as_matrix()
    return msgspec.structs.replace(seen, position=seen.position + error[:3], rotation_matrix=turned)


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("view", ["ball", "camera"])
def test_the_covariance_is_that_of_small_errors(mount: CameraAxes, view: str) -> None:
    seen = pose((0.3, -0.4, 2.5), Rotation.from_euler("xyz", (0.2, 2.8, -0.1)))

    def values(each: Pose) -> Any:
        return odometry_of_ball(each, mount, 2.0, 1.0) if view == "ball" else odometry_of_camera(each, mount, 1.0)

    here, step = values(seen), 1e-6
    columns = []
    for k in range(6):
        there = values(moved(seen, step * np.eye(6)[k]))
        turn = (rotation_of(here).inv() * rotation_of(there)).as_rotvec()
        columns.append(np.concatenate((position_of(there) - position_of(here), turn)) / step)
    jacobian = np.array(columns).T
    expected = jacobian @ seen.covariance @ jacobian.T
    assert np.allclose(full(here["pose_covariance"]), expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("mount", MOUNTS)
def test_a_target_has_its_standard_deviations(mount: CameraAxes) -> None:
    seen = pose((0.3, -0.4, 2.5), Rotation.from_euler("xyz", (0.2, 2.8, -0.1)))
    values = target_relative(seen, mount, None, 2.0)
    turned = mount.rotation.as_matrix() @ FRD_OF_RDF
    expected = np.sqrt(np.diag(turned @ seen.covariance[:3, :3] @ turned.T))
    assert np.allclose(values["pos_std"], expected)
    assert values["q_sensor"] == (0.0,) * 4
    assert np.allclose(position_of(values), position_of(landing_target(seen, mount, 0.28, 2.0)))
    assert np.allclose(values["q_target"], landing_target(seen, mount, 0.28, 2.0)["q"])
    unknown = target_relative(pose((0.3, -0.4, 2.5)), mount, None, 2.0)
    assert unknown["yaw_std"] == pytest.approx(math.pi / math.sqrt(3.0))
    assert unknown["q_target"] == (1.0, 0.0, 0.0, 0.0)


def test_a_target_s_place_in_north_east_down_follows_from_the_attitude() -> None:
    attitude = AutopilotAttitude(2.0, 0.1, -0.2, 1.3)
    values = target_relative(pose((0.3, -0.4, 2.5)), AHEAD, attitude, 2.0)
    w, x, y, z = values["q_sensor"]
    north = Rotation.from_quat((x, y, z, w)).apply(position_of(values))
    expected = Rotation.from_euler("ZYX", attitude[:0:-1]).apply((2.5, 0.3, -0.4))
    assert np.allclose(north, expected)


def test_a_velocity_ignores_all_else() -> None:
    values = velocity_target((0.5, -0.25, 0.1), 0.3, 2.0**32)
    assert values["type_mask"] == 1 + 2 + 4 + 64 + 128 + 256 + 1024
    assert (values["vx"], values["vy"], values["vz"], values["yaw_rate"]) == (0.5, -0.25, 0.1, 0.3)
    BY_NAME["SET_POSITION_TARGET_LOCAL_NED"].pack(values)
    with pytest.raises(ValueError, match="a velocity must be finite"):
        velocity_target((0.5, math.nan, 0.1), 0.3, 2.0)


def test_a_mount_is_finite() -> None:
    with pytest.raises(ValueError, match="pitch of a camera's mount must be finite, got nan"):
        CameraAxes(pitch=math.nan)


def test_every_message_of_a_pose_packs() -> None:
    seen = pose((0.3, -0.4, 2.5), Rotation.identity())
    odometry = odometry_of_camera(seen, AHEAD, 1.0)
    assert odometry is not None
    for name, values in (
        ("ODOMETRY", odometry),
        ("LANDING_TARGET", landing_target(seen, AHEAD, 0.28, 1.0)),
        ("TARGET_RELATIVE", target_relative(seen, AHEAD, None, 1.0)),
    ):
        message = BY_NAME[name]
        back = message.unpack(message.pack(values))
        assert back["x"] == pytest.approx(values["x"], rel=1e-6)
