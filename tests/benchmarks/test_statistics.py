import math

import numpy as np
import pytest
from benchmarks.options import parse_seeds
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.covariance import figures
from benchmarks.tracking.memory import growth
from benchmarks.tracking.trial import Trial, normalized_square

import matchset as ms
from matchset.app.track.score import TruthRow


def track(x: float, y: float, radius: float, covariance: list[list[float]]) -> ms.Track[ms.Circle]:
    return ms.Track(ms.Circle(x, y, radius), np.array(covariance), 1.0, np.zeros((0, 2)), 0.0)


def test_the_normalized_error_counts_in_standard_deviations() -> None:
    truth = TruthRow(0, (10.0, 20.0, 5.0))
    answer = track(12.0, 20.0, 6.0, [[4.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.25]])
    assert normalized_square(answer, truth) == pytest.approx(1.0 + 4.0)


def test_the_normalized_error_minds_correlation() -> None:
    covariance = np.array([[2.0, 0.9, 0.1], [0.9, 1.0, 0.0], [0.1, 0.0, 0.5]])
    error = np.array([0.3, -0.7, 1.1])
    answer = track(10.0 + error[0], 20.0 + error[1], 5.0 + error[2], covariance.tolist())
    expected = error @ np.linalg.inv(covariance) @ error
    assert normalized_square(answer, TruthRow(0, (10.0, 20.0, 5.0))) == pytest.approx(expected)


def test_a_covariance_that_is_none_is_never_honest() -> None:
    answer = track(10.0, 20.0, 5.0, [[0.0] * 3] * 3)
    assert normalized_square(answer, TruthRow(0, (10.0, 20.0, 5.0))) == math.inf


def test_what_was_not_answered_has_no_normalized_error() -> None:
    assert normalized_square(ms.Lost("gone", 0.0), TruthRow(0, (10.0, 20.0, 5.0))) is None
    assert normalized_square(track(1.0, 1.0, 1.0, np.eye(3).tolist()), TruthRow(0, None)) is None


def test_an_honest_tracker_passes() -> None:
    rng = np.random.default_rng(0)
    found = {figure.name: figure.value for figure in figures(rng.chisquare(3, 20_000).tolist())}
    assert found["below"] == pytest.approx(95.0, abs=0.5)
    assert found["mean"] == pytest.approx(3.0, abs=0.1)


def test_pooled_trials_count_every_frame_but_no_difference_across_trials() -> None:
    truths = [TruthRow(k, (10.0, 10.0, 5.0)) for k in range(3)]
    still = Trial(0, truths, [(10.0, 10.0, 5.0)] * 3, [0.0] * 3)
    shifted = Trial(1, truths, [(12.0, 10.0, 5.0)] * 3, [0.0] * 3)
    result = pooled([still, shifted])
    assert result.answered == 6
    assert result.mean_error_px == pytest.approx(1.0)
    assert result.trembling_px == pytest.approx(0.0)
    assert result.jitter_px == pytest.approx(0.0)


def test_errors_are_of_tight_answered_frames() -> None:
    truths = [TruthRow(0, (10.0, 10.0, 5.0)), TruthRow(1, (10.0, 10.0, 5.0), lowconf=True), TruthRow(2, None)]
    trial = Trial(0, truths, [(11.0, 10.0, 7.0), (10.0, 10.0, 5.0), None], [1.0, None, None])
    assert trial.errors == pytest.approx([3.0, math.nan, math.nan], nan_ok=True)


def test_memory_that_rises_is_not_flat() -> None:
    assert growth([50.0] + [80.0] * 99) == 0.0
    assert growth([float(k) for k in range(100)]) == pytest.approx(80.0)


def test_seeds_are_numbers_and_ranges() -> None:
    assert parse_seeds("100-103,200") == (100, 101, 102, 103, 200)


@pytest.mark.parametrize("text", ["", "a", "3-", "-3", "1.5", "5-2"])
def test_other_seeds_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="seeds"):
        parse_seeds(text)
