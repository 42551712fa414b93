"""Targets that look alike, followed together by one `MultiTracker` so that each keeps its name: `AlikeTracker`."""

import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import msgspec

from matchset.app.several.chosen import SharingParameters, shared_part
from matchset.app.several.crowd import DoubtfulBalls
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.live.targets.messages import Begin
from matchset.shapes.shape import Shape
from matchset.tracking.many.multi_tracker import MultiTracker
from matchset.tracking.many.parameters import MultiTrackerParameters
from matchset.tracking.many.sightings import MergeParameters, place_of
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost, Track


class AlikeParameters(msgspec.Struct, frozen=True, kw_only=True):
    """When targets are followed together, and how.

    Parameters
    ----------
    most : int
        Targets in one tracker, those of a search that are not sure yet among them. Chosen by hand: more than a page
        lists, so that the page says that there are enough.
    coasting : float
        How long it is shown where a target is expected that is not seen, s. Longer: a place that says nothing any
        more. Chosen by hand.
    sharing : SharingParameters
        When two colors are one.
    tracker : MultiTrackerParameters
        On a page targets end when a person drops them: they are remembered for ever, and after a second looked for in
        the whole picture.
    """

    most: int = 60
    coasting: float = 1.0
    sharing: SharingParameters = SharingParameters()
    tracker: MultiTrackerParameters = MultiTrackerParameters(memory=math.inf, searched=1.0)


ALIKE = AlikeParameters()
DROPPED = "no more like {} are looked for, or it would be found again"


Answers = list[tuple[Begin, int | None]]


class TogetherAnswer(NamedTuple):
    """What is known of one of several targets in a frame.

    Attributes
    ----------
    track : Track or Lost
    alternatives : tuple of int
        Numbers of the targets that it may be as well.
    """

    track: Track[Any] | Lost[Any]
    alternatives: tuple[int, ...] = ()


class AlikeTracker:
    """Follows targets of one color, known by their numbers on the page.

    Parameters
    ----------
    family : type
    color : ColorModel
    finds : bool
        Whether all that looks like them is followed, too.
    parameters : AlikeParameters, optional

    Attributes
    ----------
    doubtful : DoubtfulBalls
        What may be one of them, and how many are left out.
    answered : list of (Begin, int or None)
        What was asked for, and the number of the target that it has begun, or None: it was not found.
    """

    def __init__(self, family: type[Any], color: ColorModel, finds: bool, parameters: AlikeParameters = ALIKE) -> None:
        self._parameters = parameters
        self._tracker = MultiTracker(family, color, parameters.most, parameters.tracker, finds=finds)
        self._numbers: dict[int, int] = {}
        self._seen: dict[int, float] = {}
        self._asked: dict[int, tuple[Begin, float | None]] = {}
        self.doubtful = DoubtfulBalls(self._tracker)
        self.answered: Answers = []

    @property
    def finds(self) -> bool:
        """Whether all that looks like them is searched for; may be changed."""
        return self._tracker.finds

    @finds.setter
    def finds(self, finds: bool) -> None:
        self._tracker.finds = finds

    def add(self, number: int, track: Track[Any], hidden: bool = False) -> None:
        """Follow a target on from where it was seen last; `hidden`: it is not seen any more."""
        self._numbers[self._tracker.add(track, hidden=hidden)] = number
        self._seen[number] = track.time

    def ask(self, begin: Begin, shape: Shape) -> None:
        """Follow something doubtful, since a person says that it is one; what becomes of that is in `answered`.

        Raises
        ------
        ValueError
            If it is followed already.
        """
        self._asked[self._tracker.add(shape)] = begin, None

    def give_up(self) -> Answers:
        """Return what was answered, and what was asked for in vain, since this tracker is used no more."""
        return [*self.answered, *((begin, None) for begin, _ in self._asked.values())]

    def remove(self, number: int) -> None:
        """Follow a target no more."""
        for identity in [each for each, known in self._numbers.items() if known == number]:
            self._tracker.remove(identity)
            del self._numbers[identity]
        self._seen.pop(number, None)

    def update(
        self, frame: Frame, name: Callable[[int], str], begin: Callable[[], int | None]
    ) -> dict[int, TogetherAnswer]:
        """Follow all into a frame.

        Parameters
        ----------
        frame : Frame
        name : callable
            Returns the name of a target.
        begin : callable
            Begins a target that was found; returns its number, or None: it is not followed.

        Returns
        -------
        dict of int to TogetherAnswer
            By number.

        Raises
        ------
        ValueError
            If time runs anew, or the pictures have another size.
        """
        targets = self._tracker.update(frame)
        left_out = 0
        for each in targets:
            if each.identity in self._numbers or isinstance(each.track, Lost):
                continue
            number = begin()
            if each.identity in self._asked:
                self.answered.append((self._asked.pop(each.identity)[0], number))
            if number is None:
                self._tracker.remove(each.identity)
                left_out += 1
            else:
                self._numbers[each.identity] = number
        self.doubtful.update(frame, targets, left_out)
        self._end_asked(frame.time)
        known = [each for each in targets if each.identity in self._numbers]
        return {self._numbers[each.identity]: self._answer(each, name) for each in known}

    def _end_asked(self, time: float) -> None:
        """Give up what was asked for, and is not found while it is looked for."""
        for identity, (begin, since) in list(self._asked.items()):
            if since is None:
                self._asked[identity] = begin, time
            elif not 0.0 <= time - since <= self._parameters.tracker.requested:
                self.answered.append((begin, None))
                del self._asked[identity]

    def _answer(self, target: Target[Any], name: Callable[[int], str]) -> TogetherAnswer:
        number, track = self._numbers[target.identity], target.track
        if isinstance(track, Track):
            self._seen[number] = track.time
            others = (self._numbers.get(each) for each in target.alternatives)
            return TogetherAnswer(track, tuple(sorted(each for each in others if each is not None)))
        if target.behind in self._numbers:
            words = f"hidden behind {name(self._numbers[target.behind])}, which looks the same"
            track = msgspec.structs.replace(track, reason=words)
        if not 0.0 <= track.time - self._seen.get(number, -math.inf) <= self._parameters.coasting:
            track = msgspec.structs.replace(track, predicted=None)
        return TogetherAnswer(track)


def are_alike(one: ColorModel, other: ColorModel, parameters: AlikeParameters = ALIKE) -> bool:
    """Whether two colors are one."""
    return shared_part(one, other) >= parameters.sharing.share


def joined(colors: Iterable[ColorModel]) -> ColorModel:
    """Return what covers several colors; of gray ones the first."""
    first, *others = colors
    for other in others:
        if not (first.gray or other.gray):
            first = first | other
    return first


def on_one(one: Track[Any], other: Track[Any], limits: MergeParameters = ALIKE.tracker.merge) -> bool:
    """Whether two tracks are of one outline, as `MultiTracker` has it."""
    a, b = place_of(one.shape), place_of(other.shape)
    larger = max(a.half_width, b.half_width)
    near = a.distance(b) < limits.distance * larger
    return near and abs(math.log(a.half_width / b.half_width)) < limits.log_size
