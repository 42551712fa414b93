"""What a tracker does in flight, in numbers: quantiles, correlation in time, runs of far poses; and a flight."""

import numpy as np
import pytest
from benchmarks.flight.vision import (
    NAMES,
    angles,
    autocorrelation,
    circle_through,
    in_words,
    longest,
    quantiles,
    side_by_side,
    summary,
    watch,
)

from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.links.simulation_parameters import SimulationParameters


def test_quantiles_are_those_of_magnitudes_and_leave_losses_out() -> None:
    errors = np.array([-3.0, 1.0, np.nan, 2.0])
    assert quantiles(errors)[0] == 2.0
    assert np.isnan(quantiles(np.array([np.nan]))).all()


def test_errors_of_different_followers_are_not_correlated_with_each_other() -> None:
    rng = np.random.default_rng(1)
    steady = [np.repeat(rng.standard_normal(400), 5) for _ in range(2)]
    assert autocorrelation(steady, 1) == pytest.approx(0.8, abs=0.08)
    assert autocorrelation(steady, 10) == pytest.approx(0.0, abs=0.15)
    assert np.isnan(autocorrelation([np.array([1.0, 2.0])], 1))


def test_a_loss_neither_counts_nor_ends_a_run_of_far_poses() -> None:
    assert longest([np.array([0.4, np.nan, -0.5, 0.1, 0.4]), np.array([0.1])], 0.3) == 2


def test_a_flight_without_pictures_shows_the_noise_that_it_was_given() -> None:
    seen = watch(FlightParameters(duration=8.0, world=SimulationParameters(seed=900, quick=True)))
    assert len(seen) == 2
    rows = summary(seen)
    assert [row[0] for row in rows] == list(NAMES)
    medians = [float(row[1]) for row in rows]
    assert medians[:3] == pytest.approx([0.11, 0.2, 0.21], abs=0.05)  # as rendered
    assert medians[6:] == pytest.approx([0.4, 0.53], abs=0.15)
    assert max(medians[3:6]) < 0.012  # m; 9 mm too far ahead as rendered
    assert "0.00 % lost" in in_words(seen)


def test_the_circle_of_an_ellipse_has_its_middle_wherever_its_points_are_dense() -> None:
    angle = np.pi * np.linspace(0.0, 1.9, 40) ** 1.2
    ellipse = np.column_stack((100.0 + 31.0 * np.cos(angle), 50.0 + 30.0 * np.sin(angle)))
    np.testing.assert_allclose(circle_through(ellipse), (100.0, 50.0, 30.5), atol=0.3)
    circle = np.column_stack((100.0 + 30.0 * np.cos(angle), 50.0 + 30.0 * np.sin(angle)))
    np.testing.assert_allclose(circle_through(circle), (100.0, 50.0, 30.0), atol=1e-9)


def test_a_place_half_a_radius_right_of_the_middle_is_30_degrees_to_the_right() -> None:
    place, circle = np.array((115.0, 50.0)), np.array((100.0, 50.0, 30.0))
    np.testing.assert_allclose(angles(place, circle), (30.0, 0.0), atol=1e-9)


def test_two_summaries_share_each_cell() -> None:
    assert side_by_side([["x", "1", "2"]], [["x", "3", "4"]]) == [["x", "1 / 3", "2 / 4"]]
