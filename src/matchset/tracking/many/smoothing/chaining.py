"""Which segments are of one target: decided for all together (`chains`)."""

import bisect
import heapq
import math
from collections.abc import Iterator, Sequence

import msgspec
import numpy as np

from matchset.tracking.many.smoothing.joining import NOBODY, Seen, Segment, single_frames
from matchset.tracking.many.smoothing.motion_odds import MotionOdds


class ChainingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How segments are linked into chains.

    Chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#smoothing); `python -m benchmarks.crowds` would show
    a change.

    Parameters
    ----------
    least : int
        Sightings from which a segment is linked with others; shorter ones are put into the gaps that are left.
    same, kept : float
        Log-odds that a reading gives two segments that it takes for one target; and how much more the forward one does:
        where nothing tells two explanations apart the names stay that `update` gives.
    followed : float
        The same if its tracker went on without a gap.
    overlap : int
        In how many frames two readings may see the end of a segment beside the beginning of the one that goes on.
    overlapped : float
        What each of these frames costs: a target is in one place.
    nearest : int
        Into how many of the nearest chains it is tried to put a short segment.
    """

    least: int = 5
    same: float = 4.0
    kept: float = 2.0
    followed: float = 4.0
    overlap: int = 5
    overlapped: float = 2.0
    nearest: int = 4


class _Chain:
    """Sightings of one target, in order of time, into which more can be put."""

    def __init__(self, seen: Sequence[Seen]) -> None:
        self.seen = list(seen)
        self._frames = [each.frame for each in seen]

    def around(self, segment: Segment, count: int) -> tuple[Segment | None, Segment | None] | None:
        """Return what comes before and after a segment; None where that does not fit in."""
        at = bisect.bisect_left(self._frames, segment.begin)
        if self._frames[at : at + len(segment.seen)] and not self._is_free(segment):
            return None
        behind = bisect.bisect_right(self._frames, segment.end)
        before, after = self.seen[max(at - count, 0) : at], self.seen[behind : behind + count]
        return Segment(before) if before else None, Segment(after) if after else None

    def put(self, segment: Segment) -> None:
        """Put a segment in that fits."""
        for each in segment.seen:
            at = bisect.bisect_left(self._frames, each.frame)
            self._frames.insert(at, each.frame)
            self.seen.insert(at, each)

    def _is_free(self, segment: Segment) -> bool:
        places = ((each.frame, bisect.bisect_left(self._frames, each.frame)) for each in segment.seen)
        return all(at == len(self._frames) or self._frames[at] != frame for frame, at in places)


class Chaining:
    """Links segments.

    Parameters
    ----------
    times : sequence of float
        Of the frames, s.
    memory : float
        How long a target may be unseen, s.
    limits : ChainingParameters
    odds : MotionOdds
    """

    def __init__(self, times: Sequence[float], memory: float, limits: ChainingParameters, odds: MotionOdds) -> None:
        self._times, self._memory, self._limits, self._odds = times, memory, limits, odds

    def chains(self, segments: Sequence[Segment], context: int) -> list[list[Seen]]:
        """Return the sightings of each target.

        Parameters
        ----------
        segments : sequence of Segment
            In order of their first frames.
        context : int
            Sightings around a gap by which what may fill it is judged.
        """
        found = [
            _Chain(single_frames(seen)) for seen in self._linked([each for each in segments if self._is_long(each)])
        ]
        rest = self._fill(found, [each for each in segments if not self._is_long(each)], context)
        found += [_Chain(each.seen) for each in rest if len(each.seen) > 1 and _is_of_both(each)]
        return [each.seen for each in found]

    def _is_long(self, segment: Segment) -> bool:
        return len(segment.seen) >= self._limits.least

    def _linked(self, segments: Sequence[Segment]) -> list[list[Seen]]:
        """Link segments so that the sum of the log-odds of all links is as large as it can be."""
        links = [(a, b, odds) for a, b in self._pairs(segments) if (odds := self._pair(segments[a], segments[b])) > 0.0]
        following = best_links(len(segments), links)
        chains = list[list[Seen]]()
        for first in sorted(set(range(len(segments))) - set(following.values())):
            chain, number = list(segments[first].seen), first
            while number in following:
                number = following[number]
                chain += segments[number].seen
            chains.append(chain)
        return chains

    def _pairs(self, segments: Sequence[Segment]) -> Iterator[tuple[int, int]]:
        """Pairs of which the second one begins about where the first one ends, or not much later."""
        begins = [each.begin for each in segments]
        for number, one in enumerate(segments):
            first = bisect.bisect_right(begins, one.end - self._limits.overlap)
            for other in range(first, len(segments)):
                if self._times[begins[other]] - self._times[one.end] > self._memory:
                    break
                later = one.begin < begins[other] and one.end < segments[other].end
                near = self._odds.is_near(one.seen[-1], segments[other].seen[0])
                if later and near and one.label == segments[other].label:
                    yield number, other

    def _pair(self, one: Segment, other: Segment) -> float:
        """Log-odds that a segment goes on in another one."""
        common = max(one.end - other.begin + 1, 0)
        if common:
            end, begin = one.end, other.begin
            one = Segment([each for each in one.seen if each.frame < begin])
            other = Segment([each for each in other.seen if each.frame > end])
        odds = 0.5 * (self._odds.forward(one, other) + self._odds.backward(one, other))
        return odds + self._agreed(one, other) - self._limits.overlapped * common

    def _agreed(self, one: Segment, other: Segment) -> float:
        """Log-odds of what the readings themselves said."""
        ahead, back = (one.owner(side, True) == other.owner(side, False) != NOBODY for side in (0, 1))
        last, first = one.seen[-1], other.seen[0]
        trackers = sum(a == b != NOBODY for a, b in zip(last.tracklets, first.tracklets, strict=True))
        followed = self._limits.followed * trackers * (first.frame == last.frame + 1)
        return self._limits.same * (ahead + back) + self._limits.kept * ahead + followed

    def _fill(self, chains: Sequence[_Chain], segments: Sequence[Segment], context: int) -> list[Segment]:
        """Put short segments where they fit in, the likeliest first; return those that fit nowhere."""
        wanted = list[tuple[float, int, int]]()
        for number, segment in enumerate(segments):
            far = [(_distance(chain, segment), place) for place, chain in enumerate(chains)]
            for _, place in heapq.nsmallest(self._limits.nearest, far):
                odds = self._fit(chains[place], segment, context)
                if odds > 0.0:
                    wanted.append((odds, number, place))
        rest = set(range(len(segments)))
        for _, number, place in sorted(wanted, reverse=True):
            if number in rest and chains[place].around(segments[number], 1) is not None:
                chains[place].put(segments[number])
                rest.remove(number)
        return [segments[number] for number in sorted(rest)]

    def _fit(self, chain: _Chain, segment: Segment, context: int) -> float:
        """Log-odds that a segment is of a chain, by what is seen of that before and after it; 0 if it cannot be."""
        around = chain.around(segment, context) if segment.label == chain.seen[0].sighting.label else None
        if around is None:
            return 0.0
        before, after = around
        odds, agreed = list[float](), 0.0
        if before is not None and self._may_follow(before.seen[-1], segment.seen[0]):
            odds.append(self._odds.forward(before, segment))
            agreed = self._agreed(before, segment)
        if after is not None and self._may_follow(segment.seen[-1], after.seen[0]):
            odds.append(self._odds.backward(segment, after))
            agreed = max(agreed, self._agreed(segment, after))
        return sum(odds) / len(odds) + agreed if odds else 0.0

    def _may_follow(self, before: Seen, after: Seen) -> bool:
        """Whether sightings are near enough, in time and place."""
        passed = self._times[after.frame] - self._times[before.frame]
        return passed <= self._memory and self._odds.is_near(before, after)


def best_links(count: int, links: Sequence[tuple[int, int, float]]) -> dict[int, int]:
    """Choose links so that each of so many segments has one on each side at most, with the largest sum of log-odds.

    Parameters
    ----------
    count : int
    links : sequence of (int, int, float)
        From a segment to another one, with positive log-odds.

    Returns
    -------
    dict of int to int
    """
    from scipy.sparse import coo_array  # slow to load, see `assigned`
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    if not links:
        return {}
    rows, columns, odds = (np.array(each) for each in zip(*links, strict=True))
    none = np.arange(count)  # each may go on in nothing: a column of its own
    most = 1.0 + float(odds.max())
    costs = np.concatenate((most - odds, np.full(count, most)))
    at = np.concatenate((rows, none)), np.concatenate((columns, count + none))
    taken = min_weight_full_bipartite_matching(coo_array((costs, at), shape=(count, 2 * count)).tocsr())
    return {row: column for row, column in zip(*(each.tolist() for each in taken), strict=True) if column < count}


def _distance(chain: _Chain, segment: Segment) -> float:
    """Return how far a segment is from what a chain has before it or after it, px; infinite if it does not fit in."""
    before, after = chain.around(segment, 1) or (None, None)
    pairs = [(each, segment.seen[at]) for each, at in ((before, 0), (after, -1)) if each is not None]
    return min((one.seen[0].sighting.place.distance(other.sighting.place) for one, other in pairs), default=math.inf)


def _is_of_both(segment: Segment) -> bool:
    """Whether both readings have seen something of a segment."""
    return NOBODY not in (segment.owner(0, True), segment.owner(1, True))
