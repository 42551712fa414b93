"""Weighted least squares over the lines of a match-set: the normal equations, solved by Cholesky's factor."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import helper, kernel

Floats = npt.NDArray[np.float64]


@helper
def _factor(a: Floats, n: int) -> bool:
    """Cholesky factor of the lower triangle of a (n, n) in one row, in place; False if it is not positive definite."""
    for j in range(n):
        d = a[j * n + j]
        for k in range(j):
            d -= a[j * n + k] * a[j * n + k]
        if not d > 1e-9:
            return False
        d = math.sqrt(d)
        a[j * n + j] = d
        for i in range(j + 1, n):
            t = a[i * n + j]
            for k in range(j):
                t -= a[i * n + k] * a[j * n + k]
            a[i * n + j] = t / d
    return True


@kernel(refcount=False)
def substitute(a: Floats, b: Floats, x: Floats, n: int) -> None:
    """Solve with a Cholesky factor (n, n) in one row."""
    for i in range(n):
        t = b[i]
        for k in range(i):
            t -= a[i * n + k] * x[k]
        x[i] = t / a[i * n + i]
    for i in range(n - 1, -1, -1):
        t = x[i]
        for k in range(i + 1, n):
            t -= a[k * n + i] * x[k]
        x[i] = t / a[i * n + i]


@helper
def turn(outline: Floats, turned: Floats, p: int) -> None:
    """Write how the outline moves, a row for each number of the state: sums over lines then run along memory."""
    n = outline.shape[0]
    for k in range(p):
        row, column = turned[k * n : (k + 1) * n], np.uintp(k + 4)
        for line in range(n):
            i = np.uintp(line)
            row[i] = outline[i, column]


@kernel(refcount=False, reassociate=True)
def _gather(turned: Floats, weights: Floats, places: Floats, scaled: Floats, a: Floats, b: Floats, p: int) -> None:
    """Add the weighted normal equations to `a` (lower triangle, in one row) and `b`."""
    n = weights.shape[0]
    for k in range(p):
        row, total = turned[k * n : (k + 1) * n], 0.0
        for i in range(n):
            scaled[i] = weights[i] * row[i]
            total += scaled[i] * places[i]
        b[k] += total
        for m in range(k + 1):
            other, total = turned[m * n : (m + 1) * n], 0.0
            for i in range(n):
                total += scaled[i] * other[i]
            a[k * p + m] += total


@helper
def solve(
    turned: Floats,
    weights: Floats,
    places: Floats,
    scaled: Floats,
    held: Floats,
    a: Floats,
    b: Floats,
    step: Floats,
    p: int,
) -> bool:
    """Weighted least squares with the priors; False where there is no unique answer."""
    for k in range(p):
        b[k] = held[3 * k] * held[3 * k + 1]
        for m in range(k):
            a[k * p + m] = 0.0
        a[k * p + k] = held[3 * k] + held[3 * k + 2]
    _gather(turned, weights, places, scaled, a, b, p)
    if not _factor(a, p):
        return False
    substitute(a, b, step, p)
    return True
