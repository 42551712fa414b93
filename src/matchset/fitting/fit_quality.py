"""What a fit rests on: how many lines agree with the outline, what is inside it, its match-set and its covariance."""

import math
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.light.color_adaptation import cell_at
from matchset.numeric.jit import helper, kernel
from matchset.numeric.record import Record

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]
Limits = Any  # `QualityParameters`, or the record of the same fields

TINY = 1e-9


class QualityParameters(msgspec.Struct, frozen=True):
    """How a fit is measured.

    Numbers without another reason are chosen by hand; `python -m benchmarks --only false_locks` would show a change.

    Parameters
    ----------
    tolerance, min_tolerance, max_tolerance : float
        How near an edge point must be to the outline to be an inlier, in half-widths, and at least and at most so many
        px: more forgives an outline that is no perfect circle, less tells shapes apart.
    min_residual : float
        Edge points are never taken to be more exact than this, px.
    interior_radius : float
        How far out the inside is looked at, in half-widths: beyond it blur mixes it with the background.
    core : float
        Share of the way from the center to the outline within which a pixel belongs to the core.
    ring_inner, ring_outer : float
        Between which shares of the way a pixel belongs to the middle, whose emptiness tells a ring.
    rim : float
        From which share of the way on a pixel belongs to the rim.
    min_pixels : int
        From more than so many pixels a share of the inside is told.
    lines : int
        Number of lines that the limits of autocorrelation and harmonic score are for: of more lines, residuals are
        compared so far apart as here, and count as so many. Lines nearer to each other read the same pixels, and err
        alike on any shape. The default of `Tracker`, with which those limits were chosen.
    match_set_sigmas, match_set_min_noise : float
        Distance from the outline up to which an edge point belongs to the match-set, in standard deviations of an edge
        point, which are taken to be at least so many px: the outline may be an ellipse.
    covariance_inflation : float
        By how much the covariance of independent edge points is enlarged, since neighboring points err together.
        Chosen by: `python -m benchmarks --only covariance`.
    covariance_min_score : float
        The covariance grows as 1 / score^2 down to this MSAC score.
    center_sigma, size_sigma : float
        Least standard deviation of place and size, px: shading, blur and the grid of pixels shift all points alike.
        Chosen by: `python -m benchmarks --only covariance`.
    field_share : float
        Standard deviation of the place besides in an interlaced picture, along the offset of its fields and as a share
        of it: what one field shows alone pulls the outline to it. That of the size has half the variance. Chosen on
        rendered flights, seeds 910 to 915; `python -m benchmarks.flight.vision` shows a change.
    """

    tolerance: float = 0.06
    min_tolerance: float = 1.2
    max_tolerance: float = 3.0
    min_residual: float = 0.3
    interior_radius: float = 0.88
    core: float = 0.5
    ring_inner: float = 0.35
    ring_outer: float = 0.62
    rim: float = 0.75
    min_pixels: int = 3
    lines: int = 64
    match_set_sigmas: float = 4.0
    match_set_min_noise: float = 0.4
    covariance_inflation: float = 1.15
    covariance_min_score: float = 0.1
    center_sigma: float = 0.01
    size_sigma: float = 0.05
    field_share: float = 0.05


@helper
def tolerance_of(limits: Limits, half_width: float) -> float:
    """How near an edge point must be to the outline of a shape of this half-width to be an inlier, px."""
    return float(min(max(limits.tolerance * half_width, limits.min_tolerance), limits.max_tolerance))


@helper
def overlap_of(work: Record) -> float:
    """How many lines there are for each that reads pixels of its own, beyond what is usual (`QualityParameters.lines`).

    A line runs along one row or column: on a small outline many of them are the same one.
    """
    runs, n, usual = work.runs, work.line_count, work.quality_limits.lines
    if n <= usual:
        return 1.0
    seen = own = 0
    row, across = np.int64(-1), np.int64(-1)
    for i in range(n):
        if runs[i, 4] > 0:
            seen += 1
            own += runs[i, 1] != row or runs[i, 0] != across
            across, row = runs[i, 0], runs[i, 1]
    return float(max(seen / max(own, usual * seen / n, 1.0), 1.0))


