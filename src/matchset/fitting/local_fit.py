"""The local fit: trace the outline at a state, find its match-set, fit, and again until the shape stands still."""

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.fitting.fit_quality import measure_interior, measure_lines, overlap_of, tolerance_of
from matchset.fitting.match_set import choose_criteria, find_edge_points
from matchset.fitting.prior import correct_field_offset, predict_field_offset
from matchset.fitting.robust_fit import robust_fit
from matchset.fitting.validation import rejection_without_fit, validate_track
from matchset.numeric.jit import helper, kernel
from matchset.numeric.record import Record

Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]


@helper
def _begin(work: Record) -> None:
    """Note where the fit starts, and what it expects."""
    for k in range(work.state_count):  # a loop compiles in a tenth of the time of `[:] =`
        work.start[k] = work.state[k]
    work.iteration.noise, work.fit.edge_noise = work.fit.edge_noise, 0.0
    work.iteration.initial_sigma, work.criteria.range_px = work.window.initial_sigma, work.window.range_px
    predict_field_offset(work)


@helper
def _match_and_fit(image: Bytes, table: Scores, work: Record) -> None:
    """One iteration, for an outline that was traced: match-set, fit, and what the fit rests on."""
    fit, memory = work.fit, work.match_limits.noise_memory
    choose_criteria(work)
    noise = find_edge_points(image, table, work)
    fit.pixel_noise = memory * fit.pixel_noise + (1.0 - memory) * noise
    work.iteration.overlap = overlap_of(work)
    robust_fit(work)
    measure_lines(work, tolerance_of(work.quality_limits, work.iteration.half_width))
    measure_interior(image, table, work)


@helper
def _narrow(work: Record) -> None:
    """Search nearer to the outline in the next iteration."""
    limits = work.fit_limits
    work.criteria.range_px = max(limits.next_range, 2.0 + limits.next_range_per_speed * work.window.speed)
    work.iteration.initial_sigma = limits.next_sigma
    correct_field_offset(work)


@helper
def _conclude(work: Record, half_width: float) -> None:
    """Write noise, size and ellipticity of a fit that stands still."""
    modes = 0.0
    for k in range(work.parameter_count, work.state_count):
        modes += work.state[k] * work.state[k]
    work.fit.edge_noise, work.fit.half_width = work.iteration.noise, half_width
    work.fit.ellipticity = math.sqrt(modes) / half_width


@functools.cache
def make_local_fit(trace: Callable[..., Any], half_width: Callable[..., Any]) -> Callable[[Bytes, Scores, Record], int]:
    """Compile the local fit for a family of shapes, a piece of a kernel.

    Parameters
    ----------
    trace, half_width : callable
        Compiled, see `Shape`.

    Returns
    -------
    callable
        ``fit_locally(image, table, work)``: fit near the state in the workspace, as far as its window says; returns the
        `Rejection` of `validate_track`, or why there was nothing to fit.
    """

    @kernel(refcount=False, entry=False)
    def fit_locally(image: Bytes, table: Scores, work: Record) -> int:
        n, columns, limits, iteration, fit = (
            work.line_count,
            work.place_columns,
            work.fit_limits,
            work.iteration,
            work.fit,
        )
        state, outline = work.state[: work.state_count], work.outline[:n]
        places = work.places[: n * columns].reshape((n, columns))
        _begin(work)
        work.start_half_width = half_width(state)
        for _ in range(limits.max_iterations):
            iteration.half_width = half_width(state)
            if not limits.min_half_width < iteration.half_width < limits.max_half_width:
                fit.visible = 0
                return rejection_without_fit(fit, work.validation, n)
            trace(state, places, outline)
            _match_and_fit(image, table, work)
            if iteration.noise == 0.0 or fit.msac_score < work.window.min_score:
                return rejection_without_fit(fit, work.validation, n)
            if iteration.moved * iteration.moved < limits.final_move * iteration.half_width:
                break
            _narrow(work)
        size = half_width(state)
        _conclude(work, size)
        if not limits.min_half_width < size < limits.max_half_width:
            return rejection_without_fit(fit, work.validation, n)
        return validate_track(fit, work.validation, n)

    return fit_locally
