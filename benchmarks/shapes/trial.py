"""One tracker, one sequence of a flat shape, one click, and beside it what people use: `follow_shape`."""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any

import msgspec
import numpy as np

import matchset as ms
from benchmarks.shapes.cases import CASES, Errors
from benchmarks.shapes.contours import contour_method
from benchmarks.shapes.ellipses import GRAY, ellipse_method
from benchmarks.workers import spread

CONTOUR, EDGE_DRAWING, EDGE_GRAY = "contour", "EdgeDrawing on the mask", "EdgeDrawing on the gray frame"
METHODS: dict[str, Callable[..., Callable[..., Any]]] = {
    CONTOUR: contour_method,
    EDGE_DRAWING: ellipse_method,
    EDGE_GRAY: functools.partial(ellipse_method, parameters=GRAY),
}


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
    peers : tuple of str
        Which of `METHODS` are measured too.
    """

    case: str
    preset: str
    seed: int
    frames: int
    hidden: float = 0.0
    peers: tuple[str, ...] = ()


class ShapeTrial(msgspec.Struct, frozen=True):
    """How far each answer was from the truth, frame by frame; None where there was none.

    Parameters
    ----------
    ours : list of dict or None
        Of the tracker.
    theirs : dict of str to list of dict or None
        Of each peer.
    """

    ours: list[Errors | None]
    theirs: dict[str, list[Errors | None]]


def follow_shape(task: ShapeTask) -> ShapeTrial:
    """Click once on the shape in the first frame and follow it, with no help from the truth after that."""
    case = CASES[task.case]
    clip = case.clip(task.preset, task.seed, task.frames, task.hidden)
    tracker: ms.Tracker[Any] | None = None
    result = ShapeTrial([], {name: [] for name in task.peers})
    for frame, truth in clip:
        click = clip.first_click
        if tracker is None:
            tracker = ms.Tracker(case.family, ms.ColorModel.pick(frame.image, *click, ball=False), start=click)
            finders = {name: METHODS[name](task.case, frame.image, truth) for name in task.peers}
        answer = tracker.update(frame)
        result.ours.append(case.errors(clip, frame.index, answer.shape) if isinstance(answer, ms.Track) else None)
        for name, find in finders.items():
            found = find(frame.image)
            result.theirs[name].append(None if found is None else case.errors(clip, frame.index, found))
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


def mean_error(answers: Sequence[Errors | None]) -> float | None:
    """Mean of `scalar` over the frames with an answer; None where there is none."""
    found = [scalar(each) for each in answers if each is not None]
    return float(np.mean(found)) if found else None


def lost_percent(answers: Sequence[Errors | None]) -> float:
    """Share of the frames without an answer, %."""
    return 100.0 * sum(each is None for each in answers) / len(answers)
