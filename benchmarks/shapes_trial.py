"""One tracker, one sequence of a flat shape, one click, and beside it what people use: `follow_shape`."""

import math
from typing import Any

import msgspec

import matchset as ms
from benchmarks.shapes_cases import CASES, Errors
from benchmarks.shapes_contours import contour_method
from benchmarks.workers import spread


class ShapeTask(msgspec.Struct, frozen=True):
    """Which sequence to follow.

    Parameters
    ----------
    case : str
        Name of one of `CASES`.
    preset : str
        The link.
    seed, frames : int
        Of the sequence.
    hidden : float
        Share of the outline behind four fingers.
    peer : bool
        Whether the contour of a mask is measured too.
    """

    case: str
    preset: str
    seed: int
    frames: int
    hidden: float = 0.0
    peer: bool = False


class ShapeTrial(msgspec.Struct, frozen=True):
    """How far each answer was from the truth, frame by frame; None where there was none.

    Parameters
    ----------
    ours, theirs : list of dict or None
        Of the tracker, and of the contour of a mask.
    """

    ours: list[Errors | None]
    theirs: list[Errors | None]


def follow_shape(task: ShapeTask) -> ShapeTrial:
    """Click once on the shape in the first frame and follow it, with no help from the truth after that."""
    case = CASES[task.case]
    clip = case.clip(task.preset, task.seed, task.frames, task.hidden)
    tracker: ms.Tracker[Any] | None = None
    result = ShapeTrial([], [])
    for frame, truth in clip:
        click = clip.first_click
        if tracker is None:
            tracker = ms.Tracker(case.family, ms.ColorModel.pick(frame.image, *click), start=click)
            find = contour_method(task.case, frame.image, truth) if task.peer else None
        answer = tracker.update(frame)
        result.ours.append(case.errors(clip, frame.index, answer.shape) if isinstance(answer, ms.Track) else None)
        if find is not None:
            found = find(frame.image)
            result.theirs.append(None if found is None else case.errors(clip, frame.index, found))
    return result


def follow_all(tasks: list[ShapeTask], jobs: int) -> list[ShapeTrial]:
    """Follow many sequences."""
    return spread(follow_shape, tasks, jobs)


def scalar(errors: Errors | None) -> float:
    """One number to compare two answers by: px, or the share of the area that they do not have in common, in %."""
    if errors is None:
        return math.inf
    if "overlap" in errors:
        return 100.0 * (1.0 - errors["overlap"])
    return errors["corners"] if "corners" in errors else errors["center"] + errors["axes"]
