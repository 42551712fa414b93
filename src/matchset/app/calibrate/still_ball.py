"""The moments in which a tracked ball is held still."""

from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]

_LEAST_FRAMES = 15
_WANDER = 0.15  # of the radius: how far a held ball may move within _LEAST_FRAMES
_BREATHE = 0.03  # of the radius: how much it may change
_ONE_PLACE = 0.05  # of the radius: two still moments of this difference and less are at one distance


class Still(msgspec.Struct, frozen=True):
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


def still_moments(found: list[tuple[int, Track[Any]]]) -> list[Still]:
    """Find the moments of at least 15 frames in which a ball hardly moves; one after the other at one size are one.

    Parameters
    ----------
    found : list of (int, Track)
        Frames in which the ball was found, with their numbers, in order.

    Returns
    -------
    list of Still
        In order.
    """
    if len(found) < _LEAST_FRAMES:
        return []
    circles = np.array([(track.shape.x, track.shape.y, track.shape.radius) for _, track in found])
    windows = np.lib.stride_tricks.sliding_window_view(circles, _LEAST_FRAMES, axis=0)
    span = np.ptp(windows, axis=2) / np.median(windows[:, 2], axis=1)[:, None]
    quiet = (span[:, :2].max(axis=1) < _WANDER) & (span[:, 2] < _BREATHE)
    still = np.zeros(len(found), np.bool_)
    for start in np.flatnonzero(quiet):
        still[start : start + _LEAST_FRAMES] = True
    edges = np.flatnonzero(np.diff(np.concatenate(([0], still.astype(np.int8), [0]))))
    moments: list[Still] = []
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        moment = _moment(found[begin:end])
        if moments and abs(moment.radius / moments[-1].radius - 1.0) < _ONE_PLACE:
            before = moments.pop()
            outlines = before.outlines + moment.outlines
            radius = float(np.average([before.radius, moment.radius], weights=[len(before.outlines), end - begin]))
            moment = Still(before.first, moment.last, radius, outlines)
        moments.append(moment)
    return moments


def _moment(found: list[tuple[int, Track[Any]]]) -> Still:
    radius = float(np.median([track.shape.radius for _, track in found]))
    return Still(found[0][0], found[-1][0], radius, [track.match_set for _, track in found])
