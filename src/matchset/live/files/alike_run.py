"""The way of targets of a recorded video that look alike, from a frame on: `AlikeRun`; and all runs: `RunQueue`."""

import time
from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from matchset.app.target.shape_option import parse_shape
from matchset.image.frame import Frame
from matchset.live.files.file_group import FileGroup
from matchset.live.files.file_target import Answer, FileTarget
from matchset.live.files.run import FrameWalk, TrackingRun
from matchset.live.targets.alike import (
    AlikeTracker,
    TogetherAnswer,
    joined,
    on_one,
)
from matchset.media.exact_reader import ExactReader
from matchset.media.frame_list import FrameList
from matchset.tracking.track import Lost, Track


class AlikeRun:
    """The way of targets that look alike from a frame on, in one direction.

    Parameters
    ----------
    group : FileGroup
    click : int
        Place of the frame from which on they are followed: of each that is known, it is taken for certain.
    backward : bool
    reader : ExactReader
    end : int, optional
        Place at which it ends.

    Attributes
    ----------
    seconds : float
        Computing time of the last frame, s.
    place : int
        Of the next frame.
    """

    def __init__(
        self, group: FileGroup, click: int, backward: bool, reader: ExactReader, end: int | None = None
    ) -> None:
        self.group, self.click, self.backward, self.end = group, click, backward, end
        self.place, self.seconds = click, 0.0
        self._walk = FrameWalk(reader, click, backward)
        self._tracker: AlikeTracker | None = None
        self._followed: set[int] = set()
        self._twice = 0.0
        self._last = next(iter(group.members.values()))

    @property
    def target(self) -> FileTarget:
        """One of the targets."""
        self._last = next(iter(self.group.members.values()), self._last)
        return self._last

    @property
    def count(self) -> int:
        """How many targets are followed."""
        return max(len(self.group.members), 1)

    def over(self, frames: FrameList) -> bool:
        """Whether there is nothing left to do."""
        if not self.group.members or self.place == self.end:
            return True
        return self.place < 0 or (self.place >= len(frames) and frames.complete)

    @property
    def has_begun(self) -> bool:
        """Whether the first frame was looked at."""
        return self._tracker is not None

    def waits_for(self, run: TrackingRun) -> bool:
        """Whether another run comes to the first frame, where it is not known yet where its target is."""
        target = self.group.members.get(run.target.number)
        comes = run.place >= self.click if run.backward else run.place <= self.click
        return target is run.target and target.answer(self.click) is None and comes

    def is_after(self, place: int) -> bool:
        """Whether it has come past a frame, going forward, since a person said last where a target is."""
        told = self.group.next_told(place)
        return not self.backward and self.place > place and (told is None or told >= self.place)

    def step(self, begin: Callable[[FileTarget, int], FileTarget | None]) -> None:
        """Follow all into the next frame; raises InterruptedReadingError if something is wanted more.

        Parameters
        ----------
        begin : callable
            Begins a target that was found in a frame and looks like another one; None: there are enough.
        """
        frame = self._walk.next(self.place)
        start = time.thread_time()
        self._begin_where_told(frame)
        if self.place != self.click:
            self._follow(frame, begin)
        self.seconds = time.thread_time() - start
        self.place += -1 if self.backward else 1

    def _begin_where_told(self, frame: Frame) -> None:
        """Begin at the first frame, and take over what nobody follows yet, and what a person said."""
        if self._tracker is None:
            color = joined(each.color for each in self.group.members.values() if each.color is not None)
            family = parse_shape(self.target.shape)
            self._twice = 2.0 * frame.time
            self._tracker = AlikeTracker(family, color, self.group.finds, self.group.parameters.alike)
            for number, target in self.group.members.items():
                answer = target.answer(self.place)
                if answer is None:
                    continue
                last = answer if isinstance(answer, Track) else target.nearest(self.place, not self.backward)
                if last is not None:
                    self._add(number, last, hidden=isinstance(answer, Lost))

    def _follow(self, frame: Frame, begin: Callable[[FileTarget, int], FileTarget | None]) -> None:
        tracker, members = self._tracker, self.group.members
        assert tracker is not None
        tracker.finds = self.group.finds
        for number in self._followed - set(members):
            self._remove(number)

        def found() -> int | None:
            born = begin(self.target, self.place)
            if born is None:
                return None
            self._followed.add(born.number)
            return born.number

        moment = self._mirrored(frame.time)
        answers = tracker.update(msgspec.structs.replace(frame, time=moment), lambda each: members[each].name, found)
        answers = self._corrected(answers)
        for number, target in members.items():
            if number in answers:
                track, others = answers[number]
                target.put(self.place, self._of_frame(track, frame), others)
            else:
                self._take_over(target, answers, frame)

    def _corrected(self, answers: dict[int, TogetherAnswer]) -> dict[int, TogetherAnswer]:
        """Where a person said where targets are, they are there, and one that was taken for it is what that was."""
        for number, track in self.group.told.get(self.place, {}).items():
            found = answers.get(number)
            if found is not None and isinstance(found.track, Track) and on_one(found.track, track):
                continue
            others = [each for each, (taken, _) in answers.items() if isinstance(taken, Track) and on_one(taken, track)]
            moved = {number: track}
            if others and found is not None and isinstance(found.track, Track):
                moved[others[0]] = found.track
            for each in {number, *others}:
                self._remove(each)
            for each, where in moved.items():
                self._add(each, where)
                answers[each] = TogetherAnswer(where)
            for each in set(others) - set(moved):
                name = self.group.members[number].name
                answers[each] = TogetherAnswer(Lost(f"hidden behind {name}, which looks the same", track.time))
                self._add(each, track, hidden=True)
        return answers

    def _take_over(self, target: FileTarget, answers: Mapping[int, TogetherAnswer], frame: Frame) -> None:
        """Follow on one that nobody follows yet from where it was found before, if nothing else is there."""
        known = target.answer(self.place)
        if isinstance(known, Track):
            seen = [each.track for each in answers.values() if isinstance(each.track, Track)]
            if not any(on_one(known, each) for each in seen):
                self._add(target.number, known)
                return
        if known is not None or target.clicked:
            target.put(self.place, Lost("not found yet", frame.time))

    def _add(self, number: int, track: Track[Any], hidden: bool = False) -> None:
        assert self._tracker is not None
        self._tracker.add(number, msgspec.structs.replace(track, time=self._mirrored(track.time)), hidden)
        self._followed.add(number)

    def _remove(self, number: int) -> None:
        assert self._tracker is not None
        self._tracker.remove(number)
        self._followed.discard(number)

    def _mirrored(self, moment: float) -> float:
        """Return a time as the tracker has it, for which all goes forward, s."""
        return self._twice - moment if self.backward else moment

    def _of_frame(self, answer: Answer, frame: Frame) -> Answer:
        """Return an answer with the frame's own time."""
        if isinstance(answer, Lost) or answer.acquired is None:
            return msgspec.structs.replace(answer, time=frame.time)
        acquired = msgspec.structs.replace(answer.acquired, time=self._mirrored(answer.acquired.time))
        return msgspec.structs.replace(answer, time=frame.time, acquired=acquired)


