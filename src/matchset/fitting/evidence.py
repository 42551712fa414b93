"""How much a fit speaks for the target: log-odds of target against chance, from what the fit rests on.

A fixed limit on one figure asks too much of a compressed, blurred or half-hidden ball and too little of a sharp square.
So all figures are weighed together, by logistic regression over fits that were the target and fits that were not:

    log-odds = bias + sum of weight * figure.

One figure is measured for this alone: the step in color across the outline over a longer way than an edge point
(`measure_color_step`), since a coded picture keeps one color for blocks of 2 x 2 to 16 x 16 pixels.
"""

import math
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Lines = npt.NDArray[np.bool_]
Scores = npt.NDArray[np.int8]
Indices = npt.NDArray[np.intp]
Statistics = Any  # `FitStatistics`, or the record of the same fields


class EvidenceParameters(msgspec.Struct, frozen=True):
    """How figures are weighed, and how much evidence a detection needs.

    The weights come from logistic regression over candidates of rendered sequences and of real clips, once, by hand.
    `python -m benchmarks.evidence` does such a fit again; it finds somewhat other weights
    (docs/log/fitting.md#evidence-weighed), which were not taken, since what is asked goes with the scale of these.

    Parameters
    ----------
    bias : float
        Log-odds of a candidate of which nothing is known.
    msac, inliers : float
        Weights of the MSAC score and of the share of inliers.
    harmonic : float
        Weight of the harmonic score, over five standard deviations.
    core : float
        Weight of the share of the middle that has the target's color.
    size, small, small_px : float
        Weights of ln(half-width / px) / 4 and of 1 - half-width / `small_px`, 0 for larger shapes: chance makes small
        ones easily.
    noise : float
        Weight of the standard deviation of the edge points over the tolerance of an inlier, thrice at most, over 3.
    step, agreement, outside : float
        Weights of the step in color across the outline, of that times the MSAC score, and of the share of the
        surroundings that have the target's color.
    unknown, present, here : float
        Least log-odds of a shape that may be anywhere, of one that somebody clicked at or that was tracked until now,
        and of one that is expected about here. Less finds more, and more that is not there.
    clear : float
        Least log-odds with which a high color score may speak for a shape that may be anywhere. Less finds more, and
        more that is not there: rings of the target's color, most of them before dark things, had 1.6 to 4.4 in
        `python -m benchmarks --only false_locks`; of half-hidden balls among clutter half have more
        (docs/log/tracking.md#false-locks-again).
    faint : float
        Log-odds below which a shape that is tracked with a low color score is seen faintly. More gives it up sooner.
    clicked : float
        The same of the circle that was found around a click, in the picture that was clicked: the color did not find
        it. Three clicks on balls of r = 7 gave fits 0.5 px off with -0.9 to -0.2.
    unknown_msac : float
        Least MSAC score of a shape that may be anywhere: a card of the target's color touches a circle too.
    asked, asked_msac : float
        The same two for a single picture that somebody wants searched: there is no other frame to find it in, and a
        wrong answer is not held on to.
    hidden : float
        Log-odds that are lost per share of the outline outside the picture.
    way, min_way_px, max_way_px : float
        Where the step in color is read, on both sides of the outline: in half-widths, at least and at most px.
    near_way, min_near_px : float
        The same nearer to the outline, where it tells which of two outlines is right.
    boundary, min_boundary_px, boundary_samples : float
        How far on both sides of the outline the end of the target's color is looked for: in half-widths and at least
        px; and in how many places at most.
    full_step : float
        Step in whiteness, -1 ... 1 on each side, from which a larger one is no better.
    """

    bias: float = -4.2
    msac: float = 0.4
    inliers: float = 4.5
    harmonic: float = -4.7
    core: float = 5.2
    size: float = -0.3
    small: float = -4.2
    small_px: float = 12.0
    noise: float = -7.3
    step: float = 3.1
    agreement: float = 2.3
    outside: float = -9.0
    unknown: float = 6.75
    unknown_msac: float = 0.6
    asked: float = 2.5
    asked_msac: float = 0.4
    present: float = 1.0
    here: float = 0.0
    clear: float = 4.5
    faint: float = 1.0
    clicked: float = -3.0
    hidden: float = 6.0
    way: float = 0.2
    min_way_px: float = 2.0
    max_way_px: float = 8.0
    near_way: float = 0.08
    min_near_px: float = 1.5
    boundary: float = 0.5
    min_boundary_px: float = 4.0
    boundary_samples: int = 41
    full_step: float = 1.2


class ColorStep(NamedTuple):
    """Step in color across an outline.

    Attributes
    ----------
    step : float
        Mean over the lines of whiteness inside minus whiteness outside, as a share of a full step, 0 ... 1.
    outside : float
        Share of the lines beyond which the target's color goes on.
    """

    step: float
    outside: float


DISTANCES = np.array([-2.0, -1.5, -1.0, 1.0, 1.5, 2.0])  # geometry: where the color is read, in ways from the outline
NO_STEP, BEST_STEP = ColorStep(0.0, 1.0), ColorStep(1.0, 0.0)


