"""Robust fit of a shape to the edge points of its lines: iteratively reweighted least squares.

With the outline traced at a state, an edge point at offset d along the normal of line i says ``d = J_i step + noise``;
J is how the outline moves along its normal with each number of the state. Several edge points may claim a line: the
fit takes the one that agrees, and gives none of them weight when all disagree (Tukey's biweight). What stands in front
of a shape hides its rim and shows an edge inside it, never outside: an edge point inside is disbelieved sooner.

Priors keep the step sane where edge points are few: the motion's prediction for the parameters, zero and the last
frame for the modes, and what is expected of the distance between the two fields of an interlaced picture.
"""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import helper, kernel
from matchset.tracking.least_squares import solve, substitute, turn
from matchset.tracking.match_set import CANDIDATES

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

ROUNDS = 8  # at most; five are typical
CUT, INNER_CUT = 4.0, 3.0  # the biweight is 0 beyond so many standard deviations outside and inside the outline
WEAK_WEIGHT = 0.2  # strength, in typical ones, at which an edge point has half its full weight
CHOICE = 2.0  # how much, in squared deviations, an e times stronger edge point of the same line is preferred
MODE = 0.01  # standard deviation of a mode, in half-widths
MODE_DRIFT = 0.002  # of its change per frame
FINAL = 2  # rounds at most once the noise is known
STIFF = 1e6  # weight that keeps a mode still
COARSE = 2.0  # in floors: from this noise on the fit is coarse
INFINITE = np.int32(0x7F800000)  # bits of an infinite float
J0, W0 = np.uintp(0), np.uintp(CANDIDATES)
ROWS = 4 + 2 * CANDIDATES  # numbers that a fit writes down for each line, beside how the outline moves there
PARTED = 0.5  # px a frame: from this speed on the fields of an interlaced picture are fitted apart
CONFUSED = 0.4  # px: the least noise by which priors are weighed


@kernel(refcount=False)
def _median(values: Singles, wanted: int) -> float:
    """Return the value that stands at place `wanted` of values >= 0 in order, found bit by bit without a branch."""
    bits = values.view(np.int32)  # floats >= 0 are in the order of their bits
    low, high, under, most = np.int32(0), INFINITE, 0, bits.shape[0]
    while low < high and most - under > 1:  # until one value is left between them, or one and the same
        middle = low + (high - low) // np.int32(2)
        below = 0
        for i in range(bits.shape[0]):
            below += bits[i] <= middle
        if below > wanted:
            high, most = middle, below
        else:
            low, under = middle + np.int32(1), below
    for i in range(bits.shape[0]):
        if low <= bits[i] <= high:
            return float(values[i])
    return math.inf


@helper
def _hold(
    held: Floats, state: Floats, expected: Floats, spread: Floats, size: float, fields: Floats, noise: float
) -> None:
    """Write the priors, three numbers each: inverse variance in units of the noise's, step to their mean, nothing.

    That of the fields' distance is not in units of the noise's: the noisier the edge points, the less it says.
    """
    s, free, noise = state.shape[0], spread.shape[0], max(noise, CONFUSED)
    for k in range(s):
        weight = mean = 0.0
        if k < free:
            if spread[0] > 0.0:
                weight, mean = (noise / spread[k]) ** 2, expected[k] - state[k]
        else:
            zero, last = (noise / (MODE * size)) ** 2, 0.0
            if spread[0] > 0.0:
                last = (noise / (MODE_DRIFT * size)) ** 2
            weight, mean = zero + last, last * expected[k] / (zero + last) - state[k]
        held[3 * k], held[3 * k + 1], held[3 * k + 2] = weight, mean, 0.0
    for k in range(s, s + 2):
        held[3 * k], held[3 * k + 1], held[3 * k + 2] = 1.0 / fields[4] ** 2, fields[2 + k - s], 0.0


@helper
def _predict(turned: Floats, step: Floats, predicted: Floats, p: int) -> None:
    """How far the step moves the outline on every line."""
    n = predicted.shape[0]
    for i in range(n):
        predicted[i] = 0.0
    for k in range(p):
        row, along = turned[k * n : (k + 1) * n], step[k]
        for i in range(n):
            predicted[i] += row[i] * along


@helper
def _weigh(
    edges: Floats,
    choice: Floats,
    predicted: Floats,
    sigma: float,
    found: Floats,
    weights: Floats,
    places: Floats,
    order: Singles,
) -> tuple[float, int]:
    """Choose an edge point on every line and weigh it; returns the sum of weights, and on how many lines there is one.

    Its weight, offset and absolute residual are written in rows too.
    """
    total, count, n = 0.0, 0, edges.shape[0]
    unit, outer, inner = 1.0 / (sigma * sigma), 1.0 / (CUT * sigma), 1.0 / (INNER_CUT * sigma)
    for line in range(n):
        i, own = np.uintp(line), np.uintp(2 * CANDIDATES * line)  # unsigned: that spares a check for negative ones
        place, best, weight, at = edges[i, J0, 0], 0.0, choice[own + W0], predicted[i]
        e = place - at
        cost = e * e * unit + choice[own]
        for j in range(1, CANDIDATES):  # no branches here: which edge point is nearest cannot be foreseen
            offset = edges[i, np.uintp(j), 0]
            other = offset - at
            price = other * other * unit + choice[own + np.uintp(j)]
            nearer = price < cost
            e = other if nearer else e
            place = offset if nearer else place
            best = float(j) if nearer else best
            weight = choice[own + np.uintp(j + CANDIDATES)] if nearer else weight
            cost = price if nearer else cost
        z = e * (outer if e > 0.0 else inner)
        near = 1.0 - z * z
        near = near if near > 0.0 else 0.0
        weight *= near * near
        e = e if cost < math.inf else math.inf
        found[i, 0], found[i, 1], found[i, 2] = e, weight, best
        weights[i], places[i], order[i] = weight, place, abs(e)
        count += e < math.inf
        total += weight
    return total, count


