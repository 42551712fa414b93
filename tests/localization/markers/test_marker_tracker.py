import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial.transform import Rotation

import matchset as ms
from balls import PINHOLE, Floats
from matchset.localization.ball_target import BALLOON
from matchset.localization.markers.marker_fit import fit_marker, new_rows, sum_equations
from matchset.localization.markers.marker_patch import new_patch, read_patch
from matchset.localization.markers.marker_shape import SoftEllipse, coverage, ellipse_axes
from matchset.localization.markers.marker_workspace import MARKERS, MarkerFitParameters, MarkerParameters
from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, fields, new_block, store
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from naive_marker import Scale, Sight, normal_equations, picture_of_marker

BLUE = ms.ColorModel.hsv((95, 120, 20), (119, 255, 255))
PURPLE = ms.ColorModel.hsv((132, 110, 20), (165, 255, 255))
PLACE = np.array((0.1, -0.05, 1.5))


@kernel
def fit_one(image: npt.NDArray[np.uint8], block: Block, which: int) -> None:
    fit_marker(image, block.view(MARKERS)[0], which)


@kernel
def sum_one(image: npt.NDArray[np.uint8], block: Block, which: int) -> None:
    work = block.view(MARKERS)[0]
    span = work.window.span
    patch = new_patch(span)
    read_patch(image, work, which, patch)
    sum_equations(patch, work, new_rows(span * (span + 1)))


def workspace(ball: Floats, places: Floats, size: float, depth: float, softness_px: float) -> tuple[Block, Any]:
    """A block of a ball (x, y, radius) with markers, and its fields."""
    block = new_block(MARKERS)
    work = fields(block, MARKERS)
    store(work.limits, MarkerParameters(fit=MarkerFitParameters(softness_px=softness_px)))
    work.ball.x, work.ball.y, work.ball.radius = ball
    work.patch_radius, work.rim_distance, work.count = size, depth, len(places)
    work.places[: len(places)] = places
    return block, work


def looking(off_deg: float, side_deg: float, place: Floats = PLACE) -> Rotation:
    """Rotation whose marker 0 looks `off_deg` past the camera, to a side."""
    sight = -place / np.linalg.norm(place)
    side = math.radians(side_deg)
    across = np.cross(sight, (math.cos(side), math.sin(side), 0.0))
    away = Rotation.from_rotvec(math.radians(off_deg) * across / np.linalg.norm(across)).apply(sight)
    y = np.array((0.0, 1.0, 0.0)) - away[1] * away
    y /= np.linalg.norm(y)
    return Rotation.from_matrix(np.column_stack((np.cross(y, away), y, away)))


def errors_deg(preset: str, off_deg: float, side_deg: float, frames: int = 5, seed: int = 100) -> list[float]:
    turn = looking(off_deg, side_deg)
    flight = BallFlightClip(
        camera=PINHOLE, place=lambda _: PLACE, turn=lambda _: turn,
        frames=frames, seed=seed, scene_seed=5, preset=preset,
    )  # fmt: skip
    target, found = BALLOON, []
    x, y = PINHOLE.project(PLACE[np.newaxis])[0].tolist()
    tracker = ms.Tracker(ms.Circle, BLUE | PURPLE, start=(x, y))
    finder, localizer = ms.MarkerTracker(PURPLE, target), ms.Localizer(PINHOLE, target)
    for frame in flight:
        ball = tracker.update(frame)
        pose = localizer.update(ball, finder.update(frame, ball))
        assert isinstance(pose, ms.Pose)
        if frame.index > 0:
            assert pose.observed == "level"
            assert pose.rotation_matrix is not None
            cosine = float(pose.rotation_matrix[:, 2] @ turn.as_matrix()[:, 2])
            found.append(math.degrees(math.acos(min(cosine, 1.0))))
    return found


@pytest.mark.parametrize(("off", "side"), [(0.0, 0.0), (40.0, 0.0), (60.0, 180.0), (40.0, 90.0)])
def test_the_direction_of_a_marker_on_analog_video(off: float, side: float) -> None:
    errors = errors_deg("typical", off, side)
    assert math.sqrt(np.mean(np.square(errors))) < 3.0


def test_the_direction_of_a_marker_on_clean_video() -> None:
    assert max(errors_deg("clean", 30.0, 20.0)) < 1.0


def test_a_marker_out_of_sight_leaves_the_position() -> None:
    turn = looking(150.0, 0.0)
    flight = BallFlightClip(camera=PINHOLE, place=lambda _: PLACE, turn=lambda _: turn, frames=3, seed=1, scene_seed=5)
    x, y = PINHOLE.project(PLACE[np.newaxis])[0].tolist()
    tracker, finder = ms.Tracker(ms.Circle, BLUE | PURPLE, start=(x, y)), ms.MarkerTracker(PURPLE, BALLOON)
    localizer = ms.Localizer(PINHOLE, BALLOON)
    for frame in flight:
        ball = tracker.update(frame)
        assert ball
        assert finder.update(frame, ball) == ()
        pose = localizer.update(ball, ())
        assert isinstance(pose, ms.Pose)
        assert (pose.observed, pose.rotation) == ("position", None)


