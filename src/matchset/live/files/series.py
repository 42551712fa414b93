"""The course of a target over a whole video, reduced to what a screen can show: `Series`."""

import threading
import time
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.live.files.file_target import FileTarget
from matchset.localization.pose import Pose
from matchset.media.frame_list import FrameList
from matchset.tracking.track import Lost, Track

PARAMETERS = 3  # format: curves of a page
DIGITS = 5  # format: decimals of m and px that are sent

Floats = npt.NDArray[np.float64]


class SeriesParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How fine a course is.

    Parameters
    ----------
    columns : int
        At most; each has the least and the largest value of its frames. Chosen by hand: a curve of a wide screen.
    slice : float
        Longest time for one answer, s: a long video is located over several. Chosen by hand: nobody waits.
    """

    columns: int = 500
    slice: float = 0.3


class PlottedCourse(msgspec.Struct, frozen=True):
    """What a page draws.

    Parameters
    ----------
    target : int
    whole : bool
        Whether all that is known is in it; otherwise ask again.
    placed : bool
        Whether the values are m in the camera's frame, x, y, z; else the shape's first parameters, px.
    names : list of str
    times : list of float
        s, of the columns.
    low, high, sigma : list of lists of float or None
        For each name the least and largest value, and the largest standard deviation, of each column; None where it was
        not found.
    lost : list of bool
        Whether there is a frame in the column in which it was lost.
    """

    target: int
    whole: bool
    placed: bool
    names: list[str]
    times: list[float]
    low: list[list[float]]
    high: list[list[float]]
    sigma: list[list[float]]
    lost: list[bool]


class Series:
    """Keeps the values of a target, and computes those that are new; for any thread.

    Parameters
    ----------
    target : FileTarget
    frames : FrameList
    parameters : SeriesParameters, optional
    """

    def __init__(self, target: FileTarget, frames: FrameList, parameters: SeriesParameters | None = None) -> None:
        self._target, self._frames = target, frames
        self._parameters, self._lock = parameters or SeriesParameters(), threading.Lock()
        self._given = self._localizer = None
        self._taken: dict[int, Any] = {}
        self._names: list[str] = []
        self._values = np.empty((0, 2 * PARAMETERS))

    _given: Any
    _localizer: Any

    def course(self) -> PlottedCourse:
        """Return the course so far."""
        with self._lock:
            count = len(self._frames)
            whole = self._take(count)
            return self._reduced(count, whole)

    def _take(self, count: int) -> bool:
        """Compute what is new; False if the time was not enough."""
        end = time.monotonic() + self._parameters.slice
        if self._target.localizer is not self._given:
            self._given, self._localizer = self._target.localizer, self._target.new_localizer()
            self._taken.clear()
        if count > len(self._values):
            self._values = np.vstack((self._values, np.full((count - len(self._values), 2 * PARAMETERS), np.nan)))
        codes = self._target.codes
        for place in [each for each in self._taken if each >= len(codes) or not codes[each]]:
            self._values[place] = np.nan  # forgotten by a correction
            del self._taken[place]
        for place, answer in self._target.found(range(count)):
            if self._taken.get(place) is not answer:
                self._values[place] = self._row(answer)
                self._taken[place] = answer
                if time.monotonic() > end:
                    return False
        return True

    def _row(self, answer: Track[Any] | Lost[Any]) -> Floats:
        row = np.full(2 * PARAMETERS, np.nan)
        if isinstance(answer, Lost):
            return row
        if self._localizer is not None:
            pose = self._localizer.update(answer)
            self._names = ["x", "y", "z"]
            if isinstance(pose, Pose):
                row[:PARAMETERS] = pose.position
                row[PARAMETERS:] = np.sqrt(np.diagonal(pose.covariance)[:PARAMETERS])
            return row
        named = list(answer.measured().items())[:PARAMETERS]
        self._names = [name for name, _ in named]
        for column, (_, (value, sigma)) in enumerate(named):
            row[column], row[PARAMETERS + column] = value, np.nan if sigma is None else sigma
        return row

    def _reduced(self, count: int, whole: bool) -> PlottedCourse:
        columns = min(count, self._parameters.columns)
        begins = np.arange(columns) * count // max(columns, 1)
        values = self._values[:count]
        codes = np.zeros(count, np.uint8)
        known = np.frombuffer(self._target.codes[:count], np.uint8)
        codes[: len(known)] = known
        parts: tuple[Any, ...] = (values[:, :PARAMETERS],) * 2 + (values[:, PARAMETERS:],)
        reduce = (np.fmin.reduceat, np.fmax.reduceat, np.fmax.reduceat)
        low, high, sigma = (
            [np.round(each(part[:, column], begins), DIGITS).tolist() for column in range(len(self._names))]
            for each, part in zip(reduce, parts, strict=True)
        )
        lost = (np.maximum.reduceat(codes, begins) > 1).tolist() if columns else []
        times = [round(self._frames[int(place)].time, DIGITS) for place in begins]
        placed = self._localizer is not None
        return PlottedCourse(self._target.number, whole, placed, list(self._names), times, low, high, sigma, lost)
