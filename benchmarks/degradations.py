"""What each degradation of real video costs, one by one: `python -m benchmarks.degradations`.

Every knob of a rendered clip at a moderate and at a strong level, over a clean link; matchset is told one click and has
its defaults. `--sheet FILE` draws a picture of each instead.
"""

import sys
from collections import Counter
from pathlib import Path
from typing import Annotated, Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import typer

import matchset as ms
from benchmarks.results import quantity, table
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.trial import Trial, as_truth, circle, clicked
from benchmarks.workers import one_thread, spread
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.clip import Clip
from matchset.sim.digital_camera.codec import Codec
from matchset.sim.digital_camera.control_steps import ControlSteps
from matchset.sim.digital_camera.digital_camera import DigitalCamera
from matchset.sim.rendering.renderer import Light

Changes = dict[str, Any]
SEEDS, FRAMES = 6, 60


def _camera(**changes: Any) -> Changes:
    return {"digital": DigitalCamera(**changes)}


def _steps(**changes: float) -> Changes:
    return _camera(steps=ControlSteps(**changes))


def _ball(**changes: Any) -> Changes:
    return {"balloon": Balloon(**changes)}


def _plain(color: tuple[float, float, float]) -> Changes:
    return _ball(color=color, marker_radius=0.0)


def _small(low: float, high: float, **changes: Any) -> Changes:
    return {"radii": (low, high), **changes}


WHITE, GRAY, BLACK, GREEN = (225.0, 228.0, 230.0), (120.0, 122.0, 124.0), (28.0, 28.0, 30.0), (60.0, 190.0, 90.0)
BRIGHT = {**_ball(color=WHITE, marker_radius=0.0)}
KNOBS: dict[str, Changes] = {
    "nothing": {},
    "H.264, 800 kbit/s": {"codec": Codec(name="h264", kbps=800.0)},
    "H.264, 250 kbit/s": {"codec": Codec(name="h264", kbps=250.0)},
    "motion JPEG, 6000 kbit/s": {"codec": Codec(kbps=6000.0)},
    "motion JPEG, 3000 kbit/s": {"codec": Codec(kbps=3000.0)},
    "exposure steps × 1.6": _steps(brightness=1.6, every=0.8),
    "exposure steps × 2.5": _steps(brightness=2.5, every=0.8),
    "light × 2, settling in 0.3 s": _steps(brightness=2.0, every=0.8, settling=0.3),
    "light × 4, settling in 0.3 s": _steps(brightness=4.0, every=0.8, settling=0.3),
    "white balance ± 15 %": _steps(tint=0.15, every=0.8),
    "white balance ± 35 %": _steps(tint=0.35, every=0.8),
    "rolling shutter, 0.5 frame": _camera(readout=0.5),
    "rolling shutter, 1 frame, fast": {**_camera(readout=1.0), "speed": 3.0},
    "noise 10": _camera(noise=10.0),
    "noise 25": _camera(noise=25.0),
    "sharpening 1": _camera(noise=4.0, sharpening=1.0),
    "sharpening 3": _camera(noise=4.0, sharpening=3.0),
    "noise 10, denoised 0.7, trail 0.5": _camera(noise=10.0, denoising=0.7, trail=0.5),
    "noise 20, denoised 1, trail 0.85": _camera(noise=20.0, denoising=1.0, trail=0.85),
    "highlight 400, shadow 0.5": {"light": Light(highlight=400.0, shadow=0.5)},
    "highlight 1500, shadow 0.9": {"light": Light(highlight=1500.0, shadow=0.9)},
    "saturation 0.4": _camera(saturation=0.4),
    "saturation 0.15": _camera(saturation=0.15),
    "white ball": _plain(WHITE),
    "gray ball": _plain(GRAY),
    "black ball": _plain(BLACK),
    "green ball on grass": {**_plain(GREEN), "backdrop": "grass"},
    "soccer ball": _ball(color=WHITE, pattern="soccer"),
    "soccer ball on grass": {**_ball(color=WHITE, pattern="soccer"), "backdrop": "grass"},
    "basketball": _ball(color=(50.0, 110.0, 215.0), pattern="basketball"),
    "ball with a logo": _ball(pattern="logo", pattern_color=WHITE),
    "motion blur 1 diameter": {"radii": (12.0, 20.0), "speed": 4.0, "exposure": 1.0, "blur_samples": 64},
    "motion blur 2 diameters": {"radii": (8.0, 14.0), "speed": 6.0, "exposure": 1.0, "blur_samples": 64},
    "radius 5 to 8 px": {"radii": (5.0, 8.0)},
    "radius 3 to 5 px": {"radii": (3.0, 5.0)},
    "defocus 2.5 px": _camera(defocus=2.5),
    "defocus 5 px": _camera(defocus=5.0),
    "hand over 0.2 of the rim": {"hand": 0.2},
    "hand over 0.4 of the rim": {"hand": 0.4},
}


