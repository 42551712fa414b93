"""The Kalman filter's steps against the textbook."""

import numpy as np
import pytest

from balls import square
from matchset.numeric.kalman import add_prediction, correct_by_scalar, predict, predict_constant_velocity, update


def test_the_kernels_agree_with_the_textbook() -> None:
    rng = np.random.default_rng(0)
    half = rng.normal(size=(6, 6))
    state, covariance, t, q = rng.normal(size=6), half @ half.T, 0.04, 0.7
    f = np.asarray(np.block([[np.eye(3), t * np.eye(3)], [np.zeros((3, 3)), np.eye(3)]]), np.float64)
    noise = np.asarray(q * q * np.kron([[t**3 / 3, t**2 / 2], [t**2 / 2, t]], np.eye(3)), np.float64)
    ahead, wide = f @ state, f @ covariance @ f.T + noise
    other_state, other_covariance = state.copy(), covariance.copy()
    predict(other_state, other_covariance, f, noise)
    np.testing.assert_allclose(other_state, ahead)
    np.testing.assert_allclose(other_covariance, wide)
    predict_constant_velocity(state, covariance, t, q)
    np.testing.assert_allclose(state, ahead)
    np.testing.assert_allclose(covariance, wide)
    seen, r, h = rng.normal(size=3), np.diag((1.0, 2.0, 3.0)), np.eye(3, 6)
    s = h @ wide @ h.T + r
    gain = wide @ h.T @ np.linalg.inv(s)
    assert update(state, covariance, seen, h, r, 1e9) == pytest.approx(square(seen, s))
    np.testing.assert_allclose(state, ahead + gain @ seen)
    np.testing.assert_allclose(covariance, (np.eye(6) - gain @ h) @ wide, atol=1e-12)


def test_a_measurement_outside_the_gate_changes_nothing() -> None:
    state, covariance = np.zeros(2), np.eye(2)
    h, r = np.array([[1.0, 0.0]]), np.array([[1.0]])
    assert update(state, covariance, np.array([4.0]), h, r, 7.9) == pytest.approx(8.0)
    np.testing.assert_array_equal(state, 0.0)
    np.testing.assert_array_equal(covariance, np.eye(2))
    assert update(state, -np.eye(2), np.array([4.0]), h, r, 7.9) == np.inf


def test_a_prediction_and_a_correction_without_arrays_are_those_of_the_textbook() -> None:
    rng = np.random.default_rng(4)
    n = 5
    root, noise_root, f, h = (rng.normal(size=shape) for shape in ((n, n), (n, n), (n, n), (n,)))
    x, p, q = rng.normal(size=n), root @ root.T, noise_root @ noise_root.T
    state, covariance = np.empty(n), q.copy()
    add_prediction.py_func(x, p, f, state, covariance)  # type: ignore[attr-defined]
    np.testing.assert_allclose(state, f @ x, rtol=1e-12)
    np.testing.assert_allclose(covariance, f @ p @ f.T + q, rtol=1e-10)

    other, other_covariance = x.copy(), p.copy()
    predict.py_func(other, other_covariance, f, q)  # type: ignore[attr-defined]
    np.testing.assert_allclose(state, other, rtol=1e-12)
    np.testing.assert_allclose(covariance, other_covariance, rtol=1e-10)

    cross, r, innovation = covariance @ h, 0.3, 0.7
    variance = float(h @ cross) + r
    expected = state + cross * innovation / variance, covariance - np.outer(cross, cross) / variance
    correct_by_scalar.py_func(state, covariance, cross, innovation, variance)  # type: ignore[attr-defined]
    np.testing.assert_allclose(state, expected[0], rtol=1e-12)
    np.testing.assert_allclose(covariance, expected[1], rtol=1e-10, atol=1e-10)
