"""Follow several targets at once, in pixels: `MultiTracker`."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from matchset.image.color import ColorModel
from matchset.image.frame import ArrayFrames, Frame, Picture, check_follows
from matchset.numeric.arguments import check_kind, checked_count
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line
from matchset.tracking.many.linking import Linking
from matchset.tracking.many.motion_bank import Predicted
from matchset.tracking.many.observer import Observer
from matchset.tracking.many.parameters import MultiTrackerParameters
from matchset.tracking.many.target import Target
from matchset.tracking.many.tracklet import Followed
from matchset.tracking.track import Lost, Track

MOST = 100  # format: targets at once

Colors = ColorModel | Sequence[ColorModel] | Mapping[str, ColorModel]


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
        families = dict.fromkeys(self.colors, family)
        self._observer = Observer(families, self.colors, self.parameters)
        self._linking = Linking(most, self.parameters.motion, self.parameters.linking)
        self._arrays = ArrayFrames(fps)
        self._count = self._frames = 0
        self._format: tuple[int, ...] | None = None
        self._time, self._passed = -math.inf, 1.0 / 30.0
        self._make_derived()

    @one_line
    def __repr__(self) -> str:
        names = [each.identity for each in self._linking.targets if each.identity is not None]
        return f"MultiTracker({len(names)} targets followed, {self._count} found, {self._frames} frames)"

    def update(self, frame: Picture) -> list[Target[Any]]:
        """Track all targets in a frame, and search a strip of it for new ones."""
        frame = self._checked(frame)
        linking, observer = self._linking, self._observer
        linking.forget(frame.time, self.parameters.memory)
        predicted = linking.bank.predict(frame.time)
        seen = observer.observe(frame, predicted, linking.tracklets, linking.hidden(), self._passed)
        lost = linking.end(seen.ended, frame.time)
        linking.doubt(lost, seen.continued, predicted)
        linking.go_on(seen.continued, frame.time)
        linking.begin(seen.fresh, predicted, frame.time)
        linking.decide(frame.time)
        for each in (*seen.ended, *linking.dropped):
            if each.tracker is not None:
                observer.take_back(each.label, each.tracker)
        linking.dropped.clear()
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

    def _answers(self, frame: Frame, predicted: Predicted) -> list[Target[Any]]:
        answers = list[Target[Any]]()
        for each in self._linking.targets:
            if each.identity is None and each.sightings >= self.parameters.confirm:
                each.identity = self._count
                self._count += 1
            if each.identity is None:
                continue
            track: Track[Any] | Lost[Any]
            if each.tracklet is not None:
                track = each.tracklet.sighting.track
            else:
                track = Lost("hidden", frame.time, each.shape_at(predicted.likeliest(each.slot)[0]))
            answers.append(Target(each.identity, each.label, track, each.since, _alternatives(each)))
        return sorted(answers, key=lambda target: target.identity)


def _alternatives(each: Followed) -> tuple[int, ...]:
    """Which other targets a tracklet may be of."""
    links = () if each.tracklet is None else each.tracklet.links
    return tuple(sorted(other.identity for other in links if other is not each and other.identity is not None))


def _named(colors: Colors) -> dict[str, ColorModel]:
    if isinstance(colors, ColorModel):
        return {"0": colors}
    if isinstance(colors, Mapping):
        return dict(colors)
    return {str(k): each for k, each in enumerate(colors)}
