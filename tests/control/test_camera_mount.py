import copy
import math

import msgspec
import numpy as np
import pytest

from matchset.control.ego_motion import EgoMotion
from matchset.control.mount.camera_mount import CameraMount, MountParameters, mounting, turn_about_down
from matchset.control.sticks.ego_parameters import AttitudeCommand
from matchset.localization.pose import Pose

STEP = 1.0 / 30.0
FACING = np.diag((-1.0, 1.0, -1.0))  # of a ball whose marker looks at a level camera


def pose(marker_elevation: float, mount: tuple[float, float, float], time: float) -> Pose:
    """See a ball 1.5 m ahead and 0.2 m above, its marker so much above its equator, by a camera that is turned."""
    turn = mounting(*mount)
    ball = FACING @ mounting(0.0, marker_elevation, 0.0)
    return Pose(
        position=turn.T @ np.array((0.0, -0.2, 1.5)),
        rotation_matrix=turn.T @ ball,
        covariance=np.diag((1.0, 2.0, 3.0, 4.0, 5.0, 6.0)),
        observed="level",
        time=time,
    )


def learned(mount: CameraMount, true_pitch: float, marker: float, seconds: float, tilt: float = 0.0) -> float:
    """Hover for a while, the neighbor swinging; return what is taken for the camera's pitch, rad."""
    own = EgoMotion()
    for k in range(round(seconds / STEP)):
        own.update(AttitudeCommand(), k * STEP)
        swing = tilt * math.sin(2.86 * k * STEP)
        mount.learn(pose(marker + swing, (0.0, true_pitch, 0.0), k * STEP), own.at(k * STEP))
    return mount.parameters.pitch + mount.correction


def test_a_told_mount_turns_poses_from_the_camera_to_the_vehicle() -> None:
    told = MountParameters(yaw=0.1, pitch=-0.2, roll=0.05)
    turned = CameraMount(told).turn(pose(0.0, (0.1, -0.2, 0.05), 1.0))
    np.testing.assert_allclose(turned.position, (0.0, -0.2, 1.5), atol=1e-12)
    assert turned.rotation_matrix is not None
    np.testing.assert_allclose(turned.rotation_matrix, FACING, atol=1e-12)
    both = np.kron(np.eye(2), mounting(0.1, -0.2, 0.05))
    np.testing.assert_allclose(turned.covariance, both @ np.diag((1.0, 2.0, 3.0, 4.0, 5.0, 6.0)) @ both.T)
    assert (turned.observed, turned.time) == ("level", 1.0)
    assert turned.systematic_covariance is None


def test_what_all_poses_of_a_camera_have_in_common_is_turned_with_it() -> None:
    part = np.diag((0.5, 0.4, 0.3, 0.2, 0.1, 0.0))
    seen = msgspec.structs.replace(pose(0.0, (0.1, -0.2, 0.05), 1.0), systematic_covariance=part)
    turned = CameraMount(MountParameters(yaw=0.1, pitch=-0.2, roll=0.05)).turn(seen)
    both = np.kron(np.eye(2), mounting(0.1, -0.2, 0.05))
    assert turned.systematic_covariance is not None
    np.testing.assert_allclose(turned.systematic_covariance, both @ part @ both.T, atol=1e-12)
    np.testing.assert_allclose(turned.random_covariance, both @ seen.random_covariance @ both.T, atol=1e-12)


def test_without_a_marker_only_the_place_is_turned() -> None:
    seen = pose(0.0, (0.0, 0.0, 0.0), 0.0)
    blind = msgspec.structs.replace(seen, rotation_matrix=None, observed="position")
    mount = CameraMount()
    assert mount.turn(blind).rotation_matrix is None
    own = EgoMotion()
    for k in range(90):
        mount.learn(msgspec.structs.replace(blind, time=k * STEP), own.at(k * STEP))
    assert mount.correction == 0.0


def test_a_pose_of_a_camera_that_looks_straight_ahead_stays_as_it_is() -> None:
    seen, mount = pose(0.0, (0.0, 0.0, 0.0), 0.0), CameraMount()
    assert mount.turn(seen) is seen
    assert CameraMount(MountParameters(marker_yaw=0.1)).turn(seen) is not seen
    assert learned(mount, 0.1, 0.0, 10.0) > 0.05
    np.testing.assert_allclose(mount.from_camera, mounting(0.0, mount.correction, 0.0), atol=1e-15)
    np.testing.assert_allclose(mount.turn(seen).position, mount.from_camera @ seen.position, atol=1e-15)


