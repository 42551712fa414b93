"""What a fit rests on: how many lines agree with the outline, and which edge points are the match-set."""

import math

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

LEAST = 0.3  # px: edge points are never judged to be more exact than this


@kernel(refcount=False)
def review_lines(
    found: Floats, edges: Floats, runs: Ints, turns: Floats, tolerance: float
) -> tuple[int, int, float, float, float, float]:
    """How well the lines agree with the fitted outline.

    Parameters
    ----------
    found : (n, 3)
        What the fit took on each line, see `fit_lines`.
    edges, runs
        See `Views`.
    turns : (n, 2)
        Cosine and sine of the angle of each line around the shape.
    tolerance : float
        A line confirms the shape if its edge point is this near to the outline, px.

    Returns
    -------
    seen, confirmed : int
        Lines that lie in the picture, and those of them that confirm the shape.
    agreement : float
        Mean over the lines seen of ``1 - (residual / tolerance)^2``, 0 where not confirmed: 1 is perfect.
    evidence : float
        The same, but a line without a step in color counts half.
    wave : float
        Correlation of the residuals of neighboring lines: near 0 for the right shape, near 1 for another.
    corners : float
        Third or fourth harmonic of the residuals around the outline, in standard deviations: that of a triangle or a
        square stands out.
    """
    seen, confirmed, wide = 0, 0, 0
    agreement = evidence = square = product = spread = 0.0
    c3 = s3 = c4 = s4 = 0.0
    before = math.inf
    for i in range(found.shape[0]):
        if runs[i, 4] == 0:
            before = math.inf
            continue
        seen += 1
        e = found[i, 0]
        if abs(e) <= tolerance:
            confirmed += 1
            near = 1.0 - (e / tolerance) ** 2
            agreement += near
            evidence += near * (0.5 + 0.5 * edges[i, int(found[i, 2]), 2])
            square += e * e
            product += e * before if abs(before) <= tolerance else 0.0
        if abs(e) <= 2.0 * tolerance:
            c, s = turns[i, 0], turns[i, 1]
            c2, s2 = c * c - s * s, 2.0 * c * s
            c3, s3 = c3 + e * (c2 * c - s2 * s), s3 + e * (s2 * c + c2 * s)
            c4, s4 = c4 + e * (c2 * c2 - s2 * s2), s4 + e * 2.0 * c2 * s2
            spread += e * e
            wide += 1
        before = e
    largest = math.sqrt(max(c3 * c3 + s3 * s3, c4 * c4 + s4 * s4))
    corners = largest / math.sqrt(0.5 * (spread + wide * LEAST * LEAST) + 1e-9)
    wave = product / (square + confirmed * LEAST * LEAST + 1e-9)
    whole = max(seen, 1)
    return seen, confirmed, agreement / whole, evidence / whole, wave, corners


@kernel(refcount=False)
def conclude(
    outline: Floats,
    edges: Floats,
    found: Floats,
    outlier: float,
    covariance: Floats,
    inflation: float,
    center_floor: float,
    size_floor: float,
    points: Floats,
    wide: Floats,
) -> int:
    """Match-set and covariance of a fit.

    Parameters
    ----------
    outline, edges : (n, 4 + s + 2), (n, 3, 3)
        See `Views`.
    found : (n, 3)
        See `fit_lines`.
    outlier : float
        Distance from the outline from which an edge point is left out, px.
    covariance : (p, >= p)
        That of the fit.
    inflation : float
        By how much it is enlarged.
    center_floor, size_floor : float
        Least variance of the first two parameters and of the others.
    points : (n, 2), written
        Edge points that are no gross outliers, px (Epstein & Feldman, Eq. 4), from the first row on.
    wide : (p, p), written
        The covariance.

    Returns
    -------
    int
        How many points there are.
    """
    count = 0
    for i in range(found.shape[0]):
        if abs(found[i, 0]) < outlier:
            d = edges[i, int(found[i, 2]), 0]
            points[count, 0], points[count, 1] = (
                outline[i, 0] + d * outline[i, 2],
                outline[i, 1] + d * outline[i, 3],
            )
            count += 1
    p = covariance.shape[0]
    for j in range(p):
        for k in range(p):
            wide[j, k] = inflation * 0.5 * (covariance[j, k] + covariance[k, j])
        wide[j, j] += center_floor if j < 2 else size_floor
    return count
