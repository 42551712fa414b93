"""A ball that has left the picture is not found in what is of its color: whole films, rendered."""

import numpy as np
import pytest
from benchmarks.tracking.false_locks import Task, watch

import matchset as ms
from matchset.sim.clips.clip import Clip
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.ball.lost_ball import _Expected
from matchset.tracking.motion import Gate
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.voting import SearchParameters


@pytest.mark.parametrize("seed", [101508, 101520, 303537])
def test_nothing_is_taken_for_a_ball_that_is_gone(seed: int) -> None:
    """Small discs of the color, a fifth of its size, and blue things that only edges take for a ball."""
    assert watch(Task(seed, leaving=True)).false == []


@pytest.mark.parametrize("missed", [1.0, 5.0, 50.0, 1000.0])
def test_however_long_it_is_gone_its_size_stays_within_a_factor(missed: float) -> None:
    limits, place = NetworkParameters(), Gate(100.0, 100.0, 40.0)
    expected = _Expected(place, 40.0, missed)
    for factor in (limits.returned, 1.0 / limits.returned):
        assert expected.log_odds(place._replace(half_width=40.0 * factor**1.01), limits) is None
    inside = place._replace(half_width=40.0 * min(limits.growth, limits.returned) ** 0.99)
    assert expected.log_odds(inside, limits) is not None


def test_without_a_search_of_the_whole_frame_a_lost_ball_is_looked_for_near_by_alone() -> None:
    """Otherwise the tracker of a ball that has left goes to another ball, which is somebody else's."""
    clip = Clip(frames=2, seed=3)
    first, _ = next(iter(clip))
    x, y = clip.first_click
    to = 0.25 if x > first.image.shape[1] / 2.0 else 0.75
    moved = np.roll(first.image, round(to * first.image.shape[1] - x), axis=1)
    color, found = ms.ColorModel.pick(first.image, x, y), []
    for whole_frame in (False, True):
        parameters = TrackerParameters(search=SearchParameters(whole_frame=whole_frame))
        tracker = ms.Tracker(ms.Circle, color, start=(x, y), parameters=parameters)
        tracker.start(ms.Circle(*color.circle or (x, y, 40.0)))
        assert isinstance(tracker.update(first), ms.Track)
        later = [ms.Frame(moved, first.time + k / 30.0, first.index + k) for k in range(1, 5)]
        found.append(any(tracker.update(frame) for frame in later))
    assert found == [False, True]
