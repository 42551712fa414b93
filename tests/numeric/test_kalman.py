"""The Kalman filter's steps without arrays of their own, against the textbook's matrices."""

import numpy as np

from matchset.numeric.kalman import add_prediction, correct_by_scalar, predict


def test_a_prediction_and_a_correction_are_those_of_the_textbook() -> None:
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
