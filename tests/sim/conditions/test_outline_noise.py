"""Errors of outlines: a function of seed, follower and picture; as large, lasting and rare as documented."""

import msgspec
import numpy as np
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.links.simulation_parameters import STEPS_PER_FRAME
from matchset.sim.conditions.outline_noise import EXACT, PICTURE, Deviates, OutlineNoise, deviates, slip
from matchset.sim.conditions.outlines import BallOutline, OutlineCameras
from matchset.sim.world import ChainParameters, World

CAMERA = CameraModel(width=640, height=480, fx=320.0, fy=320.0, cx=319.5, cy=239.5)
NOISE = OutlineNoise()
STILL, FAST = np.zeros(2), np.array((0.0, 9.0))
RADIUS = 31.0  # px, of a ball at 1.45 m
LASTS = 20  # pictures
LASTING = msgspec.structs.replace(EXACT, center_px=0.05, center_way_px=0.1, size=0.0016, size_way_px=0.038)


def slips(noise: OutlineNoise, way: np.ndarray, seed: int = 1, count: int = 20000) -> np.ndarray:
    """Errors of center x, y and of the radius in so many pictures in a row, (count, 3) px."""
    weights = noise.lasting_weights()
    drawn: list[Deviates] = [deviates(seed, 1, 0, PICTURE * k) for k in range(-LASTS, count)]
    found = (slip(noise, drawn[k : k - LASTS : -1], weights, way, RADIUS) for k in range(LASTS, len(drawn)))
    return np.array([(*off.center, off.radius) for off in found])


def correlation(errors: np.ndarray, lag: int) -> float:
    return float(np.corrcoef(errors[:-lag], errors[lag:])[0, 1])


def chain(seed: int = 3, vehicles: int = 3, noise: OutlineNoise = NOISE) -> OutlineCameras:
    views = OutlineCameras(World(ChainParameters(vehicles=vehicles), seed), CAMERA, noise)
    views.world.advance(30 * PICTURE)
    return views


def test_pictures_are_as_far_apart_as_those_of_the_cameras() -> None:
    assert PICTURE == STEPS_PER_FRAME


def test_an_outline_depends_on_seed_follower_and_picture_only() -> None:
    first, second, other = chain(), chain(), chain(seed=4)
    forward = {(who, step): first.outline(who, step) for step in range(160, 480, PICTURE) for who in (0, 1)}
    deviates.cache_clear()
    for (who, step), seen in reversed(forward.items()):
        second.outline_beyond(0, step)
        again = second.outline(who, step)
        assert isinstance(seen, BallOutline)
        assert isinstance(again, BallOutline)
        np.testing.assert_array_equal(again.points, seen.points)
        np.testing.assert_array_equal(again.marker, seen.marker)
    assert deviates(3, 1, 0, 160).lasting != deviates(3, 1, 1, 160).lasting
    seen, another = first.outline(0, 480), other.outline(0, 480)
    assert isinstance(seen, BallOutline)
    assert isinstance(another, BallOutline)
    assert abs(seen.radius - another.radius) > 1e-3


def test_with_zeros_nothing_is_off() -> None:
    np.testing.assert_array_equal(slips(EXACT, np.array((20.0, 20.0)), count=50), 0.0)
    assert EXACT.point_deviation(20.0) == 0.0
    views = chain(noise=EXACT)
    seen = views.outline(0, 480)
    assert isinstance(seen, BallOutline)
    assert seen.marker is not None
    poses = views.world.poses(480)
    view = views.viewpoint(poses[0])
    ball = view.from_room @ (poses[1].ball - view.position)
    np.testing.assert_allclose(seen.middle, CAMERA.project(ball[np.newaxis])[0], atol=0.6)  # an ellipse's middle
    out = -(view.from_room @ poses[1].rotation)[:, 2]
    place = ball + views.world.vehicle.ball_radius * out
    np.testing.assert_allclose(seen.marker, CAMERA.project(place[np.newaxis])[0], atol=1e-9)


