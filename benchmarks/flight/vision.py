"""What the tracker does in flight, beside the noise of flights without pictures: `python -m benchmarks.flight.vision`.

Outlines and poses of rendered flights are compared with the truth, and those of the same flights without pictures, so
that what is tuned on the second can be trusted on the first: quantiles, how long errors last, whether covariances hold.
"""

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt
import typer
from scipy.stats import chi2

from benchmarks.options import parse_seeds
from benchmarks.results import table
from benchmarks.tracking.covariance import FREEDOM, LEVEL
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.links.simulation_parameters import STEPS_PER_FRAME, SimulationParameters
from matchset.localization.pose import Pose
from matchset.sim.conditions.outline_noise import EXACT
from matchset.sim.conditions.outlines import BallOutline, OutlineCameras
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]

BEGIN = 5.0  # s, of the start, which counts elsewhere
QUANTILES = (50, 90, 95, 99)
LAGS = (1, 2, 3, 10)  # pictures
OFF = 1.0  # px, a center that is farther off counts as a burst
FAR = 0.3  # m, a pose that is farther off leads into the neighbor
LIMIT = float(chi2.ppf(LEVEL, FREEDOM))
NAMES = ("x, px", "y, px", "r, px", "right, m", "down, m", "ahead, m", "marker right, deg", "marker down, deg")
MARKER = slice(6, 8)  # format: places of its errors


class Seen(NamedTuple):
    """A picture of one follower.

    Attributes
    ----------
    errors : ndarray of shape (8,)
        Of center and radius of the circle through the outline's points, px, of the ball's position in the camera frame,
        m, and of the marker's place on the circle as an angle to the right and down, degree; NaN if it was lost.
    square : float
        Normalized error squared of the position; NaN if it was lost.
    heading : float
        Heading that it flies by, for when its command acts, less the true one when that was sent, m; NaN: it has none.
    """

    errors: Floats
    square: float
    heading: float


def watch(parameters: FlightParameters) -> list[list[Seen]]:
    """Fly, and compare each picture of each follower with the truth.

    Parameters
    ----------
    parameters : FlightParameters
    """
    with Flight(parameters) as flight:
        exact = OutlineCameras(flight.chain.world, parameters.world.camera, EXACT)
        seen: list[list[Seen]] = [[] for _ in flight.chain.cameras]
        for chain_step in flight:
            for who, pictures in enumerate(seen):
                if chain_step.time >= parameters.arming_time(who) + BEGIN:
                    pictures.append(_seen(exact, chain_step, who))
    return seen


def _seen(exact: OutlineCameras, chain_step: ChainStep, who: int) -> Seen:
    """Compare a picture with the truth; its circle is that of its points, from which the pose follows."""
    step, truth = chain_step.steps[who], chain_step.truth_at_exposure
    errors, square = np.full(len(NAMES), np.nan), np.nan
    outline = exact.outline(who, STEPS_PER_FRAME * chain_step.index)
    if isinstance(step.ball, Track) and isinstance(outline, BallOutline):
        found, true = circle_through(step.ball.match_set), circle_through(outline.points)
        errors[:3] = found - true
        markers = [marker.shape for marker in step.markers if isinstance(marker, Track)]
        if markers and outline.marker is not None:
            place = np.array((markers[0].x, markers[0].y))
            errors[MARKER] = angles(place, found) - angles(outline.marker, true)
    if isinstance(step.pose, Pose):
        view = exact.viewpoint(truth[who])
        errors[3:6] = step.pose.position - view.from_room @ (truth[who + 1].ball - view.position)
        square = float(errors[3:6] @ np.linalg.solve(step.pose.covariance[:3, :3], errors[3:6]))
    heading = np.nan if step.control is None else step.control.heading - float(chain_step.true_positions[who, 2])
    return Seen(errors, square, heading)


def angles(place: Floats, circle: Floats) -> Floats:
    """How far to the right and down a place is on a ball that appears as a circle, degree.

    Parameters
    ----------
    place : ndarray of shape (2,)
        px
    circle : ndarray of shape (3,)
        x, y, r, px.
    """
    found: Floats = np.degrees(np.arcsin(np.clip((place - circle[:2]) / circle[2], -1.0, 1.0)))
    return found


