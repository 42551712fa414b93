"""A fit in the gate needs no search; a ball that jumps out of it is found by one, and nothing that is not there."""

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.tracking.ball.estimator import BallEstimator
from matchset.tracking.tracker import Tracker

Picture = npt.NDArray[np.uint8]
STILL, JUMP = 5, 12.0  # frames at rest, px in the frame after


def picture(x: float) -> Picture:
    rows, columns = np.indices((240, 320))
    image = np.random.default_rng(3).normal(130.0, 3.0, (240, 320, 3))
    image[np.hypot(columns - x, rows - 120.0) < 14.0] = (60.0, 180.0, 70.0)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.8).astype(np.uint8)


def rested() -> Tracker[ms.Circle]:
    """Tracker of a ball that has been at rest."""
    image = picture(150.0)
    color = ms.ColorModel.pick(image, 150.0, 120.0)
    tracker = ms.Tracker(ms.Circle, color, start=(150.0, 120.0))
    for index in range(STILL):
        assert tracker.update(ms.Frame(image, index / 30.0, index))
    return tracker


def test_a_ball_that_jumps_is_found_and_once_it_has_left_it_is_lost() -> None:
    tracker = rested()
    answer = tracker.update(ms.Frame(picture(150.0 + JUMP), STILL / 30.0, STILL))
    assert isinstance(answer, ms.Track)
    assert answer.shape.state[:3] == pytest.approx((150.0 + JUMP, 120.0, 14.0), abs=0.5)
    assert len(answer.match_set) > 32
    empty = picture(-100.0)
    for index in range(STILL + 1, STILL + 4):
        assert not tracker.update(ms.Frame(empty, index / 30.0, index))


def test_a_fit_in_the_gate_needs_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    tracker = rested()
    monkeypatch.setattr(Tracker, "_choose", None)  # so that a search would fail
    monkeypatch.setattr(BallEstimator, "find", None)
    assert tracker.update(ms.Frame(picture(152.0), STILL / 30.0, STILL))