def test_blocks_of_a_covariance_are_turned_one_by_one() -> None:
    root = np.random.default_rng(0).normal(size=(6, 6))
    seen = msgspec.structs.replace(pose(0.0, (0.0, 0.0, 0.0), 0.0), covariance=root @ root.T)
    turn = mounting(0.2, -0.1, 0.3)
    both = np.kron(np.eye(2), turn)
    turned = CameraMount(MountParameters(yaw=0.2, pitch=-0.1, roll=0.3)).turn(seen)
    np.testing.assert_allclose(turned.covariance, both @ seen.covariance @ both.T, atol=1e-12)


def test_a_marker_right_of_the_back_is_turned_back() -> None:
    off = math.radians(10.0)  # seen from behind, to the right: in the ball frame of its vehicle's back to the left
    seen = pose(0.0, (0.0, 0.0, 0.0), 0.0)
    marked = msgspec.structs.replace(seen, rotation_matrix=FACING @ turn_about_down(-off))
    turned = CameraMount(MountParameters(marker_yaw=off)).turn(marked)
    assert turned.rotation_matrix is not None
    np.testing.assert_allclose(turned.rotation_matrix, FACING, atol=1e-12)
    assert marked.rotation_matrix is not None
    assert marked.rotation_matrix[0, 2] > 0.0  # in the picture it is to the right, too


@pytest.mark.parametrize("pitch", [-0.087, 0.087])
def test_a_pitch_that_nobody_told_is_learned_but_for_the_share_that_a_marker_may_have(pitch: float) -> None:
    mount = CameraMount()
    share = 0.09**2 / (0.09**2 + 0.03**2)
    assert learned(mount, pitch, 0.0, 30.0, tilt=0.08) == pytest.approx(share * pitch, abs=0.006)
    np.testing.assert_allclose(mount.from_camera, mounting(0.0, mount.correction, 0.0))


def test_a_pitch_that_was_measured_is_believed() -> None:
    mount = CameraMount(MountParameters(pitch=0.05, pitch_sigma=0.005))
    assert learned(mount, 0.05, 0.03, 30.0) == pytest.approx(0.05, abs=0.001)
    exact = CameraMount(MountParameters(pitch_sigma=0.0))
    assert learned(exact, 0.1, 0.0, 5.0) == 0.0


def test_what_may_be_chance_and_what_is_seen_at_the_start_moves_nothing() -> None:
    mount = CameraMount()
    assert learned(mount, 0.015, 0.0, 10.0, tilt=0.1) == 0.0
    assert learned(CameraMount(), 0.3, 0.0, 2.4) == 0.0
    early = CameraMount(MountParameters(significance=0.0))
    assert learned(early, 0.015, 0.0, 10.0) > 0.005


def test_it_says_how_sure_it_is() -> None:
    mount = CameraMount()
    assert mount.sigma == pytest.approx(0.09)
    learned(mount, 0.0, 0.0, 60.0)
    only_marker = 0.09 * 0.03 / math.hypot(0.09, 0.03)
    assert only_marker < mount.sigma < 1.1 * only_marker


def test_correction_and_its_rate_are_limited() -> None:
    mount = CameraMount(MountParameters(max_correction=0.1, max_rate=0.02, settling_time=0.0, significance=0.0))
    assert learned(mount, 0.4, 0.0, 2.0) == pytest.approx(0.04, abs=0.002)
    assert learned(mount, 0.4, 0.0, 30.0) == pytest.approx(0.1)


def test_a_marker_far_from_the_back_and_a_clock_that_stands_teach_nothing() -> None:
    mount, own = CameraMount(), EgoMotion()
    seen = pose(0.0, (0.0, 0.1, 0.0), 1.0)
    for _ in range(30):
        mount.learn(seen, own.at(1.0))
    assert mount.correction == 0.0
    for k in range(30):
        aside = pose(0.0, (0.0, 0.1, 0.0), 2.0 + k * STEP)
        assert aside.rotation_matrix is not None
        turned = msgspec.structs.replace(aside, rotation_matrix=aside.rotation_matrix @ turn_about_down(1.2))
        mount.learn(turned, own.at(aside.time))
    assert mount.correction == 0.0


def test_a_copy_goes_on_by_itself() -> None:
    mount = CameraMount()
    learned(mount, 0.1, 0.0, 5.0)
    other, before = copy.deepcopy(mount), mount.correction
    own = EgoMotion()
    for k in range(150, 300):
        other.learn(pose(0.0, (0.0, 0.1, 0.0), k * STEP), own.at(k * STEP))
    assert other.correction > before == mount.correction


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("pitch", 1.6, "pitch must be less than a quarter turn"),
        ("yaw", math.nan, "yaw must be"),
        ("pitch_sigma", -0.1, "pitch_sigma must be zero or positive"),
        ("marker_sigma", 0.0, "marker_sigma must be positive"),
        ("max_rate", math.inf, "max_rate must be positive"),
    ],
)
def test_what_cannot_be_is_refused(field: str, value: float, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        MountParameters(**{field: value})
