"""How well one segment goes on in another one, by how targets move, forward and backward in time (`MotionOdds`)."""

import math
from collections.abc import Sequence

import msgspec

from matchset.tracking.many.linking import LinkingParameters
from matchset.tracking.many.motion_bank import ManyMotionParameters, MotionBank, Predicted
from matchset.tracking.many.smoothing.joining import Seen, Segment


class MotionOddsParameters(msgspec.Struct, frozen=True, kw_only=True):
    """From which sightings it is judged that one segment goes on in another one.

    Chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#smoothing); `python -m benchmarks.crowds` would show
    a change.

    Parameters
    ----------
    before, after : int
        Sightings from which the motion of the first segment is known, and of the second one by which it is judged.
    certain : int
        What was in doubt at the ends is left out as long as so many sightings remain.
    changed : float
        Log-odds against a motion that has nothing to do with the one before, as after a throw.
    least : float
        Least log-odds of one direction of time: less lets one of both decide alone.
    speed, near : float
        What would be faster is not judged at all: half-widths/s, and half-widths beside that.
    """

    before: int = 30
    after: int = 10
    certain: int = 6
    changed: float = 1.0
    least: float = -30.0
    speed: float = 90.0
    near: float = 3.0


class _Direction:
    """The same in one direction of time, 1 or -1."""

    def __init__(
        self,
        times: Sequence[float],
        sign: int,
        limits: MotionOddsParameters,
        motion: ManyMotionParameters,
        linking: LinkingParameters,
    ) -> None:
        self._times, self._sign, self._limits, self._linking = times, sign, limits, linking
        self._motion = motion
        self._ends: dict[Segment, tuple[MotionBank, int]] = {}
        self._alone: dict[Segment, float] = {}
        self._new = -linking.new_log - 2.0 * math.log(linking.new_px)

    def odds(self, before: Segment, after: Segment) -> float:
        """Log-odds that a segment goes on in another one, against a new target."""
        before, after = (before, after) if self._sign > 0 else (after, before)
        seen = self._clear(after.seen[:: self._sign])[: self._limits.after]
        first = seen[0].sighting
        if before not in self._ends:
            self._ends[before] = self._end(self._clear(before.seen[:: -self._sign])[self._limits.before - 1 :: -1])
        if after not in self._alone:
            alone = MotionBank(1, self._motion)
            self._alone[after] = self._new + self._log(alone, alone.begin(first.place, self._time(seen[0])), seen[1:])
        bank, slot = self._ends[before]
        there = Predicted(bank, self._time(seen[0])).likelihood(slot, first.place, first.variance)
        changed = there.log - self._new - self._limits.changed
        kept = self._log(bank, bank.copied(slot), seen) - self._alone[after]
        return max(kept, changed, self._limits.least)

    def _time(self, seen: Seen) -> float:
        return self._sign * self._times[seen.frame]

    def _clear(self, seen: Sequence[Seen]) -> Sequence[Seen]:
        """Leave out what is in doubt at the beginning."""
        first = next((k for k, each in enumerate(seen) if each.is_certain), 0)
        return seen[first:] if len(seen) - first >= self._limits.certain else seen

    def _end(self, seen: Sequence[Seen]) -> tuple[MotionBank, int]:
        """Return the motion at the end of sightings, in a bank of its own: all of a bank is predicted each time."""
        bank = MotionBank(2, self._motion)
        slot = bank.begin(seen[0].sighting.place, self._time(seen[0]))
        for each in seen[1:]:
            bank.correct([slot], [each.sighting], self._time(each))
        return bank, slot

    def _log(self, bank: MotionBank, slot: int, seen: Sequence[Seen]) -> float:
        """Log-likelihood of sightings as the next ones of a slot, which is used up by it."""
        total = 0.0
        for number, each in enumerate(seen):
            time, sighting = self._time(each), each.sighting
            explained = Predicted(bank, time).likelihood(slot, sighting.place, sighting.variance)
            total += max(explained.log, self._linking.least)
            if explained.halted and number == 0:  # it may go on in any direction
                bank.free(slot)
                slot = bank.begin(sighting.place, time)
            else:
                bank.correct([slot], [sighting], time)
        bank.free(slot)
        return total


class MotionOdds:
    """How well segments go on in others, by how targets move.

    Parameters
    ----------
    times : sequence of float
        Of the frames, s.
    limits : MotionOddsParameters
    motion : ManyMotionParameters
    linking : LinkingParameters
        What a new target and one bad sighting cost.
    """

    def __init__(
        self,
        times: Sequence[float],
        limits: MotionOddsParameters,
        motion: ManyMotionParameters,
        linking: LinkingParameters,
    ) -> None:
        self._times, self._limits = times, limits
        self._forward, self._backward = (_Direction(times, sign, limits, motion, linking) for sign in (1, -1))

    def forward(self, before: Segment, after: Segment) -> float:
        """Log-odds that a segment goes on in another one, by how that begins."""
        return self._forward.odds(before, after)

    def backward(self, before: Segment, after: Segment) -> float:
        """Log-odds that a segment goes on in another one, by how the first one ends, seen from the second one."""
        return self._backward.odds(before, after)

    def is_near(self, before: Seen, after: Seen) -> bool:
        """Whether something could be at one place and then at another one."""
        passed = abs(self._times[after.frame] - self._times[before.frame])
        one, other = before.sighting.place, after.sighting.place
        reach = self._limits.near + self._limits.speed * passed
        return one.distance(other) < reach * max(one.half_width, other.half_width)