def circle_through(points: Floats) -> Floats:
    """Circle that fits points best: x, y, r, px. A ball off the axis is no circle, and its middle not the points' mean.

    Parameters
    ----------
    points : ndarray of shape (n, 2)
        px.
    """
    middle = points.mean(axis=0)
    away = points - middle
    rows = np.column_stack((2.0 * away, np.ones(len(away))))
    x, y, rest = np.linalg.lstsq(rows, (away**2).sum(axis=1))[0]
    return np.array((middle[0] + x, middle[1] + y, np.sqrt(rest + x * x + y * y)))


def quantiles(errors: Floats) -> list[float]:
    """Quantiles of the magnitude of errors; NaN are left out."""
    known = np.abs(errors[np.isfinite(errors)])
    return np.percentile(known, QUANTILES).tolist() if len(known) else [np.nan] * len(QUANTILES)


def autocorrelation(followers: Sequence[Floats], lag: int) -> float:
    """Correlation of errors with those so many pictures later, of the same follower."""
    pairs = np.concatenate([np.column_stack((each[:-lag], each[lag:])) for each in followers])
    pairs = pairs[np.isfinite(pairs).all(axis=1)]
    return float(np.corrcoef(pairs.T)[0, 1]) if len(pairs) > 2 else np.nan


def longest(followers: Sequence[Floats], limit: float) -> int:
    """Most pictures in a row whose errors are larger than a limit; those that were lost neither count nor end it."""
    most = 0
    for each in followers:
        run = 0
        for error in each[np.isfinite(each)]:
            run = run + 1 if abs(error) > limit else 0
            most = max(most, run)
    return most


def summary(followers: Sequence[Sequence[Seen]]) -> list[list[str]]:
    """Rows of what was seen: one for each number of an outline, of a pose and of a marker."""
    rows = []
    for k, name in enumerate(NAMES):
        each = [np.array([seen.errors[k] for seen in pictures]) for pictures in followers]
        values = [*quantiles(np.concatenate(each)), *(autocorrelation(each, lag) for lag in LAGS)]
        rows.append([name, *(f"{value:.2g}" for value in values)])
    return rows


def side_by_side(first: Sequence[Sequence[str]], second: Sequence[Sequence[str]]) -> list[list[str]]:
    """Rows of two summaries, each cell with both."""
    return [
        [one[0], *(f"{left} / {right}" for left, right in zip(one[1:], other[1:], strict=True))]
        for one, other in zip(first, second, strict=True)
    ]


def in_words(followers: Sequence[Sequence[Seen]]) -> str:
    """Say what no table has: losses, covariances, how long poses and headings were far off."""
    every = [seen for pictures in followers for seen in pictures]
    squares = np.array([seen.square for seen in every])
    known = squares[np.isfinite(squares)]
    away = [np.array([np.linalg.norm(seen.errors[3:6]) for seen in pictures]) for pictures in followers]
    heading = [np.array([seen.heading for seen in pictures]) for pictures in followers]
    center = [np.array([np.hypot(*seen.errors[:2]) for seen in pictures]) for pictures in followers]
    unmarked = np.isfinite([seen.errors[0] for seen in every]) & np.isnan([seen.errors[MARKER][0] for seen in every])
    return (
        f"{len(every)} pictures, {100.0 * np.isnan(squares).mean():.2f} % lost, "
        f"{100.0 * unmarked.mean():.2f} % without a marker; "
        f"centers more than {OFF:g} px off: {100.0 * (np.concatenate(center) > OFF).mean():.1f} %, "
        f"{longest(center, OFF)} in a row; "
        f"normalized error squared below its 95 % quantile in {100.0 * (known < LIMIT).mean():.1f} %; "
        f"poses more than {FAR:g} m off: {longest(away, FAR)} in a row, headings flown by: {longest(heading, FAR)}"
    )


def main(
    seeds: Annotated[str, typer.Option(help='Seeds of the flights, as "900-903,910".')] = "900,901",
    seconds: Annotated[float, typer.Option(help="Length of each, s.")] = 20.0,
) -> None:
    """Compare rendered flights with the same ones without pictures."""
    rows = []
    for quick in (False, True):
        followers: list[list[Seen]] = []
        for seed in parse_seeds(seeds):
            world = SimulationParameters(seed=seed, quick=quick)
            followers += watch(FlightParameters(duration=seconds, world=world))
        typer.echo(f"\n{'without pictures' if quick else 'rendered'}: {in_words(followers)}")
        rows.append(summary(followers))
    typer.echo("\nRendered / without pictures\n")
    typer.echo(table(["", *(f"{q} %" for q in QUANTILES), *(f"lag {lag}" for lag in LAGS)], side_by_side(*rows)))


if __name__ == "__main__":
    typer.run(main)
