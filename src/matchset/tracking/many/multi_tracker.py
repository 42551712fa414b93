"""Follow several targets at once, in pixels: `MultiTracker`."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec
import numpy as np

from matchset.image.color import ColorModel
from matchset.image.frame import ArrayFrames, Frame, Picture, channels_last, check_follows
from matchset.numeric.arguments import check_kind, checked_count
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.many.association import AssociationParameters, associate, distances
from matchset.tracking.many.followed import Followed
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
        self._bank = MotionBank(most, self.parameters.motion)
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
        chosen = self._associate(sightings, predicted)
        self._correct(frame, sightings, chosen)
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

    def _associate(self, sightings: list[Sighting], predicted: Predicted) -> list[int]:
        if not self._targets:
            return []
        slots, limits = [each.slot for each in self._targets], self.parameters
        squared, cost = distances(predicted, slots, sightings, limits.motion)
        own = np.array(
            [
                [
                    each.own and each.slot in seen.owners and seen.track.support > limits.association.own_support
                    for seen in sightings
                ]
                for each in self._targets
            ],
            bool,
        ).reshape(squared.shape)
        return associate(squared, cost, own, limits.association)

    def _correct(self, frame: Frame, sightings: list[Sighting], chosen: list[int]) -> None:
        slots, places, variances = [], [], []
        for each, k in zip(self._targets, chosen, strict=True):
            if k < 0:
                each.own, each.restarts = False, self.parameters.restarts
                continue
            seen = sightings[k]
            if each.slot not in seen.owners:
                each.restarts = self.parameters.restarts
            each.own = True
            each.track, each.seen = seen.track, frame.time
            each.sightings += 1
            slots.append(each.slot), places.append(seen.place), variances.append(seen.variance)
        if slots:
            self._bank.correct(np.array(slots), np.array(places), np.array(variances), frame.time)

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
            answers.append(Target(each.identity, each.label, track, each.since, each.alternatives))
        return sorted(answers, key=lambda target: target.identity)


def _named(colors: Colors) -> dict[str, ColorModel]:
    if isinstance(colors, ColorModel):
        return {"0": colors}
    if isinstance(colors, Mapping):
        return dict(colors)
    return {str(k): each for k, each in enumerate(colors)}
