"""Robust fit of a shape to the edge points of its lines: iteratively reweighted least squares.

With the outline traced at a state, an edge point at offset d along the normal of line i says ``d = J_i step + noise``;
J is how the outline moves along its normal with each number of the state. Several edge points may claim a line: the
fit takes the one that agrees, and gives none of them weight when all disagree (Tukey's biweight). What stands in front
of a shape hides its rim and shows an edge inside it, never outside: an edge point inside is disbelieved sooner.

Priors keep the step sane where edge points are few: the motion's prediction for the parameters, zero and the last
frame for the modes, and what is expected of the field offset of an interlaced picture. Each round solves the normal
equations by Cholesky's factor.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.match_set import CANDIDATES
from matchset.numeric.jit import helper, kernel
from matchset.numeric.linalg import factor_cholesky, solve_cholesky
from matchset.numeric.record import Record

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

INFINITE = np.int32(0x7F800000)  # format: bits of an infinite float32
J0, W0 = np.uintp(0), np.uintp(CANDIDATES)  # format: where costs and weights of a line's edge points begin
MAD_TO_SIGMA = 1.4826  # theorem: 1 / Phi^-1(3/4) makes the median absolute deviation consistent for normal noise
TINY = 1e-9


class FitParameters(msgspec.Struct, frozen=True):
    """How a shape is fitted to edge points.

    Parameters
    ----------
    min_noise : float
        Least standard deviation of an edge point that is believed during the fit, px: smaller, and a chance agreement
        of few points wins. Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    min_reported_noise : float
        Least standard deviation that is reported, px.
    min_prior_noise : float
        Least standard deviation of an edge point by which priors are weighed, px.
    outer_cut, inner_cut : float
        Standard deviations outside and inside the outline beyond which the biweight is 0. Tukey's 4.685 is 95 %
        efficient for normal noise; less, since false edges are frequent, and least inside, where they are most so.
        Chosen by hand; `python -m benchmarks --only accuracy` would show a change.
    half_weight_strength : float
        Strength at which an edge point has half its full weight, in typical ones.
    strength_preference : float
        How much an e times stronger edge point of the same line is preferred, in squared deviations.
    mode_sigma, mode_drift : float
        Standard deviation of a mode, and of its change per frame, in half-widths.
        Chosen by hand; `python -m benchmarks --only covariance` would show a change.
    mode_stiffness : float
        Weight that keeps the modes still while the fit is coarse.
    coarse_noise : float
        Noise from which a fit is coarse, in `min_noise`.
    max_rounds, final_rounds : int
        Rounds of reweighting, and how many of them once the noise is known; five are typical.
    final_step : float
        A change of the first three numbers of the state that ends the rounds, px.
    settled_ratio : float
        The noise counts as known once what a round assumed is at most so many times what it found.
    decay : float
        The least share of the noise assumed in a round that the next one assumes.
    max_iterations : int
        How often the outline is traced anew at most.
    final_move : float
        A squared change of the state that ends the iterations, px per half-width.
    next_range, next_range_per_speed : float
        Search range after the first iteration: at least so many px, or 2 px and a share of the speed per frame.
    next_sigma : float
        How far edge points are expected from the outline after the first iteration, px.
    start_noise, sided_start_noise : float
        Noise with which a fit begins at least, px, for round shapes and for those with corners: one side that is off
        is not called back by the others, so it must be seen from farther.
        Chosen by: docs/decisions/073-sides-that-move-alone.md.
    initial_pixel_noise : float
        Noise of a pixel that is assumed before the first look, gray levels.
    min_half_width, max_half_width : float
        Half-widths between which a shape can be fitted, px.
    """

    min_noise: float = 0.4
    min_reported_noise: float = 0.05
    min_prior_noise: float = 0.4
    outer_cut: float = 4.0
    inner_cut: float = 3.0
    half_weight_strength: float = 0.2
    strength_preference: float = 2.0
    mode_sigma: float = 0.01
    mode_drift: float = 0.002
    mode_stiffness: float = 1e6
    coarse_noise: float = 2.0
    max_rounds: int = 8
    final_rounds: int = 2
    final_step: float = 0.03
    settled_ratio: float = 1.2
    decay: float = 0.5
    max_iterations: int = 4
    final_move: float = 0.04
    next_range: float = 4.0
    next_range_per_speed: float = 0.5
    next_sigma: float = 1.0
    start_noise: float = 1.0
    sided_start_noise: float = 2.0
    initial_pixel_noise: float = 2.0
    min_half_width: float = 2.0
    max_half_width: float = 1e5


@kernel(refcount=False, entry=False)
def median_of(values: Singles, wanted: int) -> float:
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


@kernel(refcount=False, reassociate=True, entry=False)
def _add_lines(columns: Floats, weights: Floats, offsets: Floats, scaled: Floats, normal: Floats, p: int) -> None:
    """Add the weighted normal equations of the lines to `normal`: a lower triangle, in one row, and the right side.

    In `scaled` the weighted columns are written.
    """
    n, a, b = weights.shape[0], normal[: p * p], normal[p * p :]
    for k in range(p):
        row, total = columns[k * n : (k + 1) * n], 0.0
        for i in range(n):
            scaled[i] = weights[i] * row[i]
            total += scaled[i] * offsets[i]
        b[k] += total
        for m in range(k + 1):
            other, total = columns[m * n : (m + 1) * n], 0.0
            for i in range(n):
                total += scaled[i] * other[i]
            a[k * p + m] += total


@helper
def _solve(work: Record, n: int, p: int) -> bool:
    """Weighted least squares with the priors; False where there is no unique answer."""
    priors, a, b = work.priors, work.normal[: p * p], work.normal[p * p :]
    for k in range(p):
        b[k] = priors[3 * k] * priors[3 * k + 1]
        for m in range(k):
            a[k * p + m] = 0.0
        a[k * p + k] = priors[3 * k] + priors[3 * k + 2]
    columns, scaled = work.columns[: n * p], work.predicted[:n]  # the predicted offsets are not needed any more
    _add_lines(columns, work.weights[:n], work.offsets[:n], scaled, work.normal, p)
    if not factor_cholesky(a, p, TINY):
        return False
    solve_cholesky(a, b, work.step[:p], p)
    return True


@helper
def _set_priors(work: Record) -> None:
    """Write the priors, three numbers each: inverse variance in units of the noise's, step to their mean, stiffness.

    Where lines read the same pixels (`overlap_of`) they count for more than they tell, and so must the priors. That of
    the field offset is not in units of the noise's: the noisier the edge points, the less it says.
    """
    limits, priors, state, expected = work.fit_limits, work.priors, work.state, work.start
    sigma, size, offset = work.motion.prior_sigma, work.iteration.half_width, work.field_offset
    s, free, noise = work.state_count, work.parameter_count, max(work.iteration.noise, limits.min_prior_noise)
    tracked, many = work.window.use_prior and sigma[0] > 0.0, work.iteration.overlap
    for k in range(s):
        weight = mean = 0.0
        if k < free:
            if tracked:
                weight, mean = (noise / sigma[k]) ** 2, expected[k] - state[k]
        else:
            zero, last = (noise / (limits.mode_sigma * size)) ** 2, 0.0
            if tracked:
                last = (noise / (limits.mode_drift * size)) ** 2
            weight, mean = zero + last, last * expected[k] / (zero + last) - state[k]
        priors[3 * k], priors[3 * k + 1], priors[3 * k + 2] = many * weight, mean, 0.0
    for k in range(s, s + 2):
        priors[3 * k], priors[3 * k + 1] = many / offset.sigma**2, offset.expected[k - s]
        priors[3 * k + 2] = 0.0


@helper
def _copy_columns(work: Record, n: int, p: int) -> None:
    """Write how the outline moves, a row for each number of the state: sums over lines then run along memory."""
    outline, columns = work.outline, work.columns
    for k in range(p):
        row, column = columns[k * n : (k + 1) * n], np.uintp(k + 4)
        for line in range(n):
            i = np.uintp(line)
            row[i] = outline[i, column]


@helper
def _predict_offsets(work: Record, n: int, p: int) -> None:
    """How far the step moves the outline on every line."""
    predicted, columns, step = work.predicted[:n], work.columns, work.step
    for i in range(n):
        predicted[i] = 0.0
    for k in range(p):
        row, along = columns[k * n : (k + 1) * n], step[k]
        for i in range(n):
            predicted[i] += row[i] * along


@helper
def _prepare_choice(work: Record, n: int) -> int:
    """Write how much less likely the weaker edge points of a line are, and full weights; returns lines with any."""
    limits, edges, choice = work.fit_limits, work.edges, work.choice
    typical, count = 0.0, 0
    for i in range(n):
        if edges[i, 0, 1] > 0.0:
            typical += math.sqrt(edges[i, 0, 1])
            count += 1
    typical = limits.half_weight_strength * (typical / max(count, 1)) ** 2
    for i in range(n):
        strongest = edges[i, 0, 1]
        for j in range(CANDIDATES):
            q, own = edges[i, j, 1], 2 * CANDIDATES * i + j
            if q > 0.0:
                choice[own] = limits.strength_preference * math.log(strongest / q) if j > 0 else 0.0
                choice[own + CANDIDATES] = q / (q + typical)
            else:
                choice[own], choice[own + CANDIDATES] = math.inf, 0.0
    return count


@helper
def _weigh(work: Record, n: int, sigma: float) -> tuple[float, int]:
    """Choose an edge point on every line and weigh it; returns the sum of weights, and on how many lines there is one.

    A row of `chosen` is its residual, infinite where there is none; its weight; which of the line's edge points it is.
    """
    edges, choice, predicted, chosen, total, count = work.edges, work.choice, work.predicted, work.chosen, 0.0, 0
    weights, offsets, deviations, limits = work.weights, work.offsets, work.deviations, work.fit_limits
    unit, outer, inner = 1.0 / (sigma * sigma), 1.0 / (limits.outer_cut * sigma), 1.0 / (limits.inner_cut * sigma)
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
        chosen[i, 0], chosen[i, 1], chosen[i, 2] = e, weight, best
        weights[i], offsets[i], deviations[i] = weight, place, abs(e)
        count += e < math.inf
        total += weight
    return total, count


@helper
def _reweight(work: Record, n: int, p: int) -> tuple[float, float]:
    """Reweight and solve until the noise is known; returns scale and sum of weights, 0 where no fit is possible."""
    limits, priors, step = work.fit_limits, work.priors, work.step
    sigma, scale, total, final = work.iteration.initial_sigma, work.iteration.initial_sigma, 0.0, 0
    coarse = sigma > limits.coarse_noise * limits.min_noise  # while far off the modes keep still
    for _ in range(limits.max_rounds):
        _predict_offsets(work, n, p)
        total, count = _weigh(work, n, sigma)
        for k in range(work.parameter_count, work.state_count):
            priors[3 * k + 2] = limits.mode_stiffness if coarse else 0.0
        x, y, z = step[0], step[1], step[2]
        if total < 2.0 or not _solve(work, n, p):
            return 0.0, 0.0
        scale = MAD_TO_SIGMA * median_of(work.deviations[:n], count // 2) if count else 0.0
        tight = max(limits.min_noise, min(scale, sigma))
        settled = sigma <= limits.settled_ratio * tight
        if settled and not coarse:
            final += 1
            moved = abs(step[0] - x) + abs(step[1] - y) + abs(step[2] - z)
            if final == limits.final_rounds or moved < limits.final_step:
                break
        coarse = coarse and not settled and sigma > limits.coarse_noise * limits.min_noise
        sigma = max(tight, limits.decay * sigma)
    return scale, 0.0 if coarse else total


@helper
def _take_field_offset(work: Record, n: int, s: int, p: int) -> None:
    """Note the field offset that was fitted, and bring the chosen edge points from their field to the mean of both."""
    outline, edges, chosen, step, fitted = work.outline, work.edges, work.chosen, work.step, work.field_offset.fitted
    fitted[0] = fitted[1] = 0.0
    if p == s:
        return
    fitted[0], fitted[1] = step[s], step[s + 1]
    for i in range(n):
        if chosen[i, 0] < math.inf:
            edges[i, int(chosen[i, 2]), 0] -= outline[i, s + 4] * step[s] + outline[i, s + 5] * step[s + 1]


@kernel(refcount=False, entry=False)
def robust_fit(work: Record) -> None:
    """Fit the step of the state that explains the edge points best, and take it.

    Parameters
    ----------
    work : record
        Reads `outline` and `edges`, `start` and the motion's prior, `iteration`: half-width, noise of the last fit and
        noise to begin with; `window.speed`: below `FieldParameters.min_speed` the fields are one, and in a half-frame
        there is one only, `rows`; `field_offset`. The
        fit of a field offset begins where that was expected: begun at 0 it would take one of the fields for the whole
        and the other for outliers.

        Writes `state`, moved by the step; `chosen`; `covariance`, (p, s + 2); `field_offset.fitted`; the edge points
        that were chosen, brought to the mean of the fields; in `iteration` the noise of an edge point, px, 0 where no
        fit is possible, and the largest change of a number of the state.
    """
    n, s, free, iteration = work.line_count, work.state_count, work.parameter_count, work.iteration
    fields_apart = work.rows == 0 and work.window.speed > work.field_limits.min_speed
    p = s + 2 if fields_apart else s
    state, step, a, b = work.state, work.step, work.normal[: p * p], work.normal[p * p :]
    enough = _prepare_choice(work, n) >= p
    scale = total = 0.0
    if enough:
        for k in range(p):
            step[k] = 0.0
        if p > s:
            step[s], step[s + 1] = work.field_offset.fitted[0], work.field_offset.fitted[1]
        _copy_columns(work, n, p)
        _set_priors(work)
        scale, total = _reweight(work, n, p)
    iteration.noise = iteration.moved = 0.0
    if total == 0.0:
        return
    noise = max(scale * math.sqrt(total / max(total - p, 1.0)), work.fit_limits.min_reported_noise)
    for j in range(free):
        for k in range(p):
            b[k] = noise * noise if k == j else 0.0
        solve_cholesky(a, b, work.covariance[j], p)
    _take_field_offset(work, n, s, p)
    moved = 0.0
    for k in range(s):
        state[k] += step[k]
        moved = max(moved, abs(step[k]))
    iteration.noise, iteration.moved = noise, moved
