"""The next-but-one ball in painted pictures: found beside and behind the neighbor's, and not taken for another one."""

import copy
import math

import cv2
import msgspec
import numpy as np
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.next_ball.disc_search import sample_points
from matchset.localization.next_ball.next_ball_tracker import NextBallParameters, NextBallTracker
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

CAMERA = CameraModel.from_fov(640, 480, math.pi / 2.0)
TARGET = BallTarget()
BLUE, WALL = (190, 70, 30), (150, 160, 155)
NEAR = np.array((0.0, -0.19, 1.5))
PLACE = np.array((0.0, -0.19, 3.05))  # of the next ball, where everybody holds the set place


def circle(ball: np.ndarray) -> Circle:
    """What a camera shows of a ball, but for the little by which that is no circle."""
    x, y = CAMERA.project(ball[np.newaxis])[0]
    return Circle(float(x), float(y), 320.0 * TARGET.radius / math.sqrt(ball @ ball - TARGET.radius**2))


def painted(*balls: np.ndarray, seed: int = 0) -> Frame:
    """Paint balls on a wall, the farthest first."""
    image = np.full((480, 640, 3), WALL, np.uint8)
    for ball in sorted(balls, key=lambda each: -each[2]):
        disc = circle(ball)
        place = round(256 * disc.x), round(256 * disc.y)
        cv2.circle(image, place, round(256 * disc.radius), BLUE, -1, cv2.LINE_AA, 8)
    image[:] = cv2.GaussianBlur(image, (0, 0), 0.8)
    noise = np.random.default_rng(seed).normal(0.0, 4.0, image.shape)
    return Frame(np.clip(image + noise, 0, 255).astype(np.uint8), seed / 30.0, seed)


def color() -> ColorModel:
    disc = circle(NEAR)
    return ColorModel.pick(painted(NEAR).image, disc.x, disc.y)


COLOR = color()


def tracker() -> NextBallTracker:
    return NextBallTracker(CAMERA, TARGET, COLOR)


@pytest.mark.parametrize("far", [(0.0, -0.19, 3.05), (0.25, -0.2, 2.95), (-0.6, 0.1, 3.2)])
def test_a_ball_that_is_followed_is_found_where_it_is(far: tuple[float, float, float]) -> None:
    ball, expected = np.array(far), np.array(far) + np.array((0.04, 0.03, 0.0))
    sought = tracker()
    for seed in range(5):
        pose = sought.update(painted(NEAR, ball, seed=seed), COLOR, circle(NEAR), expected, followed=True)
        assert isinstance(pose, Pose)
        assert pose.rotation_matrix is None
        assert pose.distance == pytest.approx(math.sqrt(ball @ ball), rel=0.06)
        assert CAMERA.project(pose.position[np.newaxis])[0] == pytest.approx(
            CAMERA.project(ball[np.newaxis])[0], abs=1.0
        )
        track = sought.ball
        assert isinstance(track, Track)
        disc = circle(NEAR)
        assert (np.hypot(*(track.match_set - (disc.x, disc.y)).T) > disc.radius + 1.0).all()  # none of the neighbor's


@pytest.mark.parametrize("aside", [(0.3, -0.2, 0.0), (-0.9, 0.3, 0.0), (0.8, -0.5, 0.1)])
def test_a_ball_far_aside_and_higher_is_found_in_the_first_picture(aside: tuple[float, float, float]) -> None:
    ball = PLACE + np.array(aside)
    pose = tracker().update(painted(NEAR, ball), COLOR, circle(NEAR), PLACE, followed=False)
    assert isinstance(pose, Pose)
    assert pose.position == pytest.approx(ball, abs=0.15)


@pytest.mark.parametrize("followed", [True, False])
def test_a_ball_whose_fields_lie_apart_is_found(followed: bool) -> None:
    ball, moved = PLACE + np.array((0.5, -0.3, 0.0)), np.array((0.08, 0.0, 0.0))  # between two fields
    for seed in range(5):
        frame, later = painted(NEAR, ball, seed=seed), painted(NEAR, ball + moved, seed=seed + 5)
        frame.image[1::2] = later.image[1::2]
        pose = tracker().update(frame, COLOR, circle(NEAR), ball + 0.5 * moved, followed)
        assert isinstance(pose, Pose)
        assert CAMERA.project(pose.position[np.newaxis])[0] == pytest.approx(
            CAMERA.project((ball + 0.5 * moved)[np.newaxis])[0],
            abs=5.0,  # of one field
        )


