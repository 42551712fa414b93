"""What looking ahead is worth: the pose predicted for the time at which a command acts, against the last pose."""

import math

import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.localization.poses import PINHOLE, observe
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Floats = npt.NDArray[np.float64]

AGE = 0.067  # s from the middle of the exposure to the command
SPEED, ACCELERATION = 0.5, 0.5  # m/s, m/s^2
SECONDS, SETTLED = 60.0, 1.0
FPS, JITTER = 30.0, 0.003


def place(time: float) -> Floats:
    """Where the ball is: a circle at 0.5 m/s whose centripetal acceleration is 0.5 m/s^2, seen aslant, r 40-60 px."""
    radius = SPEED**2 / ACCELERATION
    phase = time * SPEED / radius
    tilt = 0.45  # rad
    across, deep = radius * math.cos(phase), radius * math.sin(phase)
    return np.array((across, 0.3 * deep * math.sin(tilt), 1.30 + 0.5 * deep * math.cos(tilt)))


def run(options: Options) -> Section:
    """Filter the poses of a flight and compare predictions with the truth 67 ms later."""
    seconds = 10.0 if options.quick else SECONDS
    findings = []
    for preset in ("typical", "clean"):
        predicted, last = errors(preset, options.seeds[0], seconds)
        ratio = _rms(predicted) / _rms(last)
        findings.append(
            Finding(
                name=f"prediction_{preset}",
                what=f"pose predicted over 67 ms, target at 0.5 m/s, `{preset}`: error against that of the last pose",
                figures=(
                    Figure("ratio", ratio, "", 3),
                    Figure("predicted", 1000.0 * _rms(predicted), "mm", 1),
                    Figure("last pose", 1000.0 * _rms(last), "mm", 1),
                    Figure("frames", len(predicted), "", 0, aside=True),
                ),
                bar=(Goal("ratio", high=0.5),),
                prize=(Goal("ratio", high=1 / 3),),
            )
        )
    text = (
        f"A balloon on a circle at {SPEED} m/s, {ACCELERATION} m/s² toward its middle, {seconds:.0f} s at {FPS:.0f} "
        f"frames a second, time stamps off by {1000 * JITTER:.0f} ms (standard deviation); `PoseFilter` with default "
        "settings. Root of the mean square of the distance to where the ball is 67 ms after the frame."
    )
    return Section("Prediction", findings, text)


def errors(preset: str, seed: int, seconds: float) -> tuple[list[float], list[float]]:
    """Distances to the truth 67 ms after each frame: of the prediction, and of the last pose, m."""
    flight = BallFlightClip(camera=PINHOLE, place=place, frames=round(seconds * FPS), fps=FPS, seed=seed, preset=preset)
    rng = np.random.default_rng((seed, 0x717))
    filtered, predicted, last = ms.PoseFilter(), [], []
    for sight in observe(flight):
        stamp = sight.time + float(np.clip(rng.normal(0.0, JITTER), -0.01, 0.01))
        if isinstance(sight.pose, ms.Lost):
            continue
        filtered.update(_stamped(sight.pose, stamp))
        ahead = filtered.predict(stamp + AGE)
        if sight.time > SETTLED and isinstance(ahead, ms.Pose):
            then = place(sight.time + AGE)
            predicted.append(float(np.linalg.norm(ahead.position - then)))
            last.append(float(np.linalg.norm(sight.pose.position - then)))
    return predicted, last


def _stamped(pose: ms.Pose, time: float) -> ms.Pose:
    return ms.Pose(
        position=pose.position,
        rotation_matrix=pose.rotation_matrix,
        covariance=pose.covariance,
        observed=pose.observed,
        time=time,
    )


def _rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values else math.nan
