"""The compiled kernels as the tests call them: where a signature changes, this file changes and no other."""

from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting import fit_quality, match_set, robust_fit
from matchset.fitting.fit_quality import QualityParameters
from matchset.fitting.match_set import MatchParameters
from matchset.fitting.prior import FieldParameters, MotionParameters
from matchset.fitting.robust_fit import FitParameters
from matchset.fitting.workspace import MAX_LINES, PLACE_COLUMNS, STATE, EdgeCriteria, workspace_dtype
from matchset.image.color import ColorModel
from matchset.image.light.color_adaptation import AdaptationParameters, adapt_table, adaptation_block
from matchset.numeric.jit import kernel
from matchset.numeric.record import Record, fields, new_block, store
from matchset.shapes.circle import Circle
from matchset.sim.quadrotor import SETPOINT, VEHICLE, WAKE, advance, write_downwash
from matchset.tracking.search import peak_circles, voting

WORK = workspace_dtype(MAX_LINES, STATE, PLACE_COLUMNS)
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]
Scores = npt.NDArray[np.int8]


class Found(NamedTuple):
    """The edge points of n lines, up to three each; strength 0 where there is none."""

    offset: Floats
    strength: Floats
    whiteness: Floats
    looked: npt.NDArray[np.bool_]
    noise: float


Limits = EdgeCriteria  # what `find_edge_points` is asked for


def channels_last(image: Bytes) -> Bytes:
    return image if image.ndim == 3 else image[:, :, np.newaxis]


@kernel(refcount=False)
def find_edge_points(image: Bytes, table: Scores, work: Record) -> float:
    return match_set.find_edge_points(image, table, work)


@kernel(refcount=False)
def robust_fit_of(work: Record) -> None:
    robust_fit.robust_fit(work)


@kernel(refcount=False)
def measure_lines(work: Record, tolerance: float) -> None:
    fit_quality.measure_lines(work, tolerance)


@kernel(refcount=False)
def measure_interior(image: Bytes, table: Scores, work: Record) -> None:
    fit_quality.measure_interior(image, table, work)


@kernel(refcount=False)
def median_of(values: npt.NDArray[np.float32], wanted: int) -> float:
    return robust_fit.median_of(values, wanted)


def workspace(lines: int, state: int, parameters: int) -> Record:
    """An empty workspace with the default parameters, for a state of so many numbers."""
    work = fields(new_block(WORK), WORK)
    work.line_count, work.state_count, work.parameter_count, work.place_columns = lines, state, parameters, 2
    limits = (work.match_limits, MatchParameters()), (work.fit_limits, FitParameters())
    more = (work.quality_limits, QualityParameters()), (work.field_limits, FieldParameters())
    for record, values in (*limits, *more, (work.motion_limits, MotionParameters())):
        store(record, values)
    work.places[: 2 * lines] = turns(lines).ravel()
    return work


def edges_across(image: Bytes, table: Scores, points: Floats, normals: Floats, limits: Limits) -> Found:
    """Edge points on the lines through points (n, 2) along normals (n, 2)."""
    n = len(points)
    work = workspace(n, 5, 3)
    work.outline[:n, 0:2], work.outline[:n, 2:4] = points, normals
    work["criteria"] = tuple(limits)
    noise = find_edge_points(channels_last(image), table, work)
    offset, strength, whiteness = (work.edges[:n, :, k].copy() for k in range(3))
    return Found(offset, strength, whiteness, work.runs[:n, 4] > 0, noise)


class Prior(NamedTuple):
    """What `fit_lines` is told beside the edge points."""

    expected: Floats
    spread: Floats
    size: float
    speed: float = 0.0
    noise: float = 0.0
    start: float = 2.0
    floor: float = 0.4


class Fit(NamedTuple):
    """What `fit_lines` made of them; residual infinite where a line has no edge point."""

    step: Floats
    noise: float
    covariance: Floats
    residual: Floats
    weight: Floats
    chosen: Ints


def fit(
    jacobian: Floats,
    offset: Floats,
    strength: Floats,
    state: Floats,
    prior: Prior,
    begin: tuple[float, float] = (0.0, 0.0),
    expected: tuple[float, float, float] | None = None,
) -> Fit:
    """Fit of a state (s,) to edge points (n, 3) with a jacobian (n, s + 2); where the fields' distance begins.

    What is expected of it, and its standard deviation: by default none, by as much as the speed allows.
    """
    n, s, p = len(jacobian), len(state), len(prior.spread)
    work = workspace(n, s, p)
    work.outline[:n, 4 : 4 + s + 2] = jacobian
    work.edges[:n] = np.stack((offset, strength, np.ones_like(offset)), axis=2)
    work.state[:s], work.start[:s], work.motion.prior_sigma[:p] = state, prior.expected, prior.spread
    work.window.use_prior, work.window.speed, work.fit_limits.min_noise = 1, prior.speed, prior.floor
    work["iteration"] = prior.size, prior.noise, prior.start, 0.0, 1.0
    expected = expected or (0.0, 0.0, 0.1 + 0.5 * prior.speed)
    work["field_offset"] = begin, expected[:2], expected[2]
    robust_fit_of(work)
    chosen = work.chosen[:n, 2].astype(np.int64)
    covariance = work.covariance[:p, :p].copy()
    residual, weight = work.chosen[:n, 0].copy(), work.chosen[:n, 1].copy()
    return Fit(work.state[:s] - state, float(work.iteration.noise), covariance, residual, weight, chosen)


