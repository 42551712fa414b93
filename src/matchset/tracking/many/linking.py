"""Which target a tracklet is of: decided by what is seen of all while it is in doubt (`Linking`)."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.tracking.many.assignment import assigned
from matchset.tracking.many.motion_bank import ManyMotionParameters, MotionBank, Predicted
from matchset.tracking.many.sightings import Sighting
from matchset.tracking.many.tracklet import Followed, Hypothesis, Observed, Tracklet

FORBIDDEN = 1e6  # format: cost of what cannot be, which SciPy's solver takes for a number


class LinkingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How tracklets are linked with targets.

    All chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#association); `python -m benchmarks.crowds` would
    show a change.

    Parameters
    ----------
    gate : float
        Squared distance of center, and of size, in standard deviations, up to which a sighting may be a target.
    least : float
        Least log-likelihood of one sighting: less lets one bad fit decide.
    touching : float
        Distance from where a target was expected that was lost, in half-widths, up to which a tracklet may be of it.
    clear : float
        Log-odds of the best joint explanation against the best other one from which there is no doubt.
    stays : float
        Log-odds of what was taken in the frame before: more changes names less often while they are in doubt.
    decide : int
        Sightings of a tracklet after which the likeliest explanation is taken in any case.
    new_log : float
        Log-likelihood of a new target: that of one in a square of `new_px` px, less this.
    new_px : float
        See there.
    chance : float
        Log-likelihood up to which what only a search for a hidden target has found is taken for chance.
    """

    least: float = -30.0
    gate: float = 25.0
    touching: float = 0.9
    clear: float = 3.0
    stays: float = 2.0
    decide: int = 12
    new_log: float = 8.0
    new_px: float = 60.0
    chance: float = -12.0


