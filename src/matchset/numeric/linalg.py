"""Small linear algebra inside kernels, written out: calls of LAPACK cost more than the arithmetic.

Arrays are float64 in one piece (C order). The Cholesky functions take square matrices of any size, row by row in a flat
array, and read and write the lower triangle only.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]

# theorem: a positive definite matrix has det <= product of its diagonal (Hadamard); below this share of it the inverse
# has fewer than three correct digits in double precision
SINGULAR = 1e-13


@kernel(refcount=False, entry=False)
def invert_3x3(a: Floats, inverse: Floats) -> bool:
    """Inverse of a symmetric positive definite 3 x 3 matrix, by cofactors.

    Parameters
    ----------
    a : (3, 3)
        Its upper triangle is read.
    inverse : (3, 3), written

    Returns
    -------
    bool
        False if the matrix is singular or not positive definite.
    """
    c00, c01 = a[1, 1] * a[2, 2] - a[1, 2] * a[1, 2], a[0, 2] * a[1, 2] - a[0, 1] * a[2, 2]
    c02 = a[0, 1] * a[1, 2] - a[0, 2] * a[1, 1]
    det = a[0, 0] * c00 + a[0, 1] * c01 + a[0, 2] * c02
    if not det > SINGULAR * a[0, 0] * a[1, 1] * a[2, 2] or not det > 0.0:
        return False
    unit = 1.0 / det
    inverse[0, 0], inverse[0, 1], inverse[0, 2] = c00 * unit, c01 * unit, c02 * unit
    inverse[1, 1] = (a[0, 0] * a[2, 2] - a[0, 2] * a[0, 2]) * unit
    inverse[1, 2] = (a[0, 1] * a[0, 2] - a[0, 0] * a[1, 2]) * unit
    inverse[2, 2] = (a[0, 0] * a[1, 1] - a[0, 1] * a[0, 1]) * unit
    inverse[1, 0], inverse[2, 0], inverse[2, 1] = inverse[0, 1], inverse[0, 2], inverse[1, 2]
    return True


@kernel(refcount=False)
def transform(matrix: Floats, vector: Floats, out: Floats) -> None:
    """Write ``matrix @ vector`` of a 3 x 3 matrix and a vector of 3."""
    for j in range(3):
        out[j] = matrix[j, 0] * vector[0] + matrix[j, 1] * vector[1] + matrix[j, 2] * vector[2]


@kernel(refcount=False)
def cross(a: Floats, b: Floats, out: Floats) -> None:
    """Write the cross product of two vectors of 3; `out` may be one of them."""
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@kernel(refcount=False)
def norm(vector: Floats) -> float:
    """Euclidean length of a vector of 3."""
    return math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])


@kernel(refcount=False)
def add_propagated_covariance(jacobian: Floats, covariance: Floats, total: Floats) -> None:
    """Add ``J covariance J^T``, the covariance of three numbers that depend on n others.

    Parameters
    ----------
    jacobian : (3, n)
        J, the derivatives of the three numbers.
    covariance : (n, n)
        Of the n numbers.
    total : (3, 3), written
        What is added to.
    """
    n = covariance.shape[0]
    for a in range(3):
        for k in range(n):
            part = 0.0
            for m in range(n):
                part += jacobian[a, m] * covariance[m, k]
            if part != 0.0:
                for b in range(3):
                    total[a, b] += part * jacobian[b, k]


@kernel(refcount=False, entry=False)
def factor_cholesky(a: Floats, n: int, least_pivot: float) -> bool:
    """Factor ``a = L L^T`` in place.

    Parameters
    ----------
    a : (n * n,), written
        A symmetric matrix; its lower triangle becomes L.
    n : int
    least_pivot : float
        A pivot (the square of a diagonal element of L) not above this counts as zero.

    Returns
    -------
    bool
        False if the matrix is not positive definite.
    """
    for j in range(n):
        d = a[j * n + j]
        for k in range(j):
            d -= a[j * n + k] * a[j * n + k]
        if not d > least_pivot:
            return False
        d = math.sqrt(d)
        a[j * n + j] = d
        for i in range(j + 1, n):
            t = a[i * n + j]
            for k in range(j):
                t -= a[i * n + k] * a[j * n + k]
            a[i * n + j] = t / d
    return True


@kernel(refcount=False, entry=False)
def solve_cholesky(factor: Floats, b: Floats, x: Floats, n: int) -> None:
    """Solve ``L L^T x = b``.

    Parameters
    ----------
    factor : (n * n,)
        See `factor_cholesky`.
    b : (n,)
    x : (n,), written
        It may be `b`.
    n : int
    """
    for i in range(n):
        t = b[i]
        for k in range(i):
            t -= factor[i * n + k] * x[k]
        x[i] = t / factor[i * n + i]
    for i in range(n - 1, -1, -1):
        t = x[i]
        for k in range(i + 1, n):
            t -= factor[k * n + i] * x[k]
        x[i] = t / factor[i * n + i]
