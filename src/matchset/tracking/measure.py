"""One look at a shape: match-set, fit and review in a single compiled call, since calls cost more than arithmetic."""

import numpy as np
import numpy.typing as npt

from matchset.image.adapt import count_inside
from matchset.shapes.jit import kernel
from matchset.tracking.fit import fit_lines
from matchset.tracking.match_set import match_lines
from matchset.tracking.review import review_lines

Floats = npt.NDArray[np.float64]

GRAIN_MEMORY = 0.9  # share of the pixels' noise that one look leaves


@kernel
def measure(
    image: npt.NDArray[np.uint8],
    table: npt.NDArray[np.int8],
    outline: Floats,
    edges: Floats,
    runs: npt.NDArray[np.int64],
    starts: Floats,
    pixels: npt.NDArray[np.uint8],
    sums: npt.NDArray[np.float32],
    rays: Floats,
    limits: Floats,
    state: Floats,
    expected: Floats,
    spread: Floats,
    covariance: Floats,
    found: Floats,
    size: float,
    reach: float,
    speed: float,
    noise: float,
    sigma: float,
    grain: float,
) -> tuple[float, float, float, int, int, float, float, float, float, float, float, float]:
    """Match, fit and review the outline that was traced.

    Parameters
    ----------
    image, table, outline, edges, runs, starts, pixels, sums
        See `match_lines`.
    rays : (n, 3)
        Per line the cosine and sine of its angle around the shape, and a share of the way from the center to the
        outline where the inside is looked at.
    limits : (6,)
        See `MatchParameters`: margin, threshold, enough, clear, floor, tolerance.
    state, expected, spread, covariance, found, size, speed, noise, sigma
        See `fit_lines`.
    reach : float
        How far the edge may be from the outline, px.
    grain : float
        Standard deviation of the pixels' noise over the last looks, gray levels.

    Returns
    -------
    noise, moved
        See `fit_lines`; a noise of 0 means that there was nothing to fit.
    grain
        The pixels' noise with this look.
    seen, confirmed, agreement, evidence, wave, corners
        See `review_lines`.
    inside, core, hollow
        See `count_inside`.
    """
    most = max(int(1.5 + 0.4 * grain), 2)
    margin = max(min(int(0.25 * size), most, int(limits[0])), 1)
    full = 254.0 * margin  # whiteness of a step from surely background to surely target
    plain = 6.0 * margin * (limits[3] * max(grain, 1.0)) ** 2
    now = match_lines(
        image,
        table,
        outline,
        reach,
        margin,
        limits[1] * full,
        limits[2] * full,
        plain,
        edges,
        runs,
        starts,
        pixels,
        sums,
    )
    grain = GRAIN_MEMORY * grain + (1.0 - GRAIN_MEMORY) * now
    noise, moved = fit_lines(
        outline, edges, state, expected, spread, size, speed, noise, sigma, limits[4], covariance, found
    )
    tolerance = min(max(limits[5] * size, 1.2), 3.0)
    seen, confirmed, agreement, evidence, wave, corners = review_lines(found, edges, runs, rays, tolerance)
    inside, core, hollow = count_inside(image, table, outline, rays[:, 2], state[0], state[1])
    return noise, moved, grain, seen, confirmed, agreement, evidence, wave, corners, inside, core, hollow
