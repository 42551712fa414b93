"""Tracks as `supervision.Detections`: `to_supervision`."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from matchset.numeric.arguments import check_kind
from matchset.shapes.described import box_of
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost, Track

Answer = Track[Any] | Lost[Any]


def to_supervision(tracks: Answer | Iterable[Answer | Target[Any]], tracker_id: Sequence[int] | None = None) -> Any:
    """Make `supervision.Detections` of tracks, for the annotators, zones and counters of that package.

    Parameters
    ----------
    tracks : Track, Lost, or iterable of them or of Target
        What `Tracker.update`, `detect` or `MultiTracker.update` returned; what is lost is left out.
    tracker_id : sequence of int, optional
        An identity for each of the tracks that were given, the lost among them; targets have their own.

    Returns
    -------
    supervision.Detections
        `xyxy`: the box of each shape, px; `confidence`: its support; `class_id`: 0; `tracker_id` if it was given. Of
        targets `tracker_id` is their identity, and `data["class_name"]` the label of their color.

    Raises
    ------
    ImportError
        If supervision is not installed.
    TypeError
        If one of them is no `Track` or `Lost`, or targets are among them.
    ValueError
        If there are more or fewer identities than tracks, or some are given of targets.
    """
    try:
        from supervision import Detections
    except ImportError:
        raise ImportError("to_supervision needs the package supervision: pip install supervision") from None
    given: list[Any] = [tracks] if isinstance(tracks, Track | Lost) else list(tracks)
    if given and all(isinstance(each, Target) for each in given):
        if tracker_id is not None:
            raise ValueError(f"targets have identities of their own, got tracker_id {tracker_id!r:.60}")
        return _of_targets(Detections, given)
    for each in given:
        check_kind("a track", each, (Track, Lost), "Tracker.update(frame) gives one")
    if tracker_id is not None and len(tracker_id) != len(given):
        raise ValueError(f"tracker_id must have one number for each of {len(given)} tracks, got {len(tracker_id)}")
    seen = [k for k, each in enumerate(given) if isinstance(each, Track)]
    found = [each for each in given if isinstance(each, Track)]
    found_ids = None if tracker_id is None else [tracker_id[k] for k in seen]
    return Detections(**_fields(found, found_ids))


def _of_targets(detections: Any, targets: Sequence[Target[Any]]) -> Any:
    """Make detections of targets."""
    seen = [each for each in targets if isinstance(each.track, Track)]
    fields = _fields([each.track for each in seen if isinstance(each.track, Track)], [each.identity for each in seen])
    return detections(**fields, data={"class_name": np.array([each.label for each in seen], np.str_)})


def _fields(found: Sequence[Track[Any]], identities: Sequence[int] | None) -> dict[str, Any]:
    """Return what `supervision.Detections` takes."""
    return {
        "xyxy": np.array([box_of(each.shape) for each in found], np.float32).reshape(-1, 4),
        "confidence": np.array([each.support for each in found], np.float32),
        "class_id": np.zeros(len(found), int),
        "tracker_id": None if identities is None else np.array(identities, int),
    }
