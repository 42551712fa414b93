"""All that one decoding of a clip gives: runs from every start, and searches of the labelled frames."""

from collections.abc import Sequence

import msgspec

from benchmarks.options import Options
from benchmarks.real.clips import Clip
from benchmarks.real.detection import Detected, Seeker
from benchmarks.real.following import Recorder, Run, follow
from benchmarks.real.foreign import Ball
from benchmarks.real.starts import starts_of
from benchmarks.workers import spread


class Task(msgspec.Struct, frozen=True):
    """A clip to be measured, and whether a few starts will do."""

    clip: Clip
    quick: bool = False


class Measured(msgspec.Struct, frozen=True):
    """What was found in a clip.

    Parameters
    ----------
    runs : list of Run
        The standard one first.
    detected : Detected
    ball : Ball or None
        Its color; None where it was refused.
    """

    runs: list[Run]
    detected: Detected
    ball: Ball | None


def measure_all(clips: Sequence[Clip], options: Options) -> dict[str, Measured]:
    """Measure every clip, the longest first, so that no process idles in the end."""
    tasks = [Task(clip, options.quick) for clip in sorted(clips, key=_size, reverse=True)]
    found = spread(measure, tasks, options.jobs)
    return {task.clip.name: each for task, each in zip(tasks, found, strict=True)}


def measure(task: Task) -> Measured:
    """Follow the ball of a clip from all its starts, and search its labelled frames."""
    recorder, seeker = Recorder(task.clip, starts_of(task.clip, task.quick)), Seeker(task.clip)
    for frame, answers in follow(task.clip, recorder.followers):
        recorder.take(frame.index, answers)
        seeker.take(frame)
    return Measured(recorder.runs(), seeker.detected(), seeker.ball)


def _size(clip: Clip) -> int:
    return clip.video.stat().st_size