Run = TrackingRun | AlikeRun


class RunQueue:
    """The ways of targets through a video that are not at their end, the newest last.

    Parameters
    ----------
    reader : ExactReader

    Attributes
    ----------
    all : list of TrackingRun or AlikeRun
    """

    def __init__(self, reader: ExactReader) -> None:
        self._reader = reader
        self.all: list[Run] = []

    def take_over(self, frames: FrameList) -> list[Run]:
        """Remove those that are at their end, and return them."""
        over = [run for run in self.all if run.over(frames)]
        self.all = [run for run in self.all if run not in over]
        return over

    def forget(self, target: FileTarget) -> None:
        """Remove those of a single target."""
        self.all = [run for run in self.all if isinstance(run, AlikeRun) or run.target is not target]

    def reach(self, place: int) -> int | None:
        """Return up to which frame all is known that is being tracked forward past a place; None: to the end."""
        ways = [run for run in list(self.all) if not run.backward]
        known = [max(run.place - 1, run.click) for run in ways if run.click <= place]
        return min((each for each in known if each >= place), default=None)

    def ready(self, count: int) -> list[Run]:
        """Return those that can go on where so many frames are known, the newest first.

        One that follows several waits for those that come to where it begins.
        """
        found = list[Run]()
        for run in reversed(self.all):
            before = None
            if isinstance(run, AlikeRun) and not run.has_begun:
                before = next(
                    (each for each in self.all if isinstance(each, TrackingRun) and run.waits_for(each)), None
                )
            wanted = before or run
            if wanted.place < count:
                found.append(wanted)
        return found

    def follow_together(self, group: FileGroup, place: int, joined: FileTarget | None = None) -> None:
        """Follow a group from a frame on, both ways; a target that has joined it is followed alone no more."""
        back = place + (group.parameters.lead if group.finds else 0)
        others = (run for run in self.all if not (isinstance(run, AlikeRun) and run.group is group))
        others = (run for run in others if isinstance(run, AlikeRun) or run.target is not joined)
        ways = AlikeRun(group, back, True, self._reader), AlikeRun(group, place, False, self._reader)
        self.all = [*others, *ways]

    def correct_together(self, group: FileGroup, place: int, first: bool) -> None:
        """Follow a group anew from a frame on, up to the next one for which a person said where a target is."""
        old = [each for each in self.all if isinstance(each, AlikeRun) and each.group is group]
        old = [each for each in old if each.is_after(place) or (first and each.backward and each.place < place)]
        self.all = [each for each in self.all if each not in old]
        end = None if any(not each.backward for each in old) else group.next_told(place)
        if first:
            self.all.append(AlikeRun(group, place, True, self._reader))
        self.all.append(AlikeRun(group, place, False, self._reader, end))
