"""When a shape was found, and how sure that was: `Track.acquired`."""

import math

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.tracking.track import Acquisition

BALL, WALL = (40, 60, 210), (120, 130, 110)


def picture(x: float | None, index: int) -> ms.Frame:
    noise = np.random.default_rng(index).normal(0.0, 3.0, (180, 320, 3))
    image = np.full((180, 320, 3), WALL, np.uint8)
    if x is not None:
        cv2.circle(image, (round(16 * x), 16 * 90), 16 * 24, BALL, -1, cv2.LINE_AA, 4)
    return ms.Frame(np.clip(image + noise, 0.0, 255.0).astype(np.uint8), index / 30.0, index)


def test_a_track_says_when_it_was_found_again_and_how_sure_that_was() -> None:
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(picture(100.0, 0), 100.0, 90.0), start=(100.0, 90.0))
    hidden = range(8, 12)
    answers = [tracker.update(picture(None if k in hidden else 100.0 + 4.0 * k, k)) for k in range(16)]
    for k, answer in enumerate(answers):
        assert isinstance(answer, ms.Lost if k in hidden else ms.Track), k
        if isinstance(answer, ms.Track):
            assert answer.acquired is not None
            assert answer.acquired.time == (0.0 if k < 8 else 12 / 30.0)
            assert answer.acquired.probability is not None
            assert answer.acquired.probability > 0.5


def test_who_said_where_it_is_acquired_it() -> None:
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(picture(100.0, 0), 100.0, 90.0))
    tracker.start(ms.Circle(101.0, 91.0, 23.0))
    answer = tracker.update(picture(100.0, 0))
    assert isinstance(answer, ms.Track)
    assert answer.acquired is None


@pytest.mark.parametrize("log_odds", [-800.0, -2.0, 0.0, 3.0, 800.0])
def test_log_odds_are_a_probability(log_odds: float) -> None:
    probability = Acquisition(0.0, log_odds).probability
    assert probability is not None
    assert 0.0 <= probability <= 1.0
    if abs(log_odds) < 30.0:
        assert math.log(probability / (1.0 - probability)) == pytest.approx(log_odds)
    assert Acquisition(0.0).probability is None
