"""The intervals in which a tracked ball is held still: `still_intervals`."""

from collections.abc import Sequence
from typing import Any, Protocol

import msgspec
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


class StillParameters(msgspec.Struct, frozen=True):
    """When a ball counts as held still.

    All were chosen by hand for a ball in a person's hand; `tests/app/calibrate/test_ball_command.py` shows a change.

    Parameters
    ----------
    min_frames : int
        Frames of an interval at least.
    max_motion : float
        Range of the center within `min_frames`, as a share of the radius: more accepts an unsteady hand, and a ball
        that is carried slowly.
    max_growth : float
        Range of the radius within `min_frames`, as a share of it.
    same_radius : float
        Two intervals in sequence belong to one distance if their radii differ by less than this share.
    """

    min_frames: int = 15
    max_motion: float = 0.15
    max_growth: float = 0.03
    same_radius: float = 0.05


PARAMETERS = StillParameters()


class StillInterval(msgspec.Struct, frozen=True):
    """A ball held still.

    Parameters
    ----------
    first, last : int
        Frames.
    radius : float
        Median, px.
    outlines : list of ndarray of shape (m, 2), float64
        Match-sets, px.
    """

    first: int
    last: int
    radius: float
    outlines: list[Floats]


class FoundBall(Protocol):
    """A ball in a frame, such as a `Track` of a `Circle`."""

    @property
    def shape(self) -> Any:
        """Circle."""
        ...

    @property
    def match_set(self) -> Floats:
        """Edge points, px, (m, 2)."""
        ...


def still_intervals(found: Sequence[tuple[int, FoundBall]]) -> list[StillInterval]:
    """Find the intervals in which a ball hardly moves; consecutive ones of one radius are joined.

    Parameters
    ----------
    found : sequence of (int, FoundBall)
        Frames in which the ball was found, with their numbers, in order.

    Returns
    -------
    list of StillInterval
        In order.
    """
    if len(found) < PARAMETERS.min_frames:
        return []
    circles = np.array([(track.shape.x, track.shape.y, track.shape.radius) for _, track in found])
    windows = np.lib.stride_tricks.sliding_window_view(circles, PARAMETERS.min_frames, axis=0)
    span = np.ptp(windows, axis=2) / np.median(windows[:, 2], axis=1)[:, None]
    is_still = (span[:, :2].max(axis=1) < PARAMETERS.max_motion) & (span[:, 2] < PARAMETERS.max_growth)
    still = np.zeros(len(found), np.bool_)
    for start in np.flatnonzero(is_still):
        still[start : start + PARAMETERS.min_frames] = True
    edges = np.flatnonzero(np.diff(np.concatenate(([0], still.astype(np.int8), [0]))))
    intervals: list[StillInterval] = []
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        interval = _interval(found[begin:end])
        if intervals and abs(interval.radius / intervals[-1].radius - 1.0) < PARAMETERS.same_radius:
            before = intervals.pop()
            outlines = before.outlines + interval.outlines
            radius = float(np.average([before.radius, interval.radius], weights=[len(before.outlines), end - begin]))
            interval = StillInterval(before.first, interval.last, radius, outlines)
        intervals.append(interval)
    return intervals


def _interval(found: Sequence[tuple[int, FoundBall]]) -> StillInterval:
    radius = float(np.median([track.shape.radius for _, track in found]))
    return StillInterval(found[0][0], found[-1][0], radius, [track.match_set for _, track in found])
