"""One look at a shape: match-set, fit and review of an outline that was traced."""

import numpy as np
import numpy.typing as npt

from matchset.image.color_adaptation import count_inside
from matchset.numeric.jit import inlined
from matchset.tracking.fit import fit_lines
from matchset.tracking.match_set import match_lines
from matchset.tracking.memory import (
    AGREEMENT,
    APART,
    CONFIRMED,
    CORE,
    CORNERS,
    EVIDENCE,
    EXPECTED,
    FIELDS,
    GRAIN,
    HOLLOW,
    INSIDE,
    SEEN,
    WAVE,
    Views,
)
from matchset.tracking.review import review_lines

Floats = npt.NDArray[np.float64]

GRAIN_MEMORY = 0.9  # share of the pixels' noise that one look leaves
COMBED = 2.0  # so many standard deviations of an edge point apart the fields are combed along a column
QUIET = 0.7  # px: the least standard deviation that is taken for that


@inlined
def measure(
    image: npt.NDArray[np.uint8],
    table: npt.NDArray[np.int8],
    parts: Views,
    spread: Floats,
    size: float,
    reach: float,
    speed: float,
    noise: float,
    sigma: float,
) -> tuple[float, float]:
    """Match, fit and review the outline that was traced.

    Parameters
    ----------
    image, table
        See `match_lines`.
    parts : Views
        Outline and state are read; edge points, state, covariance and what is known of the fit are written.
    spread : (p,)
        How far each parameter may be from where the fit began, see `fit_lines`.
    size, speed, noise, sigma
        See `fit_lines`.
    reach : float
        How far the edge may be from the outline, px.

    Returns
    -------
    noise, moved
        See `fit_lines`; a noise of 0 means that there was nothing to fit.
    """
    fit, limits = parts.fit, parts.match
    grain = fit[GRAIN]
    most = max(int(1.5 + 0.4 * grain), 2)
    margin = max(min(int(0.25 * size), most, int(limits[0])), 1)
    full = 254.0 * margin  # whiteness of a step from surely background to surely target
    plain = 6.0 * margin * (limits[3] * max(grain, 1.0)) ** 2
    outline, edges, found, state, runs = parts.outline, parts.edges, parts.found, parts.state, parts.runs
    enough, starts, pixels, sums = limits[2] * full, parts.starts, parts.pixels, parts.sums
    combed = abs(fit[EXPECTED + 1]) > COMBED * max(noise, QUIET)
    now = match_lines(
        image, table, outline, reach, margin, limits[1] * full, enough, plain, combed, edges, runs, starts, pixels, sums
    )
    fit[GRAIN] = GRAIN_MEMORY * grain + (1.0 - GRAIN_MEMORY) * now
    between = fit[FIELDS : APART + 1]
    noise, moved = fit_lines(
        outline,
        edges,
        state,
        parts.begin,
        spread,
        size,
        speed,
        noise,
        sigma,
        limits[4],
        parts.covariance,
        found,
        between,
        parts.scratch,
    )
    tolerance = min(max(limits[5] * size, 1.2), 3.0)
    fit[SEEN], fit[CONFIRMED], fit[AGREEMENT], fit[EVIDENCE], fit[WAVE], fit[CORNERS] = review_lines(
        found, edges, runs, parts.rays, tolerance
    )
    shares = parts.rays[:, parts.rays.shape[1] - 1]
    fit[INSIDE], fit[CORE], fit[HOLLOW] = count_inside(image, table, outline, shares, state[0], state[1])
    return noise, moved
