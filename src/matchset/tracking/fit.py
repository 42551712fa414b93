"""Robust fit of a shape to the edge points of its lines: iteratively reweighted least squares.

With the outline traced at a state, an edge point at offset d along the normal of line i says ``d = J_i step + noise``;
J is how the outline moves along its normal with each number of the state. Several edge points may claim a line: the
fit takes the one that agrees, and gives none of them weight when all disagree (Tukey's biweight). What stands in front
of a shape hides its rim and shows an edge inside it, never outside: an edge point inside is disbelieved sooner.

Priors keep the step sane where edge points are few: the motion's prediction for the parameters, zero and the last
frame for the modes, and as much difference between the two fields of an interlaced picture as the speed allows.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.shapes.jit import kernel

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

ROUNDS = 10  # at most; five are typical
CUT, INNER_CUT = 4.0, 3.0  # the biweight is 0 beyond so many standard deviations outside and inside the outline
WEAK_WEIGHT = 0.2  # strength, in typical ones, at which an edge point has half its full weight
CHOICE = 2.0  # how much, in squared deviations, an e times stronger edge point of the same line is preferred
MODE, MODE_DRIFT = 0.02, 0.004  # standard deviation of a mode, and of its change per frame, in half-widths
CONFUSED = 0.4  # px: the least noise by which priors are weighed


@kernel
def _factor(a: Floats, n: int) -> bool:
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
def _substitute(a: Floats, b: Floats, x: Floats, n: int) -> None:
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
def _median(values: Floats, count: int) -> float:
    """Median of the first `count` values (Hoare's selection); their order is lost."""
    wanted, low, high = count // 2, 0, count - 1
    while low < high:
        pivot = values[(low + high) // 2]
        i, j = low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if wanted <= j:
            high = j
        elif wanted >= i:
            low = i
        else:
            break
    return float(values[wanted])


@kernel
def _hold(
    held: Floats, state: Floats, expected: Floats, spread: Floats, size: float, speed: float, noise: float
) -> None:
    """Write the priors: inverse variance in units of the noise's variance, and the step to their mean."""
    s, free, noise = state.shape[0], spread.shape[0], max(noise, CONFUSED)
    for k in range(s):
        held[k, 0] = held[k, 1] = 0.0
        if k < free:
            if spread[0] > 0.0:
                held[k, 0], held[k, 1] = (noise / spread[k]) ** 2, expected[k] - state[k]
        else:
            zero, last = (noise / (MODE * size)) ** 2, 0.0
            if spread[0] > 0.0:
                last = (noise / (MODE_DRIFT * size)) ** 2
            held[k, 0], held[k, 1] = zero + last, last * expected[k] / (zero + last) - state[k]
    for k in range(s, s + 2):
        held[k, 0], held[k, 1] = 1.0 / (0.1 + 0.5 * speed) ** 2, 0.0


@kernel
def _weigh(
    jacobian: Floats,
    offsets: Floats,
    quality: Floats,
    penalty: Floats,
    typical: float,
    step: Floats,
    sigma: float,
    residual: Floats,
    weight: Floats,
    chosen: Ints,
    p: int,
) -> float:
    """Choose an edge point on every line and weigh it at the present step; returns the sum of weights."""
    total = 0.0
    for i in range(jacobian.shape[0]):
        weight[i] = 0.0
        residual[i] = math.inf
        if quality[i, 0] <= 0.0:
            continue
        predicted = 0.0
        for k in range(p):
            predicted += jacobian[i, k] * step[k]
        best, cost = 0, math.inf
        for j in range(quality.shape[1]):
            e = (offsets[i, j] - predicted) / sigma
            if quality[i, j] > 0.0 and e * e + penalty[i, j] < cost:
                best, cost = j, e * e + penalty[i, j]
        e = offsets[i, best] - predicted
        residual[i], chosen[i] = e, best
        z = e / ((CUT if e > 0.0 else INNER_CUT) * sigma)
        if z * z < 1.0:
            q = quality[i, best]
            weight[i] = (1.0 - z * z) * (1.0 - z * z) * q / (q + typical)
            total += weight[i]
    return total


@kernel
def _solve(
    jacobian: Floats,
    offsets: Floats,
    chosen: Ints,
    weight: Floats,
    held: Floats,
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
        a[k, k] = held[k, 0]
    for i in range(jacobian.shape[0]):
        if weight[i] > 0.0:
            d = offsets[i, chosen[i]]
            for k in range(p):
                jk = weight[i] * jacobian[i, k]
                b[k] += jk * d
                for m in range(k + 1):
                    a[k, m] += jk * jacobian[i, m]
    if not _factor(a, p):
        return False
    _substitute(a, b, step, p)
    return True


@kernel
def fit_lines(
    jacobian: Floats,
    offsets: Floats,
    quality: Floats,
    state: Floats,
    expected: Floats,
    spread: Floats,
    size: float,
    speed: float,
    noise: float,
    start: float,
    floor: float,
    step: Floats,
    covariance: Floats,
    residual: Floats,
    weight: Floats,
    chosen: Ints,
) -> tuple[float, float]:
    """Fit the step of the state that explains the edge points best, and take it.

    Parameters
    ----------
    jacobian : (n, s + 2)
        By how much the outline moves along the normal of each line per unit of each number of the state, and of the
        distance between the fields.
    offsets, quality : (n, 3)
        The edge points, see `Lines`.
    state : (s,), written
        Where the outline was traced; moved by the step.
    expected : (s,)
        Prediction of the motion.
    spread : (p,)
        How far each parameter may be from its prediction; zeros where there is none.
    size, speed : float
        Half-width of the shape, px, and its speed, px per frame; below half a pixel the fields are one.
    noise : float
        Noise of an edge point in the last fit, px.
    start, floor : float
        Noise to begin with, and the least that is believed, px.
    step : (s + 2,), written
    covariance : (s + 2, s + 2), written
    residual, weight, chosen : (n,), written

    Returns
    -------
    noise : float
        Standard deviation of an edge point, px; 0 where no fit is possible.
    moved : float
        Largest change of a number of the state.
    """
    n, s = jacobian.shape[0], state.shape[0]
    p = s + 2 if speed > 0.5 else s
    a, b, held, order = np.empty((p, p)), np.empty(p), np.empty((s + 2, 2)), np.empty(n)
    penalty = np.zeros(quality.shape)
    typical, count = 0.0, 0
    for i in range(n):
        if quality[i, 0] > 0.0:
            typical += math.sqrt(quality[i, 0])
            count += 1
            for j in range(1, quality.shape[1]):
                if quality[i, j] > 0.0:
                    penalty[i, j] = CHOICE * math.log(quality[i, 0] / quality[i, j])
    if count < p:
        return 0.0, 0.0
    typical = WEAK_WEIGHT * (typical / count) ** 2
    _hold(held, state, expected, spread, size, speed, noise)
    step[:] = 0.0
    sigma, scale, total = start, start, 0.0
    for _ in range(ROUNDS):
        total = _weigh(jacobian, offsets, quality, penalty, typical, step, sigma, residual, weight, chosen, p)
        x, y, z = step[0], step[1], step[2]
        if total < 2.0 or not _solve(jacobian, offsets, chosen, weight, held, a, b, step, p):
            return 0.0, 0.0
        count = 0
        for i in range(n):
            if residual[i] < math.inf:
                order[count] = abs(residual[i])
                count += 1
        scale = 1.4826 * _median(order, count)
        tight = max(floor, min(scale, sigma))
        if sigma <= 1.05 * tight and abs(step[0] - x) + abs(step[1] - y) + abs(step[2] - z) < 0.01:
            break
        sigma = max(tight, 0.5 * sigma)
    noise = max(scale * math.sqrt(total / max(total - p, 1.0)), 0.05)
    moved = 0.0
    for j in range(p):
        b[:] = 0.0
        b[j] = noise * noise
        _substitute(a, b, covariance[j], p)
    for k in range(s):
        state[k] += step[k]
        moved = max(moved, abs(step[k]))
    return noise, moved
