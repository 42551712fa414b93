"""What is seen in a frame: by the trackers of tracklets, by those of hidden targets, and by searches (`Observer`)."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from matchset.image.color import ColorModel
from matchset.image.frame import Frame, channels_last
from matchset.tracking.many.motion_bank import HALTED, Predicted
from matchset.tracking.many.parameters import MultiTrackerParameters
from matchset.tracking.many.sightings import Sighting, are_fields, of_both, sighting_of
from matchset.tracking.many.strip_search import StripSearch
from matchset.tracking.many.tracklet import Followed, Tracklet, start
from matchset.tracking.motion import Gate
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker


class Observed(NamedTuple):
    """What is seen in a frame.

    Attributes
    ----------
    continued : dict of Tracklet to Sighting
    ended : list of Tracklet
        Those whose trackers have lost what they followed, or are where another one is.
    fresh : list of Sighting
        What none of them follows.
    """

    continued: dict[Tracklet, Sighting]
    ended: list[Tracklet]
    fresh: list[Sighting]


class Observer:
    """Trackers and searches of several targets.

    Parameters
    ----------
    families : mapping of str to type
        By label.
    colors : mapping of str to ColorModel
        By label.
    parameters : MultiTrackerParameters
    """

    def __init__(
        self, families: Mapping[str, type[Any]], colors: Mapping[str, ColorModel], parameters: MultiTrackerParameters
    ) -> None:
        self._families, self._colors, self._limits = families, colors, parameters
        self._searches = {
            label: StripSearch(families[label], color, parameters.search) for label, color in colors.items()
        }
        self._spare: dict[str, list[Tracker[Any]]] = {label: [] for label in colors}
        self._frames = 0
        self._fields = 0.0, 0.0

    def tracker(self, label: str) -> Tracker[Any]:
        """Return a tracker that nobody uses."""
        if self._spare[label]:
            return self._spare[label].pop()
        limits = self._limits
        return Tracker(self._families[label], self._colors[label], limits.points, parameters=limits.tracker)

    def take_back(self, label: str, tracker: Tracker[Any]) -> None:
        """Take back a tracker that is not used any more."""
        tracker.restart()
        self._spare[label].append(tracker)

    def observe(
        self,
        frame: Frame,
        predicted: Predicted,
        tracklets: Sequence[Tracklet],
        hidden: Sequence[Followed],
        passed: float,
    ) -> Observed:
        """Look at a frame, `passed` seconds after the one before."""
        self._frames += 1
        self._share_fields(tracklets)
        continued, ended = self._follow(frame, predicted, (tracklets, hidden), passed)
        known = list(continued.values())
        fresh = list[Sighting]()
        for sighting in self._probe(frame, predicted, (hidden, known), passed):
            self._add(frame, fresh, sighting, known)
        for sighting in self._search(frame, predicted, hidden, [*known, *fresh]):
            self._add(frame, fresh, sighting, known)
        return Observed(continued, ended, fresh)

    def _share_fields(self, tracklets: Sequence[Tracklet]) -> None:
        """Let all trackers know what the fastest target has told about the fields of the camera's pictures."""
        trackers = [each.tracker for each in tracklets if each.tracker is not None]
        works = [each._fitter.work.motion for each in trackers]
        best = max(works, key=lambda motion: float(motion.speed_moment), default=None)
        if best is not None and best.speed_moment > self._fields[1]:
            self._fields = float(best.offset_moment), float(best.speed_moment)
        for motion in works:
            if motion.speed_moment < self._fields[1]:
                motion.offset_moment, motion.speed_moment = self._fields

    def _follow(
        self, frame: Frame, predicted: Predicted, followed: tuple[Sequence[Tracklet], Sequence[Followed]], passed: float
    ) -> tuple[dict[Tracklet, Sighting], list[Tracklet]]:
        """Continue the tracklets; of two that see one outline the one with most support."""
        tracklets, hidden = followed
        seen, ended = dict[Tracklet, Sighting](), list[Tracklet]()
        for each in tracklets:
            if each.tracker is None:
                each.tracker = self.tracker(each.label)
                each.restarts = self._limits.restarts
                motion = each.tracker._fitter.work.motion
                motion.offset_moment, motion.speed_moment = self._fields
            if each.restarts > 0:
                each.restarts -= 1
                each.start(predicted, passed)
            answer = each.tracker.update(frame)
            if isinstance(answer, Track):
                seen[each] = sighting_of(answer, self._limits.motion.center_sigmas, each.label)
            else:
                ended.append(each)
        for each in [each for each in seen if self._is_mixed(each, seen, hidden, predicted)]:
            ended.append(each)
            del seen[each]
        continued = dict[Tracklet, Sighting]()
        for each in sorted(seen, key=lambda tracklet: -seen[tracklet].track.support):
            twin = next((other for other in continued if self._same(frame, continued[other], seen[each])), None)
            if twin is None:
                continued[each] = seen[each]
            else:
                continued[twin] = self._both(frame, continued[twin], seen[each])
                ended.append(each)
        return continued, ended

    def _is_mixed(
        self, each: Tracklet, seen: Mapping[Tracklet, Sighting], hidden: Sequence[Followed], predicted: Predicted
    ) -> bool:
        """Whether the outline is that of two targets that touch: far larger or smaller than expected."""
        owner = each.owner()
        place, usual = seen[each].place, float(predicted.half_widths[each.links[owner].slot])
        if abs(math.log(place.half_width / usual)) < self._limits.merge.mixed_log_size:
            return False
        others = [sighting.place for other, sighting in seen.items() if other is not each]
        others += [predicted.likeliest(target.slot)[0] for target in hidden if target not in each.links]
        return any(place.distance(other) < place.half_width + other.half_width for other in others)

    def _same(self, frame: Frame, one: Sighting, other: Sighting) -> bool:
        limits = self._limits.merge
        far, change = _apart(one.place, other.place)
        return (far < limits.distance and change < limits.log_size) or self._are_fields(frame, one, other)

    def _are_fields(self, frame: Frame, one: Sighting, other: Sighting) -> bool:
        limits, (far, change) = self._limits.merge, _apart(one.place, other.place)
        if not (limits.field_near < far < limits.field_distance and change < limits.field_log_size):
            return False
        return are_fields(channels_last(frame.image), self._colors[one.label], (one.place, other.place), limits)

    def _both(self, frame: Frame, one: Sighting, other: Sighting) -> Sighting:
        return of_both(one, other) if self._are_fields(frame, one, other) else one

    def _add(self, frame: Frame, fresh: list[Sighting], sighting: Sighting, known: Sequence[Sighting]) -> None:
        """Add a sighting, unless it is one that is known."""
        limits = self._limits.merge
        for other in known:
            far, change = _apart(other.place, sighting.place)
            if (far < limits.fresh_distance and change < limits.fresh_log_size) or self._are_fields(
                frame, other, sighting
            ):
                return
        for k, other in enumerate(fresh):
            far, change = _apart(other.place, sighting.place)
            if self._are_fields(frame, other, sighting):
                fresh[k] = of_both(other, sighting)
                return
            if far < limits.fresh_distance and change < limits.fresh_log_size:
                if sighting.track.support > other.track.support:
                    fresh[k] = sighting._replace(sure=sighting.sure or other.sure)
                return
        fresh.append(sighting)

    def _probe(
        self, frame: Frame, predicted: Predicted, around: tuple[Sequence[Followed], Sequence[Sighting]], passed: float
    ) -> list[Sighting]:
        """Track hidden targets from where their motion would have them, and by turns from where they were last."""
        hidden, known = around
        height, width = frame.image.shape[:2]
        found = list[Sighting]()
        for each in hidden:
            place, velocity = predicted.likeliest(each.slot)
            if self._frames % self._limits.halted_period == 0 and frame.time - each.seen > self._limits.halted_after:
                x, y = predicted.centers[each.slot, HALTED].tolist()
                place, velocity = place._replace(x=x, y=y), (0.0, 0.0)
            inside = -place.half_width < place.x < width + place.half_width
            inside = inside and -place.half_width < place.y < height + place.half_width
            if not inside or frame.time - each.seen > self._limits.expected or self._is_covered(place, known):
                continue
            tracker = each.probe = each.probe or self.tracker(each.label)
            since = passed if each.probed is None else min(frame.time - each.probed, 1.0)
            motion = tracker._fitter.work.motion
            if motion.speed_moment < self._fields[1]:
                motion.offset_moment, motion.speed_moment = self._fields
            start(tracker, each.last, (place, velocity), since)
            each.probed = frame.time
            answer = tracker.update(frame)
            if isinstance(answer, Track):
                sighting = sighting_of(answer, self._limits.motion.center_sigmas, each.label)
                found.append(sighting._replace(sure=False, tracker=tracker))
        return found

    def _is_covered(self, place: Gate, known: Sequence[Sighting]) -> bool:
        """Whether what is expected at a place is hidden behind something that is seen."""
        visible = self._limits.min_visible * place.half_width
        return any(
            place.distance(each.place) + place.half_width < each.place.half_width + visible for each in known
        )

    def _search(
        self, frame: Frame, predicted: Predicted, hidden: Sequence[Followed], known: Sequence[Sighting]
    ) -> list[Sighting]:
        """Search a strip for what nobody follows, and a quarter of the image around one that is hidden."""
        places, sigmas = [each.place for each in known], self._limits.motion.center_sigmas
        labels = list(self._colors)
        label = labels[self._frames % len(labels)]
        found = [sighting_of(track, sigmas, label) for track in self._searches[label].update(frame, places)]
        if hidden:
            sought = min(hidden, key=lambda each: (each.identity is not None, each.sought, -each.seen))
            sought.sought = frame.time
            place, _ = predicted.likeliest(sought.slot)
            places += [each.place for each in found]
            tracks = self._searches[sought.label].near(frame, place, places)
            found += [sighting_of(track, sigmas, sought.label)._replace(sure=False) for track in tracks]
        return found


def _apart(one: Gate, other: Gate) -> tuple[float, float]:
    """Distance of two places in half-widths of the larger, and the change of size as a logarithm."""
    larger = max(one.half_width, other.half_width)
    return one.distance(other) / larger, abs(math.log(one.half_width / other.half_width))
