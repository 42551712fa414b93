"""All targets of a camera: they begin without holding up the pictures, what is nothing ends: `FollowedTargets`."""

import functools
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import NamedTuple

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.live.targets.alike import DROPPED, TogetherAnswer
from matchset.live.targets.clicks import AGAIN, NEWER, Clicks
from matchset.live.targets.groups import AlikeGroups
from matchset.live.targets.messages import (
    Begin,
    Diameter,
    Drop,
    FieldOfView,
    FindAll,
    Hold,
    Marker,
    Outline,
    Pick,
    Rename,
    Reread,
    Wish,
)
from matchset.live.targets.target import ClickedTarget, catch_up, is_beside, same_place
from matchset.live.targets.target_facts import checked_name, free_name
from matchset.live.targets.target_localizer import ball_of, camera_of
from matchset.live.targets.target_maker import TargetMaker
from matchset.live.vision.kept_frames import KeptFrames
from matchset.live.wire.state import CrowdState, TargetState
from matchset.media.closing import Closing
from matchset.tracking.track import Track


class FollowedTargetsParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How many targets there are, and how long one may take to be found.

    Parameters
    ----------
    targets : int
        At most. More: a slower loop, most of all where they are lost. Chosen by hand: a list that can be read; see
        docs/live.md for what 20 that look alike take.
    trial : float
        For how long something clicked may not be found before it is given up, s. Longer: a ball clicked while it is
        hidden or blurred is still found; and clicks on nothing cost more. Chosen by hand: with what learning a color
        takes, a wrong click is refused within a second.
    on_trial : int
        How many may be on trial; with one more the oldest is given up. More: a thousand clicks cost more. Chosen by
        hand: a person clicks on one thing, then the next.
    """

    targets: int = 20
    trial: float = 0.6
    on_trial: int = 2


class _Making(NamedTuple):
    """A target that is being made, and what is to be done with it then."""

    number: int
    begin: Begin
    frame: Frame
    result: Future[ClickedTarget]
    later: list[Wish]


class _Trial(NamedTuple):
    """A target that was not found yet: what began it, time of the picture in which that was, and since when, s."""

    begin: Begin
    clicked: float
    since: float


class FollowedTargets(Closing):
    """Follows what was clicked. All methods are for one thread, that of the pictures.

    Parameters
    ----------
    kept : KeptFrames
        The last pictures: a click names one.
    note : callable
        Told what a person should know.
    parameters : FollowedTargetsParameters, optional
    clicks : Clicks, optional
        Told what became of each click.

    Attributes
    ----------
    camera : CameraModel or None
    clicks : Clicks
    """

    def __init__(
        self,
        kept: KeptFrames,
        note: Callable[[str], None],
        parameters: FollowedTargetsParameters | None = None,
        clicks: Clicks | None = None,
    ) -> None:
        self.clicks = clicks or Clicks(note)
        self._kept, self._note, self._parameters = kept, note, parameters or FollowedTargetsParameters()
        self._targets: dict[int, ClickedTarget] = {}
        self._trials: dict[int, _Trial] = {}
        self._making: deque[_Making] = deque()
        self._numbers = 0
        self._groups = AlikeGroups()
        self._maker: TargetMaker[ClickedTarget] = TargetMaker()
        self.camera: CameraModel | None = None

    def close(self) -> None:
        """Make no targets any more."""
        self._maker.close()

    @property
    def targets(self) -> Sequence[ClickedTarget]:
        """What is followed."""
        return list(self._targets.values())

    def target(self, number: int) -> ClickedTarget:
        """Return a target by its number.

        Raises
        ------
        ValueError
            If there is none.
        """
        found = self._targets.get(number)
        if found is None:
            raise ValueError(f"there is no target {number} any more")
        return found

    def do(self, wish: Wish) -> None:
        """Do what was asked for.

        Raises
        ------
        ValueError
            If it cannot be done.
        """
        making = next((made for made in self._making if made.number == getattr(wish, "target", None)), None)
        if isinstance(wish, Pick | Outline):
            self._try(wish)
        elif isinstance(wish, Hold):
            self._kept.hold(wish.sequence)
        elif making is not None:
            making.later.append(wish)
        elif isinstance(wish, Drop):
            target = self.target(wish.target)
            if self._groups.end_finding(wish.target):
                self._note(DROPPED.format(target.name))
            self._forget(wish.target)
        elif isinstance(wish, Reread):
            self._reread(wish)
        elif isinstance(wish, Rename):
            target = self.target(wish.target)
            target.name = checked_name(wish.name, self._names_without(target))
            target.is_kept = True
        elif isinstance(wish, FindAll):
            self._find_all(wish)
        elif isinstance(wish, Diameter):
            self.target(wish.target).locate(self.camera, ball_of(wish))
        elif isinstance(wish, Marker):
            frame = self._kept.since(wish.sequence)[0]
            self.target(wish.target).mark(frame, wish.x, wish.y, wish.meters)
            self._groups.recolor(wish.target)
        elif isinstance(wish, FieldOfView):
            self._view(wish)

    def locate(self, camera: CameraModel | None) -> None:
        """Take another camera model."""
        self.camera = camera
        for each in self._targets.values():
            each.locate(camera, each.ball)

    def clear(self) -> None:
        """Forget all targets."""
        self._groups.clear()
        waiting = [*(made.begin for made in self._making), *(trial.begin for trial in self._trials.values())]
        for begin in (*waiting, *(begin for begin, _ in self._groups.take_answers())):
            self.clicks.turn_away(begin, "the pictures are others now: click again")
        self._targets.clear()
        self._trials.clear()
        self._making.clear()

    def restart(self) -> None:
        """Take note that the source begins anew: where targets were says nothing any more."""
        for each in self._targets.values():
            each.tracker.restart()
        self._groups.restart()

    def update(self, frame: Frame) -> list[TargetState]:
        """Follow all into a frame."""
        self._take_made()
        together = self._groups.update(frame, self._room, self._begin_alike)
        self._take_answers()
        for number in self._groups.gone(self.targets, frame.time):
            self._forget(number)
        states = {number: self._updated(target, frame, together) for number, target in self._targets.items()}
        for number in list(self._trials):
            self._judge(number, frame, states)
        judged = {number: target for number, target in self._targets.items() if number not in self._trials}
        for number, (track, others) in self._groups.merge(judged, frame).items():
            states[number] = self._targets[number].take(frame, track, others)
        for number in self._trials:
            states[number] = msgspec.structs.replace(states[number], pending=True, reason="finding it ...")
        return [self._shown(states[number]) for number in self._targets]

    @property
    def crowd(self) -> CrowdState | None:
        """What is doubtful, and how many are left out, while all that looks like a target is looked for."""
        return self._groups.crowd(self.targets, self._parameters.targets)

    def _take_answers(self) -> None:
        """Say what became of clicks on what is doubtful; what was not found is clicked as anything else is."""
        for begin, number in self._groups.take_answers():
            if number is None:
                try:
                    self._begin(begin)
                except ValueError as error:
                    self.clicks.refuse(begin, str(error))
            elif number in self._targets:
                self._targets[number].is_kept = True
                self.clicks.accept(begin)

    def _updated(self, target: ClickedTarget, frame: Frame, together: dict[int, TogetherAnswer]) -> TargetState:
        """Follow a target into a frame, by its own tracker if it is not followed together with others."""
        answer = together.get(target.number)
        return target.update(frame) if answer is None else target.take(frame, *answer)

    def _shown(self, state: TargetState) -> TargetState:
        """Say of a target whether all that looks like it is followed."""
        group = self._groups.of(state.id)
        return state if group is None or not group.finds else msgspec.structs.replace(state, finds=True)

    @property
    def _room(self) -> int:
        """How many more targets there may be."""
        return self._parameters.targets - len(self._targets) - len(self._making)

    def _begin_alike(self, other: ClickedTarget) -> ClickedTarget:
        """Begin a target that was found since it looks like another one."""
        self._numbers += 1
        target = self._targets[self._numbers] = other.alike(self._numbers)
        target.name = free_name(target.name, self._names_without(target))
        if self._room <= 0:
            self._note(f"{self._parameters.targets} targets are enough: no more are looked for until one is gone")
        return target

    def _names_without(self, target: ClickedTarget) -> list[str]:
        return [each.name for each in self.targets if each is not target]

    def _find_all(self, wish: FindAll) -> None:
        target = self.target(wish.target)
        if wish.target in self._trials:
            raise ValueError(f"{target.name} is not found yet: then all like it can be")
        if wish.on and self._room <= 0:
            raise ValueError(f"{self._parameters.targets} targets are enough: drop one first")
        self._groups.find_all(target, wish.on)

    def _view(self, wish: FieldOfView) -> None:
        newest = self._kept.newest
        if newest is None:
            raise ValueError("there is no picture yet whose field of view could be told")
        height, width = newest.image.shape[:2]
        self.locate(camera_of(wish, width, height))

    def _try(self, begin: Begin) -> None:
        """Begin a target, or follow what is doubtful there; a page hears why that cannot be."""
        try:
            if self._room <= 0 or not self._groups.follow_doubtful(begin):
                self._begin(begin)
        except ValueError as error:
            self.clicks.turn_away(begin, str(error))
            raise

    def _begin(self, begin: Begin) -> None:
        """Make a target in the background: its color is learned, and perhaps something is compiled."""
        frame = self._kept.since(begin.sequence)[0]
        while len(self._trials) >= self._parameters.on_trial:
            number, trial = next(iter(self._trials.items()))
            self.clicks.turn_away(trial.begin, NEWER)
            self._forget(number)
        if len(self._making) >= self._parameters.on_trial:  # clicks that wait give way to newer ones
            cancelled = [made for made in self._making if made.result.cancel()]
            self._making = deque(made for made in self._making if made not in cancelled)
            for made in cancelled:
                self.clicks.turn_away(made.begin, NEWER)
                self._do_later(made)
        if self._room <= 0:
            raise ValueError(f"{self._parameters.targets} targets are enough: drop one first")
        self._numbers += 1
        order = functools.partial(ClickedTarget, self._numbers, begin, frame)
        self._making.append(_Making(self._numbers, begin, frame, self._maker.order(order), []))

    def _reread(self, wish: Reread) -> None:
        """Make a target anew in its place, since its click meant something else."""
        clicked = self.target(wish.target).clicked
        if clicked is None:
            raise ValueError(f"{self.target(wish.target).name} was not clicked: there is nothing else that it may mean")
        click, frame = clicked
        meant = msgspec.structs.replace(click, reading=wish.reading)
        order = functools.partial(ClickedTarget, wish.target, meant, frame)
        self._making.append(_Making(wish.target, meant, frame, self._maker.order(order), []))

    def _take_made(self) -> None:
        while self._making and self._making[0].result.done():
            made = self._making.popleft()
            try:
                self._put(made)
            except ValueError as error:
                self.clicks.refuse(made.begin, str(error))
            self._do_later(made)

    def _put(self, made: _Making) -> None:
        """Follow a target that is made up to the newest picture; ValueError if it could not be made."""
        number, begin, frame = made.number, made.begin, made.frame
        target, before = made.result.result(), self._targets.get(number)
        target.locate(self.camera, None if before is None else before.ball)
        frames = [frame, *self._kept.after(begin.sequence)]
        catch_up(target, frames)
        self._groups.leave(number)
        target.name = before.name if before else free_name(target.name, self._names_without(target))
        self._targets[number], self._trials[number] = target, _Trial(begin, frame.time, frames[-1].time)
        if target.note:
            self._note(target.note)

    def _do_later(self, made: _Making) -> None:
        """Do what waited for a target: with what it was before, if it could not be made anew."""
        for wish in made.later:
            try:
                self.do(wish)
            except ValueError as error:
                self._note(str(error))

    def _judge(self, number: int, frame: Frame, states: dict[int, TargetState]) -> None:
        """End the trial of a target: it is found, it is one that is followed already, or it is nothing."""
        state, target, trial = states[number], self._targets[number], self._trials[number]
        over = not 0.0 <= frame.time - trial.since <= self._parameters.trial
        twin = next((each for each in states.values() if each.id != number and same_place(each, state)), None)
        if twin is not None:
            words = f"that is {twin.name}, which is followed already"
        elif isinstance(target.answer, Track) and is_beside(trial.begin, target.answer, frame.time - trial.clicked):
            words = f"the {target.shape} that was found is not where you clicked. {AGAIN}"
        elif state.found or (over and target.seen is not None):
            del self._trials[number]
            self.clicks.accept(trial.begin)
            self._groups.join(target, (each for each in self.targets if each.number not in self._trials))
            return
        elif over:
            at = "({:.0f}, {:.0f})".format(*target.begun)
            words = f"no {target.shape} at {at}: {state.reason}. {AGAIN}"
        else:
            return
        self.clicks.refuse(trial.begin, words)
        self._forget(number)
        del states[number]

    def _forget(self, number: int) -> None:
        self._groups.leave(number)
        self._targets.pop(number, None)
        self._trials.pop(number, None)
