"""The bars of the benchmark on a few short clips that neither it nor the tuning uses."""

import functools

import pytest
from benchmarks.tracking import false_locks, reacquisition
from benchmarks.tracking.accuracy import GOALS, pooled
from benchmarks.tracking.covariance import figures
from benchmarks.tracking.trial import Trial, follow, sequence
from scenes import Answer

import matchset as ms
from matchset.sim.clips.clip import Clip

SEEDS = 210, 211


@functools.cache
def followed_of(name: str, seed: int) -> Trial:
    return follow(sequence(name, seed, 70))


@pytest.mark.parametrize("name", list(GOALS))
def test_the_bars_of_accuracy(name: str) -> None:
    (mean, valid), _ = GOALS[name]
    result = pooled([followed_of(name, seed) for seed in SEEDS])
    assert result.mean_error_px is not None
    assert result.valid_percent is not None
    assert result.mean_error_px <= mean
    assert result.valid_percent >= valid
    assert result.false_locks == 0


def test_the_covariance_is_honest() -> None:
    trials = [followed_of("typical", seed) for seed in (*SEEDS, 212, 213)]
    squares = [square for trial in trials for square in trial.squares if square is not None]
    below, mean = figures(squares)[:2]
    assert below.value is not None
    assert mean.value is not None
    assert 88.0 <= below.value <= 99.0
    assert 1.5 <= mean.value <= 4.8


@pytest.mark.parametrize("seed", [220, 221])
def test_it_is_found_again_after_a_second_behind_a_board(seed: int) -> None:
    back = reacquisition.watch(seed)
    assert back.held
    assert back.frames <= 3
    assert back.false_locks == 0


def followed(clip: Clip) -> list[tuple[Answer, bool, float]]:
    """Answer, whether any of the ball shows, and the share of its disc that does, frame by frame."""
    pairs = list(clip)
    color = ms.ColorModel.pick(pairs[0][0].image, *clip.first_click)
    tracker = ms.Tracker(ms.Circle, color, start=clip.first_click)
    return [(tracker.update(frame), truth.visible, truth.share) for frame, truth in pairs]


@pytest.mark.parametrize("seed", [230])
def test_it_leaves_and_returns(seed: int) -> None:
    story = followed(Clip(seed=seed, frames=110, away=((40, 70),)))
    absent = [answer for answer, visible, _ in story if not visible]
    assert len(absent) >= 25
    assert not any(absent)
    there = [bool(answer) for answer, _, share in story if share > 0.9]
    assert sum(there) >= len(there) - 3
    assert story[-1][0]


@pytest.mark.parametrize("leaving", [False, True])
def test_no_ball_is_seen_where_there_is_none(leaving: bool) -> None:
    tally = false_locks.watch(false_locks.Task(240, leaving))
    assert tally.absent >= 95
    assert tally.false == []


def test_it_follows_the_ball_down_to_four_pixels() -> None:
    clip = Clip(seed=250, frames=90, preset="clean", radii=(30.0, 40.0), shrink_to=4.0)
    result = pooled([follow(clip)])
    assert clip.truth(89).circle is not None
    assert result.valid == result.tight == 90
    assert result.mean_error_px is not None
    assert result.mean_error_px < 0.3