class Linking:
    """Targets and tracklets, and which are whose.

    Parameters
    ----------
    most : int
        How many targets there may be.
    motion : ManyMotionParameters
    limits : LinkingParameters

    Attributes
    ----------
    targets : list of Followed
    tracklets : list of Tracklet
    bank : MotionBank
    births : bool
        Whether what is found may be a new target; otherwise only what somebody said shall be followed.
    left_out : int
        How many were found at last for which there was no room.
    """

    def __init__(self, most: int, motion: ManyMotionParameters, limits: LinkingParameters) -> None:
        self.most, self.limits = most, limits
        self.bank = MotionBank(4 * most, motion)
        self.births = True
        self.left_out = 0
        self.targets: list[Followed] = []
        self.tracklets: list[Tracklet] = []
        assigned(np.zeros((1, 1)))  # so that no frame waits for SciPy

    def hidden(self) -> list[Followed]:
        """Targets that are not seen."""
        return [each for each in self.targets if each.tracklet is None]

    def candidates(self) -> list[Followed]:
        """Targets, and new ones that tracklets in doubt are taken for now."""
        in_doubt = [each.target for each in self.tracklets if not each.is_certain]
        return [*self.targets, *(owner for owner in in_doubt if owner is not None and owner not in self.targets)]

    def bridge(self, seen: Observed, predicted: Predicted) -> list[Tracklet]:
        """Let tracklets in doubt go on with what was found anew where their trackers lost them.

        Of a target that was seen once no velocity is known, and its tracker does not find it where it has moved far.
        What a search finds in the same frame is likelier the same than a new one.
        """
        open_ones = [each for each in seen.ended if not each.is_certain]
        if not (open_ones and seen.fresh):
            return []
        table = np.full((len(open_ones), len(seen.fresh)), FORBIDDEN)
        for row, tracklet in enumerate(open_ones):
            for column, sighting in enumerate(seen.fresh):
                if sighting.label == tracklet.label and sighting.identity is None and sighting.sure:
                    table[row, column] = -self._explained(tracklet, sighting, predicted)
        rows, columns = assigned(table)
        bridged = [
            (open_ones[row], seen.fresh[column])
            for row, column in zip(rows.tolist(), columns.tolist(), strict=True)
            if table[row, column] < -self._new_score
        ]
        for tracklet, sighting in bridged:
            seen.ended.remove(tracklet)
            seen.fresh.remove(sighting)
            seen.continued[tracklet] = sighting
        return [tracklet for tracklet, _ in bridged]

    def _explained(self, tracklet: Tracklet, sighting: Sighting, predicted: Predicted) -> float:
        """Log-likelihood of a sighting by the likeliest hypothesis of a tracklet; that of nothing where none may be."""
        explained = [
            predicted.likelihood(each.slot, sighting.place, sighting.variance) for each in tracklet.hypotheses.values()
        ]
        return max((each.log for each in explained if each.squared < self.limits.gate), default=-FORBIDDEN)

    @property
    def _new_score(self) -> float:
        """Log-likelihood of a sighting as that of a new target."""
        return -self.limits.new_log - 2.0 * math.log(self.limits.new_px)

    def end(self, ended: Sequence[Tracklet], time: float) -> list[Followed]:
        """End tracklets, at a time, s; return the targets that were lost with them. Of one in doubt nothing is kept."""
        lost = list[Followed]()
        for tracklet in ended:
            for each, hypothesis in tracklet.hypotheses.items():
                if each.tracklet is tracklet:
                    each.tracklet = None
                if not tracklet.is_certain:
                    self.bank.free(hypothesis.slot)
                else:
                    each.take_probe(tracklet, time)
                    lost.append(each)
            self.tracklets.remove(tracklet)
        return lost

    def doubt(self, lost: Sequence[Followed], seen: dict[Tracklet, Sighting], predicted: Predicted) -> None:
        """Doubt whose the tracklets are that are where targets were lost: these may be what is seen there."""
        for each in lost:
            place, _ = predicted.likeliest(each.slot)
            for tracklet, sighting in seen.items():
                reach = self.limits.touching * max(place.half_width, sighting.place.half_width)
                if each.label != tracklet.label or each in tracklet.hypotheses:
                    continue
                if place.distance(sighting.place) > reach:
                    continue
                self._doubt_also(tracklet, each, each.slot)

    def _doubt_also(self, tracklet: Tracklet, target: Followed, slot: int) -> None:
        """Let a tracklet be of another target, too, by the filters of a slot, and as likely as of the likeliest."""
        if tracklet.is_certain:
            owner = next(iter(tracklet.hypotheses))
            tracklet.hypotheses[owner] = Hypothesis(self.bank.copied(owner.slot), 0.0)
            tracklet.is_certain = False
        score = max(hypothesis.score for hypothesis in tracklet.hypotheses.values())
        tracklet.hypotheses[target] = Hypothesis(self.bank.copied(slot), score)
        tracklet.doubted = 0

    def foresee(self, time: float) -> None:
        """Foresee which targets on a table hit each other until a time, s."""
        groups = [[hypothesis.slot for hypothesis in each.hypotheses.values()] for each in self.tracklets]
        self.bank.foresee([*groups, *([each.slot] for each in self.hidden())], time)

    def doubt_rivals(self, seen: dict[Tracklet, Sighting], predicted: Predicted, rival: float) -> None:
        """Doubt whose the tracklets are that on a table another target explains nearly as well as their own."""
        slots = {
            each: each.slot if each.tracklet is None else each.tracklet.hypotheses[each].slot for each in self.targets
        }
        for tracklet, sighting in seen.items():
            if not tracklet.is_certain:
                continue
            owner = tracklet.owner()
            own = predicted.likelihood(slots[owner], sighting.place, sighting.variance).log
            for each, slot in slots.items():
                if each.label != tracklet.label or each is owner:
                    continue
                if predicted.likelihood(slot, sighting.place, sighting.variance).log < own + rival:
                    continue
                self._doubt_also(tracklet, each, slot)

    def go_on(self, seen: dict[Tracklet, Sighting], time: float, calm: bool) -> None:
        """Correct the filters of all hypotheses of tracklets by their new sightings, and weigh those in doubt.

        In a `calm` frame, if all targets are seen for certain, the sightings are noted only.
        """
        slots, sightings = list[int](), list[Sighting]()
        doubted = any(not tracklet.is_certain for tracklet in seen)
        predicted = Predicted(self.bank, time) if doubted else None
        for tracklet, sighting in seen.items():
            tracklet.sighting = sighting
            for hypothesis in tracklet.hypotheses.values():
                if predicted is not None and not tracklet.is_certain:
                    explained = predicted.likelihood(hypothesis.slot, sighting.place, sighting.variance)
                    hypothesis.score += max(explained.log, self.limits.least)
                slots.append(hypothesis.slot)
                sightings.append(sighting)
            tracklet.doubted += not tracklet.is_certain
        if not calm or doubted or len(seen) < len(self.targets):
            self.bank.correct(slots, sightings, time)
        else:
            self.bank.note(slots, sightings, time)

    def begin(self, fresh: Sequence[Sighting], predicted: Predicted, time: float) -> None:
        """Begin tracklets with what nobody follows yet: each is of a target that is not seen for certain, or new."""
        begun = list[Tracklet]()
        left_out = 0
        for sighting in fresh:
            tracklet = Tracklet(sighting.label, sighting)
            for each in () if sighting.identity is not None else self.targets:
                if each.label != sighting.label or (each.tracklet is not None and each.tracklet.is_certain):
                    continue
                explained = predicted.likelihood(each.slot, sighting.place, sighting.variance)
                likely = sighting.sure or explained.log > self.limits.chance
                if explained.squared < self.limits.gate and likely:
                    slot = self._slot_after(each, sighting, explained.halted, time)
                    tracklet.hypotheses[each] = Hypothesis(slot, explained.log)
            may_be_new = sighting.sure and (self.births or sighting.identity is not None)
            is_full = may_be_new and self._count_with([*self.tracklets, *begun]) >= self.most
            left_out += is_full and not tracklet.hypotheses
            if may_be_new and not is_full:
                new = Followed(sighting.label, self.bank.begin(sighting.place, time), sighting)
                tracklet.hypotheses[new] = Hypothesis(new.slot, self._new_score)
            if tracklet.hypotheses:
                tracklet.doubted = 1
                for each in self.targets:
                    if each.probe is not None and each.probe is sighting.tracker:
                        each.probe = each.probed = None
                begun.append(tracklet)
        self.tracklets += begun
        if fresh or len(self.targets) < self.most:
            self.left_out = left_out

    def take(self, sighting: Sighting, hidden: bool) -> None:
        """Take over a target that was seen before; `hidden`: it is not seen any more."""
        new = Followed(sighting.label, self.bank.begin(sighting.place, sighting.track.time), sighting)
        self.targets.append(new)
        if hidden:
            return
        new.tracklet = Tracklet(sighting.label, sighting)
        new.tracklet.hypotheses, new.tracklet.is_certain = {new: Hypothesis(new.slot, 0.0)}, True
        self.tracklets.append(new.tracklet)

    def _count_with(self, tracklets: Sequence[Tracklet]) -> int:
        """Count the targets, with the new ones that tracklets in doubt may be of."""
        known = set(self.targets)
        return len(known) + sum(not known.issuperset(each.hypotheses) for each in tracklets)

    def _slot_after(self, each: Followed, sighting: Sighting, halted: bool, time: float) -> int:
        """Return filters as a target's after a sighting; one that has halted may go on in any direction."""
        if halted:
            return self.bank.begin(sighting.place, time)
        slot = self.bank.copied(each.slot)
        self.bank.correct([slot], [sighting], time)
        return slot

    def decide(self, time: float) -> list[Tracklet]:
        """Take the best joint explanation of all tracklets, and end doubts where no other is nearly as good.

        Returns those that can be of no target, and are forgotten.
        """
        dropped = list[Tracklet]()
        open_ones = [each for each in self.tracklets if not each.is_certain]
        if open_ones:
            chosen, cost, table, columns = self._best(open_ones)
            for tracklet in open_ones:
                for each in tracklet.hypotheses:
                    if each.tracklet is tracklet:
                        each.tracklet = None
            for row, tracklet in enumerate(open_ones):
                column = chosen[row]
                if column is not None:
                    columns[column].tracklet = tracklet
            for row, tracklet in enumerate(open_ones):
                column = chosen[row]
                if column is None:
                    self._drop(tracklet)
                    dropped.append(tracklet)
                elif (
                    tracklet.doubted >= self.limits.decide or self._margin(table, row, column, cost) > self.limits.clear
                ):
                    self._settle(tracklet, columns[column])
            dropped += self._remove_taken()
        for tracklet in self.tracklets:
            if (owner := tracklet.target) is not None:
                owner.sightings += 1
                if tracklet.is_certain:
                    owner.seen, owner.last = time, tracklet.sighting
        return dropped

    def _best(
        self, open_ones: Sequence[Tracklet]
    ) -> tuple[list[int | None], float, npt.NDArray[np.float64], list[Followed]]:
        columns = list(dict.fromkeys(each for tracklet in open_ones for each in tracklet.hypotheses))
        table = np.full((len(open_ones), len(columns) + len(open_ones)), FORBIDDEN)
        for row, tracklet in enumerate(open_ones):
            for column, each in enumerate(columns):
                if each in tracklet.hypotheses:
                    stays = self.limits.stays if each.tracklet is tracklet else 0.0
                    table[row, column] = -tracklet.hypotheses[each].score - stays
        rows, taken = assigned(table)
        chosen: list[int | None] = [None] * len(open_ones)
        for row, column in zip(rows.tolist(), taken.tolist(), strict=True):
            chosen[row] = column if column < len(columns) and table[row, column] < FORBIDDEN else None
        return chosen, float(table[rows, taken].sum()), table, columns

    def _margin(self, table: npt.NDArray[np.float64], row: int, column: int, cost: float) -> float:
        """By how much more the best explanation costs in which a tracklet is not of its target."""
        kept, table[row, column] = table[row, column], FORBIDDEN
        rows, taken = assigned(table)
        other = float(table[rows, taken].sum())
        table[row, column] = kept
        return other - cost

    def _settle(self, tracklet: Tracklet, owner: Followed) -> None:
        """End the doubt about a tracklet: it is of this target."""
        hypothesis = tracklet.hypotheses[owner]
        for each, other in tracklet.hypotheses.items():
            if each is not owner:
                self.bank.free(other.slot)
                if each.tracklet is tracklet:
                    each.tracklet = None
        if owner.slot != hypothesis.slot:
            self.bank.free(owner.slot)
            owner.slot = hypothesis.slot
        tracklet.hypotheses = {owner: hypothesis}
        tracklet.is_certain, tracklet.doubted = True, 0
        if owner not in self.targets:
            self.targets.append(owner)

    def _remove_taken(self) -> list[Tracklet]:
        """Remove hypotheses of targets that are certainly elsewhere; return the tracklets that have no other."""
        dropped = list[Tracklet]()
        for tracklet in [each for each in self.tracklets if not each.is_certain]:
            taken = [each for each in tracklet.hypotheses if each.tracklet not in (None, tracklet)]
            taken = [each for each in taken if each.tracklet is not None and each.tracklet.is_certain]
            if len(taken) == len(tracklet.hypotheses):
                self._drop(tracklet)
                dropped.append(tracklet)
                continue
            for each in taken:
                self.bank.free(tracklet.hypotheses.pop(each).slot)
        return dropped

    def _drop(self, tracklet: Tracklet) -> None:
        """Forget a tracklet that can be of no target."""
        for hypothesis in tracklet.hypotheses.values():
            self.bank.free(hypothesis.slot)
        self.tracklets.remove(tracklet)

    def forget(self, time: float, memory: float, unconfirmed: float) -> None:
        """Forget targets that were not seen for longer than this, s; the second time for those without an identity."""
        for each in self.hidden():
            if time - each.seen > (unconfirmed if each.identity is None else memory):
                self.remove(each)

    def remove(self, target: Followed) -> list[Tracklet]:
        """Forget a target; return the tracklets that end with it."""
        self.targets.remove(target)
        ended = list[Tracklet]()
        for tracklet in [each for each in self.tracklets if target in each.hypotheses]:
            hypothesis = tracklet.hypotheses.pop(target)
            if not tracklet.is_certain:
                self.bank.free(hypothesis.slot)
            if not tracklet.hypotheses:
                self.tracklets.remove(tracklet)
                ended.append(tracklet)
        self.bank.free(target.slot)
        return ended
