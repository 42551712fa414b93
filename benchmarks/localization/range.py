"""How far away: bias and spread of the range, by the angle off the axis, with and without a distorting lens."""

import math
from typing import Any

import msgspec
import numpy as np

import matchset as ms
from benchmarks.localization.poses import observe, place_ball
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.workers import spread
from matchset.sim.clips.ball_flight_clip import BallFlightClip

ANGLES_DEG = (0, 10, 20, 30, 35)
SCENES, FRAMES = 10, 5  # 50 frames per angle
SPREAD_FRAMES = 10
WIDE: dict[str, Any] = {"width": 800, "height": 600, "fx": 450.0, "fy": 450.0, "cx": 399.5, "cy": 299.5}
CAMERAS = {
    "pinhole": ms.CameraModel(**WIDE),
    "barrel": ms.CameraModel(**WIDE, distortion=(-0.3, 0.0, 0.0, 0.0, 0.0)),
}


class Task(msgspec.Struct, frozen=True):
    """One ball at rest: camera, link, radii to choose from, px, angle off the axis, seed, frames."""

    camera: str
    preset: str
    radii: tuple[float, float]
    off_axis_deg: int
    seed: int
    frames: int


def run(options: Options) -> Section:
    """Measure bias and spread for both lenses."""
    scenes = 3 if options.quick else SCENES
    findings, tables = [], []
    for name in CAMERAS:
        biases = _by_angle(name, "clean", (40.0, 60.0), scenes, FRAMES, options)
        spreads = _by_angle(name, "typical", (20.0, 20.0), scenes, SPREAD_FRAMES, options)
        findings += [_bias(name, biases), _spread(name, spreads)]
        tables.append(f"\n**{name}**\n\n" + _table(biases, spreads))
    text = (
        "A balloon at rest in rendered rooms, 800 × 600, f = 450 px, *barrel*: k1 = -0.3, known. Error of the range "
        f"as a share of it, {scenes} rooms for each angle; the color is learned from two clicks, the first frame is "
        "left out. Clean: radius 40-60 px; typical: 20 px. Worst: over the angles; missed: not answered.\n"
        + "".join(tables)
    )
    return Section("Range", findings, text)


def measure(task: Task) -> list[float]:
    """Range errors of one ball, as shares; NaN where it was not answered."""
    rng = np.random.default_rng((task.seed, task.off_axis_deg, 0xD15))
    camera = CAMERAS[task.camera]
    place = None
    while place is None:
        place = place_ball(camera, rng.uniform(*task.radii), math.radians(task.off_axis_deg), rng, room_px=6.0)
    still = place
    flight = BallFlightClip(
        camera=camera, place=lambda _: still, frames=task.frames + 1, seed=task.seed, preset=task.preset
    )
    return [sight.range_error for sight in observe(flight)]


Errors = dict[int, list[list[float]]]


def _by_angle(
    camera: str, preset: str, radii: tuple[float, float], scenes: int, frames: int, options: Options
) -> Errors:
    seeds = [options.seeds[0] + 10 * k for k in range(scenes)]
    tasks = [Task(camera, preset, radii, angle, seed, frames) for angle in ANGLES_DEG for seed in seeds]
    errors = spread(measure, tasks, options.jobs)
    return {angle: errors[k * scenes : (k + 1) * scenes] for k, angle in enumerate(ANGLES_DEG)}


def _bias(name: str, errors: Errors) -> Finding:
    means = [abs(100.0 * float(np.nanmean(each))) for each in errors.values()]
    return _finding(
        f"range_bias_{name}", f"range, `clean`, r 40-60, {name}: bias", ("bias", max(means)), errors, 0.5, 0.1
    )


def _spread(name: str, errors: Errors) -> Finding:
    stds = [100.0 * float(np.nanstd(each)) for each in errors.values()]
    return _finding(
        f"range_std_{name}", f"range, `typical`, r 20, {name}: spread", ("std", max(stds)), errors, 1.0, 0.5
    )


def _finding(name: str, what: str, worst: tuple[str, float], errors: Errors, bar: float, prize: float) -> Finding:
    every = np.ravel(list(errors.values()))
    missed = 100.0 * float(np.isnan(every).mean())
    return Finding(
        name=name,
        what=f"{what} at the worst of 0-35° off the axis",
        figures=(Figure(worst[0], worst[1], "%", 3), Figure("missed", missed, "%", 1)),
        bar=(Goal(worst[0], high=bar), Goal("missed", high=5.0)),
        prize=(Goal(worst[0], high=prize), Goal("missed", high=1.0)),
    )


def _table(biases: Errors, spreads: Errors) -> str:
    rows = []
    for angle in ANGLES_DEG:
        cells = [
            f"{100.0 * float(f(errors[angle])):.3f} %" for errors in (biases, spreads) for f in (np.nanmean, np.nanstd)
        ]
        missed = [f"{100.0 * float(np.isnan(errors[angle]).mean()):.0f} %" for errors in (biases, spreads)]
        rows.append([f"{angle}°", *cells, *missed])
    return table(["off axis", "clean: bias", "std", "typical: bias", "std", "clean: missed", "typical"], rows)
