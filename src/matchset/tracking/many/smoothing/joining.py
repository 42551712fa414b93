"""What two readings of a video saw, joined: `segments`, stretches in which they agree who is followed."""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import msgspec
import numpy as np

from matchset.tracking.many.assignment import assigned
from matchset.tracking.many.sightings import Sighting
from matchset.tracking.many.smoothing.sweep import OwnedSighting
from matchset.tracking.motion import Gate

NOBODY = -1  # format: owner, and tracklet, of what a reading did not see


class JoiningParameters(msgspec.Struct, frozen=True, kw_only=True):
    """When outlines of the forward and the backward reading are the same, and where that is in doubt.

    Chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#smoothing); `python -m benchmarks.crowds` would show
    a change.

    Parameters
    ----------
    distance, log_size : float
        Outlines of the two readings are the same if they are nearer than this, in half-widths of the larger, and their
        sizes differ by less, as a logarithm.
    apart : float
        What one reading alone has seen is not what the other one sees of the same target in that frame if it is farther
        away than this, in half-widths of the larger; nearer, one of them is a bad fit.
    least : int
        Sightings from which something that one reading saw where a target was hidden may be that target.
    """

    distance: float = 0.6
    log_size: float = 0.35
    apart: float = 1.0
    least: int = 5


class Seen(NamedTuple):
    """What one reading or both have seen in a frame.

    Attributes
    ----------
    frame : int
        Its place in the video.
    sighting : Sighting
        The one with more support.
    owners : (int, int)
        Whose it is forward and backward; `NOBODY` where it was not seen.
    tracklets : (int, int)
        The same of the tracklets.
    is_certain : bool
        Whether neither doubted that.
    """

    frame: int
    sighting: Sighting
    owners: tuple[int, int]
    tracklets: tuple[int, int]
    is_certain: bool

    @property
    def rank(self) -> tuple[bool, bool, float]:
        """The higher of two is rather to be believed: it was seen twice, is certain, has more support."""
        return NOBODY not in self.owners, self.is_certain, self.sighting.track.support


class Segment:
    """Sightings of what is taken for one target.

    Attributes
    ----------
    seen : list of Seen
        In order of time, one for each frame.
    """

    def __init__(self, seen: Sequence[Seen]) -> None:
        self.seen = list(seen)

    @property
    def label(self) -> str:
        """Of its color."""
        return self.seen[0].sighting.label

    @property
    def begin(self) -> int:
        """Its first frame."""
        return self.seen[0].frame

    @property
    def end(self) -> int:
        """Its last frame."""
        return self.seen[-1].frame

    def owner(self, side: int, at_end: bool) -> int:
        """Return whose it is forward (0) or backward (1), as far as that is known nearest to one of its ends."""
        seen = reversed(self.seen) if at_end else iter(self.seen)
        return next((each.owners[side] for each in seen if each.owners[side] != NOBODY), NOBODY)


def segments(
    forward: Sequence[Sequence[OwnedSighting]], backward: Sequence[Sequence[OwnedSighting]], limits: JoiningParameters
) -> list[Segment]:
    """Join two readings, both frame by frame in order of time, into segments, in order of their first frames."""
    from scipy.sparse import coo_array  # slow to load, see `assigned`
    from scipy.sparse.csgraph import connected_components

    seen = [
        each
        for frame, (ahead, back) in enumerate(zip(forward, backward, strict=True))
        for each in _of_frame(frame, _one_each(ahead), _one_each(back), limits)
    ]
    same = np.array([pair for side in (0, 1) for pair in _same(seen, side, limits.apart)], int).reshape(-1, 2)
    graph = coo_array((np.ones(len(same), bool), (same[:, 0], same[:, 1])), shape=(len(seen), len(seen)))
    count, numbers = connected_components(graph, directed=False)
    groups: list[list[Seen]] = [[] for _ in range(count)]
    for number, each in zip(numbers.tolist(), seen, strict=True):
        groups[number].append(each)
    found = [Segment(single_frames(group)) for group in groups]
    return sorted(_split(found, limits.least), key=lambda each: each.begin)


def single_frames(seen: Sequence[Seen]) -> list[Seen]:
    """Return one sighting for each frame, that which is rather to be believed, in order of time."""
    best = {each.frame: each for each in sorted(seen, key=lambda each: each.rank)}
    return [best[frame] for frame in sorted(best)]


def _one_each(sightings: Sequence[OwnedSighting]) -> list[OwnedSighting]:
    """Return one sighting of each owner: a certain one, or that with most support."""
    ordered = sorted(sightings, key=lambda each: (each.is_certain, each.sighting.track.support))
    return list({each.owner: each for each in ordered}.values())


