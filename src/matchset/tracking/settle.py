"""From a rough state to the shape: trace the outline, find its match-set, fit, again until nothing moves."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import inlined
from matchset.tracking import motion
from matchset.tracking.measure import measure
from matchset.tracking.memory import AGREEMENT, BENT, LEAST, NOISE, RATE, REACH, SEEN, SIGMA, SIZE, Views

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]

NEAR = 0.04  # px: a square move below so much of the half-width leaves the lines where they are
SMALL, LARGE = 2.0, 1e5  # half-widths between which a shape can be fitted, px


def make_settle(trace: Callable[..., Any], half_width: Callable[..., Any]) -> Callable[..., bool]:
    """Compile the fit for a family of shapes.

    Parameters
    ----------
    trace, half_width : callable
        Compiled, see `Shape`.

    Returns
    -------
    callable
        ``settle(image, table, parts, spread)``: fit near ``parts.state``, as far as
        ``parts.look`` says; whether there are edge points to judge. See `Matcher.settle`.
    """

    @inlined
    def settle(
        image: Bytes,
        table: Scores,
        parts: Views,
        spread: Floats,
    ) -> bool:
        fit, state, look = parts.fit, parts.state, parts.look
        reach, speed, sigma, least = look[REACH], look[RATE], look[SIGMA], look[LEAST]
        for k in range(state.shape[0]):
            parts.begin[k] = state[k]
        noise, fit[NOISE] = fit[NOISE], 0.0
        motion.part_fields(parts)
        for _ in range(int(parts.match[6])):
            size = half_width(state)
            if not SMALL < size < LARGE:
                fit[SEEN] = 0.0
                return False
            trace(state, parts.rays, parts.outline)
            noise, moved = measure(image, table, parts, spread, size, reach, speed, noise, sigma)
            if noise == 0.0 or fit[AGREEMENT] < least:
                return False
            if moved * moved < NEAR * size:
                break
            reach, sigma = max(4.0, 2.0 + 0.5 * speed), 1.0
        size, modes = half_width(state), 0.0
        for k in range(parts.spread.shape[0], state.shape[0]):
            modes += state[k] * state[k]
        fit[NOISE], fit[SIZE], fit[BENT] = noise, size, math.sqrt(modes) / size
        return bool(SMALL < size < LARGE)

    return settle