class Task(msgspec.Struct, frozen=True):
    """One clip to be followed: the name of its knob, and its seed."""

    knob: str
    seed: int


class Outcome(msgspec.Struct, frozen=True):
    """A trial, and the reasons of its losses with how often each was given; a refused click loses every frame."""

    trial: Trial
    reasons: Counter[str]


def clip_of(knob: str, seed: int, frames: int = FRAMES) -> Clip:
    """Build the clip of a knob."""
    return Clip(preset="clean", seed=seed, frames=frames, **KNOBS[knob])


def follow(task: Task) -> Outcome:
    """Follow a clip after one click, and note why the ball was lost."""
    clip = clip_of(task.knob, task.seed)
    trial, reasons = Trial(task.seed, [], [], []), Counter[str]()
    tracker: ms.Tracker[ms.Circle] | None = None
    refusal = ""
    for frame, seen in clip:
        trial.truths.append(as_truth(seen))
        if frame.index == 0:
            try:
                tracker = clicked(frame, clip.first_click)
            except ValueError as error:
                refusal = str(error).partition(": ")[2].partition(" (")[0]
        if tracker is None:
            trial.answers.append(None)
            reasons[f"click refused: {refusal}"] += 1
            continue
        answer = tracker.update(frame)
        trial.answers.append(circle(answer.shape) if isinstance(answer, ms.Track) else None)
        if isinstance(answer, ms.Lost):
            reasons[answer.reason] += 1
    return Outcome(trial, reasons)


def main(
    first: Annotated[int, typer.Option(help="First of six seeds; tuning uses 0 to 9.")] = 100,
    only: Annotated[str, typer.Option(help="Knobs whose names contain this.")] = "",
    jobs: Annotated[int, typer.Option(help="Processes.")] = 1,
    sheet: Annotated[Path | None, typer.Option(help="Draw a picture of each knob into this file instead.")] = None,
) -> None:
    """Follow the clips of all knobs and print a table."""
    one_thread()
    knobs = [knob for knob in KNOBS if only in knob]
    if sheet is not None:
        cv2.imwrite(str(sheet), contact_sheet(knobs, first))
        return
    head = ["knob", "valid, %", "worst seed", "mean, px", "95 %, px", "false locks", "frames lost, and why"]
    sys.stdout.write(table(head, []))
    for knob in knobs:
        outcomes = spread(follow, [Task(knob, seed) for seed in range(first, first + SEEDS)], jobs)
        sys.stdout.write(table(head, [row(knob, outcomes)]).splitlines()[-1] + "\n")
        sys.stdout.flush()


def row(knob: str, outcomes: list[Outcome]) -> list[str]:
    """Put the outcomes of a knob into words."""
    score = pooled([outcome.trial for outcome in outcomes])
    worst = min(pooled([outcome.trial]).valid_percent or 0.0 for outcome in outcomes)
    errors = (quantity(value, "", 2) for value in (score.mean_error_px, score.error_95_px))
    reasons = sum((outcome.reasons for outcome in outcomes), Counter[str]()).most_common(3)
    said = "; ".join(f"{count} × {reason}" for reason, count in reasons)
    return [knob, f"{score.valid_percent or 0.0:.1f}", f"{worst:.0f}", *errors, str(score.false_locks), said]


def contact_sheet(knobs: list[str], seed: int, columns: int = 6, side: int = 220) -> npt.NDArray[np.uint8]:
    """Draw a crop around the ball of each knob's clip, with its name: the last of some frames, so that codecs smear."""
    tiles = []
    for knob in knobs:
        frames = list(clip_of(knob, seed, 16))
        frame, truth = frames[-1]
        assert truth.circle is not None
        half = round(max(1.7 * truth.circle.radius, 24.0))
        x, y = (round(value) + half for value in (truth.circle.x, truth.circle.y))
        wide = cv2.copyMakeBorder(frame.image, half, half, half, half, cv2.BORDER_REPLICATE)
        crop = wide[y - half : y + half, x - half : x + half]
        way = cv2.INTER_NEAREST if half < side // 3 else cv2.INTER_AREA
        tile = cv2.resize(crop, (side, side), interpolation=way)
        tile = cv2.copyMakeBorder(tile, 0, 26, 4, 4, cv2.BORDER_CONSTANT, value=(255, 255, 255))
        cv2.putText(
            tile, knob.replace("×", "x").replace("±", "+-"), (4, side + 18), 0, 0.42, (20, 20, 20), 1, cv2.LINE_AA
        )
        tiles.append(tile)
    blank = np.full_like(tiles[0], 255)
    tiles += [blank] * (-len(tiles) % columns)
    return np.vstack([np.hstack(tiles[k : k + columns]) for k in range(0, len(tiles), columns)])


if __name__ == "__main__":
    typer.run(main)
