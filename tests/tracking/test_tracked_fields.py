"""Trackers in half-frames: edge points of the new rows only, at their time; exact where a whole frame is a comb."""

import math

import numpy as np
import pytest

import matchset as ms
from interlaced_videos import Pictures, ball_clip, circle_at, frames_of, pictures_of, upside_down
from matchset.fitting.workspace import SearchWindow
from matchset.image.frame import Frame, Rows
from matchset.media.fields.half_frames import HalfFrames
from matchset.sim.clips.clip import Clip
from matchset.tracking.compiled_step import tracking_fitter

CLIP = ball_clip(frames=40, speed=4.0, seed=44)


def halves_of(pictures: Pictures, first: str = "top") -> list[Frame]:
    splitter = HalfFrames("top" if first == "top" else "bottom", 30.0)
    return [half for frame in frames_of(pictures) for half in splitter.of(frame)]


def tracker_of(clip: Clip, turned: bool = False) -> ms.Tracker[ms.Circle]:
    picture, (x, y) = pictures_of(clip)[0], clip.first_click
    shown, y = (upside_down((picture,))[0], clip.height - 1 - y) if turned else (picture, y)
    return ms.Tracker(ms.Circle, ms.ColorModel.pick(shown, x, y), start=(x, y))


def errors(clip: Clip, frames: list[Frame], turned: bool = False) -> list[float]:
    """Distance from the truth at each frame's own time, of whole frames: of the mean of their fields, px."""
    tracker, found = tracker_of(clip, turned), list[float]()
    for frame in frames:
        track = tracker.update(frame)
        x, y, _ = circle_at(clip, frame.time)
        if frame.rows == "all":
            around = [circle_at(clip, frame.time + shift / 120.0) for shift in (-1.0, 1.0)]
            x, y = (0.5 * (around[0][k] + around[1][k]) for k in range(2))
        y = clip.height - 1 - y if turned else y
        found.append(math.dist((track.shape.x, track.shape.y), (x, y)) if isinstance(track, ms.Track) else math.inf)
    return found


def test_a_fast_ball_is_placed_better_than_in_whole_frames() -> None:
    pictures = pictures_of(CLIP)
    whole, half = errors(CLIP, frames_of(pictures)), errors(CLIP, halves_of(pictures))
    assert np.percentile(half, 95) < 0.7 * np.percentile(whole, 95)
    assert np.percentile(half, 95) < 0.7


def test_either_field_may_come_first() -> None:
    turned = upside_down(pictures_of(CLIP))
    assert np.percentile(errors(CLIP, halves_of(turned, "bottom"), turned=True), 95) < 0.7


@pytest.mark.parametrize(("rows", "old"), [("top", 1), ("bottom", 0)])
def test_a_fit_reads_nothing_of_the_rows_that_are_not_new(rows: Rows, old: int) -> None:
    picture = pictures_of(CLIP)[3]
    circle = circle_at(CLIP, (3 + (-0.25 if rows == "top" else 0.25)) / 30.0)
    color, fitter = ms.ColorModel.pick(pictures_of(CLIP)[0], *CLIP.first_click), tracking_fitter(ms.Circle, 64)
    fitter.take_rows(rows)
    states = []
    for seed in range(3):
        other = picture.copy()
        if seed:
            other[old::2] = np.random.default_rng(seed).integers(0, 256, other[old::2].shape, np.uint8)
        fitter.forget()
        estimate = fitter.fit(other, color, ms.Circle(*circle).state, SearchWindow(8.0, 10.0, use_prior=False))
        states.append(estimate.state)
    np.testing.assert_array_equal(states[0], states[1])
    np.testing.assert_array_equal(states[0], states[2])
    assert math.dist(states[0][:2].tolist(), circle[:2]) < 0.5


def test_whole_frames_after_half_frames_are_read_whole() -> None:
    pictures = pictures_of(CLIP)
    fresh, used = tracking_fitter(ms.Circle, 64), tracking_fitter(ms.Circle, 64)
    color, start = ms.ColorModel.pick(pictures[0], *CLIP.first_click), ms.Circle(*circle_at(CLIP, 0.0)).state
    used.take_rows("top")
    used.fit(pictures[0], color, start, SearchWindow(6.0))
    used.forget()
    used.take_rows("all")
    expected = fresh.fit(pictures[0], color, start, SearchWindow(6.0))
    np.testing.assert_array_equal(used.fit(pictures[0], color, start, SearchWindow(6.0)).state, expected.state)


def test_detections_are_those_of_the_new_rows() -> None:
    index = 12
    pictures, color = pictures_of(CLIP), ms.ColorModel.pick(pictures_of(CLIP)[0], *CLIP.first_click)
    for half in halves_of(pictures)[2 * index : 2 * index + 2]:
        (track, *_) = ms.detect(half, ms.Circle, color)
        x, y, _ = circle_at(CLIP, half.time)
        assert math.dist((track.shape.x, track.shape.y), (x, y)) < 0.6


def test_rows_of_a_frame_are_all_top_or_bottom() -> None:
    picture = np.zeros((4, 4), np.uint8)
    with pytest.raises(ValueError, match="rows of a frame are all, top or bottom, got 'odd'"):
        Frame(picture, rows="odd")  # type: ignore[arg-type]
    assert repr(Frame(picture, 0.5, 3, rows="bottom")).endswith("index 3, bottom rows)")