def test_a_lost_ball_has_no_markers_and_gray_pictures_are_refused() -> None:
    finder = ms.MarkerTracker(PURPLE, BALLOON)
    frame = ms.Frame(np.zeros((60, 80, 3), np.uint8))
    assert finder.update(frame, ms.Lost("gone", 0.0)) == ()
    with pytest.raises(ValueError, match="gray"):
        finder.update(ms.Frame(np.zeros((60, 80), np.uint8)), ms.Lost("gone", 0.0))


@pytest.mark.parametrize("at", [(0.0, 0.0), (0.5, -0.3), (-0.2, 0.8)])
def test_the_fit_finds_the_ellipse_of_a_patch_to_a_fraction_of_a_pixel(at: tuple[float, float]) -> None:
    size, depth = 0.214, 0.977
    ball = np.array((60.3, 59.6, 40.0))
    truth = ball[:2] + 40.0 * np.array(at)
    image = picture_of_marker(ball, truth, size, depth)
    block, work = workspace(ball, (truth + np.array((1.7, -1.2)))[np.newaxis], size, depth, 0.4)
    work.axis[:] = 0.0, 0.0, 1.0 / 120.0, -40.0 / 120.0  # red rises from 40 to 160
    work.brightness[:] = 1.0 / 200.0, 0.0, 0.0  # blue is 200 all over
    fit_one(image, block, 0)
    np.testing.assert_allclose(work.places[0], truth, atol=0.06)
    assert work.result.contrast == pytest.approx(1.0, abs=0.2)
    assert work.result.explained > 0.97
    assert work.result.noise < 0.1
    assert np.linalg.eigvalsh(work.result.covariance).min() > 0.0


@pytest.mark.parametrize("middle", [(55.2, 63.4), (41.7, 44.1), (4.5, 60.2)])
def test_the_sums_of_a_fit_agree_with_their_slow_twin(middle: tuple[float, float]) -> None:
    rng = np.random.default_rng(7)
    middles = np.array(((88.0, 70.0), middle))
    ball, other, at = np.array((58.3, 59.6, 57.0)), middles[0], middles[1]
    image = picture_of_marker(ball, ball[:2] + 0.2, 0.2, 0.98)
    image = np.clip(image + rng.normal(0.0, 9.0, image.shape), 0, 255).astype(np.uint8)
    scale = Scale(np.array((1e-3, -5e-4, 1.0 / 120.0, -0.5)), np.array((4e-3, 1e-3, 0.0)), np.array((0.8, 2e-3, -3e-3)))
    block, work = workspace(ball, middles, 0.2, 0.98, 0.8)
    ux, uy, ratio = ellipse_axes(at[0] - ball[0], at[1] - ball[1], 0.98 * ball[2], 0.25)
    sight = Sight(ball, at, other, np.array((ux, uy)), ratio, 11.0, 0.8, 18.5)
    work.axis[:], work.brightness[:], work.noise_correlation = scale.axis, scale.ground, 0.3
    window, sums = work.window, work.sums
    window.span, window.semi_axis, window.reach = 43, 11.0, 18.5
    window.left, window.top = math.floor(at[0] + 0.5) - 21, math.floor(at[1] + 0.5) - 21
    window.x, window.y = at[0] - window.left, at[1] - window.top
    window.axis_x, window.axis_y, window.ratio = ux, uy, ratio
    window.contrast, window.level, window.shading[:] = 0.9, 0.05, scale.shade
    sum_one(image, block, 1)
    expected, rest = normal_equations(image, sight, scale, 0.9, 0.05, 0.3)
    found = np.concatenate((sums.normal, sums.right_side, (sums.residual_square,)))
    np.testing.assert_allclose(found, expected[np.tril_indices(5)], rtol=2e-4, atol=2e-3)
    assert sums.raw_square == pytest.approx(rest, rel=1e-4)


def test_the_derivative_of_the_coverage_is_its_change() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        place = rng.uniform(-25.0, 25.0, 2)
        shape = SoftEllipse(*ellipse_axes(place[0], place[1], 0.977 * 40.0, 0.25), 8.6, 1.0)
        dx, dy = rng.uniform(-10.0, 10.0, 2)
        share, right, down = coverage(dx, dy, shape)
        assert 0.0 <= share <= 1.0
        numeric = [
            float(coverage(dx - h, dy - v, shape)[0] - coverage(dx + h, dy + v, shape)[0]) / 2e-4
            for h, v in ((1e-4, 0.0), (0.0, 1e-4))
        ]
        np.testing.assert_allclose(
            (float(right), float(down)), numeric, atol=0.03
        )  # the slope itself is taken to be constant