def test_what_is_hidden_or_outside_is_lost_with_a_reason() -> None:
    hidden = NEAR * 2.0
    pose = tracker().update(painted(NEAR, hidden), COLOR, circle(NEAR), hidden, followed=True)
    assert isinstance(pose, Lost)
    assert "not seen where it should be" in pose.reason
    for away in ((5.0, 0.0, 2.0), (0.0, 0.0, -2.0)):
        outside = tracker().update(painted(NEAR), COLOR, circle(NEAR), np.array(away), followed=True)
        assert isinstance(outside, Lost)
        assert "not in the picture" in outside.reason


@pytest.mark.parametrize("corners", [4, 5])
@pytest.mark.parametrize("size", [1.1, 1.25, 1.4])
def test_a_card_of_the_balls_color_and_size_is_not_taken_for_it(corners: int, size: float) -> None:
    disc, angles = circle(PLACE + np.array((0.6, -0.2, 0.0))), np.linspace(0.0, 2.0 * math.pi, corners, endpoint=False)
    outline = size * disc.radius * np.column_stack((np.cos(angles + 0.3), np.sin(angles + 0.3)))
    for seed in range(3):
        frame = painted(NEAR, seed=seed)
        cv2.fillPoly(frame.image, [np.round(outline + np.array((disc.x, disc.y))).astype(np.int32)], BLUE, cv2.LINE_AA)
        assert isinstance(tracker().update(frame, COLOR, circle(NEAR), PLACE, followed=False), Lost)


@pytest.mark.parametrize("away", [(-2.57, 0.22, 1.18), (40.0, 0.0, 1.0), (0.0, -3.0, 0.2)])
def test_a_place_for_which_the_lens_has_no_pixel_is_lost(away: tuple[float, float, float]) -> None:
    barrel = msgspec.structs.replace(CAMERA, distortion=(-0.08, 0.0, 0.0, 0.0, 0.0))
    outside = NextBallTracker(barrel, TARGET, COLOR).update(
        painted(NEAR), COLOR, circle(NEAR), np.array(away), followed=True
    )
    assert isinstance(outside, Lost)
    assert "not in the picture" in outside.reason


@pytest.mark.parametrize("distance", [1.0 / 1.5, 1.5])
@pytest.mark.parametrize("followed", [True, False])
def test_another_vehicles_ball_is_not_taken_for_it(distance: float, followed: bool) -> None:
    expected = np.array((0.6, -0.3, 3.0))
    sought = tracker()
    for seed in range(11):
        other = painted(NEAR, expected * distance, seed=seed)
        assert isinstance(sought.update(other, COLOR, circle(NEAR), expected, followed), Lost)


def test_the_neighbors_own_outline_is_no_ball() -> None:
    for x in np.linspace(-0.4, 0.4, 9):
        for y in (-0.5, -0.19, 0.1):
            sought = tracker()
            for seed in range(3):
                pose = sought.update(
                    painted(NEAR, seed=seed), COLOR, circle(NEAR), np.array((x, y, 3.0)), followed=True
                )
                assert isinstance(pose, Lost)


def test_a_fit_whose_disc_has_too_little_of_the_color_is_not_the_ball() -> None:
    for least, found in ((0.7, True), (1.9, False)):
        sought = NextBallTracker(CAMERA, TARGET, COLOR, NextBallParameters(score=least))
        sought.update(painted(NEAR, PLACE), COLOR, circle(NEAR), PLACE, followed=True)
        assert isinstance(sought.ball, Track) is found


def test_a_copy_goes_on_by_itself() -> None:
    sought, ball = tracker(), np.array((0.5, -0.2, 3.0))
    other = copy.deepcopy(sought)
    found = sought.update(painted(NEAR, ball), COLOR, circle(NEAR), ball, followed=True)
    assert isinstance(other.ball, Lost)
    again = other.update(painted(NEAR, ball), COLOR, circle(NEAR), ball, followed=True)
    assert isinstance(found, Pose)
    assert isinstance(again, Pose)
    np.testing.assert_array_equal(found.position, again.position)


def test_the_points_are_spread_evenly() -> None:
    points = sample_points(64, 32, (0.9, 1.2, 1.5))
    away = np.hypot(points[:, 0], points[:, 1])
    np.testing.assert_array_equal(points[:, 2], (away <= 0.9).astype(float))
    assert ((away <= 0.9) | ((away >= 1.2) & (away <= 1.5))).all()
    assert np.median(away[:64]) == pytest.approx(0.9 / math.sqrt(2.0), rel=0.02)
    assert np.abs(points[:64, :2].mean(axis=0)).max() < 0.03


@pytest.mark.parametrize("wrong", [{"points": 15}, {"inside": 2}, {"rings": (0.9, 0.8, 1.5)}, {"reach": 0.0}])
def test_what_cannot_be_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        NextBallParameters(**wrong)  # type: ignore[arg-type]
