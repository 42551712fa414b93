"""Follow the ball of a clip from many clicks at once, decoding the video once: `follow`, and its record, `Run`."""

from collections.abc import Iterator, Sequence

import msgspec
import numpy as np

import matchset as ms
from benchmarks.real.clips import Clip
from benchmarks.real.starts import Start
from benchmarks.tracking.trial import circle, clicked
from matchset.app.track.score import Circle3, Score, score

Answer = ms.Track[ms.Circle] | ms.Lost[ms.Circle]


class Follower:
    """A tracker that begins with its click, in the frame of the click.

    Parameters
    ----------
    start : Start

    Attributes
    ----------
    tracker : Tracker or None
        None before the click, and where it was refused.
    refusal : str
        Why it was refused; empty where it was not.
    """

    def __init__(self, start: Start) -> None:
        self.start = start
        self.refusal = ""
        self.tracker: ms.Tracker[ms.Circle] | None = None

    def update(self, frame: ms.Frame) -> Answer | None:
        """Answer for a frame: None before the click, `Lost` for ever where the click was refused."""
        if frame.index < self.start.frame:
            return None
        if self.tracker is None and not self.refusal:
            try:
                self.tracker = clicked(frame, (self.start.x, self.start.y))
            except ValueError as error:
                self.refusal = f"refused: {error}"
        if self.tracker is None:
            return ms.Lost(self.refusal, frame.time)
        return self.tracker.update(frame)


class Run(msgspec.Struct, frozen=True):
    """What became of one click.

    Parameters
    ----------
    start : Start
    answers : dict of int to (x, y, radius) or None
        By frame, from the click on.
    covariances : dict of int to list of 3 lists of 3 floats
        Of the answers in frames with a tight row.
    refusal : str
        Why the click was refused; empty where it was not.
    """

    start: Start
    answers: dict[int, Circle3 | None]
    covariances: dict[int, list[list[float]]]
    refusal: str = ""

    @property
    def nothing(self) -> bool:
        """Whether the click never gave a `Track`."""
        return not any(self.answers.values())

    def score(self, clip: Clip) -> Score:
        """Score it from the frame of its click to the end."""
        return score(self.answers, clip.truths, start=self.start.frame)


def follow(clip: Clip, followers: Sequence[Follower]) -> Iterator[tuple[ms.Frame, list[Answer | None]]]:
    """Give every frame of a clip to every follower.

    Parameters
    ----------
    clip : Clip
    followers : sequence of Follower

    Yields
    ------
    Frame
    list of Track, Lost or None
        The answer of each follower; None before its click.
    """
    with ms.Video(clip.video) as video:
        for frame in video:
            yield frame, [each.update(frame) for each in followers]


class Recorder:
    """Takes the answers of the followers of a clip down.

    Parameters
    ----------
    clip : Clip
    starts : sequence of Start
    """

    def __init__(self, clip: Clip, starts: Sequence[Start]) -> None:
        self.followers = [Follower(start) for start in starts]
        self._tight = {row.frame for row in clip.tight}
        self._answers: list[dict[int, Circle3 | None]] = [{} for _ in starts]
        self._covariances: list[dict[int, list[list[float]]]] = [{} for _ in starts]

    def take(self, frame: int, answers: list[Answer | None]) -> None:
        """Note the answers for a frame."""
        for answer, known, covariances in zip(answers, self._answers, self._covariances, strict=True):
            if answer is None:
                continue
            track = answer if isinstance(answer, ms.Track) else None
            known[frame] = None if track is None else circle(track.shape)
            if track is not None and frame in self._tight:
                covariances[frame] = np.asarray(track.covariance).tolist()

    def runs(self) -> list[Run]:
        """Return what became of each click."""
        noted = zip(self.followers, self._answers, self._covariances, strict=True)
        return [Run(each.start, answers, covariances, each.refusal) for each, answers, covariances in noted]