@helper
def _prepare(edges: Floats, choice: Floats) -> int:
    """Write how much less likely the weaker edge points of a line are, and full weights; returns lines with any."""
    typical, count = 0.0, 0
    for i in range(edges.shape[0]):
        if edges[i, 0, 1] > 0.0:
            typical += math.sqrt(edges[i, 0, 1])
            count += 1
    typical = WEAK_WEIGHT * (typical / max(count, 1)) ** 2
    for i in range(edges.shape[0]):
        strongest = edges[i, 0, 1]
        for j in range(CANDIDATES):
            q, own = edges[i, j, 1], 2 * CANDIDATES * i + j
            if q > 0.0:
                choice[own] = CHOICE * math.log(strongest / q) if j > 0 else 0.0
                choice[own + CANDIDATES] = q / (q + typical)
            else:
                choice[own], choice[own + CANDIDATES] = math.inf, 0.0
    return count


@helper
def _join_fields(outline: Floats, edges: Floats, found: Floats, step: Floats, s: int) -> None:
    """Take the distance between the fields out of the edge points that were taken."""
    for i in range(outline.shape[0]):
        if found[i, 0] < math.inf:
            edges[i, int(found[i, 2]), 0] -= outline[i, s + 4] * step[s] + outline[i, s + 5] * step[s + 1]


def scratch_size(n: int, s: int) -> int:
    """How many numbers of working memory the fit of a state of s numbers to n lines needs."""
    p = s + 2
    return (ROWS + p) * n + p * (p + 5)


@kernel(refcount=False)
def fit_lines(
    outline: Floats,
    edges: Floats,
    state: Floats,
    expected: Floats,
    spread: Floats,
    size: float,
    speed: float,
    noise: float,
    start: float,
    floor: float,
    covariance: Floats,
    found: Floats,
    fields: Floats,
    scratch: Floats,
) -> tuple[float, float]:
    """Fit the step of the state that explains the edge points best, and take it.

    Parameters
    ----------
    outline : (n, 4 + s + 2)
    edges : (n, 3, 3), written
        The lines and their edge points, see `Views`. The edge points the fit took are brought from their own field to
        the mean of the two, by the distance between the fields that was fitted.
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
    covariance : (p, s + 2), written
    found : (n, 3), written
        Per line the residual of the edge point the fit took, px, infinite where there is none; its weight; which of
        the line's edge points it is.
    fields : (5,), the first two written
        Distance between the two fields, x and y, px: where to begin, and what was found; what is expected, and the
        standard deviation of that for a noise of 1 px. At 16 px per frame the fields lie 8 px apart; begun at 0 the fit
        would take one of them for the whole and the other for outliers.
    scratch : (scratch_size(n, s),)
        Working memory.

    Returns
    -------
    noise : float
        Standard deviation of an edge point, px; 0 where no fit is possible.
    moved : float
        Largest change of a number of the state.
    """
    n, s, free = outline.shape[0], state.shape[0], spread.shape[0]
    p = s + 2 if speed > PARTED else s
    weights, places, row = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 3 * n]
    order, here = scratch[3 * n : 4 * n].view(np.float32)[:n], ROWS * n
    choice, turned, here = scratch[4 * n : here], scratch[here : here + n * p], here + n * p
    a, b, step = scratch[here : here + p * p], scratch[here + p * p :], scratch[here + p * p + p :]
    held = scratch[here + p * p + 2 * p :]
    if _prepare(edges, choice) < p:
        return 0.0, 0.0
    for k in range(p):
        step[k] = 0.0
    if p > s:
        step[s], step[s + 1] = fields[0], fields[1]
    turn(outline, turned, p)
    _hold(held, state, expected, spread, size, fields, noise)
    sigma, scale, total, final = start, start, 0.0, 0
    coarse = start > COARSE * floor  # while far off the modes keep still
    for _ in range(ROUNDS):
        _predict(turned, step, row, p)
        total, count = _weigh(edges, choice, row, sigma, found, weights, places, order)
        for k in range(free, s):
            held[3 * k + 2] = STIFF if coarse else 0.0
        x, y, z = step[0], step[1], step[2]
        if total < 2.0 or not solve(turned, weights, places, row, held, a, b, step, p):
            return 0.0, 0.0
        scale = 1.4826 * _median(order, count // 2) if count else 0.0  # outliers hardly move it
        tight = max(floor, min(scale, sigma))
        settled = sigma <= 1.2 * tight
        if settled and not coarse:
            final += 1
            if final == FINAL or abs(step[0] - x) + abs(step[1] - y) + abs(step[2] - z) < 0.03:
                break
        coarse = coarse and not settled and sigma > COARSE * floor
        sigma = max(tight, 0.5 * sigma)
    if coarse:
        return 0.0, 0.0
    noise = max(scale * math.sqrt(total / max(total - p, 1.0)), 0.05)
    for j in range(free):
        for k in range(p):
            b[k] = noise * noise if k == j else 0.0
        substitute(a, b, covariance[j], p)
    fields[0] = fields[1] = 0.0
    if p > s:
        fields[0], fields[1] = step[s], step[s + 1]
        _join_fields(outline, edges, found, step, s)
    moved = 0.0
    for k in range(s):
        state[k] += step[k]
        moved = max(moved, abs(step[k]))
    return noise, moved
