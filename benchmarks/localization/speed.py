"""What it costs beyond tracking: the localizer, the marker tracker and the filter, each call timed by itself."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import matchset as ms
from benchmarks.localization.markers import THREE
from benchmarks.localization.poses import BARREL, PINHOLE, facing, learn
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from matchset.sim.clips.ball_flight_clip import BallFlightClip

FRAMES = 150
WARM_UP = 20


class Clock:
    """Calls, timed."""

    def __init__(self) -> None:
        self.ns: dict[str, list[int]] = {}

    def __call__(self, name: str, function: Callable[..., Any], *arguments: object) -> Any:
        """Call a function and note how long it took, under a name."""
        begin = time.perf_counter_ns()
        result = function(*arguments)
        self.ns.setdefault(name, []).append(time.perf_counter_ns() - begin)
        return result

    def median(self, name: str) -> float:
        """Median, us."""
        return float(np.median(self.ns[name][WARM_UP:])) / 1e3

    def least(self, name: str) -> float:
        """Minimum, us."""
        return float(np.min(self.ns[name][WARM_UP:])) / 1e3


def run(options: Options) -> Section:
    """Time everything that follows the tracker, in the order in which a program calls it."""
    frames = 80 if options.quick else FRAMES
    findings, rows = [], []
    cases = (
        ("one marker", PINHOLE, THREE[:1]),
        ("three markers", PINHOLE, THREE),
        ("one marker, barrel lens", BARREL, THREE[:1]),
    )
    for name, camera, markers in cases:
        clock = _timed(camera, markers, frames, options.seeds[0])
        findings.append(
            Finding(
                name="localization_speed_" + name.replace(" ", "_").replace(",", ""),
                what=f"`Localizer.update`, beyond tracking, {name}",
                figures=(
                    Figure("median", clock.median("Localizer.update"), "µs", 1),
                    Figure("minimum", clock.least("Localizer.update"), "µs", 1),
                ),
                bar=(Goal("median", high=100.0),),
                prize=(Goal("median", high=30.0),),
            )
        )
        rows += [[f"{name}: {call}", f"{clock.median(call):.1f}", f"{clock.least(call):.1f}"] for call in clock.ns]
    text = (
        f"A balloon, r 40 px, `typical`, {frames} frames; rendered beforehand; each comes from memory, not from the "
        "cache. `Tracker.update` and `MarkerTracker.update` find the circles, `Localizer.update` makes them a pose, "
        "the filter takes it in and looks ahead.\n\n" + table(["", "median, µs", "minimum"], rows)
    )
    return Section("Localization", findings, text)


def _timed(camera: ms.CameraModel, markers: tuple[tuple[float, float, float], ...], frames: int, seed: int) -> Clock:
    clock = Clock()
    flight = BallFlightClip(
        camera=camera,
        place=lambda t: np.array((0.2 * np.sin(t), 0.1 * np.cos(t), 1.55)),
        turn=lambda _: facing(np.array((0.0, 0.0, 1.0))),
        markers=markers,
        frames=frames,
        seed=seed,
        preset="typical",
    )
    for _ in _follow(flight, clock):
        pass
    return clock


def _follow(flight: BallFlightClip, clock: Clock) -> Iterator[None]:
    target = ms.BallTarget(0.28, flight.markers, 0.06)
    ball_color, marker_color = learn(flight)
    x, y = flight.camera.project(flight.place(0.0)[np.newaxis])[0].tolist()
    tracker = ms.Tracker(ms.Circle, ball_color | marker_color, start=(x, y))
    finder, localizer = ms.MarkerTracker(marker_color, target), ms.Localizer(flight.camera, target)
    filtered = ms.PoseFilter()
    for frame in list(flight):  # rendered before anything is timed
        ball = clock("Tracker.update", tracker.update, frame)
        found = clock("MarkerTracker.update", finder.update, frame, ball)
        pose = clock("Localizer.update", localizer.update, ball, found)
        clock("PoseFilter.update", filtered.update, pose)
        clock("PoseFilter.predict", filtered.predict, frame.time + 0.067)
        yield
