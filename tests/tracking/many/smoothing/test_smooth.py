"""Whole files explained together: names, beginnings, clicks, and what is refused."""

import copy
from pathlib import Path

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.sim.clips.multi_ball_clip import MultiBallClip, PositionFunction
from matchset.sim.clips.truth import sphere_outline
from matchset.tracking.many.smoothing.answers import TargetsAt
from matchset.tracking.many.smoothing.sweep import Click
from several_balls import BALLS, FRAMES, RADIUS, picture, places, write_pictures

CAMERA = ms.CameraModel.from_fov(640, 480, 1.25)


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("smooth") / "balls")


def blue() -> ms.ColorModel:
    return ms.ColorModel.pick(picture(0), *BALLS[0][1])


def seen(answers: list[TargetsAt], identity: int) -> dict[int, tuple[float, float]]:
    """Where a target is, by the index of the frame."""
    pairs = [(each.index, target) for each in answers for target in each.targets if target.identity == identity]
    return {
        index: (each.track.shape.x, each.track.shape.y) for index, each in pairs if isinstance(each.track, ms.Track)
    }


def near(place: tuple[float, float], other: tuple[float, float]) -> bool:
    return float(np.hypot(place[0] - other[0], place[1] - other[1])) < 0.3


def test_each_target_is_there_in_every_frame_and_the_tracker_stays_as_it_was(balls: Path) -> None:
    tracker = ms.MultiTracker(ms.Circle, blue())
    with ms.Video(balls) as video:
        found = tracker.smooth(video)
        assert next(video).index == 0
    assert [each.index for each in found] == list(range(FRAMES))
    for identity in (0, 1):
        way = seen(found, identity)
        assert sorted(way) == list(range(FRAMES))
        ball = 0 if near(way[0], places(0)[0]) else 1
        assert all(near(way[k], places(k)[ball]) for k in range(FRAMES))
    assert {target.identity for each in found for target in each.targets} == {0, 1}
    fresh = ms.MultiTracker(ms.Circle, blue())
    assert repr(tracker) == repr(fresh)
    assert [repr(each) for each in tracker.update(picture(0))] == [repr(each) for each in fresh.update(picture(0))]


def test_pictures_are_a_file_too(balls: Path) -> None:
    with ms.Video(balls) as video:
        tracker = ms.MultiTracker(ms.Circle, blue(), fps=video.fps)
        of_file = tracker.smooth(video)
        of_frames = tracker.smooth(list(video))
    images = [frame.image for frame in ms.Video(balls)]
    for other in (of_frames, tracker.smooth(images), copy.copy(tracker).smooth(images)):
        assert [each.time for each in other] == pytest.approx([each.time for each in of_file])
        for identity in (0, 1):
            assert seen(other, identity) == seen(of_file, identity)
    assert tracker.smooth([]) == []


def test_what_was_clicked_is_followed_both_ways_and_nothing_else(balls: Path) -> None:
    tracker = ms.MultiTracker(ms.Circle, blue(), finds=False)
    click = Click(15, places(15)[1])
    with ms.Video(balls) as video:
        found = tracker.smooth(video, [click])
    assert {target.identity for each in found for target in each.targets} == {0}
    way = seen(found, 0)
    assert sorted(way) == list(range(FRAMES))
    assert all(near(way[k], places(k)[1]) for k in range(FRAMES))
    twice = [click, Click(18, places(18)[1])]
    with ms.Video(balls) as video, pytest.raises(ValueError, match="is target 0, followed already"):
        tracker.smooth(video, twice)


def test_a_ball_that_is_found_late_is_there_from_where_it_enters() -> None:
    """One half of a ball is not found by a search; the backward reading follows it until it is gone."""

    def drawn(k: int) -> np.ndarray:
        image = np.full((240, 400, 3), 150, np.uint8)
        cv2.circle(image, (round(16 * (-26 + 5.0 * k)), 16 * 120), 16 * 24, (190, 70, 30), cv2.FILLED, cv2.LINE_AA, 4)
        return cv2.GaussianBlur(image, (0, 0), 0.8)

    frames = [drawn(k) for k in range(40)]
    tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(frames[30], 124.0, 120.0))
    first = next(k for k, frame in enumerate(frames) if copy_of(tracker, frames[: k + 1]))
    found = seen(tracker.smooth(frames), 0)
    assert min(found) < first
    assert all(abs(x - (-26 + 5.0 * k)) < 1.5 for k, (x, _) in found.items())


def copy_of(tracker: ms.MultiTracker, frames: list[np.ndarray]) -> bool:
    """Whether the last of some frames has a target that is seen."""
    followed = copy.deepcopy(tracker)
    answer = [followed.update(frame) for frame in frames][-1]
    return any(isinstance(each.track, ms.Track) for each in answer)


@pytest.mark.parametrize("seed", [11, 12, 13])
def test_one_that_hides_behind_another_keeps_its_name(seed: int) -> None:
    paths: list[PositionFunction] = [lambda t: (-0.8 + 0.4 * t, 0.0, 2.0), lambda t: (0.6 - 0.3 * t, 0.02, 1.4)]
    frames = list(MultiBallClip(camera=CAMERA, paths=paths, marked=(False, False), frames=120, seed=seed))

    def circles(k: int) -> list[ms.Circle]:
        return [sphere_outline(CAMERA, np.array(path(frames[k].time)), 0.14).circle() for path in paths]

    front = circles(0)[1]
    found = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(frames[0].image, front.x, front.y)).smooth(frames)
    for identity in (0, 1):
        met = set()
        for k, (x, y) in seen(found, identity).items():
            far = [np.hypot(x - each.x, y - each.y) / each.radius for each in circles(k)]
            met.add(int(np.argmin(far)))
        assert len(met) == 1
    assert max(len(each.targets) for each in found) == 2


def test_a_live_source_has_no_way_back(balls: Path) -> None:
    with ms.Video(balls) as video:
        video.live = True
        with pytest.raises(ValueError, match="a live source has no way back"):
            ms.MultiTracker(ms.Circle, blue()).smooth(video)


def test_radius_is_that_of_the_balls(balls: Path) -> None:
    with ms.Video(balls) as video:
        found = ms.MultiTracker(ms.Circle, blue()).smooth(video)
    radii = [each.track.shape.radius for at in found for each in at.targets if isinstance(each.track, ms.Track)]
    assert np.allclose(radii, RADIUS, atol=1.0)