@kernel(refcount=False, entry=False)
def measure_lines(work: Record, tolerance: float) -> None:
    """Measure how well the lines agree with the fitted outline: the first half of `FitStatistics`.

    Parameters
    ----------
    work : record
        Reads `chosen`, `edges`, `runs` and, from `places`, cosine and sine of each line's angle around the shape.
    tolerance : float
        A line's edge point is an inlier if it is this near to the outline, px.
    """
    fit, chosen, runs, edges, places = work.fit, work.chosen, work.runs, work.edges, work.places
    visible, inliers, wide, columns, least = 0, 0, 0, work.place_columns, work.quality_limits.min_residual
    score = color = square = product = spread = 0.0
    c3 = s3 = c4 = s4 = 0.0
    usual = work.quality_limits.lines
    apart = max((work.line_count + usual - 1) // usual, 1)
    for i in range(work.line_count):
        if runs[i, 4] == 0:
            continue
        visible += 1
        e = chosen[i, 0]
        if abs(e) <= tolerance:
            inliers += 1
            near = 1.0 - (e / tolerance) ** 2
            score += near
            color += near * (0.5 + 0.5 * edges[i, int(chosen[i, 2]), 2])
            square += e * e
            before = chosen[i - apart, 0] if i >= apart and runs[i - apart, 4] > 0 else math.inf
            product += e * before if abs(before) <= tolerance else 0.0
        if abs(e) <= 2.0 * tolerance:
            c, s = places[i * columns], places[i * columns + 1]
            c2, s2 = c * c - s * s, 2.0 * c * s
            c3, s3 = c3 + e * (c2 * c - s2 * s), s3 + e * (s2 * c + c2 * s)
            c4, s4 = c4 + e * (c2 * c2 - s2 * s2), s4 + e * 2.0 * c2 * s2
            spread += e * e
            wide += 1
    largest = math.sqrt(max(c3 * c3 + s3 * s3, c4 * c4 + s4 * s4))
    if work.line_count > usual:
        largest *= math.sqrt(usual / work.line_count)
    whole = max(visible, 1)
    fit.visible, fit.inliers, fit.msac_score, fit.color_score = visible, inliers, score / whole, color / whole
    fit.harmonic_score = largest / math.sqrt(0.5 * (spread + wide * least * least) + TINY)
    fit.residual_autocorrelation = product / (square + inliers * least * least + TINY)


@kernel(refcount=False, entry=False)
def measure_interior(image: Bytes, table: Scores, work: Record) -> None:
    """Measure what is inside the outline, one pixel per line: the shares and the hollowness of `FitStatistics`.

    The hollowness is the foreign share halfway out minus twice that near the rim: what stands in front of a disc
    crosses its rim, but a ring is empty inside while its rim is whole.
    """
    limits, fit, outline, x, y = work.quality_limits, work.fit, work.outline, work.state[0], work.state[1]
    hits = seen = core_hits = core_seen = 0
    middle_foreign = middle_seen = rim_foreign = rim_seen = 0
    for i in range(work.line_count):
        share = work.interior[i]
        cell = cell_at(image, x + share * (outline[i, 0] - x), y + share * (outline[i, 1] - y))
        if cell >= 0:
            hit = table[cell] > 0
            seen += 1
            hits += hit
            if share < limits.core:
                core_seen += 1
                core_hits += hit
            if limits.ring_inner < share < limits.ring_outer:
                middle_seen += 1
                middle_foreign += not hit
            if share > limits.rim:
                rim_seen += 1
                rim_foreign += not hit
    fit.hollowness = middle_foreign / max(middle_seen, 1) - 2.0 * rim_foreign / max(rim_seen, 1)
    fit.interior_share = hits / seen if seen > limits.min_pixels else -1.0
    fit.core_share = core_hits / core_seen if core_seen > limits.min_pixels else fit.interior_share  # out of view


@helper
def write_answer(work: Record, points: Floats, covariance: Floats) -> tuple[float, int]:
    """Write match-set and covariance of the last fit.

    Parameters
    ----------
    work : record
    points : (n, 2), written
        Edge points that are no gross outliers, px (Epstein & Feldman, Eq. 4), from the first row on.
    covariance : (p, p), written
        That of the independent edge points, enlarged, and the floor.

    Returns
    -------
    support : float
        Share of the visible lines that are inliers.
    count : int
        Size of the match-set.
    """
    limits, fit, outline, edges, chosen = work.quality_limits, work.fit, work.outline, work.edges, work.chosen
    outlier = limits.match_set_sigmas * max(fit.edge_noise, limits.match_set_min_noise)
    inflation = limits.covariance_inflation / max(fit.msac_score, limits.covariance_min_score) ** 2
    inflation *= work.iteration.overlap
    count = 0
    for i in range(work.line_count):
        if abs(chosen[i, 0]) < outlier:
            d = edges[i, int(chosen[i, 2]), 0]
            points[count, 0] = outline[i, 0] + d * outline[i, 2]
            points[count, 1] = outline[i, 1] + d * outline[i, 3]
            count += 1
    found, p = work.covariance, work.parameter_count
    for j in range(p):
        for k in range(p):
            covariance[j, k] = inflation * 0.5 * (found[j, k] + found[k, j])
        covariance[j, j] += (limits.center_sigma if j < 2 else limits.size_sigma) ** 2
    add_field_covariance(work.field_offset.fitted, limits.field_share, covariance)
    return float(fit.inliers / max(fit.visible, 1)), count


@helper
def add_field_covariance(offset: Floats | tuple[float, float], share: float, covariance: Floats) -> None:
    """Add what fields that lie apart do to the place, along their offset, and to the size.

    Parameters
    ----------
    offset : (2,)
        From one field to the other, px.
    share : float
        See `QualityParameters.field_share`.
    covariance : (p, p), written
        px^2.
    """
    for j in range(2):
        for k in range(2):
            covariance[j, k] += share * share * (offset[j] * offset[k])
    if covariance.shape[0] > 2:
        covariance[2, 2] += 0.5 * share * share * (offset[0] * offset[0] + offset[1] * offset[1])
