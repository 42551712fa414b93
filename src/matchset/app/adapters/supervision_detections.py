"""Tracks as `supervision.Detections`: `to_supervision`."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from matchset.numeric.arguments import check_kind
from matchset.shapes.described import box_of
from matchset.tracking.track import Lost, Track


def to_supervision(
    tracks: Track[Any] | Lost[Any] | Iterable[Track[Any] | Lost[Any]], tracker_id: Sequence[int] | None = None
) -> Any:
    """Make `supervision.Detections` of tracks, for the annotators, zones and counters of that package.

    Parameters
    ----------
    tracks : Track, Lost, or iterable of them
        What `Tracker.update` or `detect` returned; what is lost is left out.
    tracker_id : sequence of int, optional
        An identity for each of the tracks that were given, the lost among them.

    Returns
    -------
    supervision.Detections
        `xyxy`: the box of each shape, px; `confidence`: its support; `class_id`: 0; `tracker_id` if it was given.

    Raises
    ------
    ImportError
        If supervision is not installed.
    TypeError
        If one of them is no `Track` or `Lost`.
    ValueError
        If there are more or fewer identities than tracks.
    """
    try:
        from supervision import Detections
    except ImportError:
        raise ImportError("to_supervision needs the package supervision: pip install supervision") from None
    given = [tracks] if isinstance(tracks, Track | Lost) else list(tracks)
    for each in given:
        check_kind("a track", each, (Track, Lost), "Tracker.update(frame) gives one")
    if tracker_id is not None and len(tracker_id) != len(given):
        raise ValueError(f"tracker_id must have one number for each of {len(given)} tracks, got {len(tracker_id)}")
    seen = [k for k, each in enumerate(given) if isinstance(each, Track)]
    found = [each for each in given if isinstance(each, Track)]
    return Detections(
        xyxy=np.array([box_of(each.shape) for each in found], np.float32).reshape(-1, 4),
        confidence=np.array([each.support for each in found], np.float32),
        class_id=np.zeros(len(found), int),
        tracker_id=None if tracker_id is None else np.array([tracker_id[k] for k in seen], int),
    )
