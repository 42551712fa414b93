"""What is seen in a frame: by the trackers of tracklets, by those of hidden targets, and by searches (`Observer`)."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from matchset.image.color import ColorModel
from matchset.image.frame import Frame, channels_last
from matchset.shapes.shape import Shape
from matchset.tracking.many.field_timing import FieldTiming
from matchset.tracking.many.motion_bank import Predicted
from matchset.tracking.many.parameters import MultiTrackerParameters
from matchset.tracking.many.searching.searches import Searches
from matchset.tracking.many.sightings import (
    Sighting,
    are_fields,
    is_inside,
    is_near_one,
    of_both,
    place_of,
    sighting_of,
)
from matchset.tracking.many.tracklet import Followed, Observed, Tracklet, start
from matchset.tracking.motion import Gate
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker


class Request:
    """What somebody said shall be followed: a point of it, px, or its outline, roughly; its identity; since when, s."""

    def __init__(self, label: str, what: tuple[float, float] | Shape, identity: int) -> None:
        self.label, self.what, self.identity = label, what, identity
        self.since: float | None = None


class Observer:
    """Trackers and searches of several targets.

    Parameters
    ----------
    families : mapping of str to type
        By label.
    colors : mapping of str to ColorModel
        By label.
    parameters : MultiTrackerParameters
    finds : bool

    Attributes
    ----------
    finds : bool
        Whether what nobody follows is searched for.
    searches : Searches
    requests : list of Request
        What shall be followed, and was not found yet.
    """

    def __init__(
        self,
        families: Mapping[str, type[Any]],
        colors: Mapping[str, ColorModel],
        parameters: MultiTrackerParameters,
        finds: bool,
    ) -> None:
        self._families, self._colors, self._limits = families, colors, parameters
        self.searches = Searches(families, colors, parameters)
        self._spare: dict[str, list[Tracker[Any]]] = {label: [self._made(label)] for label in colors}
        self.finds, self.requests = finds, list[Request]()
        self._frames = 0
        self._fields = FieldTiming(parameters.fields)

    def _tracker(self, label: str) -> Tracker[Any]:
        """Return a tracker that nobody uses."""
        if self._spare[label]:
            return self._spare[label].pop()
        return self._made(label)

    def _made(self, label: str) -> Tracker[Any]:
        limits = self._limits
        return Tracker(self._families[label], self._colors[label], limits.points, parameters=limits.tracker)

    def take_back(self, tracklet: Tracklet) -> None:
        """Take back the tracker of a tracklet that has ended."""
        if tracklet.tracker is not None:
            self._keep(tracklet.label, tracklet.tracker)
            tracklet.tracker = None

    def _keep(self, label: str, tracker: Tracker[Any]) -> None:
        """Keep a tracker that nobody uses any more, as if it were new."""
        tracker.restart()
        self._spare[label].append(tracker)

    def request(self, label: str, what: tuple[float, float] | Shape, identity: int) -> None:
        """Look for what is at a point, px, or for a shape, from the next frame on; it has an identity then.

        Raises
        ------
        ValueError
            If the shape is not of the family of its label.
        """
        if not isinstance(what, tuple):
            self.check(label, what)
        self.requests.append(Request(label, what, identity))

    def check(self, label: str, shape: Shape) -> None:
        """Raise a ValueError if a shape is not of the family of a label."""
        family = self._families[label]
        if not isinstance(shape, family):
            raise ValueError(f"targets of the color {label!r} are of the family {family.__name__}, got {shape!r:.60}")

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
        continued, ended = self._follow(frame, predicted, (tracklets, hidden), passed)
        known = list(continued.values())
        fresh = list[Sighting]()
        for sighting in self._requested(frame, known):
            self._add(frame, fresh, sighting, known)
        for sighting in self._probe(frame, predicted, (hidden, known), passed):
            self._add(frame, fresh, sighting, known)
        for sighting in self.searches.search(frame, predicted, (hidden, ended), [*known, *fresh], finds=self.finds):
            self._add(frame, fresh, sighting, known)
        return Observed(continued, ended, fresh)

    def _requested(self, frame: Frame, known: Sequence[Sighting]) -> list[Sighting]:
        """Look for what somebody said shall be followed; for half a second, and no more."""
        found, sigmas = list[Sighting](), self._limits.motion.center_sigmas
        for request in list(self.requests):
            request.since = frame.time if request.since is None else request.since
            if isinstance(request.what, tuple):
                x, y = request.what
                places = [each.place for each in known]
                tracks = self.searches.at(frame, request.label, (x, y), places)
                tracks = [track for track in tracks if _holds(place_of(track.shape), (x, y))]
            else:
                tracker = self._tracker(request.label)
                tracker.start(request.what)
                answer = tracker.update(frame)
                tracks = [answer] if isinstance(answer, Track) else []
                self._keep(request.label, tracker)
            found += [
                sighting_of(track, sigmas, request.label)._replace(identity=request.identity) for track in tracks[:1]
            ]
            if tracks or frame.time - request.since > self._limits.requested:
                self.requests.remove(request)
        return found

    def _follow(
        self, frame: Frame, predicted: Predicted, followed: tuple[Sequence[Tracklet], Sequence[Followed]], passed: float
    ) -> tuple[dict[Tracklet, Sighting], list[Tracklet]]:
        """Continue the tracklets; of two that see one outline the one with most support."""
        tracklets, hidden = followed
        crowded = self._crowded(predicted, tracklets, hidden)
        seen, ended, sigmas = dict[Tracklet, Sighting](), list[Tracklet](), self._limits.motion.center_sigmas
        for each in tracklets:
            if each.tracker is None:
                each.tracker = self._tracker(each.label)
                each.restarts = self._limits.restarts
            if each.restarts > 0:
                each.tracker.step.fields = self._fields.moments
                each.restarts -= 1
                each.start(predicted, passed)
            each.tracker.step.crowded = each in crowded
            if each in crowded:
                each.tracker.step.hold_size(crowded[each], self._limits.held_sigma)
            answer = each.tracker.update(frame)
            if isinstance(answer, Track):
                seen[each] = sighting_of(answer, sigmas, each.label)._replace(crowded=each in crowded)
                self._fields.note(each.sighting, seen[each])
            else:
                ended.append(each)
        for each in [each for each in seen if self._is_mixed(each, seen, hidden, predicted)]:
            ended.append(each)
            del seen[each]
        return self._distinct(frame, seen, ended, predicted), ended

    def _crowded(
        self, predicted: Predicted, tracklets: Sequence[Tracklet], hidden: Sequence[Followed]
    ) -> dict[Tracklet, float]:
        """Half-widths, px, of tracklets next to others, or to where hidden targets may be.

        The network of discs knows single balls only, and an outline may take in a part of the other one.
        """
        if not hidden and not near_pairs([each.sighting.place for each in tracklets], self._limits.may_meet):
            return {}
        slots = [each.hypotheses[each.target or each.owner()].slot for each in tracklets]
        places = [predicted.likeliest(slot)[0] for slot in slots]
        places += [place for each in hidden for place in predicted.places(each.slot)]
        near = near_pairs(places, self._limits.crowded)
        return {tracklets[k]: places[k].half_width for pair in near for k in pair if k < len(tracklets)}

    def _distinct(
        self, frame: Frame, seen: dict[Tracklet, Sighting], ended: list[Tracklet], predicted: Predicted
    ) -> dict[Tracklet, Sighting]:
        """Of tracklets that see one outline keep the one that was expected there most, and end the others."""
        limits = self._limits.merge
        reach = limits.field_distance
        if not near_pairs([sighting.place for sighting in seen.values()], reach):
            return seen
        expected = {each: _likelihood(each, seen[each], predicted) for each in seen}
        ordered = sorted(seen, key=lambda tracklet: -expected[tracklet])
        near = near_pairs([seen[each].place for each in ordered], reach)
        merged = set[int]()
        for first, second in near:
            if first in merged or second in merged:
                continue
            one, other = seen[ordered[first]], seen[ordered[second]]
            fields = self._are_fields(frame, one, other)
            if fields or _are_near(one, other, limits.distance, limits.log_size):
                seen[ordered[first]] = of_both(one, other) if fields else one
                ended.append(ordered[second])
                merged.add(second)
        return {each: seen[each] for k, each in enumerate(ordered) if k not in merged}

    def _is_mixed(
        self, each: Tracklet, seen: Mapping[Tracklet, Sighting], hidden: Sequence[Followed], predicted: Predicted
    ) -> bool:
        """Whether the outline is that of two targets that touch: far larger or smaller than expected."""
        owner = each.owner()
        place, usual = seen[each].place, predicted.half_width(each.hypotheses[owner].slot)
        if abs(math.log(place.half_width / usual)) < self._limits.merge.mixed_log_size:
            return False
        others = [sighting.place for other, sighting in seen.items() if other is not each]
        others += [predicted.likeliest(target.slot)[0] for target in hidden if target not in each.hypotheses]
        return any(place.distance(other) < place.half_width + other.half_width for other in others)

    def _are_fields(self, frame: Frame, one: Sighting, other: Sighting) -> bool:
        limits, (far, change) = self._limits.merge, _apart(one.place, other.place)
        if not (limits.field_near < far < limits.field_distance and change < limits.field_log_size):
            return False
        return are_fields(channels_last(frame.image), self._colors[one.label], (one.place, other.place), limits)

    def _add(self, frame: Frame, fresh: list[Sighting], sighting: Sighting, known: Sequence[Sighting]) -> None:
        """Add a sighting, unless it is one that is known."""
        near = self._limits.merge.fresh_distance, self._limits.merge.fresh_log_size
        for other in known:
            if _are_near(other, sighting, *near) or self._are_fields(frame, other, sighting):
                return
        for k, other in enumerate(fresh):
            if self._are_fields(frame, other, sighting):
                fresh[k] = of_both(other, sighting)
                return
            if _are_near(other, sighting, *near):
                if sighting.track.support > other.track.support:
                    fresh[k] = sighting._replace(sure=sighting.sure or other.sure)
                return
        fresh.append(sighting)

    def _probe(
        self, frame: Frame, predicted: Predicted, around: tuple[Sequence[Followed], Sequence[Sighting]], passed: float
    ) -> list[Sighting]:
        """Track hidden targets from where their motion would have them, and by turns from where they were last."""
        hidden, known = around
        found = list[Sighting]()
        probes = 0
        for each in sorted(hidden, key=lambda each: (each.probed or -math.inf, -each.seen)):
            place, velocity = predicted.likeliest(each.slot)
            if self._frames % self._limits.halted_period == 0 and frame.time - each.seen > self._limits.halted_after:
                place, velocity = predicted.halted(each.slot), (0.0, 0.0)
            late = frame.time - each.seen > self._limits.expected
            if late or not is_inside(place, frame.image) or self._is_covered(place, known):
                continue
            if probes == self._limits.probes:
                break
            probes += 1
            tracker = each.probe = each.probe or self._tracker(each.label)
            since = passed if each.probed is None else min(frame.time - each.probed, 1.0)
            tracker.step.fields = self._fields.moments
            start(tracker, each.last, (place, velocity), since)
            each.probed = frame.time
            tracker.step.crowded = is_near_one(place, (other.place for other in known), self._limits.crowded)
            answer = tracker.update(frame)
            if isinstance(answer, Track):
                sighting = sighting_of(answer, self._limits.motion.center_sigmas, each.label)
                found.append(sighting._replace(sure=False, tracker=tracker))
        return found

    def _is_covered(self, place: Gate, known: Sequence[Sighting]) -> bool:
        """Whether what is expected at a place is hidden behind something that is seen."""
        visible = self._limits.min_visible * place.half_width
        return any(place.distance(each.place) + place.half_width < each.place.half_width + visible for each in known)


def near_pairs(places: Sequence[Gate], distance: float) -> list[tuple[int, int]]:
    """Pairs of places nearer to each other than a distance, in half-widths of the larger, in their order."""
    order = sorted(range(len(places)), key=lambda k: places[k].x)
    reach = distance * max((place.half_width for place in places), default=0.0)
    pairs = []
    for at, first in enumerate(order):
        x, y, size = places[first]
        for second in order[at + 1 :]:
            other = places[second]
            if other.x - x > reach:
                break
            if abs(other.y - y) < reach and math.hypot(other.x - x, other.y - y) < distance * max(size, other[2]):
                pairs.append((min(first, second), max(first, second)))
    return sorted(pairs)


def _likelihood(tracklet: Tracklet, sighting: Sighting, predicted: Predicted) -> float:
    """Log-likelihood of a sighting as that of the target whose the tracklet is most likely."""
    slot = tracklet.hypotheses[tracklet.owner()].slot
    return predicted.likelihood(slot, sighting.place, sighting.variance).log


def _holds(place: Gate, point: tuple[float, float]) -> bool:
    return math.hypot(place.x - point[0], place.y - point[1]) < place.half_width


def _are_near(one: Sighting, other: Sighting, distance: float, log_size: float) -> bool:
    far, change = _apart(one.place, other.place)
    return far < distance and change < log_size


def _apart(one: Gate, other: Gate) -> tuple[float, float]:
    """Distance of two places in half-widths of the larger, and the change of size as a logarithm."""
    larger = max(one.half_width, other.half_width)
    return one.distance(other) / larger, abs(math.log(one.half_width / other.half_width))
