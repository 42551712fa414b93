"""Outlines from the truth: without noise the localizer finds the truth, and with it as far off as asked."""

import math

import numpy as np
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.control.follower import RelativeSetpoint
from matchset.localization.ball_target import BALLOON
from matchset.localization.localizer import Localizer
from matchset.localization.pose import Pose
from matchset.sim.conditions.conditions import Conditions
from matchset.sim.conditions.outline_noise import EXACT, OutlineNoise
from matchset.sim.conditions.outlines import BallOutline, OutlineCameras
from matchset.sim.world import ChainParameters, World
from matchset.tracking.track import Lost

CAMERA = CameraModel(width=640, height=480, fx=320.0, fy=320.0, cx=319.5, cy=239.5, distortion=(-0.08, 0, 0, 0, 0))


def cameras(
    noise: OutlineNoise = EXACT, start: tuple[float, float, float] = (0.1, 0.1, 0.2), **named: float
) -> OutlineCameras:
    chain = ChainParameters(
        vehicles=2, place=RelativeSetpoint(height=-0.19), start_off=start, conditions=Conditions(**named)
    )
    return OutlineCameras(World(chain, 3), CAMERA, noise)


def located(views: OutlineCameras, localizer: Localizer, step: int = 0) -> Pose:
    seen = views.outline(0, step)
    assert isinstance(seen, BallOutline)
    pose = localizer.update(*seen.tracks(1.0, views.noise))
    assert isinstance(pose, Pose)
    return pose


def truth(views: OutlineCameras, step: int = 0) -> np.ndarray:
    poses = views.world.poses(step)
    view = views.viewpoint(poses[0])
    return view.from_room @ (poses[1].ball - view.position)


def test_without_noise_the_localizer_finds_the_truth() -> None:
    views = cameras()
    pose = located(views, Localizer(CAMERA, BALLOON))
    np.testing.assert_allclose(pose.position, truth(views), atol=1e-3)
    assert pose.rotation_matrix is not None
    poses = views.world.poses(0)
    out = -(views.viewpoint(poses[0]).from_room @ poses[1].rotation)[:, 2]
    assert math.degrees(math.acos(min(float(pose.rotation_matrix[:, 2] @ out), 1.0))) < 1.5  # tilted: it hangs askew


def test_noise_is_as_large_as_asked_and_the_same_at_every_call() -> None:
    views, localizer = cameras(OutlineNoise()), Localizer(CAMERA, BALLOON)
    poses, ranges, sides = [], [], []
    for step in range(0, 4800, 12):
        views.world.advance(step)
        pose, true = located(views, localizer, step), truth(views, step)
        ranges.append(pose.distance / np.linalg.norm(true) - 1.0)
        sides.append((pose.position[0] / pose.position[2] - true[0] / true[2]) * 320.0)
        poses.append(pose)
    assert np.std(ranges) == pytest.approx(0.003, rel=0.25)  # as in rendered flights while the ball hardly moves
    assert np.mean(ranges) == pytest.approx(0.003, rel=0.25)  # outlines are too small
    assert np.std(sides) == pytest.approx(0.14, rel=0.25)
    claimed = np.sqrt([np.diagonal(pose.covariance)[:3] for pose in poses])
    assert np.median(claimed, axis=0) / 1.5 * (320.0, 320.0, 100.0) == pytest.approx((0.17, 0.2, 0.3), rel=0.4)
    again = located(views, localizer, step)
    np.testing.assert_array_equal(again.position, poses[-1].position)


def test_who_is_told_another_lens_or_ball_is_wrong_about_the_range() -> None:
    far = np.linalg.norm(truth(cameras()))
    for views in (cameras(focal_length=1.1), cameras(ball_diameter=1.1)):
        pose = located(views, Localizer(CAMERA, BALLOON))
        assert pose.distance / far == pytest.approx(1.0 / 1.1, rel=0.02)


def test_what_is_hidden_or_outside_is_lost_with_a_reason() -> None:
    views = cameras()
    views.hide_balls(1.0, 1.0)
    views.world.advance(1200)
    hidden = views.outline(0, 1200)
    assert isinstance(hidden, Lost)
    assert "hidden" in hidden.reason
    aside = cameras(camera_yaw_deg=45.0, start=(2.0, 0.0, 0.0)), cameras(camera_yaw_deg=-45.0, start=(2.0, 0.0, 0.0))
    assert any(isinstance(views.outline(0, 0), Lost) for views in aside)


@pytest.mark.parametrize(
    "wrong",
    [
        {"size": -1.0},
        {"center_px": math.nan},
        {"marker_deg": math.inf},
        {"points": 2},
        {"burst_rate": 1.1},
        {"memory": 0.0},
        {"wrong_pictures": 0},
    ],
)
def test_noise_that_is_none_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        OutlineNoise(**wrong)  # type: ignore[arg-type]


def test_the_next_but_one_ball_is_seen_beside_the_neighbors_and_not_where_that_hides_it() -> None:
    parameters = ChainParameters(vehicles=3, place=RelativeSetpoint(height=-0.19))
    world = World(parameters, 3)
    views = OutlineCameras(world, CAMERA)
    poses = world.poses(0)
    view = views.viewpoint(poses[0])
    near, far = (view.from_room @ (poses[k].ball - view.position) for k in (1, 2))
    seen = views.outline_beyond(0, 0)
    assert isinstance(seen, BallOutline)
    assert seen.marker is None
    assert 0.3 * views.noise.points <= len(seen.points) < views.noise.points  # a part of it
    assert seen.middle == pytest.approx(CAMERA.project(far[np.newaxis])[0], abs=3.0)
    off = np.hypot(*(seen.points - CAMERA.project(near[np.newaxis])[0]).T)
    assert off.min() > 0.9 * views.outline(0, 0).radius  # type: ignore[union-attr]
    assert isinstance(views.outline_beyond(1, 0), Lost)  # there is none
