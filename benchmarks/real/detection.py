"""Is the ball found in a picture of its own, with the color of one other picture and no motion to help."""

import math
from collections.abc import Mapping, Sequence

import msgspec
import numpy as np

import matchset as ms
from benchmarks.common.start import Image
from benchmarks.real.clips import Clip
from benchmarks.real.foreign import Ball, ball_of
from benchmarks.real.starts import start_at
from benchmarks.results import Figure, Finding, Goal, table
from benchmarks.tracking.trial import circle
from matchset.app.track.score import VALID_BELOW_PX, Circle3, TruthRow, error_px

BAR = (Goal("recall", low=90.0), Goal("false", high=0.0))
SHARE = 0.25
"""A detection is right with an error below 5 px or this share of the radius, whichever is more."""


class Detected(msgspec.Struct, frozen=True):
    """What a search of a clip's labelled frames found.

    Parameters
    ----------
    shown, right, wrong : int
        Tight rows searched, and those in which the first answer was right and wrong.
    absent, false : int
        Frames known not to show the ball, and those of them with an answer.
    refusal : str
        Why no color could be learned; empty where one was.
    """

    shown: int
    right: int
    wrong: int
    absent: int
    false: int
    refusal: str = ""


class Seeker:
    """Searches the labelled frames of a clip, with the color of the first tight row.

    Parameters
    ----------
    clip : Clip

    Attributes
    ----------
    ball : Ball or None
        Its color, once the first tight row has been taken; None where it was refused.
    """

    def __init__(self, clip: Clip) -> None:
        self._first = clip.tight[0]
        self._rows = {row.frame: row for row in clip.truths if row.tight or row.circle is None}
        self.ball: Ball | None = None
        self._refusal = ""
        self._before: list[ms.Frame] = []
        self._answers: list[tuple[TruthRow, Circle3 | None]] = []

    def take(self, frame: ms.Frame) -> None:
        """Search a frame if it is labelled; those before the color is known wait."""
        if frame.index == self._first.frame:
            self._learn(frame.image)
            for each in self._before:
                self._search(each)
            self._before.clear()
        elif frame.index in self._rows:
            if frame.index < self._first.frame:
                self._before.append(frame)
            else:
                self._search(frame)

    def _learn(self, image: Image) -> None:
        assert self._first.circle is not None
        start = start_at(self._first, click=0)
        try:
            self.ball = ball_of(image, self._first.circle, ms.ColorModel.pick(image, start.x, start.y))
        except ValueError as error:
            self._refusal = str(error)

    def _search(self, frame: ms.Frame) -> None:
        found = [] if self.ball is None else ms.detect(frame, ms.Circle, self.ball.color)
        self._answers.append((self._rows[frame.index], circle(found[0].shape) if found else None))

    def detected(self) -> Detected:
        """Return what was found."""
        shown = [(row.circle, answer) for row, answer in self._answers if row.circle is not None]
        absent = [answer for row, answer in self._answers if row.circle is None]
        right = sum(is_right(answer, truth) for truth, answer in shown if answer is not None)
        answered = sum(answer is not None for _, answer in shown)
        false = sum(answer is not None for answer in absent)
        return Detected(len(shown), right, answered - right, len(absent), false, self._refusal)


def is_right(answer: Circle3, truth: Circle3) -> bool:
    """Say whether an answer's center is on the ball and its error small."""
    inside = math.hypot(answer[0] - truth[0], answer[1] - truth[1]) < truth[2]
    return inside and error_px(answer, truth) < max(VALID_BELOW_PX, SHARE * truth[2])


def detection_finding(clips: Sequence[Clip], found: Mapping[str, Detected]) -> Finding:
    """Hold the searches of all clips against the goals."""
    return Finding(
        name="real_detection",
        what=f"{len(clips)} real clips, whole-frame search with the color of one labelled frame, each clip the same",
        figures=figures([found[clip.name] for clip in clips]),
        bar=BAR,
    )


def figures(every: Sequence[Detected]) -> tuple[Figure, ...]:
    """Name the numbers of some searches."""
    recall = [100.0 * each.right / each.shown for each in every if each.shown]
    return (
        Figure("recall", float(np.mean(recall)) if recall else None, "%", 1),
        Figure("wrong", sum(each.wrong for each in every), "", 0),
        Figure("false", sum(each.false for each in every), "", 0),
        Figure("frames", sum(each.shown for each in every), "", 0, aside=True),
        Figure("frames without it", sum(each.absent for each in every), "", 0, aside=True),
    )


def detection_table(clips: Sequence[Clip], found: Mapping[str, Detected]) -> str:
    """Write the searches of each clip as a table."""
    rows = [
        [clip.name, *(figure.text for figure in figures([found[clip.name]])), found[clip.name].refusal or "-"]
        for clip in clips
    ]
    return table(["clip", *(figure.name for figure in figures([])), "color refused"], rows)
