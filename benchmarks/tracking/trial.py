"""The named sequences of the contest, and what a tracker makes of one: `Trial`."""

import functools
import math
from typing import Any

import msgspec
import numpy as np

import matchset as ms
from benchmarks.options import Options
from benchmarks.workers import spread
from matchset.app.track.score import Circle3, TruthRow, error_px
from matchset.sim.clips.clip import Clip
from matchset.sim.clips.truth import ClipTruth
from matchset.sim.digital_camera.codec import Codec
from matchset.sim.digital_camera.control_steps import ControlSteps
from matchset.sim.digital_camera.digital_camera import DigitalCamera
from matchset.sim.rendering.renderer import Light

PRESETS = ("clean", "typical", "bad")
SEQUENCES = (*PRESETS, "hard")
"""Those with goals of their own."""

TRIALS = ("occlusion", "clutter", "light", "blur", "shrink", "fast", "return", "hidden", "empty")
"""`typical` with one difficulty each."""

RECORDED = ("compressed", "phone")
"""No analog link: what a codec, and a phone with all that it does, make of the picture."""

FRAMES = 300
QUICK_FRAMES = 100
FPS = 30
GONE = {"return": ((50, 80),), "hidden": ((30, 60), (90, 120))}
"""Windows of frames in which the ball is out of the picture, or behind a board."""

WHAT = {
    "clean": "sharp, little noise: the easy one",
    "typical": "analog PAL link, interlaced, usual noise",
    "bad": "analog PAL link at the end of its range",
    "hard": "`typical`, a fifth occluded, blue clutter, light × 2, motion blur, JPEG 40",
    "occlusion": "`typical`, a stick over 30 % of the disc",
    "clutter": "`typical`, posters, bars and rims of the same color",
    "light": "`typical`, brightness swings by a factor of 3 in 4 s, white balance by ± 10 %",
    "blur": "`typical`, shutter open for the whole of the field's time: motion blur",
    "shrink": "`typical`, r falls from 120 to 4 px",
    "fast": "`typical`, motion twice as fast: up to 20 px a frame in x and in y",
    "return": "`typical`, leaves the picture and returns, up to 40 px a frame",
    "hidden": "`typical`, a board hides all of it twice, for a second each",
    "empty": "`typical` with clutter of the same color and no ball at all",
    "compressed": "`clean`, then H.264 at 300 kbit/s: blocks, 4:2:0 chroma, smeared motion",
    "phone": "a phone's video: a hand over a quarter of the rim, a shadow on the ball, light × 1.6 and back with "
    "exposure settling, rolling shutter, motion blur, noise, denoising, sharpening, H.264 at 700 kbit/s",
}
CHANGES: dict[str, dict[str, Any]] = {
    "occlusion": {"occluder": 0.3},
    "clutter": {"clutter": True},
    "light": {"gain_swing": 3.0, "white_balance_drift": 0.1},
    "blur": {"exposure": 1.0},
    "shrink": {"shrink_to": 4.0},
    "fast": {"speed": 2.0},
    "return": {"away": GONE["return"]},
    "hidden": {"hidden": GONE["hidden"]},
    "empty": {"clutter": True, "ball": False},
    "compressed": {"preset": "clean", "codec": Codec(name="h264", kbps=300.0)},
    "phone": {
        "preset": None,
        "exposure": 0.4,
        "hand": 0.25,
        "light": Light(highlight=300.0, shadow=0.5),
        "digital": DigitalCamera(
            readout=0.5,
            steps=ControlSteps(brightness=1.6, tint=0.05, every=0.8, settling=0.3),
            noise=5.0,
            denoising=0.5,
            trail=0.4,
            sharpening=1.0,
        ),
        "codec": Codec(name="h264", kbps=700.0),
    },
}


def sequence(name: str, seed: int, frames: int = FRAMES, **changes: Any) -> Clip:
    """Build a sequence.

    Parameters
    ----------
    name : str
        One of `WHAT`, which says what it is.
    seed : int
        Decides path, room and noise.
    frames : int
        Length.
    **changes
        Parameters of `Clip` that differ.

    Returns
    -------
    Clip
    """
    if name == "hard":
        return Clip.hard(seed=seed, frames=frames, **changes)
    if name not in WHAT:
        raise ValueError(f"a sequence is one of {', '.join(WHAT)}, got {name!r}")
    preset = name if name in PRESETS else "typical"
    settings: dict[str, Any] = {"preset": preset, "seed": seed, "frames": frames}
    return Clip(**(settings | CHANGES.get(name, {}) | changes))