@pytest.mark.parametrize("beyond", [-12.0, -6.0, 2.0, 4.0, 6.0, 8.0])
def test_no_marker_is_placed_beyond_the_border(beyond: float) -> None:
    """Where its center is, less than half of it is in the picture."""
    rows, columns = np.indices((120, 240))
    image = np.full((120, 240, 3), 120, np.uint8)
    image[np.hypot(columns - 130, rows - 60) < 40] = (190, 70, 30)
    image[np.hypot(columns - 159.5 - beyond, rows - 60) < 9] = (120, 30, 110)
    noise = np.random.default_rng(5).normal(0.0, 8.0, image.shape)
    image = np.clip(image + noise, 0, 255).astype(np.uint8)[:, :160].copy()
    ball = ms.Track(ms.Circle(130.0, 60.0, 40.0), np.diag((0.01, 0.01, 0.01)), 1.0, np.empty((0, 2)), 0.0)
    finder = ms.MarkerTracker(PURPLE, BALLOON)
    for index in range(3):
        found = finder.update(ms.Frame(image, index / 30.0, index), ball)
        assert found or beyond > 0.0
        assert all(marker.shape.x < 159.5 for marker in found)


def _resting(place: Floats) -> Callable[[float], Floats]:
    return lambda _: place


def marked(place: Floats, turn: Rotation) -> tuple[ms.Frame, ms.Track[ms.Circle], tuple[float, float]]:
    """A picture of a ball at a place, m, turned so; its track, and where its marker is seen, px."""
    flight = BallFlightClip(
        camera=PINHOLE, place=_resting(place), turn=lambda _: turn, frames=1, seed=100, scene_seed=5,
        preset="clean",
    )  # fmt: skip
    frame = next(iter(flight))
    tracker = ms.Tracker(ms.Circle, BLUE | PURPLE, start=tuple(PINHOLE.project(place[np.newaxis])[0].tolist()))
    ball = tracker.update(frame)
    (marker,) = ms.MarkerTracker(PURPLE, BALLOON).update(frame, ball)
    assert isinstance(ball, ms.Track)
    return frame, ball, (marker.shape.x, marker.shape.y)


@pytest.mark.parametrize("apart", [(0.0, 14.0), (6.0, -9.0), (-8.0, 0.0)])
def test_both_fields_of_an_interlaced_picture_show_one_marker(apart: tuple[float, float]) -> None:
    turn, target = looking(15.0, 40.0), BALLOON
    pictures, places, circles = [], [], []
    for sign in (1.0, -1.0):  # even rows, odd rows
        shift = sign * 0.5 * PLACE[2] / PINHOLE.intrinsics[0] * np.array((*apart, 0.0))
        frame, ball, place = marked(PLACE + shift, turn)
        pictures.append(frame.image)
        circles.append(ball.shape.state)
        places.append(place)
    both = pictures[0].copy()
    both[1::2] = pictures[1][1::2]
    whole = ms.Track(
        ms.Circle.from_state(np.mean(circles, axis=0)), 0.01 * np.eye(3), 1.0, np.empty((0, 2)), 0.0, field_offset=apart
    )
    finder = ms.MarkerTracker(PURPLE, target)
    for _ in range(2):  # found, then followed
        (marker,) = finder.update(both, whole)
        assert math.dist((marker.shape.x, marker.shape.y), np.mean(places, axis=0).tolist()) < 0.3


@pytest.mark.parametrize("moved", [(0.0, 14.0), (6.0, -9.0), (-8.0, 0.0)])
def test_a_marker_in_half_frames_is_where_the_new_rows_show_it(moved: tuple[float, float]) -> None:
    turn, pictures, balls, places = looking(15.0, 40.0), [], [], []
    for k in range(4):
        frame, ball, place = marked(PLACE + k * PLACE[2] / PINHOLE.intrinsics[0] * np.array((*moved, 0.0)), turn)
        pictures.append(frame.image)
        balls.append(ball)
        places.append(place)
    finder, woven = ms.MarkerTracker(PURPLE, BALLOON), pictures[0]
    for k, (picture, ball) in enumerate(zip(pictures, balls, strict=True)):
        woven = woven.copy()
        woven[k % 2 :: 2] = picture[k % 2 :: 2]
        half = ms.Frame(woven, k / 60.0, k, rows="bottom" if k % 2 else "top")
        (marker,) = finder.update(half, ball)
        if k:  # of the first field the other one is not known
            nearer = 0.05 * math.hypot(*moved)  # the marker is before the middle of the ball, and moves by more
            assert math.dist((marker.shape.x, marker.shape.y), places[k]) < 0.1 + nearer
