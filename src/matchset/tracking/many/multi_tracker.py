"""Follow several targets at once, in pixels: `MultiTracker`."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import ArrayFrames, Frame, Picture, channels_last, check_follows
from matchset.numeric.arguments import check_kind, checked_count
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.many.association import AssociationParameters, associate, distances
from matchset.tracking.many.followed import Followed, Group
from matchset.tracking.many.motion_bank import ManyMotionParameters, MotionBank, Predicted
from matchset.tracking.many.sightings import MergeParameters, Sighting, merged, sighting_of
from matchset.tracking.many.strip_search import StripSearch, StripSearchParameters
from matchset.tracking.many.target import Target
from matchset.tracking.motion import Gate
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.voting import SearchParameters
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker

ONE_OF_SEVERAL = TrackerParameters(search=SearchParameters(whole_frame=False), network=NetworkParameters(looks=4))
MOST = 100  # format: targets at once

Floats = npt.NDArray[np.float64]
Colors = ColorModel | Sequence[ColorModel] | Mapping[str, ColorModel]


class MultiTrackerParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How several targets are kept apart.

    All chosen on rendered crowds, seeds 7 and 8 (docs/log/many.md); `python -m benchmarks.crowds` would show a change.

    Parameters
    ----------
    memory : float
        How long a target that is not seen keeps its identity, s.
    confirm : int
        Sightings from which something new has an identity.
    expected : float
        How long a target that is not seen is looked for where its motion would have it, s; later only the search can
        find it.
    restarts : int
        Frames in which a tracker is started anew where its target is expected, after that was hidden.
    points : int
        Lines across each outline, see `Tracker`.
    motion : ManyMotionParameters
    merge : MergeParameters
    association : AssociationParameters
    search : StripSearchParameters
    tracker : TrackerParameters
        Of each target's tracker; it must not search the whole frame.
    """

    memory: float = 2.0
    confirm: int = 2
    expected: float = 0.6
    restarts: int = 3
    hidden_distance: float = 0.9
    points: int = 64
    motion: ManyMotionParameters = ManyMotionParameters()
    merge: MergeParameters = MergeParameters()
    association: AssociationParameters = AssociationParameters()
    search: StripSearchParameters = StripSearchParameters()
    tracker: TrackerParameters = ONE_OF_SEVERAL


