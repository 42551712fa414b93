"""The answers of all frames, from what was seen of each target (`answers`)."""

import bisect
from collections.abc import Sequence
from typing import Any, NamedTuple

import msgspec

from matchset.tracking.many.smoothing.joining import NOBODY, Seen
from matchset.tracking.many.target import Target
from matchset.tracking.many.tracklet import shape_at
from matchset.tracking.motion import Gate
from matchset.tracking.track import Lost


class FrameMoment(NamedTuple):
    """A frame's number and its time, s."""

    number: int
    time: float


class TargetsAt(msgspec.Struct, frozen=True):
    """All targets in one frame of a video.

    Parameters
    ----------
    index : int
        Of the frame.
    time : float
        Of the frame, s.
    targets : list of Target
        In the order of their identities.
    """

    index: int
    time: float
    targets: list[Target[Any]]


def answers(
    moments: Sequence[FrameMoment], chains: Sequence[Sequence[Seen]], identities: Sequence[int | None]
) -> list[TargetsAt]:
    """Return what is where in every frame: between its first sighting and its last one a target is seen or `Lost`.

    Parameters
    ----------
    moments : sequence of FrameMoment
        Of all frames.
    chains : sequence of sequence of Seen
        What was seen of each target.
    identities : sequence of (int or None)
        Those that the forward reading gave, by owner.
    """
    found: list[list[Target[Any]]] = [[] for _ in moments]
    names = _names(chains, identities)
    ordered = sorted(zip(names, chains, strict=True), key=lambda pair: pair[0])
    for identity, chain in ordered:
        since, label = moments[chain[0].frame].time, chain[0].sighting.label
        frames = [each.frame for each in chain]
        for frame in range(frames[0], frames[-1] + 1):
            at = bisect.bisect_left(frames, frame)
            seen = chain[at]
            track = None if seen.frame == frame else _between(chain[at - 1], seen, moments[frame].time)
            found[frame].append(Target(identity, label, seen.sighting.track if track is None else track, since))
    return [TargetsAt(moment.number, moment.time, targets) for moment, targets in zip(moments, found, strict=True)]


def _names(chains: Sequence[Sequence[Seen]], identities: Sequence[int | None]) -> list[int]:
    """Return a name for each chain: the first one that the forward reading gave it, if no earlier chain has that."""
    first: dict[tuple[int, int], int] = {}
    for number, chain in enumerate(chains):
        for each in chain:
            owner = each.owners[0]
            identity = None if owner == NOBODY else identities[owner]
            if identity is not None:
                first.setdefault((number, identity), each.frame)
    names: dict[int, int] = {}
    for number, identity in sorted(first, key=lambda pair: (first[pair], pair)):
        if number not in names and identity not in names.values():
            names[number] = identity
    new = 1 + max((each for each in identities if each is not None), default=-1)
    for number in sorted(set(range(len(chains))) - set(names), key=lambda number: chains[number][0].frame):
        names[number], new = new, new + 1
    return [names[number] for number in range(len(chains))]


def _between(before: Seen, after: Seen, time: float) -> Lost[Any]:
    """Say where a target should be between two sightings: on the straight line from one to the other."""
    begin, end = before.sighting, after.sighting
    share = (time - begin.track.time) / (end.track.time - begin.track.time)
    middle = Gate(*((1.0 - share) * one + share * other for one, other in zip(begin.place, end.place, strict=True)))
    reason = f"not seen from {begin.track.time:.2f} to {end.track.time:.2f} s"
    return Lost(reason, time, shape_at(begin, middle))
