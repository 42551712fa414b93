"""The compiled kernels as the tests call them: where a signature changes, this file changes and no other."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.color_adaptation import adapt_table, count_inside
from matchset.shapes.circle import Circle
from matchset.tracking import peak_circles, voting
from matchset.tracking.fit import _median, fit_lines, scratch_size
from matchset.tracking.match_set import match_lines
from matchset.tracking.memory import Memory
from matchset.tracking.review import review_lines

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


class Limits(NamedTuple):
    """What `match_lines` is asked for."""

    reach: float
    margin: int
    threshold: float = 0.0
    enough: float = 1.0
    plain: float = 0.0
    combed: bool = False


def channels_last(image: Bytes) -> Bytes:
    return image if image.ndim == 3 else image[:, :, np.newaxis]


def edges_across(image: Bytes, table: Scores, points: Floats, normals: Floats, limits: Limits) -> Found:
    """Edge points on the lines through points (n, 2) along normals (n, 2)."""
    lines = Memory(len(points), 5, 3).parts
    lines.outline[:, 0:2], lines.outline[:, 2:4] = points, normals
    working = lines.edges, lines.runs, lines.starts, lines.pixels, lines.sums
    noise = match_lines(channels_last(image), table, lines.outline, *limits, *working)
    offset, strength, whiteness = (lines.edges[:, :, k].copy() for k in range(3))
    return Found(offset, strength, whiteness, lines.runs[:, 4] > 0, noise)


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
    fields: tuple[float, float] = (0.0, 0.0),
    expected: tuple[float, float, float] | None = None,
) -> Fit:
    """Fit of a state (s,) to edge points (n, 3) with a jacobian (n, s + 2); where the fields' distance begins.

    What is expected of it, and its standard deviation: by default none, by as much as the speed allows.
    """
    moved, count = state.copy(), len(prior.spread)
    outline = np.concatenate((np.zeros((len(jacobian), 4)), jacobian), axis=1)
    edges = np.stack((offset, strength, np.ones_like(offset)), axis=2)
    covariance, found = np.zeros((count, jacobian.shape[1])), np.zeros((len(jacobian), 3))
    scratch = np.zeros(scratch_size(len(jacobian), len(state)))
    apart = np.array((*fields, *(expected or (0.0, 0.0, 0.1 + 0.5 * prior.speed))))
    noise, _ = fit_lines(outline, edges, moved, *prior, covariance, found, apart, scratch)
    chosen = found[:, 2].astype(np.int64)
    return Fit(moved - state, noise, covariance[:, :count], found[:, 0], found[:, 1], chosen)


def review(
    residual: Floats, whiteness: Floats, seen: npt.NDArray[np.bool_], tolerance: float
) -> tuple[int, int, float, float, float, float]:
    """Seen, confirmed, agreement, evidence, wave, corners of lines at even angles, whose first edge points count."""
    n = len(residual)
    edges, runs = np.zeros((n, 3, 3)), np.zeros((n, 5), np.int64)
    edges[:, 0, 2], runs[:, 4] = whiteness, np.where(seen, 9, 0)
    return review_lines(np.column_stack((residual, np.zeros((n, 2)))), edges, runs, turns(n), tolerance)


def median(values: Floats) -> float:
    return float(_median(values.astype(np.float32), len(values) // 2))


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
    return count_inside(channels_last(image), color.table, outline, shares, circle.x, circle.y)


def adapt(image: Bytes, color: ColorModel, first: npt.NDArray[np.float32], circle: Circle, rate: float) -> None:
    """Teach a color what is in and around a circle, as a tracker does in four frames."""
    outline, shares = _outline(circle, 64)
    target = color.log_odds, first, color.table, outline, shares
    for begin in range(4):
        adapt_table(channels_last(image), *target, circle.x, circle.y, begin, rate)


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
    votes = voting.count_votes(smooth, edges, (nearest, farthest), 1, voting.SearchParameters())
    return np.stack((votes, peak_circles.sum_votes(votes)))
