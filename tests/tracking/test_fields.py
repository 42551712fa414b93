"""Fast balls over an interlaced link: its two fields show them at two places."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from benchmarks.contest.field import OURS, peer
from benchmarks.contest.run import follow_with_all
from benchmarks.tracking.trial import sequence

from matchset.app.track.score import error_px
from matchset.sim.clips.clip import Clip

SEEDS = 260, 261


def errors(clip: Clip, wanted: Callable[[int], bool] = lambda _: True) -> list[float]:
    """Error (Eq. 10) in the frames that the tracker is given, px; infinite where it loses a ball well visible."""
    frames = (pair for pair in clip if wanted(pair[0].index))
    trial = follow_with_all(frames, None, [peer(OURS)], clip.seed)[OURS]
    return [
        error_px(answer, truth.circle) if answer else math.inf
        for truth, answer in zip(trial.truths, trial.answers, strict=True)
        if truth.tight and truth.circle
    ]


@pytest.mark.parametrize("seed", SEEDS)
def test_twenty_pixels_a_frame_are_followed_to_a_pixel(seed: int) -> None:
    found = errors(sequence("fast", seed, 90))
    assert max(found) < 5.0
    assert np.mean(found) < 1.0


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("wanted", [lambda k: k % 2 == 0, lambda k: k % 3 != 1], ids=["every second", "two of three"])
def test_frames_that_are_left_out_do_not_part_the_fields(seed: int, wanted: Callable[[int], bool]) -> None:
    found = errors(sequence("typical", seed, 90), wanted)
    assert max(found) < 5.0
    assert np.mean(found) < 0.6


def test_a_fast_ball_in_whole_frames_has_no_fields() -> None:
    found = errors(sequence("clean", SEEDS[0], 90, speed=2.0))
    assert max(found) < 1.0
    assert np.mean(found) < 0.25