def test_what_lasts_has_its_deviation_and_is_forgotten_in_the_time_of_its_memory() -> None:
    for way, center, size in ((STILL, 0.05, 0.0016 * RADIUS), (FAST, 0.304, 0.124)):
        errors = slips(LASTING, way)
        assert errors[:, 1].std() == pytest.approx(center, rel=0.1)
        assert errors[:, 0].std() == pytest.approx(0.05, rel=0.1)  # across the motion
        assert errors[:, 2].std() == pytest.approx(size, rel=0.1)
    for column in errors.T:
        assert correlation(column, 1) == pytest.approx(np.exp(-1 / 8), abs=0.05)
        assert correlation(column, 8) == pytest.approx(np.exp(-1), abs=0.12)
        assert abs(correlation(column, 20)) < 0.12


def test_a_moving_ball_is_found_too_high_and_too_small() -> None:
    still, fast = slips(NOISE, STILL).mean(axis=0), slips(NOISE, FAST).mean(axis=0)
    np.testing.assert_allclose(still, (0.0, 0.0, -0.085), atol=0.02)
    np.testing.assert_allclose(fast, (0.0, -0.27, -0.29), atol=0.04)


def test_bursts_are_as_rare_as_long_and_as_large_as_told() -> None:
    errors = slips(msgspec.structs.replace(LASTING, burst_rate=0.015, burst_pictures=4, burst_factor=4.0), STILL)
    without = slips(LASTING, STILL)
    during = ~np.isclose(errors[:, 0], without[:, 0], rtol=1e-9)
    assert during.mean() == pytest.approx(1.0 - 0.985**4, abs=0.01)
    np.testing.assert_allclose(errors[during], 4.0 * without[during])
    lengths = np.diff(np.flatnonzero(np.diff(np.concatenate(([False], during, [False])))))[::2]
    assert lengths.min() >= 3  # the first may have begun before
    assert np.median(lengths) == 4
    assert np.percentile(np.abs(errors[:, 0]), 99) > 1.4 * np.percentile(np.abs(without[:, 0]), 99)


def test_wrong_outlines_come_beyond_their_speed_alone_and_more_often_the_faster() -> None:
    noise = msgspec.structs.replace(EXACT, wrong_rate=0.004, wrong_way=14.0, wrong_pictures=6, wrong_size=0.14)
    shares = []
    for speed in (13.0, 19.0, 29.0):
        errors = slips(noise, np.array((0.0, speed)))
        shares.append(float((errors[:, 2] > 0.0).mean()))
        np.testing.assert_allclose(np.abs(errors[:, 0]), errors[:, 2])  # one side stays
    assert shares == pytest.approx([0.0, 1.0 - 0.98**6, 1.0 - 0.94**6], abs=0.03)
    assert errors[errors[:, 2] > 0.0, 2].mean() == pytest.approx(0.8 * 0.14 * RADIUS, rel=0.15)


def test_the_way_is_that_between_the_middles_of_two_pictures() -> None:
    views = chain(noise=EXACT)
    before, seen = views.outline(1, 160 - PICTURE), views.outline(1, 160)  # it hangs on a rope and swings
    assert isinstance(before, BallOutline)
    assert isinstance(seen, BallOutline)
    assert float(np.hypot(*seen.way)) > 0.3
    np.testing.assert_allclose(seen.way, seen.middle - before.middle, atol=0.02)


def test_markers_are_missed_as_often_as_told_while_the_ball_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    views = chain(noise=msgspec.structs.replace(EXACT, marker_missed=0.05))
    monkeypatch.setattr(views, "_way", lambda *_: FAST)
    seen = [views.outline(who, step) for who in (0, 1) for step in range(PICTURE, 481, PICTURE)]
    missed = [isinstance(each, BallOutline) and each.marker is None for each in seen]
    assert np.mean(missed) == pytest.approx(0.45, abs=0.15)


def test_what_is_claimed_is_larger_along_the_motion() -> None:
    seen = BallOutline(np.zeros((24, 2)), np.zeros(2), RADIUS, None, np.array((0.0, 10.0)))
    ball, markers = seen.tracks(1.0, NOISE)
    assert markers == ()
    assert ball.field_offset == (0.0, -5.0)  # half the way
    across, down, radius = np.sqrt(np.diagonal(ball.covariance))
    assert across == pytest.approx(0.14, abs=0.02)
    assert down == pytest.approx(np.hypot(across, 0.25))
    assert radius == pytest.approx(0.21, abs=0.02)
