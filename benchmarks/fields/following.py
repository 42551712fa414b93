"""A rendered ball in interlaced pictures, followed in whole frames and in half-frames: errors against time."""

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.tracking.trial import sequence
from matchset.image.frame import Frame
from matchset.media.fields.half_frames import HalfFrames
from matchset.sim.clips.clip import Clip

Mode = Literal["frames", "half-frames"]
Floats = npt.NDArray[np.float64]

STEP = 0.125  # format: frames, between two times at which the position is asked for
APART = 1.6  # format: frames, between two answers from which on there is none for the times between
LEAST_SHARE = 0.5  # format: of the disc that must be seen


class Followed(NamedTuple):
    """What came of following.

    Attributes
    ----------
    own : ndarray
        Distances from the truth at the time of each answer, px: of whole frames the mean of their fields.
    over_time : ndarray
        The same at all times, on straight lines between the answers.
    newest : ndarray
        The same of the newest answer when the next one comes, as somebody has it who waits for pictures.
    missed : int
        Pictures without an answer.
    """

    own: Floats
    over_time: Floats
    newest: Floats
    missed: int


def pictures_of(clip: Clip, mode: Mode) -> Iterator[Frame]:
    """Yield the frames of a clip, or its half-frames."""
    splitter = HalfFrames("top", clip.fps)
    for frame, _ in clip:
        if mode == "frames":
            yield frame
        else:
            yield from splitter.of(frame)


def follow(clip: Clip, mode: Mode) -> Followed:
    """Follow the ball of a clip from one click.

    Parameters
    ----------
    clip : Clip
        Interlaced.
    mode : str
    """
    tracker, answers, own, missed = None, list[tuple[float, float, float]](), list[float](), 0
    for frame in pictures_of(clip, mode):
        if tracker is None:
            click = clip.first_click
            tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, *click), start=click)
        track, time = tracker.update(frame), frame.time * clip.fps
        if not is_seen(clip, time):
            continue
        if isinstance(track, ms.Lost):
            missed += 1
            continue
        answers.append((time, track.shape.x, track.shape.y))
        fields = [time] if frame.rows != "all" else [time - 0.25, time + 0.25]
        own.append(math.dist(answers[-1][1:], np.mean([place(clip, each) for each in fields], axis=0).tolist()))
    return Followed(np.array(own), _over_time(clip, answers), _newest(clip, answers), missed)


def is_seen(clip: Clip, time: float) -> bool:
    """Whether enough of the ball is seen at a time, frames."""
    truth = clip.truth(min(max(round(time), 0), clip.frames - 1))
    return truth.circle is not None and truth.share >= LEAST_SHARE


def place(clip: Clip, time: float) -> tuple[float, float]:
    """Where the ball is at a time, frames: x and y, px."""
    circle = clip._outline(time).circle()
    return circle.x, circle.y


def _over_time(clip: Clip, answers: Sequence[tuple[float, float, float]]) -> Floats:
    """Errors of the straight lines between answers."""
    found = list[float]()
    for (begin, *one), (end, *other) in itertools.pairwise(answers):
        if end - begin > APART:
            continue
        for time in np.arange(math.ceil(begin / STEP) * STEP, end, STEP).tolist():
            share = (time - begin) / (end - begin)
            there = [a + share * (b - a) for a, b in zip(one, other, strict=True)]
            found.append(math.dist(there, place(clip, time)))
    return np.array(found)


def _newest(clip: Clip, answers: Sequence[tuple[float, float, float]]) -> Floats:
    """Errors of each answer at the time of the next picture."""
    pairs = itertools.pairwise(answers)
    return np.array([math.dist(one[1:], place(clip, end[0])) for one, end in pairs if end[0] - one[0] <= APART])


def pooled(name: str, seeds: Sequence[int], frames: int, mode: Mode) -> Followed:
    """Follow a sequence of `benchmarks.tracking.trial` with several seeds."""
    runs = [follow(sequence(name, seed, frames), mode) for seed in seeds]
    return Followed(
        np.concatenate([run.own for run in runs]),
        np.concatenate([run.over_time for run in runs]),
        np.concatenate([run.newest for run in runs]),
        sum(run.missed for run in runs),
    )
