"""What errors of camera and diameter do to poses: drawn many times, and compared with what the covariance says."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import matchset as ms
from balls import PINHOLE, Floats, ball, dot, rim, square, track
from matchset.localization.ball_target import BALLOON
from matchset.localization.chain import compose
from matchset.localization.cone import BallParameters
from matchset.localization.localizer import LocalizerParameters, left_out
from matchset.localization.pose_filter import FilterParameters

EXACT = LocalizerParameters(ball=BallParameters(edge_shift_px=0.0))
THREE = ms.BallTarget(markers=((0.0, 0.0, 1.0), (0.48, -0.36, 0.8), (-0.64, 0.48, 0.6)))
PLACE, TURN = np.array((0.5, -0.2, 1.5)), Rotation.from_euler("y", 205.0, degrees=True)
SIGMAS = np.array((6.0, 5.0, 3.0, 3.0, 0.01, 0.02, 5e-4, 5e-4, 0.0))  # px and no unit


def resized(target: ms.BallTarget, diameter: float) -> ms.BallTarget:
    """The ball as it really is: larger, and its markers with it."""
    scale = diameter / target.diameter
    return ms.BallTarget(diameter, target.markers, scale * target.marker_diameter)


def sight(camera: ms.CameraModel, target: ms.BallTarget) -> Any:
    """What a camera shows of a ball, without noise."""
    toward = -PLACE / np.linalg.norm(PLACE)
    facing = (
        [each for each in TURN.apply(target.directions.reshape(-1, 3)) if each @ toward > 0.4] if target.markers else []
    )
    dots = [dot(camera, PLACE + target.marker_distance * each) for each in facing]
    return ball(camera, PLACE, target.radius), dots


def errors_of(poses: list[ms.Pose], turned: bool) -> Floats:
    rows = []
    for pose in poses:
        row = PLACE - pose.position
        if turned:
            assert pose.rotation is not None
            row = np.concatenate((row, (TURN * pose.rotation.inv()).as_rotvec()))
        rows.append(row)
    return np.array(rows)


def located(localizer: ms.Localizer, seen: Any) -> ms.Pose:
    pose = localizer.update(*seen)
    assert isinstance(pose, ms.Pose)
    return pose


def check_spread(errors: Floats, claimed: Floats) -> None:
    """Each number's variance, and each pair's covariance, within a quarter of what the two deviations allow."""
    count = errors.shape[1]
    spread, claimed = np.cov(errors.T), claimed[:count, :count]
    sigma = np.sqrt(np.diag(claimed))
    allowed = np.maximum(np.outer(sigma, sigma), 1e-4 * np.trace(claimed))
    np.testing.assert_array_less(np.abs(spread - claimed) / allowed, 0.25)


@pytest.mark.parametrize("target", [ms.BallTarget(), BALLOON, THREE], ids=["no marker", "one", "three"])
def test_poses_spread_as_focal_length_and_diameter_do(target: ms.BallTarget) -> None:
    rng = np.random.default_rng(43)
    known = PINHOLE.with_focal_sigma(0.02)
    told = msgspec.structs.replace(target, diameter_sigma=0.004)
    localizer, poses = ms.Localizer(known, told), []
    for share, diameter in zip(rng.normal(0.0, 0.02, 500), rng.normal(0.28, 0.004, 500), strict=True):
        real = msgspec.structs.replace(PINHOLE, fx=450.0 * (1.0 + share), fy=450.0 * (1.0 + share))
        poses.append(located(localizer, sight(real, resized(target, diameter))))
    middle = located(localizer, sight(PINHOLE, target))
    assert middle.systematic_covariance is not None
    check_spread(errors_of(poses, bool(target.markers)), middle.systematic_covariance)
    assert math.sqrt(middle.covariance[2, 2]) == pytest.approx(1.5 * math.hypot(0.02, 0.004 / 0.28), rel=0.05)


@pytest.mark.parametrize("target", [ms.BallTarget(), BALLOON, THREE], ids=["no marker", "one", "three"])
def test_poses_spread_as_all_numbers_of_a_camera_do(target: ms.BallTarget) -> None:
    rng = np.random.default_rng(7)
    rows = tuple(tuple(row) for row in np.diag(SIGMAS**2).tolist())
    known = msgspec.structs.replace(PINHOLE, distortion=(-0.2, 0.05, 1e-3, 0.0, 0.0), intrinsics_covariance=rows)
    localizer, poses = ms.Localizer(known, target), []
    for fx, fy, cx, cy, *lens in rng.normal(known.intrinsics, SIGMAS, (500, 9)).tolist():
        real = ms.CameraModel(width=640, height=480, fx=fx, fy=fy, cx=cx, cy=cy, distortion=tuple(lens))
        poses.append(located(localizer, sight(real, target)))
    middle = located(localizer, sight(known, target))
    assert middle.systematic_covariance is not None
    check_spread(errors_of(poses, bool(target.markers)), middle.systematic_covariance)


@given(st.floats(-0.6, 0.6), st.floats(-0.4, 0.4), st.floats(0.5, 8.0), st.floats(0.0, 0.2), st.floats(0.02, 1.0))
@settings(max_examples=40)
def test_a_share_of_the_diameter_is_that_share_of_the_range(
    x: float, y: float, z: float, share: float, diameter: float
) -> None:
    place = z * np.array((x, y, 1.0)) * diameter / 0.28
    seen = track(PINHOLE.project(rim(place, 0.5 * diameter)))
    plain = ms.Localizer(PINHOLE, ms.BallTarget(diameter)).update(seen)
    told = ms.Localizer(PINHOLE, ms.BallTarget(diameter, diameter_sigma=share * diameter)).update(seen)
    assert isinstance(plain, ms.Pose)
    assert isinstance(told, ms.Pose)
    assert np.array_equal(plain.position, told.position)
    along = told.position / told.distance
    grown = float(along @ (told.covariance - plain.covariance)[:3, :3] @ along)
    assert math.sqrt(max(grown, 0.0)) == pytest.approx(share * told.distance, rel=1e-3, abs=1e-6)
    assert not (told.covariance - plain.covariance)[3:].any()


def test_a_ball_of_four_centimeters_is_placed_and_has_no_yaw() -> None:
    camera = ms.CameraModel.from_fov(640, 480, math.radians(60.0), focal_sigma=0.05)
    place = np.array((0.03, -0.01, 0.3834))
    pose = ms.Localizer(camera, ms.BallTarget(diameter=0.04), EXACT).update(track(camera.project(rim(place, 0.02))))
    assert isinstance(pose, ms.Pose)
    np.testing.assert_allclose(pose.position, place, atol=1e-9)
    assert (pose.yaw, pose.side, pose.height, pose.heading, pose.rotation_matrix) == (None,) * 5
    assert set(pose.measured()) == {"x", "y", "z"}
    assert not [name for name in pose.to_dict() if "yaw" in name]
    assert "yaw" not in f"{pose!r} {pose} {pose._repr_html_()}"
    assert math.sqrt(pose.covariance[2, 2]) == pytest.approx(0.05 * 0.3834, rel=0.05)  # a guess of 60 degrees


def test_what_is_taken_as_exact_costs_nothing_and_is_said() -> None:
    seen = sight(PINHOLE, BALLOON)
    exact, told = ms.Localizer(PINHOLE, BALLOON), ms.Localizer(PINHOLE.with_focal_sigma(0.01), BALLOON)
    plain, known = located(exact, seen), located(told, seen)
    assert plain.systematic_covariance is None
    assert plain.random_covariance is plain.covariance
    assert known.systematic_covariance is not None
    np.testing.assert_allclose(known.random_covariance, plain.covariance, atol=1e-15)
    assert np.array_equal(known.position, plain.position)
    assert "± leaves out camera and diameter" in repr(plain)
    assert "± leaves out camera and diameter" in plain._repr_html_().replace("</td><td style='text-align:left'>", " ")
    assert "leaves out" not in repr(known) + known._repr_html_()


@pytest.mark.parametrize(
    ("focal", "sigma", "words"),
    [
        (0.0, 0.0, "± leaves out errors of the camera and of the diameter"),
        (0.01, 0.0, "± leaves out errors of the diameter"),
        (0.0, 0.001, "± leaves out errors of the camera"),
        (0.01, 0.001, ""),
    ],
)
def test_what_is_left_out_in_words(focal: float, sigma: float, words: str) -> None:
    camera = ms.CameraModel.from_fov(64, 48, 1.0, focal)
    assert left_out(camera, ms.BallTarget(diameter_sigma=sigma)) == words


def test_a_recorded_pose_is_as_it_was_where_nothing_is_told() -> None:
    pose = located(ms.Localizer(PINHOLE, BALLOON), sight(PINHOLE, BALLOON))
    fields = msgspec.msgpack.decode(msgspec.msgpack.encode(pose, enc_hook=lambda value: value.tolist()))
    assert list(fields) == ["position", "rotation_matrix", "covariance", "observed", "time"]


def noisy(localizer: ms.Localizer, real: ms.CameraModel, rng: np.random.Generator, time: float) -> ms.Pose:
    """A pose of the ball at rest, from an outline with noise, by a camera whose numbers are slightly wrong."""
    outline = real.project(rim(PLACE)) + rng.normal(0.0, 0.2, (64, 2))
    seen = msgspec.structs.replace(track(outline), time=time)
    dots = [msgspec.structs.replace(each, time=time) for each in sight(real, BALLOON)[1]]
    return located(localizer, (seen, dots))


def test_a_filter_averages_noise_and_nothing_else() -> None:
    rng = np.random.default_rng(3)
    localizer = ms.Localizer(PINHOLE.with_focal_sigma(0.02), msgspec.structs.replace(BALLOON, diameter_sigma=0.004))
    slow = FilterParameters(acceleration=0.02)
    filtered, plain = ms.PoseFilter(slow), ms.PoseFilter(slow)
    last = noisy(localizer, PINHOLE, rng, 0.0)
    for k in range(1, 60):
        last = noisy(localizer, PINHOLE, rng, k / 30)
        filtered.update(last)
        plain.update(msgspec.structs.replace(last, covariance=last.random_covariance, systematic_covariance=None))
    told, without = filtered.predict(2.0), plain.predict(2.0)
    assert isinstance(told, ms.Pose)
    assert isinstance(without, ms.Pose)
    assert without.systematic_covariance is None
    assert told.systematic_covariance is not None
    assert last.systematic_covariance is not None
    assert np.array_equal(told.systematic_covariance, last.systematic_covariance)
    assert np.array_equal(told.position, without.position)
    np.testing.assert_allclose(told.random_covariance, without.covariance, atol=1e-15)
    assert math.sqrt(told.covariance[2, 2]) > 1.4 * math.hypot(0.02, 0.004 / 0.28)
    assert told.random_covariance[2, 2] < 0.8 * last.random_covariance[2, 2]  # noise did become less


def test_a_filtered_pose_is_as_far_off_as_it_says() -> None:
    rng = np.random.default_rng(4)
    told, squares = ms.Localizer(PINHOLE.with_focal_sigma(0.02), BALLOON), []
    for share in rng.normal(0.0, 0.02, 60):
        real = msgspec.structs.replace(PINHOLE, fx=450.0 * (1.0 + share), fy=450.0 * (1.0 + share))
        filtered = ms.PoseFilter()
        for k in range(15):
            filtered.update(noisy(told, real, rng, k / 30))
        pose = filtered.predict(0.5)
        assert isinstance(pose, ms.Pose)
        squares.append(square(PLACE - pose.position, pose.covariance[:3, :3]))
    assert 0.5 < np.mean(squares) < 4.0  # 60 or more times 3 where the camera's error is averaged away


def test_a_rotation_that_is_remembered_keeps_its_own() -> None:
    localizer = ms.Localizer(PINHOLE.with_focal_sigma(0.02), BALLOON)
    seen, dots = sight(PINHOLE, BALLOON)
    with_turn = located(localizer, (seen, dots))
    without = located(localizer, (msgspec.structs.replace(seen, time=0.1), ()))
    filtered = ms.PoseFilter()
    filtered.update(with_turn)
    filtered.update(without)
    soon, late = filtered.predict(0.2), filtered.predict(0.59)
    assert isinstance(soon, ms.Pose)
    assert isinstance(late, ms.Pose)
    assert soon.systematic_covariance is not None
    assert with_turn.systematic_covariance is not None
    assert late.systematic_covariance is not None
    np.testing.assert_array_equal(soon.systematic_covariance[3:, 3:], with_turn.systematic_covariance[3:, 3:])
    assert soon.systematic_covariance[3:, 3:].any()
    assert late.rotation_matrix is None
    assert not late.systematic_covariance[3:].any()
    np.testing.assert_array_equal(late.covariance[3:, 3:], without.covariance[3:, 3:])


def test_composed_poses_carry_the_errors_of_both_cameras() -> None:
    told, exact = ms.Localizer(PINHOLE.with_focal_sigma(0.02), BALLOON), ms.Localizer(PINHOLE, BALLOON)
    known, plain = located(told, sight(PINHOLE, BALLOON)), located(exact, sight(PINHOLE, BALLOON))
    none = composed(plain, plain)
    assert none.systematic_covariance is None
    for first, second in ((known, known), (plain, known), (known, plain)):
        pose = composed(first, second)
        assert pose.systematic_covariance is not None
        assert np.linalg.eigvalsh(pose.systematic_covariance).min() > -1e-12
        assert pose.systematic_covariance[3:].any()
        np.testing.assert_allclose(pose.random_covariance, none.covariance, atol=1e-12)
    alone = composed(known, msgspec.structs.replace(known, rotation_matrix=None, observed="position"))
    assert alone.systematic_covariance is not None
    assert not alone.systematic_covariance[3:].any()


def composed(first: ms.Pose, second: ms.Pose) -> ms.Pose:
    pose = compose(first, second)
    assert isinstance(pose, ms.Pose)
    return pose