def review(
    residual: Floats, whiteness: Floats, seen: npt.NDArray[np.bool_], tolerance: float
) -> tuple[int, int, float, float, float, float]:
    """Visible, inliers, scores, autocorrelation, harmonic of lines at even angles, whose first edge points count."""
    n = len(residual)
    work = workspace(n, 5, 3)
    work.chosen[:n, 0] = residual
    work.edges[:n, 0, 2], work.runs[:n, 4] = whiteness, np.where(seen, 9, 0)
    measure_lines(work, tolerance)
    fit = work.fit
    agreement = fit.msac_score, fit.color_score, fit.residual_autocorrelation, fit.harmonic_score
    return fit.visible, fit.inliers, *agreement


def median(values: Floats) -> float:
    return float(median_of(values.astype(np.float32), len(values) // 2))


def turns(n: int) -> Floats:
    """Cosine and sine of n even angles, as a matcher has them."""
    angles = 2.0 * np.pi * (np.arange(n) + 0.5) / n
    return np.column_stack((np.cos(angles), np.sin(angles)))


class Outline(NamedTuple):
    """Where a traced outline is and how it moves with each number of the state."""

    points: Floats
    normals: Floats
    jacobian: Floats


def trace(state: Floats, directions: Floats) -> Outline:
    outline = np.zeros((len(directions), 4 + len(state) + 2))
    Circle.trace(state, directions, outline)
    return Outline(outline[:, 0:2], outline[:, 2:4], outline[:, 4 : 4 + len(state)])


def look_inside(image: Bytes, color: ColorModel, circle: Circle) -> tuple[float, float, float]:
    """Inside, core and hollow of a circle."""
    outline, shares = _outline(circle, 64)
    work = workspace(64, 5, 3)
    work.outline[:64, :11], work.interior[:64] = outline, shares
    work.state[:2] = circle.x, circle.y
    measure_interior(channels_last(image), color.table, work)
    return work.fit.interior_share, work.fit.core_share, work.fit.hollowness


def adapt(
    image: Bytes,
    color: ColorModel,
    first: npt.NDArray[np.float32],
    circle: Circle,
    rate: float,
    limits: AdaptationParameters | None = None,
    looks: range = range(4),
) -> None:
    """Teach a color what is in and around a circle, as a tracker does in as many frames as there are looks."""
    outline, shares = _outline(circle, 64)
    target = color.log_odds, first, color.table, outline, shares
    block = adaptation_block(msgspec.structs.replace(limits or AdaptationParameters(), rate=rate))
    for look in looks:
        adapt_table(channels_last(image), *target, circle.x, circle.y, look, block)


def _outline(circle: Circle, n: int) -> tuple[Floats, Floats]:
    outline = np.zeros((n, 11))
    Circle.trace(circle.state, turns(n), outline)
    return outline, 0.88 * np.sqrt((np.arange(n) * 0.6180339887) % 1.0)


def grid_edges(smooth: npt.NDArray[np.int16]) -> Floats:
    """Boundary of the positive region of a grid: x, y and outward normal, (n, 4)."""
    edges = np.zeros((smooth.size, 4))
    return edges[: voting.find_edges(smooth, edges)]


def votes_for_centers(
    smooth: npt.NDArray[np.int16], edges: Floats, nearest: int, farthest: int
) -> npt.NDArray[np.float32]:
    """Votes for each cell of a grid to be a center, as they fall and summed over 5 x 5 cells."""
    accumulator = voting.Accumulator(smooth.shape, (nearest, farthest), 1, voting.SearchParameters())
    accumulator.count_votes(smooth, edges)
    return np.stack((accumulator.votes, peak_circles.sum_votes(accumulator.votes)))


def step_vehicle(state: Floats, wanted: Floats, wind: Floats, constants: Floats, step: float) -> None:
    """Advance one vehicle by one step, in place."""
    advance(state, wanted.view(SETPOINT)[0], wind, constants.view(VEHICLE)[0], step)


def downwash(states: Floats, who: int, wake: Floats, wind: Floats) -> None:
    """Write the velocity of the air at a vehicle in the wakes of those above it."""
    write_downwash(states, who, wake.view(WAKE)[0], wind)
