"""Answers that were found before, handed out in order of time: `KnownAnswers`, of several targets `KnownTargets`."""

from collections.abc import Iterable, Iterator
from typing import Any, Generic, Protocol, TypeVar

import msgspec

from matchset.image.frame import Frame
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost, Track

STOPPED = "stopped before it was followed back to here"


class TimedFrame(Protocol):
    """A frame of a run."""

    @property
    def row(self) -> Any:
        """With the number of the frame."""
        ...

    @property
    def seconds(self) -> float:
        """Computing time, s."""
        ...


A = TypeVar("A")
Timed = TypeVar("Timed", bound=TimedFrame)


class _ByFrame(Generic[A]):
    """Answers by the indices of their frames, each with its computing time."""

    def __init__(self) -> None:
        self._answers: dict[int, A] = {}
        self._seconds: dict[int, float] = {}

    def put(self, index: int, answer: A, seconds: float) -> None:
        """Note the answer of a frame, and its computing time, s."""
        self._answers[index], self._seconds[index] = answer, seconds

    def timed(self, frames: Iterable[Timed]) -> Iterator[Timed]:
        """Pass the frames of a run on, each with the computing time of its answer."""
        for each in frames:
            seconds = self._seconds.pop(each.row.frame, 0.0)
            yield msgspec.structs.replace(each, seconds=each.seconds + seconds) if seconds else each  # type: ignore[type-var]


class KnownAnswers(_ByFrame[Track[Any] | Lost[Any]]):
    """Takes the place of a tracker for frames whose answers are known; each is handed out once.

    An answer takes 2 kB, so a click in frame 50,000 takes 100 MB.
    """

    def update(self, frame: Frame) -> Track[Any] | Lost[Any]:
        """Return what is known of a frame."""
        answer = self._answers.pop(frame.index, None)
        return Lost(STOPPED, frame.time) if answer is None else answer


class KnownTargets(_ByFrame[tuple[Target[Any], ...]]):
    """The same in the place of a tracker of several targets."""

    def update(self, frame: Frame) -> tuple[Target[Any], ...]:
        """Return what is known of a frame; nothing where that was not reached."""
        return self._answers.pop(frame.index, ())
