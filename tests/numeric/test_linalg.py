"""Small linear algebra inside kernels, against NumPy and SciPy."""

import numpy as np
import numpy.typing as npt
import pytest
from scipy.linalg import cho_factor, cho_solve

from matchset.numeric import linalg
from matchset.numeric.jit import kernel
from matchset.numeric.linalg import (
    add_propagated_covariance,
    cross,
    norm,
    transform,
)

Floats = npt.NDArray[np.float64]
RNG = np.random.default_rng(0)


@kernel(refcount=False)
def invert_3x3(a: Floats, inverse: Floats) -> bool:
    return linalg.invert_3x3(a, inverse)


@kernel(refcount=False)
def factor_cholesky(a: Floats, n: int, least_pivot: float) -> bool:
    return linalg.factor_cholesky(a, n, least_pivot)


@kernel(refcount=False)
def solve_cholesky(factor: Floats, b: Floats, x: Floats, n: int) -> None:
    linalg.solve_cholesky(factor, b, x, n)


def positive(n: int) -> Floats:
    half = RNG.normal(size=(n, n))
    return np.asarray(half @ half.T + 0.1 * np.eye(n))


def test_the_inverse_of_a_positive_matrix() -> None:
    for _ in range(20):
        a, inverse = positive(3), np.empty((3, 3))
        assert invert_3x3(a, inverse)
        np.testing.assert_allclose(inverse, np.linalg.inv(a), rtol=1e-9)


@pytest.mark.parametrize("a", [np.zeros((3, 3)), np.ones((3, 3)), np.diag((1.0, 1.0, -1.0))])
def test_a_singular_matrix_has_none(a: Floats) -> None:
    assert not invert_3x3(a, np.empty((3, 3)))


@pytest.mark.parametrize("n", [1, 3, 4, 8])
def test_the_cholesky_factor_solves(n: int) -> None:
    a, b, x = positive(n), RNG.normal(size=n), np.empty(n)
    flat = a.ravel().copy()
    assert factor_cholesky(flat, n, 0.0)
    solve_cholesky(flat, b, x, n)
    np.testing.assert_allclose(x, cho_solve(cho_factor(a), b), rtol=1e-8)
    solve_cholesky(flat, b, b, n)  # in place
    np.testing.assert_array_equal(x, b)
    assert not factor_cholesky(-a.ravel(), n, 0.0)
    assert not factor_cholesky(a.ravel().copy(), n, 1e9)


def test_vectors_and_covariances() -> None:
    a, b, out = RNG.normal(size=(3, 3)), RNG.normal(size=3), np.empty(3)
    transform(a, b, out)
    np.testing.assert_allclose(out, a @ b)
    cross(a[0], b, out)
    np.testing.assert_allclose(out, np.cross(a[0], b))
    assert norm(b) == pytest.approx(np.linalg.norm(b))
    jacobian, covariance, total = RNG.normal(size=(3, 9)), positive(9), np.eye(3)
    add_propagated_covariance(jacobian, covariance, total)
    np.testing.assert_allclose(total, np.eye(3) + jacobian @ covariance @ jacobian.T)
