"""Which discs are the same ball, and their mean."""

import math

import numpy as np
import pytest

from matchset.image.disc_network.mean_disc import are_same, mean_disc
from matchset.image.disc_network.network import Disc

EVEN = np.eye(3)
ONE = Disc((50.0, 40.0, 10.0), EVEN, 4.0)


def test_discs_are_the_same_within_a_share_of_the_radius() -> None:
    others = [ONE, ONE._replace(circle=(52.0, 41.0, 11.0)), ONE._replace(circle=(52.0, 42.0, 11.5))]
    assert are_same(others, ONE, 0.5).tolist() == [True, True, False]
    assert are_same(others, others[2], 0.5).tolist() == [True, True, True]


def test_one_disc_is_its_mean() -> None:
    found = mean_disc([ONE], np.array([4.0]), 0.5)
    assert found.circle == pytest.approx(ONE.circle)
    assert found.precision is ONE.precision
    assert found.log_odds == 4.0


def test_discs_count_by_their_precision_and_merit() -> None:
    other = Disc((52.0, 40.0, 10.0), 3.0 * EVEN, 3.0)
    less = math.exp(-1.0) * 3.0
    found = mean_disc([ONE, other], np.array([4.0, 3.0]), 0.5)
    assert found.circle == pytest.approx(((50.0 + less * 52.0) / (1.0 + less), 40.0, 10.0))
    assert found.log_odds == 4.0


def test_a_disc_that_is_another_ball_does_not_count() -> None:
    far = ONE._replace(circle=(56.0, 40.0, 10.0))
    assert mean_disc([far, ONE], np.array([3.9, 4.0]), 0.5).circle == pytest.approx(ONE.circle)


def test_a_coordinate_that_is_not_seen_is_taken_from_the_others() -> None:
    along = Disc((50.0, 44.0, 10.0), np.diag((1.0, 1e-9, 1.0)), 4.0)
    x, y, radius = mean_disc([along, ONE], np.array([4.0, 4.0]), 0.5).circle
    assert (x, radius) == pytest.approx((50.0, 10.0))
    assert y == pytest.approx(40.0, abs=1e-6)
