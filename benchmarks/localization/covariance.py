"""Is the covariance of the position honest: the normalized error squared of 1,000 poses against chi-square."""

import math

import msgspec
import numpy as np

import matchset as ms
from benchmarks.localization.poses import PINHOLE, RADIUS, observe, place_ball
from benchmarks.options import Options
from benchmarks.results import Finding, Section, table
from benchmarks.tracking.covariance import BAR, FREEDOM, LEVEL, PRIZE, figures
from benchmarks.tracking.trial import clicked, sequence
from benchmarks.workers import spread
from matchset.sim.clips.ball_flight_clip import BallFlightClip

PRESETS = ("clean", "typical")
FLYING, POSES = 10, 60  # sequences, and frames of each that count: 600 poses on the move
RESTING, STILLS = 80, 5  # places, and frames at each: 400 poses at rest
WHOLE = 0.995  # share of the disc that must be seen: a ball behind the picture's border is another matter


class Task(msgspec.Struct, frozen=True):
    """A ball that flies or rests; a link and a seed."""

    flies: bool
    preset: str
    seed: int


def run(options: Options) -> Section:
    """Compare errors with claimed covariances."""
    share = 5 if options.quick else 1
    findings, rows = [], []
    for preset in PRESETS:
        seeds = [options.seeds[0] + k for k in range(max(FLYING, RESTING))]
        flying = spread(measure, [Task(True, preset, seed) for seed in seeds[: FLYING // share]], options.jobs)
        resting = spread(measure, [Task(False, preset, seed) for seed in seeds[: RESTING // share]], options.jobs)
        squares = [square for part in (*flying, *resting) for square in part]
        findings.append(
            Finding(
                name=f"position_covariance_{preset}",
                what=f"covariance of the position, `{preset}`: normalized error squared below the 95 % quantile",
                figures=figures(squares),
                bar=BAR,
                prize=PRIZE,
            )
        )
        for name, parts in (("flying", flying), ("at rest", resting)):
            part = figures([square for each in parts for square in each])
            rows.append([f"{preset}, {name}", *(figure.text for figure in part)])
    head = ["", *(figure.name for figure in findings[0].figures)]
    text = (
        f"e = answer - truth in m, P its covariance: eᵀP⁻¹e of an honest answer follows chi-square with {FREEDOM} "
        f"degrees of freedom ({100 * LEVEL:.0f} % below 7.81, mean 3). *Flying*: the sequences of *Accuracy*, radius "
        "20-120 px, up to 10 px a frame, every second frame with the whole ball in the picture. *At rest*: one ball in "
        "each room, radius 15-80 px, 0-35° off the axis. Unanswered frames do not count.\n\n" + table(head, rows)
    )
    return Section("Covariance of the position", findings, text)


def measure(task: Task) -> list[float]:
    """Follow the ball of one task; its normalized errors squared."""
    return _flying(task) if task.flies else _resting(task)


def _flying(task: Task) -> list[float]:
    clip = sequence(task.preset, task.seed, 2 * POSES)
    localizer = ms.Localizer(clip.camera, ms.BallTarget(2.0 * RADIUS))
    tracker: ms.Tracker[ms.Circle] | None = None
    squares = []
    for frame, truth in clip:
        tracker = tracker or clicked(frame, clip.first_click)
        pose = localizer.update(tracker.update(frame))
        if frame.index % 2 and truth.share > WHOLE and isinstance(pose, ms.Pose):
            error = pose.position - np.array(truth.position)
            squares.append(float(error @ np.linalg.solve(pose.covariance[:3, :3], error)))
    return squares


def _resting(task: Task) -> list[float]:
    rng = np.random.default_rng((task.seed, 0xC0F))
    place = None
    while place is None:
        place = place_ball(PINHOLE, rng.uniform(15.0, 80.0), math.radians(rng.uniform(0.0, 35.0)), rng)
    still = place
    flight = BallFlightClip(
        camera=PINHOLE, place=lambda _: still, frames=STILLS + 1, seed=task.seed, preset=task.preset
    )
    return [sight.square for sight in observe(flight) if isinstance(sight.pose, ms.Pose)]
