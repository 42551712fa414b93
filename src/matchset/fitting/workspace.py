"""The workspace of a fitter and its tracker: everything that their compiled code reads and writes, by name.

It is one block of floats, cast to a record in the first line of each compiled entry, see `numeric.record`. All families
of shapes share one layout of fixed capacity, and so most of the compiled code; of the capacity only the pages that are
used take memory.
"""

import functools
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.fitting.fit_quality import QualityParameters
from matchset.fitting.match_set import CANDIDATES, MAX_PIXELS, SUMS, MatchParameters
from matchset.fitting.prior import FieldParameters, GateParameters, MotionParameters, WindowParameters
from matchset.fitting.robust_fit import FitParameters
from matchset.fitting.validation import ValidationParameters
from matchset.numeric.record import record_dtype

Floats = npt.NDArray[np.float64]

MAX_LINES = 4096  # format: capacity of the match-set, lines across the outline
FEW_LINES = 128  # format: capacity where that is enough: a compact workspace stays in the processor's cache
STATE = 8  # format: capacity of a state; a family with more numbers has a layout of its own
MOTION_ARRAYS = ("last_state", "velocity", "predicted", "innovation_scale", "prior_sigma")
PLACE_COLUMNS = 34  # format: capacity of what a family says of a line's place, numbers


class FitStatistics(NamedTuple):
    """What the last fit rests on. `edge_noise` and `pixel_noise` also are what the next fit begins with.

    Attributes
    ----------
    edge_noise : float
        Standard deviation of an edge point, px; 0 where no fit was possible.
    pixel_noise : float
        Standard deviation of a pixel's noise, gray levels.
    visible, inliers : float
        Number of lines that lie in the picture, and of those of them whose edge point lies on the outline.
    msac_score : float
        Mean over the visible lines of ``1 - (residual / tolerance)^2``, 0 for outliers: MSAC's truncated square.
    color_score : float
        The same, but an inlier without a step in color counts half.
    residual_autocorrelation : float
        Correlation of the residuals of neighboring lines: near 0 for the right shape, near 1 for another.
    harmonic_score : float
        Third or fourth harmonic of the residuals around the outline, in standard deviations: that of a triangle or a
        square stands out.
    interior_share, core_share : float
        Share of the pixels looked at that have the target's color: inside the outline, and in the middle alone; -1
        where too few were looked at.
    hollowness : float
        By how much emptier the middle is than the inside near the outline: that of a ring.
    half_width : float
        Of the fitted shape, px.
    ellipticity : float
        Length of the modes, in half-widths.
    """

    edge_noise: float
    pixel_noise: float
    visible: float
    inliers: float
    msac_score: float
    color_score: float
    residual_autocorrelation: float
    harmonic_score: float
    interior_share: float
    core_share: float
    hollowness: float
    half_width: float
    ellipticity: float


class SearchWindow(NamedTuple):
    """How far around a state a shape is looked for.

    Attributes
    ----------
    range_px : float
        How far the outline may be from where the fit begins, along its normal, px.
    speed : float
        Speed of the shape, px per frame: the two fields of an interlaced picture lie apart by a part of that.
    initial_sigma : float
        How far the edge points are expected from where the fit begins, px; 0 for a third of the range.
    min_score : float
        MSAC score below which the fit is given up.
    velocity_unknown : bool
        Whether nothing is known of the direction in which the shape moves.
    use_prior : bool
        Whether the motion's prediction is a prior of the fit, with its variance; otherwise that is infinite.
    """

    range_px: float
    speed: float = 0.0
    initial_sigma: float = 0.0
    min_score: float = 0.0
    velocity_unknown: bool = False
    use_prior: bool = False


class EdgeCriteria(NamedTuple):
    """What makes an edge point in this look, see `find_edge_points`.

    Attributes
    ----------
    range_px : float
        How far an edge point may be from the outline along its normal, px.
    margin : int
        Pixels that Eq. 1 counts on each side.
    threshold : float
        By how much their scores must differ (the paper's nabla), table units.
    full_step : float
        Difference beyond which more whiteness is no better and contrast alone decides, table units.
    min_contrast : float
        Squared contrast that noise alone can have: an edge point without a firm step in color must stand out of it.
    per_field : bool
        Whether a line along a column must keep to one field: those of an interlaced picture lie far apart, or one of
        them is the half-frame that was taken now.
    """

    range_px: float
    margin: int
    threshold: float = 0.0
    full_step: float = 1.0
    min_contrast: float = 0.0
    per_field: bool = False


class Iteration:
    """One iteration of a fit: the half-width, px, and noise it begins with, px; the largest change of the state.

    `overlap`: see `overlap_of`.
    """

    half_width: float
    noise: float
    initial_sigma: float
    moved: float
    overlap: float


class FieldOffset:
    """Field offset, x and y, px: as it was fitted, as it was expected, and the standard deviation of the latter."""

    fitted: Annotated[Floats, (2,), "f8"]
    expected: Annotated[Floats, (2,), "f8"]
    sigma: float