class MultiTracker(Copied):
    """Follows several targets at once; each keeps its identity while others cross or hide it."""

    def __init__(
        self,
        family: type[Any],
        colors: Colors,
        most: int = 20,
        parameters: MultiTrackerParameters | None = None,
        *,
        fps: float | None = 30.0,
    ) -> None:
        check_kind("parameters", parameters, (MultiTrackerParameters, type(None)))
        self.most = checked_count("most", most, 1, MOST)
        self.parameters = parameters or MultiTrackerParameters()
        self.colors = _named(colors)
        self._family = family
        self._searches = {
            label: StripSearch(family, color, self.parameters.search) for label, color in self.colors.items()
        }
        self._bank = MotionBank(2 * most, self.parameters.motion)
        self._targets: list[Followed] = []
        self._spare: dict[str, list[Tracker[Any]]] = {label: [] for label in self.colors}
        self._free = list(range(most))
        self._arrays = ArrayFrames(fps)
        self._count = self._frames = 0
        self._format: tuple[int, ...] | None = None
        self._time, self._passed = -math.inf, 1.0 / 30.0
        self._make_derived()

    @one_line
    def __repr__(self) -> str:
        names = ", ".join(str(each.identity) for each in self._targets if each.identity is not None)
        return f"MultiTracker({len(self._targets)} targets followed{names and ': ' + names}, {self._frames} frames)"

    def update(self, frame: Picture) -> list[Target[Any]]:
        """Track all targets in a frame, and search a strip of it for new ones."""
        frame = self._checked(frame)
        self._forget_old(frame.time)
        predicted = self._bank.predict(frame.time)
        sightings = self._follow(frame, predicted)
        found = self._search(frame, predicted, sightings)
        if found:
            sightings = merged([*sightings, *found], channels_last(frame.image), self.colors, self.parameters.merge)
        chosen, cost = self._associate(sightings, predicted)
        self._correct(frame, sightings, chosen, predicted, cost)
        self._begin(frame, sightings, chosen, predicted)
        return self._answers(frame, predicted)

    def _checked(self, picture: Picture) -> Frame:
        if type(picture) is not Frame or self._arrays.count:
            picture = self._arrays.next(picture, self._frames)
        check_follows(picture, self._format, self._time)
        if self._frames:
            self._passed = min(picture.time - self._time, 1.0)
        self._format, self._time = picture.image.shape, picture.time
        self._frames += 1
        return picture

    def _forget_old(self, time: float) -> None:
        limits = self.parameters
        for each in list(self._targets):
            gone = time - each.seen
            if gone > limits.memory or (each.identity is None and gone > 2.5 * self._passed):
                if each.group is not None:
                    each.group.remove(each)
                self._targets.remove(each)
                self._free.append(each.slot)
                self._spare[each.label].append(each.tracker)

    def _follow(self, frame: Frame, predicted: Predicted) -> list[Sighting]:
        """Track every target that may be in sight; of outlines that are one, one."""
        limits, found = self.parameters, []
        sigmas = limits.motion.center_sigma_px, limits.motion.center_sigma
        height, width = frame.image.shape[:2]
        for each in self._targets:
            place = each.expected(predicted)
            outside = not (
                -place.half_width < place.x < width + place.half_width
                and -place.half_width < place.y < height + place.half_width
            )
            if outside or frame.time - each.seen > limits.expected:
                each.own = False
                continue
            answer = each.follow(frame, predicted, self._passed)
            if isinstance(answer, Track):
                found.append(sighting_of(answer, sigmas, each.label, (each.slot,)))
        return merged(found, channels_last(frame.image), self.colors, limits.merge)

    def _search(self, frame: Frame, predicted: Predicted, sightings: list[Sighting]) -> list[Sighting]:
        """Search a strip for what nobody follows, and a quarter around one of those that were seen and are not."""
        limits, known = self.parameters, [each.place for each in sightings]
        sigmas = limits.motion.center_sigma_px, limits.motion.center_sigma
        labels = list(self.colors)
        label = labels[self._frames % len(labels)]
        found = [sighting_of(track, sigmas, label) for track in self._searches[label].update(frame, known)]
        followed = {slot for each in sightings for slot in each.owners}
        lost = [each for each in self._targets if each.slot not in followed]
        if lost:
            sought = min(lost, key=lambda each: (each.identity is not None, each.sought, -each.seen))
            sought.sought = frame.time
            tracks = self._searches[sought.label].near(
                frame, sought.expected(predicted), [*known, *(each.place for each in found)]
            )
            found += [sighting_of(track, sigmas, sought.label)._replace(sure=False) for track in tracks]
        return found

    def _associate(self, sightings: list[Sighting], predicted: Predicted) -> tuple[list[int], Floats]:
        """Likeliest sighting of every target, -1 for none; and the cost of each sighting as that which is seen."""
        limits, motion, targets = self.parameters.association, self.parameters.motion, self._targets
        squared, cost = distances(predicted, [each.slot for each in targets], sightings, motion)
        seen = cost
        own = np.zeros(cost.shape, bool)
        for i, each in enumerate(targets):
            for k, sighting in enumerate(sightings):
                own[i, k] = each.own and each.slot in sighting.owners and sighting.track.support > limits.own_support
        if any(each.group for each in targets):
            behind_squared, behind = distances(predicted, [each.slot + self.most for each in targets], sightings, motion)
            squared, cost = squared.copy(), cost.copy()
            fronts = {each.slot: each.group for each in targets if each.group is not None and each.own}
            for i, each in enumerate(targets):
                if each.group is None:
                    continue
                for k, sighting in enumerate(sightings):
                    if any(fronts.get(slot) is each.group for slot in sighting.owners):
                        cost[i, k] += each.group.handicap(each)
                        own[i, k] = True
                    else:
                        squared[i, k], cost[i, k], own[i, k] = behind_squared[i, k], behind[i, k], False
        return associate(squared, cost, own, limits), seen

    def _correct(self, frame: Frame, sightings: list[Sighting], chosen: list[int], predicted: Predicted, cost: Floats) -> None:
        """Correct the filters of all that are seen; note who may be hidden behind whom."""
        slots, ks = [], []
        front = {each.group: k for each, k in zip(self._targets, chosen, strict=True) if each.group and k >= 0 and self._is_front(each, sightings[k])}
        # emerged ones leave their group
        for each, k in zip(self._targets, chosen, strict=True):
            if each.group is not None and k >= 0 and front.get(each.group) != k:
                self._bank.copy(each.slot + self.most, each.slot)
                each.group.remove(each)
        # new groups
        for i, (each, k) in enumerate(zip(self._targets, chosen, strict=True)):
            if k >= 0 or each.group is not None or not each.own:
                continue
            place = each.expected(predicted)
            for j, (other, m) in enumerate(zip(self._targets, chosen, strict=True)):
                if m < 0 or other is each:
                    continue
                larger = max(place.half_width, sightings[m].place.half_width)
                if place.distance(sightings[m].place) < self.parameters.hidden_distance * larger:
                    if other.group is None:
                        self._bank.copy(other.slot, other.slot + self.most)
                        group = Group()
                        group.add(other, 0.0)
                        front[group] = m
                    if front.get(other.group) != m:
                        continue
                    self._bank.copy(each.slot, each.slot + self.most)
                    other.group.add(each, 0.0)
                    break
        for i, (each, k) in enumerate(zip(self._targets, chosen, strict=True)):
            if k < 0 and each.group is not None and each.group in front:
                m = front[each.group]
                each.group.scores[each] -= float(cost[i, m])
                slots.append(each.slot), ks.append(m)
            elif k >= 0 and each.group is not None:
                each.group.scores[each] -= float(cost[i, k])
            if k < 0:
                each.own, each.restarts = False, self.parameters.restarts
                continue
            seen = sightings[k]
            if each.slot not in seen.owners:
                each.restarts = self.parameters.restarts
            each.own = True
            each.track, each.seen = seen.track, frame.time
            each.sightings += 1
            slots.append(each.slot), ks.append(k)
        if slots:
            places, variances = np.array([sightings[k].place for k in ks]), np.array([sightings[k].variance for k in ks])
            self._bank.correct(np.array(slots), places, variances, frame.time)

    def _is_front(self, each: Followed, seen: Sighting) -> bool:
        fronts = {other.slot for other in self._targets if other.own and other.group is each.group}
        return any(slot in fronts for slot in seen.owners)

    def _begin(self, frame: Frame, sightings: list[Sighting], chosen: list[int], predicted: Predicted) -> None:
        """Begin with what nobody follows; not next to a target that is hidden, since it may be that."""
        hidden = [each.expected(predicted) for each in self._targets if 0.0 < frame.time - each.seen < 0.3]
        seen_now = [each.place for each in self._targets if each.seen == frame.time]
        for k, seen in enumerate(sightings):
            if k in chosen or seen.owners or not seen.sure or not self._free:
                continue
            if any(seen.place.distance(each) < seen.place.half_width + each.half_width for each in hidden):
                continue
            if any(seen.place.distance(each) < 0.6*max(seen.place.half_width, each.half_width) for each in seen_now):
                continue
            self._new(seen)

    def _new(self, seen: Sighting) -> None:
        slot, spare = self._free.pop(0), self._spare[seen.label]
        color = self.colors[seen.label]
        tracker = spare.pop() if spare else Tracker(self._family, color, self.parameters.points, parameters=self.parameters.tracker)
        self._targets.append(Followed(seen.label, slot, tracker, seen.track))
        self._bank.begin(slot, seen.place, seen.track.time)

    def _answers(self, frame: Frame, predicted: Predicted) -> list[Target[Any]]:
        answers = []
        for each in self._targets:
            if each.identity is None and each.sightings >= self.parameters.confirm:
                each.identity = self._count
                self._count += 1
            if each.identity is None:
                continue
            track: Track[Any] | Lost[Any] = each.track
            if each.seen != frame.time:
                track = Lost("hidden", frame.time, each.shape_at(each.expected(predicted)))
            answers.append(Target(each.identity, each.label, track, each.since, self._alternatives(each)))
        return sorted(answers, key=lambda target: target.identity)


    def _alternatives(self, each: Followed) -> tuple[int, ...]:
        others = () if each.group is None else each.group.scores
        return tuple(sorted(other.identity for other in others if other is not each and other.identity is not None))


def _named(colors: Colors) -> dict[str, ColorModel]:
    if isinstance(colors, ColorModel):
        return {"0": colors}
    if isinstance(colors, Mapping):
        return dict(colors)
    return {str(k): each for k, each in enumerate(colors)}
