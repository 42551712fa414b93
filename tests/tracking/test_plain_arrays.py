"""Plain arrays in place of frames: numbered, timed by a rate or the clock, never mixed with frames."""

from typing import Any

import cv2
import numpy as np
import pytest

import matchset as ms

BALL = (200, 60, 30)


def picture(index: int) -> np.ndarray:
    image = np.full((120, 160, 3), 90, np.uint8)
    cv2.circle(image, (50 + 2 * index, 50 + index), 20, BALL, -1, cv2.LINE_AA)
    return image


COLOR = ms.ColorModel.pick(picture(0), 50, 50)


def tracker(**options: Any) -> ms.Tracker[ms.Circle]:
    return ms.Tracker(ms.Circle, COLOR, **options)


@pytest.mark.parametrize("fps", [30.0, 120])
def test_arrays_give_the_answers_of_frames_at_their_rate(fps: float) -> None:
    plain, framed = tracker(fps=fps), tracker()
    for index in range(12):
        one, other = plain.update(picture(index)), framed.update(ms.Frame(picture(index), index / fps, index))
        assert isinstance(one, ms.Track)
        assert isinstance(other, ms.Track)
        assert one.shape == other.shape
        assert one.time == other.time == index / fps
        assert np.array_equal(one.covariance, other.covariance)


def test_without_a_rate_their_time_is_that_of_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([7.0, 7.5])
    monkeypatch.setattr("matchset.image.frame.time.monotonic", lambda: next(times))
    plain = tracker(fps=None)
    assert [plain.update(picture(index)).time for index in range(2)] == [7.0, 7.5]


def test_gray_arrays_are_tracked() -> None:
    plain = ms.Tracker(ms.Circle, ms.ColorModel.dark())
    track = plain.update(255 - picture(0)[..., 0])
    assert isinstance(track, ms.Track)
    assert track.shape.x == pytest.approx(50.0, abs=0.3)


def test_an_array_handed_in_is_neither_kept_nor_changed() -> None:
    image = picture(0)
    tracker().update(image)
    assert np.array_equal(image, picture(0))


@pytest.mark.parametrize("first_array", [True, False])
def test_frames_and_arrays_are_not_mixed(first_array: bool) -> None:
    pictures: list[Any] = [ms.Frame(picture(0), 0.0), picture(1)]
    came, before = ("Frame", "arrays") if first_array else ("array", "Frames")
    one, other = pictures[::-1] if first_array else pictures
    mixed = tracker()
    mixed.update(one)
    with pytest.raises(ValueError, match=rf"this {came} comes after {before}.*ms.Frame\(image, time\)"):
        mixed.update(other)
    assert mixed.update(one if first_array else ms.Frame(picture(1), 0.1))
    mixed.restart()
    assert mixed.update(other)


def test_a_picture_that_was_refused_leaves_the_tracker_as_it_was() -> None:
    plain = tracker()
    assert plain.update(picture(0))
    with pytest.raises(ValueError, match="frames before it had"):
        plain.update(picture(0)[:100])
    assert plain.update(picture(1))


def test_restarted_arrays_are_numbered_anew() -> None:
    plain = tracker()
    for index in range(3):
        plain.update(picture(index))
    plain.restart()
    assert plain.update(picture(0)).time == 0.0


def test_detect_and_colors_take_either() -> None:
    frame = ms.Frame(picture(3), 0.1, 3)
    (plain,), (framed,) = (ms.detect(each, ms.Circle, COLOR) for each in (frame.image, frame))
    assert plain.shape == framed.shape
    assert (plain.time, framed.time) == (0.0, 0.1)
    for one, other in (
        (ms.ColorModel.pick(frame, 56, 53), ms.ColorModel.pick(frame.image, 56, 53)),
        (ms.ColorModel.learn(frame, (50, 50, 6, 6)), ms.ColorModel.learn(frame.image, (50, 50, 6, 6))),
    ):
        assert np.array_equal(one.table, other.table)
        assert np.array_equal(one.mask(frame), one.mask(frame.image))


def test_markers_and_neighbors_take_arrays() -> None:
    image = picture(0)
    cv2.circle(image, (50, 50), 4, (160, 20, 160), -1, cv2.LINE_AA)
    purple, target = (
        ms.ColorModel.hsv((140, 60, 40), (165, 255, 255)),
        ms.BallTarget(diameter=0.28, markers=((0, 0, 1),)),
    )
    either = ms.ColorModel.pick(picture(0), 60, 50) | purple
    ball = ms.Tracker(ms.Circle, either).update(image)
    plain, framed = (
        ms.MarkerTracker(purple, target).update(each, ball) for each in (image, ms.Frame(image, ball.time))
    )
    assert [each.shape for each in plain] == [each.shape for each in framed] != []
    neighbors = ms.Neighbors(ms.CameraModel.from_fov(160, 120, 1.07), target, either, purple, fps=10.0)
    for _ in range(4):
        seen = neighbors.update(image)
    (one_ball,) = seen
    assert one_ball.pose.time == pytest.approx(0.3)
    with pytest.raises(ValueError, match="this Frame comes after arrays"):
        neighbors.update(ms.Frame(image, 9.0))
