"""Weighted least squares over the lines of a match-set: the normal equations, solved by Cholesky's factor."""

import math

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel, summing

Floats = npt.NDArray[np.float64]


@kernel
def factor(a: Floats, n: int) -> bool:
    """Cholesky factor of the lower triangle, in place; False if it is not positive definite."""
    for j in range(n):
        d = a[j, j]
        for k in range(j):
            d -= a[j, k] * a[j, k]
        if not d > 1e-9:
            return False
        d = math.sqrt(d)
        a[j, j] = d
        for i in range(j + 1, n):
            t = a[i, j]
            for k in range(j):
                t -= a[i, k] * a[j, k]
            a[i, j] = t / d
    return True


@kernel
def substitute(a: Floats, b: Floats, x: Floats, n: int) -> None:
    """Solve with a Cholesky factor."""
    for i in range(n):
        t = b[i]
        for k in range(i):
            t -= a[i, k] * x[k]
        x[i] = t / a[i, i]
    for i in range(n - 1, -1, -1):
        t = x[i]
        for k in range(i + 1, n):
            t -= a[k, i] * x[k]
        x[i] = t / a[i, i]


@kernel
def turn(outline: Floats, turned: Floats, p: int) -> None:
    """Write how the outline moves, a row for each number of the state: sums over lines then run along memory."""
    for line in range(outline.shape[0]):
        i = np.uintp(line)
        for k in range(p):
            turned[np.uintp(k), i] = outline[i, np.uintp(k + 4)]


@summing
def _gather(turned: Floats, weights: Floats, places: Floats, scaled: Floats, a: Floats, b: Floats, p: int) -> None:
    """Add the weighted normal equations to `a` (lower triangle) and `b`."""
    n = weights.shape[0]
    for k in range(p):
        row, total = turned[k], 0.0
        for i in range(n):
            scaled[i] = weights[i] * row[i]
            total += scaled[i] * places[i]
        b[k] += total
        for m in range(k + 1):
            other, total = turned[m], 0.0
            for i in range(n):
                total += scaled[i] * other[i]
            a[k, m] += total


@kernel
def solve(
    turned: Floats,
    edges: Floats,
    found: Floats,
    held: Floats,
    sums: Floats,
    a: Floats,
    b: Floats,
    step: Floats,
    p: int,
) -> bool:
    """Weighted least squares with the priors; False where there is no unique answer."""
    for k in range(p):
        b[k] = held[k, 0] * held[k, 1]
        for m in range(k):
            a[k, m] = 0.0
        a[k, k] = held[k, 0] + held[k, 2]
    weights, places = sums[0], sums[1]
    for line in range(edges.shape[0]):
        i = np.uintp(line)
        weights[i], places[i] = found[i, 1], edges[i, np.uintp(found[i, 2]), 0]
    _gather(turned, weights, places, sums[2], a, b, p)
    if not factor(a, p):
        return False
    substitute(a, b, step, p)
    return True
