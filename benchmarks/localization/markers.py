"""Which way it looks: direction of one marker, rotation from three, against OpenCV's blob detector."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

import matchset as ms
from benchmarks.localization.poses import PINHOLE, facing, learn, observe, place_ball
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.workers import spread
from matchset.localization.localizer import direction_on_ball
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Floats = npt.NDArray[np.float64]

OFF_SIGHT_DEG = (0, 15, 30, 45, 60)
SCENES, FRAMES = 20, 5
THREE = tuple(
    (
        math.sin(math.radians(turn)) * math.cos(math.radians(rise)),
        -math.sin(math.radians(rise)),
        math.cos(math.radians(turn)) * math.cos(math.radians(rise)),
    )
    for turn, rise in ((0.0, 0.0), (50.0, 20.0), (-50.0, -15.0))
)


class Task(msgspec.Struct, frozen=True):
    """One ball at rest: how far its marker looks away from the camera (None: three markers), link, seed."""

    off_sight_deg: int | None
    preset: str
    seed: int


class Result(msgspec.Struct, frozen=True):
    """Errors of the frames of a task, degrees; NaN where there was no answer."""

    ours: list[float]
    blob: list[float]


def run(options: Options) -> Section:
    """Measure the direction of one marker and the rotation from three."""
    scenes = 4 if options.quick else SCENES
    seeds = [options.seeds[0] + k for k in range(scenes)]
    findings, rows = [], []
    for preset in ("typical", "clean"):
        tasks = [Task(angle, preset, seed) for angle in OFF_SIGHT_DEG for seed in seeds]
        found = spread(measure, tasks, options.jobs)
        findings.append(_finding(f"marker_{preset}", f"direction of a marker within 60°, r 40, `{preset}`", found))
        for k, angle in enumerate(OFF_SIGHT_DEG):
            part = found[k * scenes : (k + 1) * scenes]
            rows.append([f"{preset}, {angle}°", *_cells([r.ours for r in part]), *_cells([r.blob for r in part])])
        three = spread(measure, [Task(None, preset, seed) for seed in seeds], options.jobs)
        findings.append(_finding(f"rotation_{preset}", f"rotation from three markers, r 60, `{preset}`", three))
        rows.append([f"{preset}, three markers", *_cells([r.ours for r in three]), "-", "-"])
    text = (
        f"A balloon at rest at up to 20° off the axis, marker radius 0.21 of the ball's, {scenes} rooms of "
        f"{FRAMES} frames for each row; angles from the line of sight. The marker looks to any side. Colors are "
        "learned from two clicks in a picture of the same room in which the marker looks at the camera. *Blob*: "
        "OpenCV's `SimpleBlobDetector` on the same color's mask inside the ball's circle, the largest blob, from "
        "there on our geometry.\n\n" + table(["", "rms", "missed", "blob: rms", "missed"], rows)
    )
    goals = [finding if finding.name.endswith("typical") else _bare(finding) for finding in findings]
    return Section("Markers", goals, text)


def measure(task: Task) -> Result:
    """Follow one ball and compare its answers with the truth."""
    rng = np.random.default_rng((task.seed, 61 if task.off_sight_deg is None else task.off_sight_deg, 0x3A2))
    radius, place = 60.0 if task.off_sight_deg is None else 40.0, None
    while place is None:
        place = place_ball(PINHOLE, radius, math.radians(rng.uniform(0.0, 20.0)), rng)
    still, turn = place, _turn(task, place, rng)
    markers = THREE if task.off_sight_deg is None else THREE[:1]
    flight = BallFlightClip(
        camera=PINHOLE,
        place=lambda _: still,
        turn=lambda _: turn,
        markers=markers,
        frames=FRAMES + 1,
        seed=task.seed,
        preset=task.preset,
    )
    ours = [
        math.degrees(sight.turn_error if task.off_sight_deg is None else sight.direction_error())
        for sight in observe(flight)
    ]
    return Result(ours, [] if task.off_sight_deg is None else [math.degrees(e) for e in _blobs(flight)])


def _turn(task: Task, place: Floats, rng: np.random.Generator) -> Rotation:
    """Rotation of the ball: a marker that looks away to any side, or three that can be seen."""
    if task.off_sight_deg is None:
        lean = Rotation.from_euler("yxz", rng.uniform((-10.0, -10.0, -10.0), (10.0, 10.0, 10.0)), degrees=True)
        return facing(place) * lean
    sight = -place / np.linalg.norm(place)
    across = np.cross(sight, rng.normal(size=3))
    across /= np.linalg.norm(across)
    away = Rotation.from_rotvec(math.radians(task.off_sight_deg) * across).apply(sight)
    return facing(-away)


def _blobs(flight: BallFlightClip) -> list[float]:
    """Errors of OpenCV's blob detector as the marker's finder, rad."""
    target = ms.BallTarget(0.28, markers=((0, 0, 1),))
    ball_color, marker_color = learn(flight)
    center = flight.camera.project(flight.place(0.0)[np.newaxis])[0]
    tracker = ms.Tracker(ms.Circle, ball_color | marker_color, start=(float(center[0]), float(center[1])))
    localizer = ms.Localizer(flight.camera, target)
    assert flight.turn is not None
    errors = []
    for frame in flight:
        track = tracker.update(frame)
        pose = localizer.update(track)
        seen = _largest_blob(frame, track.shape, marker_color) if isinstance(track, ms.Track) else None
        error = math.nan
        if seen is not None and isinstance(pose, ms.Pose):
            direction = direction_on_ball(flight.camera, seen, pose.position, target.marker_distance)
            if direction is not None:
                true = flight.turn(frame.time).apply((0.0, 0.0, 1.0))
                error = math.atan2(float(np.linalg.norm(np.cross(true, direction))), float(true @ direction))
        if frame.index > 0:
            errors.append(error)
    return errors


def _largest_blob(frame: ms.Frame, ball: ms.Circle, color: ms.ColorModel) -> tuple[float, float] | None:
    """Middle of the largest blob of a color inside a circle, px, or None."""
    inside = np.zeros(frame.image.shape[:2], np.uint8)
    cv2.circle(inside, (round(ball.x), round(ball.y)), round(0.97 * ball.radius), 255, -1)
    mask = 255 - (color.mask(frame.image) & inside)
    settings = cv2.SimpleBlobDetector.Params()
    settings.filterByInertia = settings.filterByConvexity = settings.filterByCircularity = False
    settings.minArea, settings.maxArea = 0.1 * (0.21 * ball.radius) ** 2, 10.0 * (0.21 * ball.radius) ** 2 + 30.0
    settings.minThreshold, settings.maxThreshold, settings.minRepeatability = 100.0, 150.0, 1
    points = cv2.SimpleBlobDetector.create(settings).detect(mask)
    if not points:
        return None
    largest = max(points, key=lambda point: point.size)
    return float(largest.pt[0]), float(largest.pt[1])


def _rms(errors: list[list[float]]) -> tuple[float | None, float]:
    """Root of the mean square over answered frames, and the percentage not answered."""
    every = np.ravel(errors)
    answered = every[~np.isnan(every)]
    missed = 100.0 * (1.0 - len(answered) / max(len(every), 1))
    return (float(np.sqrt(np.mean(answered**2))) if len(answered) else None), missed


def _cells(errors: list[list[float]]) -> list[str]:
    rms, missed = _rms(errors)
    return ["-" if rms is None else f"{rms:.2f}°", f"{missed:.0f} %"]


def _finding(name: str, what: str, results: list[Result]) -> Finding:
    rms, missed = _rms([result.ours for result in results])
    figures = [Figure("rms", rms, "°", 2), Figure("missed", missed, "%", 1)]
    if results[0].blob:
        blob, blob_missed = _rms([result.blob for result in results])
        figures += [
            Figure("blob rms", blob, "°", 2, aside=True),
            Figure("blob missed", blob_missed, "%", 1, aside=True),
        ]
    return Finding(
        name=name,
        what=what,
        figures=tuple(figures),
        bar=(Goal("rms", high=3.0), Goal("missed", high=5.0)),
        prize=(Goal("rms", high=1.0), Goal("missed", high=1.0)),
    )


def _bare(finding: Finding) -> Finding:
    return msgspec.structs.replace(finding, bar=(), prize=())
