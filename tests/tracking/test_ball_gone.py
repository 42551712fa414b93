"""A ball that has left the picture is not found in what is of its color: whole films, rendered."""

from unittest.mock import patch

import numpy as np
import pytest
from benchmarks.tracking.false_locks import Task, watch
from hidden_ball import picture

import matchset as ms
from matchset.image.disc_network.network import Disc
from matchset.sim.clips.clip import Clip
from matchset.tracking.ball.discs import middle_pixels
from matchset.tracking.ball.judge import Judge
from matchset.tracking.ball.parameters import BallSearchParameters
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.outline_choice import OutlineChoice
from matchset.tracking.parameters import TrackerParameters


@pytest.mark.parametrize("seed", [101508, 101520, 303537])
def test_nothing_is_taken_for_a_ball_that_is_gone(seed: int) -> None:
    """Small discs of the color, a fifth of its size, and blue things that only edges take for a ball."""
    assert watch(Task(seed, leaving=True)).false == []


@pytest.mark.parametrize("missed", [1.0, 5.0, 50.0, 1000.0])
def test_however_long_it_is_gone_its_size_stays_within_a_factor(missed: float) -> None:
    limits, last = BallSearchParameters(), Gate(160.0, 90.0, 26.0)
    inside = 1.3  # even in the next picture
    outside = limits.most_growth**1.01
    for factor, possible in ((inside, True), (outside, False), (1.0 / inside, True), (1.0 / outside, False)):
        image = picture(160.0)
        tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 160.0, 90.0), start=(160.0, 90.0))
        assert tracker.update(image)
        disc = Disc((160.0, 90.0, factor * last.half_width), np.eye(3), 9.0)
        with (
            patch.object(Judge, "discs", return_value=[disc]),
            patch.object(Judge, "seen", return_value=[disc]),
            patch.object(OutlineChoice, "fit_lost", return_value=False),
            patch("matchset.tracking.ball.estimator.middle_pixels", return_value=middle_pixels(image, last[:3], 0.7)),
        ):
            assert tracker._ball.find(image, tracker.color, last, last, (missed / 30.0, 1.0 / 30.0)) is possible


def test_without_a_search_of_the_whole_frame_a_lost_ball_is_looked_for_near_by_alone() -> None:
    """Otherwise the tracker of a ball that has left goes to another ball, which is somebody else's."""
    clip = Clip(frames=2, seed=3)
    first, _ = next(iter(clip))
    x, y = clip.first_click
    to = 0.25 if x > first.image.shape[1] / 2.0 else 0.75
    moved = np.roll(first.image, round(to * first.image.shape[1] - x), axis=1)
    color, found = ms.ColorModel.pick(first.image, x, y), []
    for whole_frame in (False, True):
        parameters = TrackerParameters(whole_frame=whole_frame)
        tracker = ms.Tracker(ms.Circle, color, start=(x, y), parameters=parameters)
        tracker.start(ms.Circle(*color.circle or (x, y, 40.0)))
        assert isinstance(tracker.update(first), ms.Track)
        later = [ms.Frame(moved, first.time + k / 30.0, first.index + k) for k in range(1, 5)]
        found.append(any(tracker.update(frame) for frame in later))
    assert found == [False, True]
