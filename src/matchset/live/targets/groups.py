"""Which of the targets before a camera look alike and are followed together: `AlikeGroups`."""

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence

import msgspec

from matchset.app.several.crowd import DoubtfulBalls
from matchset.image.frame import Frame
from matchset.live.targets.alike import (
    ALIKE,
    AlikeParameters,
    AlikeTracker,
    Answers,
    TogetherAnswer,
    are_alike,
    joined,
    on_one,
)
from matchset.live.targets.drawn_outline import drawn_shape
from matchset.live.targets.messages import Begin, Outline, Pick
from matchset.live.targets.target import ClickedTarget
from matchset.live.targets.target_facts import OUTLINE_POINTS, flat
from matchset.live.wire.state import CrowdState
from matchset.shapes.shape import center_of, outline
from matchset.tracking.track import Lost, Track


class GroupParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How long targets last, and what a source that begins anew does.

    Parameters
    ----------
    gone : float
        How long a target that was found without a click is not seen before it ends, s. Longer: it keeps its name, and
        the list is full of what is not there. Chosen by hand.
    away : float
        How long ago targets count as seen when a source begins anew, s: they may be anywhere. Chosen by hand: longer
        than `AlikeParameters.tracker` waits before it searches the whole picture.
    alike : AlikeParameters
    """

    gone: float = 5.0
    away: float = 2.0
    alike: AlikeParameters = ALIKE


class AlikeGroup:
    """Targets that look alike.

    Parameters
    ----------
    members : sequence of ClickedTarget
    finds : bool
        Whether all that looks like them is followed, too.
    parameters : GroupParameters

    Attributes
    ----------
    members : dict of int to ClickedTarget
    finds : bool
    """

    def __init__(self, members: Sequence[ClickedTarget], finds: bool, parameters: GroupParameters) -> None:
        self.members = {each.number: each for each in members}
        self.finds, self._parameters = finds, parameters
        self._tracker = self._new_tracker()
        self.begin_anew(None)

    def _new_tracker(self) -> AlikeTracker:
        color = joined(each.color for each in self.members.values())
        return AlikeTracker(self._first.family, color, self.finds, self._parameters.alike)

    @property
    def _first(self) -> ClickedTarget:
        return next(iter(self.members.values()))

    def begin_anew(self, away: float | None) -> None:
        """Take all members over from where they were seen last, or, `away`, as if that had been at this time, s."""
        before, self._tracker = self._tracker, self._new_tracker()
        self._tracker.answered = before.give_up()
        for each in self.members.values():
            self.add(each, away)

    def add(self, target: ClickedTarget, away: float | None = None) -> None:
        """Follow a target, too."""
        self.members[target.number] = target
        if target.last is None:
            return
        track = target.last if away is None else msgspec.structs.replace(target.last, time=away)
        self._tracker.add(target.number, track, away is not None or isinstance(target.answer, Lost))

    def remove(self, number: int) -> None:
        """Follow a target no more."""
        del self.members[number]
        self._tracker.remove(number)

    @property
    def doubtful(self) -> DoubtfulBalls:
        """What may be one of them as well."""
        return self._tracker.doubtful

    def follow_doubtful(self, begin: Begin) -> bool:
        """Follow what is doubtful where a person has clicked or drawn; returns whether there is anything."""
        if not self.finds or begin.shape != self._first.shape:
            return False
        drawn = drawn_shape(begin, self._first.family) if isinstance(begin, Outline) else None
        x, y = (begin.x, begin.y) if isinstance(begin, Pick) else center_of(outline(drawn))[:2]
        found = self.doubtful.at(x, y)
        if found is not None:
            self._tracker.ask(begin, drawn or found.shape)
        return found is not None

    def take_answers(self) -> Answers:
        """Return what became of that since it was asked last."""
        answers, self._tracker.answered = self._tracker.answered, []
        return answers

    def give_up(self) -> Answers:
        """Return the same, and what was asked for in vain, since the group is no more."""
        return self._tracker.give_up()

    def update(
        self, frame: Frame, room: int, begin: Callable[[ClickedTarget], ClickedTarget]
    ) -> dict[int, TogetherAnswer]:
        """Follow all into a frame; of what is found `room` more are begun."""

        def found() -> int | None:
            nonlocal room
            if room <= 0:
                return None
            room -= 1
            born = begin(self._first)
            self.members[born.number] = born
            return born.number

        def name(number: int) -> str:
            return self.members[number].name

        self._tracker.finds = self.finds and room > 0
        try:
            return self._tracker.update(frame, name, found)
        except ValueError:  # a time that runs anew
            self.begin_anew(frame.time - self._parameters.away)
            return self._tracker.update(frame, name, found)


class AlikeGroups:
    """Groups of targets that look alike; what looks like no other is in none and has a tracker of its own.

    Parameters
    ----------
    parameters : GroupParameters, optional
    """

    def __init__(self, parameters: GroupParameters | None = None) -> None:
        self._parameters = parameters or GroupParameters()
        self._groups: list[AlikeGroup] = []
        self._away = False
        self._answers: Answers = []

    def of(self, number: int) -> AlikeGroup | None:
        """Return the group of a target."""
        return next((each for each in self._groups if number in each.members), None)

    def clear(self) -> None:
        """Forget all."""
        for group in self._groups:
            self._end(group)

    def restart(self) -> None:
        """Take note that the source begins anew: where targets were says nothing any more."""
        self._away = True

    def join(self, target: ClickedTarget, others: Iterable[ClickedTarget]) -> None:
        """Follow a target together with one of the others that looks like it, if there is one."""
        for other in others:
            alike = other is not target and other.family is target.family and other.last is not None
            if not (alike and are_alike(target.color, other.color, self._parameters.alike)):
                continue
            group = self.of(other.number)
            if group is None:
                self._groups.append(AlikeGroup((other, target), False, self._parameters))
            else:
                group.members[target.number] = target
                group.begin_anew(None)
            return

    def leave(self, number: int) -> None:
        """Follow a target no longer with others; the last one that stays has a tracker of its own again."""
        group = self.of(number)
        if group is not None:
            group.remove(number)
            self._dissolve(group)

    def _dissolve(self, group: AlikeGroup) -> None:
        if group.members and (group.finds or len(group.members) > 1):
            return
        self._end(group)
        for each in group.members.values():
            each.follow_alone()

    def _end(self, group: AlikeGroup) -> None:
        self._answers += group.give_up()
        self._groups = [each for each in self._groups if each is not group]

    def follow_doubtful(self, begin: Begin) -> bool:
        """Follow what is doubtful where a person has clicked or drawn; returns whether there is anything."""
        return any(group.follow_doubtful(begin) for group in self._groups)

    def take_answers(self) -> Answers:
        """Return what became of that: the number of the target, or None; each once."""
        answers, self._answers = self._answers, []
        for group in self._groups:
            answers += group.take_answers()
        return answers

    def crowd(self, targets: Iterable[ClickedTarget], most: int) -> CrowdState | None:
        """Say what is doubtful, and how many are left out; None where nothing is looked for.

        Parameters
        ----------
        targets : iterable of ClickedTarget
            All that are followed.
        most : int
            How many there may be.
        """
        groups = [each for each in self._groups if each.finds]
        if not groups:
            return None
        taken = [each.answer for each in targets if isinstance(each.answer, Track)]
        doubtful = [each for group in groups for each in group.doubtful.tracks]
        doubtful = [each for each in doubtful if not any(on_one(each, other) for other in taken)]
        outlines = [flat(outline(each.shape, OUTLINE_POINTS)) for each in doubtful]
        left_out = sum(group.doubtful.left_out for group in groups)
        return CrowdState(sum(len(group.members) for group in groups), most, outlines, left_out)

    def find_all(self, target: ClickedTarget, on: bool) -> None:
        """Follow all that looks like a target, too; or no more of them than there are."""
        group = self.of(target.number)
        if group is None and on:
            self._groups.append(AlikeGroup((target,), True, self._parameters))
        elif group is not None:
            group.finds = on
            self._dissolve(group)

    def end_finding(self, number: int) -> bool:
        """Look for no more like a target that a person drops; returns whether some were looked for, and others stay."""
        group = self.of(number)
        if group is None or not group.finds or len(group.members) == 1:
            return False
        group.finds = False
        return True

    def recolor(self, number: int) -> None:
        """Take note that a target has another color, such as that of its marker, too."""
        group = self.of(number)
        if group is not None:
            group.begin_anew(None)

    def update(
        self, frame: Frame, room: int, begin: Callable[[ClickedTarget], ClickedTarget]
    ) -> dict[int, TogetherAnswer]:
        """Follow all groups into a frame.

        Parameters
        ----------
        frame : Frame
        room : int
            How many more targets there may be.
        begin : callable
            Begins a target that looks like another one.

        Returns
        -------
        dict of int to TogetherAnswer
            By number.
        """
        answers: dict[int, TogetherAnswer] = {}
        for group in self._groups:
            if self._away:
                group.begin_anew(frame.time - self._parameters.away)
            before = len(group.members)
            answers |= group.update(frame, room, begin)
            room -= len(group.members) - before
        self._away = False
        return answers

    def gone(self, targets: Iterable[ClickedTarget], time: float) -> list[int]:
        """Return the targets that nobody has clicked or named, and that are not seen any more."""
        limit = self._parameters.gone
        return [
            each.number
            for each in targets
            if not (each.is_kept or each.seen is None or 0.0 <= time - each.seen <= limit)
        ]

    def merge(self, targets: Mapping[int, ClickedTarget], frame: Frame) -> dict[int, TogetherAnswer]:
        """Follow those together that were found on one outline, from where they were seen before this frame."""
        answers: dict[int, TogetherAnswer] = {}
        for one, other in itertools.combinations(targets.values(), 2):
            if one.family is not other.family or not _on_one(one, other):
                continue
            if self.of(one.number) is not None and self.of(one.number) is self.of(other.number):
                continue
            new = next((each for each in (other, one) if each.before is None), None)
            if (
                new is not None
            ):  # found for the first time, on a ball that is followed: nothing tells that it is another
                elder = one if new is other else other
                new.last = None
                answers[new.number] = TogetherAnswer(Lost(f"that is {elder.name}", frame.time))
                continue
            groups = [self.of(each.number) for each in (one, other)]
            members = {one.number: one, other.number: other}
            for group in {id(each): each for each in groups}.values():
                if group is not None:
                    members |= group.members
                    self._end(group)
            for each in members.values():
                if isinstance(each.answer, Track) and each.before is not None:
                    each.last = each.before
            finds = any(group is not None and group.finds for group in groups)
            merged = AlikeGroup(list(members.values()), finds, self._parameters)
            self._groups.append(merged)
            answers |= merged.update(frame, 0, lambda each: each)
        return answers


def _on_one(one: ClickedTarget, other: ClickedTarget) -> bool:
    a, b = one.answer, other.answer
    return isinstance(a, Track) and isinstance(b, Track) and on_one(a, b)
