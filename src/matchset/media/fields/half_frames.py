"""Two half-frames of every interlaced frame: `HalfFrames`."""

import itertools
import math
import statistics
from collections import deque
from typing import Literal

import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from matchset.image.frame import Frame, Rows

First = Literal["top", "bottom"]
Image = npt.NDArray[np.uint8]

PARITY: dict[Rows, int] = {"top": 0, "bottom": 1}  # geometry: first row of each field
USUAL_PERIOD = 1.0 / 30.0  # format: s, between two frames of a source that does not state its rate, until there are two
INTERVALS = 15  # format: how many of the last intervals tell the period of such a source
SPARSE = 16  # format: every so many rows and columns are compared before all are


class HalfFrames:
    """Takes interlaced frames apart.

    A half-frame's picture is as large as the frame's. Its own rows are new, the others still hold the field before:
    nothing is interpolated. A field that is not there (its rows repeat those of the frame before while the other
    field's do not, or those of the other field, or are of one color throughout) is left out.

    Parameters
    ----------
    first : str
        Which field is the first in time: "top", the even rows, or "bottom".
    fps : float or None
        Frames per second; None: by their times.
    begin : int
        Index of the first frame that is taken apart: the half-frames of frame k are 2 k - begin and the next one.
    later : bool
        Whether the time of a frame is that of its later field. By default it is the mean of both, as everywhere.

    Attributes
    ----------
    missing : int
        Fields that were not there.
    """

    def __init__(self, first: First, fps: float | None, begin: int = 0, later: bool = False) -> None:
        self.begin_with(first)
        self.missing, self.later = 0, later
        self._fps, self._begin = fps, begin
        self._times: deque[float] = deque(maxlen=INTERVALS + 1)
        self._newest: Image | None = None  # both fields as they are known
        self._before: Image | None = None  # the frame before
        self._last = -math.inf

    def begin_with(self, first: First) -> None:
        """Take this field for the first of the frames to come."""
        self.order: tuple[First, First] = ("top", "bottom") if first == "top" else ("bottom", "top")

    def of(self, frame: Frame) -> list[Frame]:
        """Return the half-frames of a frame, the earlier field first; of one whose fields are missing only the other.

        Parameters
        ----------
        frame : Frame
            The next one; its picture is handed on, never written to.
        """
        image, found = frame.image, list[Frame]()
        there = [not self._is_missing(image, PARITY[rows]) for rows in self.order]
        if not any(there):  # the whole frame is a repetition, or black
            there = [True, True]
        self.missing += 2 - sum(there)
        for k, rows in enumerate(self.order):
            if there[k]:
                both = k == 1 and there[0]
                self._newest = image if self._newest is None or both else woven(self._newest, image, PARITY[rows])
                index = 2 * frame.index - self._begin + k
                found.append(replace(frame, image=self._newest, time=self._time(frame, k), index=index, rows=rows))
        self._before = image
        return found

    def _time(self, frame: Frame, k: int) -> float:
        """Time of the field that comes first, 0, or second, 1: always later than the one before."""
        if k == 0 or not self._times or self._times[-1] != frame.time:
            self._times.append(frame.time)
        period = self._period()
        second = frame.time if self.later else frame.time + 0.25 * period
        time = second - 0.5 * period * (1 - k)
        if not time > self._last:  # stamps that jitter
            time = max(0.5 * (self._last + second), math.nextafter(self._last, math.inf))
        self._last = time
        return time

    def _period(self) -> float:
        if self._fps is not None:
            return 1.0 / self._fps
        intervals = [later - earlier for earlier, later in itertools.pairwise(self._times) if later > earlier]
        return statistics.median(intervals) if intervals else USUAL_PERIOD

    def _is_missing(self, image: Image, parity: int) -> bool:
        """Whether there is nothing new in the rows of a field."""
        field, other = image[parity::2], image[1 - parity :: 2]
        if _is_plain(field) and not _is_plain(other):
            return True
        if parity == PARITY[self.order[1]] and _are_equal(field, other):  # the first one, once more
            return True
        before = self._before
        return (
            before is not None
            and _are_equal(field, before[parity::2])
            and not _are_equal(other, before[1 - parity :: 2])
        )


def woven(known: Image, image: Image, parity: int) -> Image:
    """Return a picture with the rows of a field anew."""
    both = np.array(known, order="C")
    both[parity::2] = image[parity::2]
    return both


def _are_equal(field: Image, other: Image) -> bool:
    """Whether two fields are the same, as far as both have rows."""
    rows = min(len(field), len(other))
    a, b = field[:rows], other[:rows]
    return np.array_equal(a[::SPARSE, ::SPARSE], b[::SPARSE, ::SPARSE]) and np.array_equal(a, b)


def _is_plain(field: Image) -> bool:
    """Whether a field is of one color throughout."""
    color = field[:1, :1]
    return bool((field[::SPARSE, ::SPARSE] == color).all()) and bool((field == color).all())
