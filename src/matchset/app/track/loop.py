"""The loop of `matchset track`: each frame through the tracker, each answer to every outlet."""

import re
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Protocol

import msgspec

from matchset.app.exit_codes import StopRequest
from matchset.app.track.rows import Row, row_of
from matchset.image.frame import Frame
from matchset.tracking.track import Lost, Track

UNDECODED = "frame could not be decoded"

_NUMBER = re.compile(r"\d+(?:\.\d+)?")


class Follower(Protocol):
    """What follows the shape: `matchset.Tracker`, or a stand-in for it."""

    def update(self, frame: Frame) -> Track[Any] | Lost[Any]:
        """Follow the shape into `frame`."""
        ...


class Step(msgspec.Struct, frozen=True):
    """One frame and what became of it.

    Parameters
    ----------
    frame : Frame or None
        The frame; None if it did not decode.
    answer : Track or Lost
        What the tracker said.
    row : Row
        The same for the table.
    seconds : float
        Computing time that the tracker took, s.
    """

    frame: Frame | None
    answer: Track[Any] | Lost[Any]
    row: Row
    seconds: float = 0.0


class Counted(Protocol):
    """What `Tally` needs to know of a frame: a `Step`, or what is made of it."""

    @property
    def frame(self) -> Frame | None:
        """The frame; None if it did not decode."""
        ...

    @property
    def row(self) -> Any:
        """With `found` and `reason`."""
        ...

    @property
    def seconds(self) -> float:
        """Computing time, s."""
        ...


class Tally:
    """Figures of a run: how many frames, how many found, why not, how fast."""

    def __init__(self) -> None:
        self.frames = self.found = 0
        self.reasons: Counter[str] = Counter()
        self.seconds: list[float] = []

    @property
    def median_ms(self) -> float:
        """What the tracker took for a frame, ms; the median over frames, 0 without any."""
        return 1000.0 * sorted(self.seconds)[len(self.seconds) // 2] if self.seconds else 0.0

    def count(self, step: Counted) -> None:
        """Take a step into account."""
        self.frames += 1
        self.found += step.row.found
        if step.frame is not None:
            self.seconds.append(step.seconds)
        if not step.row.found:
            self.reasons[_NUMBER.sub("…", step.row.reason)] += 1


def follow(
    frames: Iterable[Frame], follower_at: Callable[[Frame], Follower | None], gaps: bool, stop: StopRequest
) -> Iterator[Step]:
    """Track a video frame by frame.

    Parameters
    ----------
    frames : iterable of Frame
        The video.
    follower_at : callable
        Asked before each frame: a new follower to go on with, or None to keep the one there is.
    gaps : bool
        Whether a gap in the frames' numbers is a frame that did not decode, and gets a row that says so; of
        a live source it is a frame that was dropped, and gets none.
    stop : StopRequest
        Looked at after each frame.

    Yields
    ------
    Step
        One for each frame, in order.
    """
    follower: Follower | None = None
    last: Frame | None = None
    for frame in frames:
        if gaps:
            yield from _missing(last, frame)
        follower = follower_at(frame) or follower
        if follower is None:
            raise ValueError(f"nothing follows frame {frame.index}")
        # The thread's own time: what the recorder's thread takes meanwhile is not the tracker's.
        begin = time.thread_time()
        answer = follower.update(frame)
        seconds = time.thread_time() - begin
        yield Step(frame, answer, row_of(frame.index, answer), seconds)
        last = frame
        if stop:
            return


def _missing(last: Frame | None, frame: Frame) -> Iterator[Step]:
    first = 0 if last is None else last.index + 1
    start = 0.0 if last is None else last.time
    for index in range(first, frame.index):
        share = (index - first + 1) / (frame.index - first + 1)
        lost: Lost[Any] = Lost(UNDECODED, round(start + share * (frame.time - start), 6))
        yield Step(None, lost, row_of(index, lost))
