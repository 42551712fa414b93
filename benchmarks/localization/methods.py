"""What the exact cone is worth: range by the paper's Eq. 5 and by the cone, against the angle off the axis."""

import math
from collections.abc import Sequence

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.figures.kept import draw_kept
from benchmarks.localization.poses import RADIUS, learn, place_ball
from benchmarks.localization.range import CAMERAS
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Picture, Section, table
from benchmarks.workers import spread
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Floats = npt.NDArray[np.float64]

ANGLES_DEG = (0, 5, 10, 15, 20, 25, 30, 35)
RADIUS_PX = 50.0
FRAMES = 4
WAYS = ("Eq. 5, enclosing circle", "Eq. 5, tracked circle", "tangent cone (this)")
SHORT = ("enclosing", "tracked", "cone")


class Task(msgspec.Struct, frozen=True):
    """One ball at rest: angle off the axis, and seed."""

    off_axis_deg: int
    seed: int


def run(options: Options) -> Section:
    """Measure the three ways."""
    seeds = options.seeds[: 2 if options.quick else len(options.seeds)]
    tasks = [Task(angle, seed) for angle in ANGLES_DEG for seed in seeds]
    measured = np.array(spread(measure, tasks, options.jobs)).reshape(len(ANGLES_DEG), len(seeds) * FRAMES, len(WAYS))
    errors = {name: 100.0 * measured[..., way] for way, name in enumerate(WAYS)}
    pictures: tuple[Picture, ...] = ()
    if options.pictures is not None:
        data = {"angles_deg": ANGLES_DEG, "errors": errors, "best": WAYS[-1]}
        draw_kept(options.pictures, "range", "range errors", data)
        pictures = (Picture("range.svg", "Error of the range against the angle off the axis"),)
    rows = [[f"{angle}°", *(f"{mean:+.2f} %" for mean in means)] for angle, means in _means(errors)]
    text = (
        f"A balloon at rest in {len(seeds)} rendered rooms, `clean`, 800 × 600, f = 450 px, {RADIUS_PX:.0f} px of "
        "radius if it were on the axis; mean error of the range over the frames that were answered. *Eq. 5*: f R / r, "
        "with the smallest circle around the largest patch of the color mask, and with the tracked circle, the best "
        "one to the edge points.\n\n" + table(["off axis", *WAYS], rows)
    )
    return Section("Range by the print and by the cone", [_finding(errors)], text, pictures)


def measure(task: Task) -> list[list[float]]:
    """Errors of the range as shares, a row for each frame; NaN where a way has no answer."""
    rng = np.random.default_rng((task.seed, task.off_axis_deg, 0xC0))
    camera, place = CAMERAS["pinhole"], None
    while place is None:
        place = place_ball(camera, RADIUS_PX, math.radians(task.off_axis_deg), rng, room_px=6.0)
    still, far = place, float(np.linalg.norm(place))
    flight = BallFlightClip(camera=camera, place=lambda _: still, frames=FRAMES + 1, seed=task.seed)
    blue, purple = learn(flight)
    color = blue | purple
    x, y = camera.project(still[np.newaxis])[0]
    tracker, localizer = ms.Tracker(ms.Circle, color, start=(x, y)), ms.Localizer(camera, ms.BallTarget(2.0 * RADIUS))
    rows = []
    for frame in flight:
        track = tracker.update(frame)
        pose = localizer.update(track)
        tracked = math.nan if isinstance(track, ms.Lost) else camera.fx * RADIUS / track.shape.radius
        cone = math.nan if isinstance(pose, ms.Lost) else pose.distance
        enclosing = camera.fx * RADIUS / _enclosing_radius(color.mask(frame.image))
        rows.append([value / far - 1.0 for value in (enclosing, tracked, cone)])
    return rows[1:]


def _enclosing_radius(mask: npt.NDArray[np.uint8]) -> float:
    """Radius of the smallest circle around the largest patch, px, as hobby trackers do it."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask)
    if count < 2:
        return math.nan
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    outlines, _ = cv2.findContours((labels == largest).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    # The contour runs through the middles of the outermost pixels: half a pixel inside the patch.
    return float(cv2.minEnclosingCircle(outlines[0])[1]) + 0.5


def _means(errors: dict[str, Floats]) -> Sequence[tuple[int, list[float]]]:
    means = [np.nanmean(values, axis=1) for values in errors.values()]
    return [(angle, [float(each[k]) for each in means]) for k, angle in enumerate(ANGLES_DEG)]


def _finding(errors: dict[str, Floats]) -> Finding:
    worst = [max(np.abs(np.nanmean(values, axis=1)).tolist()) for values in errors.values()]
    return Finding(
        name="range_methods",
        what="range, `clean`, r 50: bias at the worst of 0-35° off the axis, by Eq. 5 and by the cone",
        figures=(
            *(Figure(name, value, "%", 2) for name, value in zip(SHORT, worst, strict=True)),
            Figure("not answered", int(np.isnan(errors[WAYS[-1]]).sum()), "", 0),
        ),
    )
