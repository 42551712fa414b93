"""What was measured of a target, frame by frame: `TimeLog`, `ShapeLog`, and `Course`, from which curves are drawn."""

import math
from array import array
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Protocol, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]

CENTER_AND_SIZE = 3  # format: numbers of a shape in a `ShapeLog`: x, y, size; then their standard deviations


class Course(msgspec.Struct, frozen=True):
    """Three numbers over time, the first of which are a place.

    Parameters
    ----------
    time : ndarray of shape (n,), float64
        Of every frame, s, since the first one.
    values, std : ndarray of shape (n, 3), float64
        The numbers and their standard deviations; NaN where it was not found, or where none is known.
    labels : tuple of str
        What each number is, with its unit: ``radius, px``.
    unit : str
        Of the place: ``px`` or ``m``.
    place : int
        How many of the numbers are the place; the speed is that of the place.
    """

    time: Floats
    values: Floats
    std: Floats
    labels: tuple[str, str, str]
    unit: str
    place: int

    @property
    def found(self) -> npt.NDArray[np.bool_]:
        """Whether it was found, (n,)."""
        return np.isfinite(self.values[:, 0])


class TimeLog:
    """A time and some numbers for each frame, eight bytes each, so that a run may take hours.

    Parameters
    ----------
    numbers : int
        For each frame, beside its time.

    Attributes
    ----------
    any_found : bool
        Whether there are numbers of any frame.
    """

    def __init__(self, numbers: int) -> None:
        self._numbers, self._width = array("d"), numbers + 1
        self.any_found = False

    def note(self, time: float, numbers: Sequence[float] | None) -> None:
        """Append a frame: its time, s, and its numbers; None where there are none."""
        self.any_found |= numbers is not None
        self._numbers.append(time)
        self._numbers.extend((math.nan,) * (self._width - 1) if numbers is None else numbers)

    @property
    def table(self) -> Floats:
        """Time and numbers, (n, 1 + numbers); NaN where there are none."""
        return np.array(self._numbers, np.float64).reshape(-1, self._width)

    @property
    def time(self) -> Floats:
        """Since the first frame, (n,), s."""
        time = self.table[:, 0]
        return np.asarray(time - time[:1])


class AnsweredFrame(Protocol):
    """A frame of a run."""

    @property
    def answer(self) -> Track[Any] | Lost[Any]:
        """The tracker's answer."""
        ...

    @property
    def row(self) -> Any:
        """With the `time` of the frame, s."""
        ...


Answered = TypeVar("Answered", bound=AnsweredFrame)


class ShapeLog(TimeLog):
    """Center and size of a shape, frame by frame.

    Parameters
    ----------
    family : type
        The family of shapes; of a circle the size is the radius, of any other one half the width of its outline.

    Attributes
    ----------
    family : type
    """

    def __init__(self, family: type[Any]) -> None:
        super().__init__(2 * CENTER_AND_SIZE)
        self.family, self._round = family, "radius" in family.parameters
        self._centered = family.parameters[:2] == ("x", "y")

    def record(self, frames: Iterable[Answered]) -> Iterator[Answered]:
        """Pass frames on, noting each."""
        for answered in frames:
            self.add(answered)
            yield answered

    def add(self, answered: AnsweredFrame) -> None:
        """Note the next frame."""
        self.note(answered.row.time, self._numbers_of(answered.answer))

    @property
    def course(self) -> Course:
        """What was noted so far."""
        table, size = self.table, "radius, px" if self._round else "half-width, px"
        labels = "x, px (right)", "y, px (down)", size
        return Course(self.time, table[:, 1:4], table[:, 4:7], labels, "px", 2)

    def _numbers_of(self, answer: Track[Any] | Lost[Any]) -> tuple[float, ...] | None:
        if isinstance(answer, Lost):
            return None
        shape, variances = answer.shape, np.diagonal(answer.covariance)
        size = shape.radius if self._round else float(self.family.half_width(shape.state))
        known = (self._centered, self._centered, self._round)
        std = (math.sqrt(v) if told and v >= 0.0 else math.nan for told, v in zip(known, variances, strict=False))
        return (*shape.center, size, *std)


def found_stretches(found: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the stretches of frames in which it was found: of each the first one, and the one after the last."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], found, [False]))))
    return [(int(first), int(end)) for first, end in edges.reshape(-1, 2)]
