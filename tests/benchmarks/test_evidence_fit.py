"""The regression behind the weights of evidence: known weights come back, and its terms are those of the log-odds."""

import numpy as np
import pytest
from benchmarks.evidence import WEIGHTS, fit_weights, is_beside, is_right, recalls, terms_of
from scipy.special import expit

from matchset.app.track.score import TruthRow
from matchset.fitting.evidence import ColorStep, EvidenceParameters, log_odds
from matchset.fitting.workspace import FitStatistics


def some_fit(rng: np.random.Generator) -> FitStatistics:
    """Statistics of no fit in particular, but for a size that is now small, now large."""
    values = dict(zip(FitStatistics._fields, rng.uniform(0.0, 1.0, len(FitStatistics._fields)), strict=True))
    return FitStatistics(**(values | {"half_width": rng.uniform(2.0, 60.0), "visible": 64.0, "inliers": 40.0}))


@pytest.mark.parametrize("seed", range(5))
def test_terms_times_weights_are_the_log_odds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    fit, step, tolerance = some_fit(rng), ColorStep(*rng.uniform(0.0, 1.0, 2)), rng.uniform(1.0, 3.0)
    limits = EvidenceParameters(small_px=12.0)
    weights = np.array([getattr(limits, name) for name in (*WEIGHTS, "bias")])
    assert terms_of(fit, step, tolerance) @ weights == pytest.approx(log_odds(fit, step, tolerance, limits), abs=1e-12)


def test_every_weight_of_the_log_odds_is_fitted() -> None:
    rng = np.random.default_rng(7)
    fit, step = some_fit(rng)._replace(half_width=6.0), ColorStep(0.4, 0.2)
    base = log_odds(fit, step, 1.2, EvidenceParameters())
    moved = {
        name
        for name in EvidenceParameters.__struct_fields__
        if log_odds(fit, step, 1.2, EvidenceParameters(**{name: getattr(EvidenceParameters(), name) + 1})) != base
    }
    assert moved == {*WEIGHTS, "bias", "small_px"}


def test_regression_recovers_known_weights() -> None:
    rng = np.random.default_rng(3)
    known = np.array([2.0, -3.0, 0.5, 0.0])  # the last is the bias: classes are as frequent as each other
    terms = np.column_stack((rng.normal(size=(40_000, 3)), np.ones(40_000)))
    is_target = rng.uniform(size=len(terms)) < expit(terms @ known)
    assert fit_weights(terms, is_target) == pytest.approx(known, abs=0.12)


def test_classes_count_the_same_however_many_there_are() -> None:
    rng = np.random.default_rng(4)
    terms = np.column_stack((rng.normal(size=20_000), np.ones(20_000)))
    is_target = rng.uniform(size=len(terms)) < expit(1.5 * terms[:, 0])
    fewer = is_target | (np.arange(len(terms)) % 10 == 0)
    assert fit_weights(terms[fewer], is_target[fewer]) == pytest.approx(fit_weights(terms, is_target), abs=0.15)


def test_one_class_alone_is_refused() -> None:
    with pytest.raises(ValueError, match="got 0 targets of 5"):
        fit_weights(np.ones((5, 2)), np.zeros(5, np.bool_))


def test_recall_counts_targets_above_what_that_share_of_others_exceeds() -> None:
    targets, others = np.array([-1.0, 5.0, 98.5, 990.0, 2000.0]), np.arange(1000.0)
    assert recalls(targets, others) == [0.2, 0.2, 0.2, 0.4]


def test_fits_on_the_target_are_neither_right_nor_others() -> None:
    truth = TruthRow(0, (100.0, 80.0, 40.0))
    assert is_right((103.0, 82.0, 43.0), truth)
    assert not is_right((110.0, 85.0, 40.0), truth)
    assert is_beside((110.0, 85.0, 40.0), truth.circle)
    assert not is_beside((200.0, 80.0, 30.0), truth.circle)
    assert not is_right((103.0, 82.0, 43.0), TruthRow(0, None))