def measure_color_step(
    image: Image, color: ColorModel, outline: Floats, half_width: float, limits: EvidenceParameters
) -> ColorStep:
    """Measure the step in color across an outline.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    outline : ndarray of shape (n, >= 4), float64
        Points and outward normals, px.
    half_width : float
        Of the shape, px.
    limits : EvidenceParameters
    """
    way = min(max(limits.way * half_width, limits.min_way_px), limits.max_way_px)
    steps, outside = _steps(image, color, outline, way, limits.full_step)
    return ColorStep(float(steps.mean()), float((outside > 0.0).mean())) if len(steps) else NO_STEP


def measure_near_step(
    image: Image, color: ColorModel, outline: Floats, half_width: float, limits: EvidenceParameters
) -> float:
    """Measure the step in color nearer to an outline, 0 ... 1: it tells which of two outlines is where the color ends.

    Parameters
    ----------
    image, color, outline, half_width, limits
        See `measure_color_step`.
    """
    way = min(max(limits.near_way * half_width, limits.min_near_px), limits.max_way_px)
    steps, _ = _steps(image, color, outline, way, limits.full_step)
    return float(steps.mean()) if len(steps) else 0.0


def _steps(image: Image, color: ColorModel, outline: Floats, way: float, full_step: float) -> tuple[Floats, Floats]:
    """Step in color of every line that lies in the picture, 0 ... 1, and the whiteness outside."""
    white = scores_along(image, color, outline, way * DISTANCES)[0] / 127.0
    inside, outside = white[:3].mean(axis=0), white[3:].mean(axis=0)
    return np.clip((inside - outside) / full_step, 0.0, 1.0), np.asarray(outside)


def pixels_along(image: Image, outline: Floats, offsets: Floats) -> tuple[Indices, Indices, Lines]:
    """Find the pixels along the normals of an outline.

    Parameters
    ----------
    image, outline
        See `measure_color_step`.
    offsets : ndarray of shape (m,), float64
        From the outline outward, px.

    Returns
    -------
    rows, columns : ndarray of shape (m, k), intp
        Of the k lines that lie in the picture.
    seen : ndarray of shape (n,), bool
        Which lines these are.
    """
    places = outline[:, :2] + offsets[:, np.newaxis, np.newaxis] * outline[:, 2:4]
    columns, rows = np.rint(places).astype(np.intp).transpose(2, 0, 1)
    seen = ((columns >= 0) & (columns < image.shape[1]) & (rows >= 0) & (rows < image.shape[0])).all(axis=0)
    return rows[:, seen], columns[:, seen], seen


def scores_along(image: Image, color: ColorModel, outline: Floats, offsets: Floats) -> tuple[Scores, Lines]:
    """Look pixels up in the color table along the normals of an outline.

    Parameters
    ----------
    image, color, outline
        See `measure_color_step`.
    offsets : ndarray of shape (m,), float64
        From the outline outward, px.

    Returns
    -------
    scores : ndarray of shape (m, k), int8
        Of the k lines that lie in the picture.
    seen : ndarray of shape (n,), bool
        Which lines these are.
    """
    rows, columns, seen = pixels_along(image, outline, offsets)
    return color.scores(image[rows, columns]).reshape(len(offsets), -1), seen


def find_color_boundary(
    image: Image, color: ColorModel, outline: Floats, half_width: float, limits: EvidenceParameters
) -> tuple[Floats, Lines]:
    """Find where the target's color ends on each line across an outline: the split with most whiteness inside.

    It does not ask for contrast, so neither blur nor a background with stronger edges leads it astray; but it is as
    rough as the color is.

    Parameters
    ----------
    image, color, outline, half_width, limits
        See `measure_color_step`.

    Returns
    -------
    distances : ndarray of shape (n,), float64
        From the outline outward, px; 0 on lines that leave the picture.
    seen : ndarray of shape (n,), bool
        Lines that lie in the picture.
    """
    span = max(limits.boundary * half_width, limits.min_boundary_px)
    offsets = np.linspace(-span, span, min(max(2 * round(span) + 1, 9), limits.boundary_samples))
    white, seen = scores_along(image, color, outline, offsets)
    distances = np.zeros(len(outline))
    if seen.any():
        inside = np.zeros((len(offsets) + 1, white.shape[1]), np.int64)
        np.cumsum(white, axis=0, out=inside[1:])
        split = np.argmax(2 * inside - inside[-1], axis=0)
        distances[seen] = offsets[0] + (split - 0.5) * (offsets[1] - offsets[0])
    return distances, seen


def log_odds(fit: Statistics, step: ColorStep, tolerance: float, limits: EvidenceParameters) -> float:
    """Log-odds of a fit being the target against chance.

    Parameters
    ----------
    fit : FitStatistics
    step : ColorStep
    tolerance : float
        Of an inlier, px.
    limits : EvidenceParameters
    """
    return float(
        limits.bias
        + limits.msac * fit.msac_score
        + limits.inliers * fit.inliers / max(fit.visible, 1.0)
        + limits.harmonic * 0.2 * fit.harmonic_score
        + limits.core * fit.core_share
        + limits.size * 0.25 * math.log(max(fit.half_width, 1.0))
        + limits.small * max(1.0 - fit.half_width / limits.small_px, 0.0)
        + limits.noise * min(fit.edge_noise / tolerance, 3.0) / 3.0
        + limits.step * step.step
        + limits.agreement * step.step * fit.msac_score
        + limits.outside * step.outside
    )