class Motion:
    """Motion of the shape that is tracked, but for its arrays.

    Time of the last sighting, s; speed, px/s; innovation, px; half-width over the last well-confirmed frames, px; sums
    over the last frames of the speed times the field offset along it, px^2/s, and of the speed squared; from which
    number on the state changes slowly; 1 where the third number is the half-width. The size remembered: ln(half-width /
    px) and its change per second, as in the middle of the picture; variance of the first, 0 where nothing is
    remembered, covariance, variance of the second; time of the last sighting, s.
    """

    time: float
    speed: float
    innovation: float
    typical_half_width: float
    offset_moment: float
    speed_moment: float
    slow_from: float
    sized: float
    size_log: float
    size_trend: float
    size_variance: float
    size_covariance: float
    trend_variance: float
    size_time: float


class Scalars:
    """What does not depend on the capacity: sizes, the classes above, and the parameters as they are for the family.

    `rows`: of the picture, that are of its time: 0: all; 1: the even ones, 2: the odd ones of a half-frame.
    """

    line_count: int
    state_count: int
    parameter_count: int
    place_columns: int
    start_half_width: float
    rows: int
    fit: FitStatistics
    window: SearchWindow
    iteration: Iteration
    criteria: EdgeCriteria
    field_offset: FieldOffset
    match_limits: MatchParameters
    fit_limits: FitParameters
    quality_limits: QualityParameters
    validation: ValidationParameters
    motion_limits: MotionParameters
    window_limits: WindowParameters
    gate: GateParameters
    field_limits: FieldParameters


@functools.cache
def workspace_dtype(lines: int, numbers: int, place_numbers: int) -> "np.dtype[np.void]":
    """Layout of a workspace: `Scalars`, `motion`, and arrays for n lines, a state of s numbers and p parameters.

    `motion`: see `Motion`, and per number of the state what was last seen, its velocity per second and its prediction;
    per parameter the innovation scale and the prior's sigma. Of a fit: `state` and where it started, (s,); the `step`
    that is solved for, (s + 2,); `priors`, three numbers each: inverse variance, mean, stiffness; the `normal`
    equations; `covariance`, (p, s + 2). Along one line: `running` sums and `responses`.

    Per line: `outline`, (4 + s + 2): where it crosses the outline, px, the outward unit normal, and by how much the
    outline moves along it per unit of each number of the state and of the field offset; `edges`, (3, 3): edge points,
    strongest first: offset along the normal, px, strength, 0 where there is none, step in color as a share of a full
    one; `runs`: 1 along a row or 0 along a column, which one, first pixel, step, number of pixels, 0 where the picture
    does not reach `margin` pixels beyond the outline on both sides; `starts`: offset of the first pixel and per pixel,
    px; `chosen`: residual of the edge point the fit took, px, infinite where there is none, its weight, which it is;
    `places`: what the family says of the line's place; `interior`: a share of the way from the center to the outline
    where the inside is looked at; `weights`, `offsets`, predicted offsets and absolute `deviations` of a round;
    `choice`: costs and full weights of its edge points; `columns` of the outline's derivatives, one behind the other;
    `pixels`, one line's behind the other's.

    Parameters
    ----------
    lines : int
        Capacity of the match-set, lines.
    numbers : int
        Capacity of a state, numbers.
    place_numbers : int
        Capacity of a line's place, numbers.
    """
    unknowns = numbers + 2  # with the field offset
    of_motion = [(name, (numbers,)) for name in MOTION_ARRAYS]
    of_fit = {"state": numbers, "start": numbers, "step": unknowns, "priors": 3 * unknowns}
    arrays = [
        *((name, (length,), "f8") for name, length in of_fit.items()),
        ("normal", (unknowns * (unknowns + 1),), "f8"),
        ("covariance", (numbers, unknowns), "f8"),
        ("running", (4 * SUMS,), "i4"),
        ("responses", (2 * SUMS,), "f4"),
        ("outline", (lines, 4 + unknowns), "f8"),
        ("edges", (lines, CANDIDATES, 3), "f8"),
        ("runs", (lines, 5), "i8"),
        ("starts", (lines, 2), "f8"),
        ("chosen", (lines, 3), "f8"),
        ("interior", (lines,), "f8"),
        ("weights", (lines,), "f8"),
        ("offsets", (lines,), "f8"),
        ("predicted", (lines,), "f8"),
        ("deviations", (lines,), "f4"),
        ("choice", (lines * 2 * CANDIDATES,), "f8"),
        ("columns", (lines * unknowns,), "f8"),
        ("places", (lines * place_numbers,), "f8"),
        ("pixels", (lines * MAX_PIXELS * 3,), "u1"),
    ]
    motion = record_dtype(Motion, [(name, np.dtype(("f8", shape))) for name, shape in of_motion])
    laid_out = [(name, np.dtype((kind, shape))) for name, shape, kind in arrays]
    return record_dtype(Scalars, [("motion", motion), *laid_out])