LOWCONF_BELOW = 0.5
"""Where less of the disc than this can be seen, the frame is left out of tight scores."""


class Trial(msgspec.Struct, frozen=True):
    """How a tracker did on one sequence.

    Parameters
    ----------
    seed : int
        Of the sequence.
    truths : list of TruthRow
        Where the ball is, frame by frame.
    answers : list of (x, y, radius) or None
        Where the tracker saw it, px.
    squares : list of float or None
        Normalized error squared, ``e' P^-1 e``, of the answered tight frames.
    """

    seed: int
    truths: list[TruthRow]
    answers: list[Circle3 | None]
    squares: list[float | None]

    @property
    def errors(self) -> list[float]:
        """Error of each frame, Eq. 10, px; NaN where it was not answered or is not tight."""
        return [
            error_px(answer, truth.circle) if answer and truth.tight and truth.circle else math.nan
            for answer, truth in zip(self.answers, self.truths, strict=True)
        ]


class Task(msgspec.Struct, frozen=True):
    """Which sequence to follow: its name, seed and length."""

    name: str
    seed: int
    frames: int


def trials(name: str, options: Options) -> list[Trial]:
    """Follow a sequence once for each seed; asked again, the same results are returned.

    Parameters
    ----------
    name : str
        Of the sequence, see `sequence`.
    options : Options

    Returns
    -------
    list of Trial
    """
    frames = QUICK_FRAMES if options.quick else FRAMES
    seeds = options.seeds[:2] if options.quick else options.seeds
    return _trials(name, seeds, frames, options.jobs)


@functools.cache
def _trials(name: str, seeds: tuple[int, ...], frames: int, jobs: int) -> list[Trial]:
    return spread(run_task, [Task(name, seed, frames) for seed in seeds], jobs)


def run_task(task: Task) -> Trial:
    """Follow the sequence of a task."""
    return follow(sequence(task.name, task.seed, task.frames))


def follow(clip: Clip) -> Trial:
    """Click once on the ball in the first frame and follow it, with no help from the truth after that.

    Parameters
    ----------
    clip : Clip
        The sequence.

    Returns
    -------
    Trial
    """
    tracker: ms.Tracker[ms.Circle] | None = None
    result = Trial(clip.seed, [], [], [])
    for frame, seen in clip:
        tracker = tracker or clicked(frame, clip.first_click)
        answer = tracker.update(frame)
        truth = as_truth(seen)
        found = isinstance(answer, ms.Track)
        result.truths.append(truth)
        result.answers.append(circle(answer.shape) if isinstance(answer, ms.Track) else None)
        tight = found and truth.tight
        result.squares.append(normalized_square(answer, truth) if tight else None)
    return result


def clicked(frame: ms.Frame, click: tuple[float, float]) -> ms.Tracker[ms.Circle]:
    """Make a tracker with default settings from one click.

    Parameters
    ----------
    frame : Frame
        The frame that was clicked at.
    click : tuple of 2 floats
        x, y, px.

    Returns
    -------
    Tracker
    """
    return ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, *click), start=click)


def as_truth(seen: ClipTruth) -> TruthRow:
    """Turn what a rendered frame shows into the truth that scores take."""
    known = None if seen.circle is None else circle(seen.circle)
    return TruthRow(seen.index, known, lowconf=seen.share < LOWCONF_BELOW)


def circle(shape: ms.Circle) -> Circle3:
    """Return x, y and radius, px."""
    return shape.x, shape.y, shape.radius


def normalized_square(answer: ms.Track[ms.Circle] | ms.Lost[ms.Circle], truth: TruthRow) -> float | None:
    """Error squared in units of the covariance that the tracker claims, ``e' P^-1 e``.

    Parameters
    ----------
    answer : Track or Lost
    truth : TruthRow

    Returns
    -------
    float or None
        Infinite where the covariance is not positive definite; None without an answer or a truth.
    """
    if not isinstance(answer, ms.Track) or truth.circle is None:
        return None
    error = np.subtract(circle(answer.shape), truth.circle)
    try:
        half = np.linalg.solve(np.linalg.cholesky(answer.covariance), error)
    except np.linalg.LinAlgError:
        return math.inf
    return float(half @ half)