def _of_frame(
    frame: int, ahead: Sequence[OwnedSighting], back: Sequence[OwnedSighting], limits: JoiningParameters
) -> list[Seen]:
    """Join the outlines of a frame."""
    costs = [[_apart(one.sighting, other.sighting, limits) for other in back] for one in ahead]
    table = np.array(costs).reshape(len(ahead), len(back))
    pairs = zip(*assigned(table), strict=True)
    joined = {int(one): int(other) for one, other in pairs if table[one, other] < 1.0}
    found = [_seen(frame, one, back[joined[k]] if k in joined else None) for k, one in enumerate(ahead)]
    alone = sorted(set(range(len(back))) - set(joined.values()))
    return found + [_seen(frame, None, back[k]) for k in alone]


def _seen(frame: int, ahead: OwnedSighting | None, back: OwnedSighting | None) -> Seen:
    """Make one of what both readings saw, or one of them."""
    both = [each for each in (ahead, back) if each is not None]
    best = max(both, key=lambda each: each.sighting.track.support)
    owners = [NOBODY if each is None else each.owner for each in (ahead, back)]
    tracklets = [NOBODY if each is None else each.tracklet for each in (ahead, back)]
    is_certain = all(each.is_certain for each in both)
    return Seen(frame, best.sighting, (owners[0], owners[1]), (tracklets[0], tracklets[1]), is_certain)


def _apart(one: Sighting, other: Sighting, limits: JoiningParameters) -> float:
    """Return how far two outlines are apart, as a share of what they may be; 2 at most."""
    if one.label != other.label:
        return 2.0
    a, b = one.place, other.place
    far = a.distance(b) / (limits.distance * max(a.half_width, b.half_width))
    return min(max(far, abs(math.log(a.half_width / b.half_width)) / limits.log_size), 2.0)


def _same(seen: Sequence[Seen], side: int, apart: float) -> list[tuple[int, int]]:
    """Pairs of consecutive sightings of a target of one reading, of which the other one says nothing else."""
    chains: dict[int, list[int]] = {}
    for number, each in enumerate(seen):
        if each.owners[side] != NOBODY:
            chains.setdefault(each.owners[side], []).append(number)
    there = {(each.frame, each.owners[1 - side]): each.sighting.place for each in seen}
    pairs = list[tuple[int, int]]()
    for chain in chains.values():
        others = [seen[number].owners[1 - side] for number in chain]
        before, after = _filled(others), _filled(others[::-1])[::-1]
        elsewhere = [
            other == NOBODY
            and any(_is_far(seen[number], there.get((seen[number].frame, name)), apart) for name in names)
            for number, other, *names in zip(chain, others, before, after, strict=True)
        ]
        for k, pair in enumerate(itertools.pairwise(chain)):
            agreed = NOBODY in (before[k], after[k + 1]) or before[k] == after[k + 1]
            if (others[k] == others[k + 1] or agreed) and elsewhere[k] == elsewhere[k + 1]:
                pairs.append(pair)
    return pairs


def _is_far(seen: Seen, place: Gate | None, apart: float) -> bool:
    """Whether a target that the other reading has at a place, if it has, is not what is seen."""
    mine = seen.sighting.place
    return place is not None and mine.distance(place) > apart * max(mine.half_width, place.half_width)


def _filled(owners: Sequence[int]) -> list[int]:
    """Put the last owner that there was where there is none."""
    last, filled = NOBODY, list[int]()
    for each in owners:
        last = each if each != NOBODY else last
        filled.append(last)
    return filled


def _split(found: Sequence[Segment], least: int) -> list[Segment]:
    """Split segments where another one lies in a gap that one of the readings took for the same target."""
    long_ones = [each for each in found if len(each.seen) >= least]
    parts = list[Segment]()
    for one in found:
        inside = [each for each in long_ones if one.begin < each.begin and each.end < one.end and _may_be(one, each)]
        part = [one.seen[0]]
        for last, following in zip(one.seen, one.seen[1:], strict=False):
            if any(last.frame < each.begin and each.end < following.frame for each in inside):
                parts.append(Segment(part))
                part = []
            part.append(following)
        parts.append(Segment(part))
    return parts


def _may_be(one: Segment, other: Segment) -> bool:
    """Whether one of the readings took two segments for one target."""
    return any(one.owner(side, True) == other.owner(side, True) != NOBODY for side in (0, 1))
