"""Follows targets through a whole file in the background, from their clicks forward and backward: `FileTracking`."""

import threading
import time
from collections.abc import Callable

import msgspec

from matchset.app.timing.durations import ShownTimes
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.live.files.alike_run import AlikeRun, Run, RunQueue
from matchset.live.files.file_group import FileGroups
from matchset.live.files.file_target import FileTarget
from matchset.live.files.messages import Correct
from matchset.live.files.player import ClickedPictures
from matchset.live.files.run import RecentCount, TrackingParameters, TrackingRun
from matchset.live.files.trials import Trial, Trials
from matchset.live.targets.alike import DROPPED
from matchset.live.targets.clicks import AGAIN, NEWER, Clicks
from matchset.live.targets.messages import (
    Begin,
    Diameter,
    Drop,
    FieldOfView,
    FindAll,
    Hold,
    Pick,
    Rename,
    Reread,
    Wish,
)
from matchset.live.targets.target import ClickedTarget
from matchset.live.targets.target_facts import checked_name, free_name
from matchset.live.targets.target_localizer import ball_of, camera_of
from matchset.live.targets.waiting import WaitingWishes
from matchset.localization.ball_target import BallTarget
from matchset.media.closing import Closing
from matchset.media.exact_reader import ExactReader, InterruptedReadingError
from matchset.media.frame_list import FrameList
from matchset.tracking.track import Track

Asked = Wish | Correct


class FileTracking(Closing):
    """Follows targets in a thread of its own; the newest click first.

    Parameters
    ----------
    reader : ExactReader
        For this thread alone.
    frames : FrameList
    shown : ClickedPictures
    note : callable
        Told what a person should know.
    parameters : TrackingParameters, optional

    Attributes
    ----------
    targets : dict of int to FileTarget
        Replaced, never changed, so any thread may look.
    camera : CameraModel or None
    clicks : Clicks
        Told what became of each click.
    calm : threading.Event
        Cleared while a click waits for its answer: what reads ahead lets it have the processor.
    answered : callable
        Called in the thread when a first click was tried; told whether something was found there.
    """

    def __init__(
        self,
        reader: ExactReader,
        frames: FrameList,
        shown: ClickedPictures,
        note: Callable[[str], None],
        parameters: TrackingParameters | None = None,
    ) -> None:
        self._reader, self._frames, self._shown, self._note = reader, frames, shown, note
        self._parameters = parameters or TrackingParameters()
        self.clicks, self._trials = Clicks(note), Trials()
        self.calm = threading.Event()
        self.calm.set()
        self.answered: Callable[[bool], None] = lambda _: None
        self.targets: dict[int, FileTarget] = {}
        self.camera: CameraModel | None = None
        self.size = (0, 0)
        self._changes = self._numbers = 0
        self._runs, self._groups = RunQueue(reader), FileGroups()
        self._done = RecentCount(self._parameters.rate_over)
        self._computing = ShownTimes()
        self._wishes: WaitingWishes[Asked] = WaitingWishes(self._parameters.wishes)
        self._stop, self._news, self._urgent = threading.Event(), threading.Event(), threading.Event()
        reader.interrupted = self._urgent.is_set
        self._thread = threading.Thread(target=self._run, name="matchset file", daemon=True)
        self._thread.start()

    def ask(self, wish: Asked) -> None:
        """Ask for something; done before the next frame. What cannot be done is a note on the page."""
        given_up = self._wishes.put(wish)
        if given_up is not None:
            self.clicks.leave_out(given_up)
        if given_up is wish:
            return
        if isinstance(wish, Begin | Correct | Drop | Reread):  # who clicks waits for no long reading
            self._urgent.set()
        if isinstance(wish, Begin):
            self.calm.clear()
        self._news.set()

    @property
    def version(self) -> int:
        """Changes whenever something else is known."""
        return self._changes + sum(target.version for target in self.targets.values())

    @property
    def rate(self) -> float | None:
        """Frames per second that are tracked now; None while nothing is."""
        return (self._done.rate or None) if self.busy else None

    @property
    def computing(self) -> dict[str, float]:
        """What a frame took so far, ms: median, mean, percentile_95, worst; empty before the first."""
        return self._computing.in_ms

    @property
    def busy(self) -> bool:
        """Whether something is being tracked."""
        return bool(self._runs.all) or len(self._wishes) > 0

    def reach(self, place: int) -> int | None:
        """Return up to which frame all is known that is being tracked forward past a place; None: to the end.

        From a place that the tracking has not reached yet, a person has gone there to look for something: None, too.
        """
        return self._runs.reach(place)

    def close(self) -> None:
        """End the thread."""
        for event in (self._stop, self._urgent, self._news, self.calm):
            event.set()
        self._thread.join()
        self._reader.close()

    def _run(self) -> None:
        while not self._stop.is_set():
            self._grant()
            run = self._next_run()
            if run is None or run.target.number not in self._trials:
                self.calm.set()
            if run is None:
                self._news.wait(0.05 if self._runs.all or not self._frames.complete else None)
                self._news.clear()
                continue
            try:
                if isinstance(run, AlikeRun):
                    if not run.has_begun:
                        self._begin_together(run)
                    run.step(self._begin_alike)
                else:
                    run.step()
            except InterruptedReadingError:
                continue
            except (ValueError, OSError) as error:
                self._fail(run, str(error))
                continue
            self._count(run)

    def _fail(self, run: Run, words: str) -> None:
        """End a run whose frames cannot be read."""
        self._runs.all.remove(run)
        if run.target.known:
            self._note(words)
        else:
            self._refuse(run.target, words)

    def _next_run(self) -> Run | None:
        """Return the run that goes on: of a click that waits for its answer, else of the newest; others are removed."""
        for run in self._runs.take_over(self._frames):
            if run.target.number in self._trials and not run.backward:
                self._refuse(run.target, f"no {run.target.shape} was found there up to the end of the video. {AGAIN}")
        ready = self._runs.ready(len(self._frames))
        trials = (run for run in ready if run.target.number in self._trials and not run.backward)
        return next(trials, ready[0] if ready else None)

    def _count(self, run: Run) -> None:
        self._computing.add(run.seconds)
        self._done.add(run.count)
        if isinstance(run, AlikeRun):
            return
        if run.target.number in self._trials and not run.backward:
            self._judge(run)
        if run.target.number in self.targets and run.target.number not in self._trials:
            self._join(run)

    def _judge(self, run: TrackingRun) -> None:
        """End the trial of a target: it is found where it was clicked, or later, or the click was on nothing."""
        words = self._trials.verdict(run, self.targets.values())
        if words:
            self._refuse(run.target, words)
        elif words is not None:
            self.clicks.accept(self._trials.pop(run.target.number).begin)
            self._tell(True)

    def _refuse(self, target: FileTarget, words: str) -> None:
        """Follow a target no more, and say why."""
        trial = self._trials.get(target.number)
        self._forget(target)
        if trial is None:
            self._note(words)
        else:
            self.clicks.refuse(trial.begin, words)
        self._tell(False)

    def _tell(self, found: bool) -> None:
        """Say that a click is answered, unless another one waits for that."""
        if found or not (self._trials or len(self._wishes)):
            self.answered(found)

    def _grant(self) -> None:
        """Do what was asked for."""
        while not self._stop.is_set():
            self._urgent.clear()
            wish = self._wishes.take()
            if wish is None:
                return
            try:
                self._do(wish)
            except InterruptedReadingError:  # something newer goes first; of clicks that one counts alone
                if isinstance(wish, Begin) and self._wishes.has_click:
                    self._turn_away(wish, NEWER)
                else:
                    self.ask(wish)
            except ValueError as error:
                self._note(str(error))
                self._turn_away(wish, str(error))
            self._changes += 1

    def _turn_away(self, wish: Asked, words: str) -> None:
        if isinstance(wish, Begin):
            self.clicks.turn_away(wish, words)
            self._tell(False)

    def _do(self, wish: Asked) -> None:
        if isinstance(wish, Begin):
            self._begin(wish)
        elif isinstance(wish, Hold):
            self._shown.place_of(wish.sequence)  # every frame of a video can be read again
        elif isinstance(wish, FieldOfView):
            self.use(camera_of(wish, *self.size))
        else:
            target = self._target(wish.target)
            if isinstance(wish, Correct):
                self._correct(target, wish)
            elif isinstance(wish, Drop):
                if self._groups.end_finding(target.number):
                    self._note(DROPPED.format(target.name))
                self._forget(target)
            elif isinstance(wish, Diameter):
                target.locate(self.camera, ball_of(wish))
            elif isinstance(wish, Reread):
                self._reread(target, wish)
            elif isinstance(wish, Rename):
                target.rename(checked_name(wish.name, self._names_without(target)))
            elif isinstance(wish, FindAll):
                self._find_all(target, wish.on)
            else:
                raise ValueError("markers are looked for in a camera's pictures, not in a video: matchset locate does")

    def use(self, camera: CameraModel | None) -> None:
        """Take another camera model; from any thread."""
        self.camera = camera
        self._changes += 1
        for target in self.targets.values():
            target.locate(camera, target.ball)

    def _names_without(self, target: FileTarget) -> list[str]:
        return [each.name for each in self.targets.values() if each is not target]

    def _join(self, run: TrackingRun) -> None:
        """Follow a target that was found together with those that look like it, from that frame on, both ways."""
        target, place = run.target, run.place + (1 if run.backward else -1)
        if self._groups.of(target.number) is None and isinstance(target.answer(place), Track):
            others = (each for each in self.targets.values() if each.number not in self._trials and each is not target)
            group = self._groups.join(target, others)
            if group is not None:
                self._runs.follow_together(group, place, target)

    def _begin_together(self, run: AlikeRun) -> None:
        """End the runs of single targets that are followed together from here on; two on one outline are one."""
        while twins := run.group.twins(run.click):
            one, other = twins
            self._note(f"{other.name} is {one.name}, which is followed already")
            self._forget(other)
        for each in run.group.members.values():
            self._runs.forget(each)

    def _find_all(self, target: FileTarget, on: bool) -> None:
        """Follow all that looks like a target, too, from where it was clicked on; or look for no more of them."""
        if on and len(self.targets) >= self._parameters.targets:
            raise ValueError(f"{self._parameters.targets} targets are enough: drop one first")
        clicked = min(target.clicks)
        place = clicked if isinstance(target.answer(clicked), Track) else target.first_found()
        if on and (place is None or target.number in self._trials):
            raise ValueError(f"{target.name} is not found yet: then all like it can be")
        group = self._groups.begin(target)
        group.set_finds(on)
        if on and place is not None:
            self._runs.follow_together(group, place)

    def _begin_alike(self, other: FileTarget, place: int) -> FileTarget | None:
        """Begin a target that was found since it looks like another one; None: there are enough."""
        group = self._groups.begin(other)
        if len(self.targets) >= self._parameters.targets:
            return None
        self._numbers += 1
        target = other.alike(self._numbers, place)
        target.name = free_name(target.name, self._names_without(target))
        self.targets = {**self.targets, target.number: target}
        group.members[target.number] = target
        if len(self.targets) == self._parameters.targets:
            self._note(f"{self._parameters.targets} targets are enough: no more are looked for")
            group.set_finds(False)
        return target

    def _target(self, number: int) -> FileTarget:
        found = self.targets.get(number)
        if found is None:
            raise ValueError(f"there is no target {number} any more")
        return found

    def _begin(self, wish: Begin) -> None:
        """Begin a target; those that were tried in vain so far give way to it."""
        for number, trial in list(self._trials.items()):
            if self.targets[number].known:
                self.clicks.turn_away(trial.begin, NEWER)
                self._forget(self.targets[number])
        if len(self.targets) >= self._parameters.targets:
            raise ValueError(f"{self._parameters.targets} targets are enough: drop one first")
        place, since = self._shown.place_of(wish.sequence), time.monotonic()
        self._follow(self._numbers + 1, wish, place, None)
        self._numbers += 1
        self._trials[self._numbers] = Trial(wish, since)

    def _follow(self, number: int, click: Begin, place: int, ball: BallTarget | None) -> None:
        """Follow a target from its first click on, both ways."""
        frame = self._frame(click, place)
        made = ClickedTarget(number, click, frame)
        target = FileTarget(number, click, place)
        target.locate(self.camera, ball)
        target.color, target.readings = made.tracker.color.copy(), made.readings
        self.targets = {**self.targets, number: target}
        backward, forward = (TrackingRun(target, place, each, self._reader, frame) for each in (True, False))
        self._runs.all += [backward, forward]
        forward.begin_with(made.tracker)
        if made.note:
            self._note(made.note)

    def _frame(self, click: Begin | Correct, place: int) -> Frame:
        """Return the frame that was clicked: the one that is shown, else it is read."""
        frame = self._shown.frame_of(click.sequence)
        return self._reader.frame(place) if frame is None else frame

    def _reread(self, target: FileTarget, wish: Reread) -> None:
        """Follow something else that the first click may mean; what was found of it is forgotten, and later clicks."""
        place = min(target.clicks)
        click = target.clicks[place]
        if not isinstance(click, Pick):
            raise ValueError(f"{target.name} was not clicked: there is nothing else that it may mean")
        self._follow(target.number, msgspec.structs.replace(click, reading=wish.reading), place, target.ball)
        self.targets[target.number].name = target.name
        self._groups.forget(target.number)
        self._runs.forget(target)
        self._changes += 1 + target.version

    def _correct(self, target: FileTarget, wish: Correct) -> None:
        place = self._shown.place_of(wish.sequence)
        click = Pick(wish.sequence, wish.x, wish.y, target.shape)
        frame, group = self._frame(wish, place), self._groups.of(target.number)
        made = ClickedTarget(target.number, click, frame)  # refuses what cannot be followed
        if group is not None:
            made.update(frame)
            if made.last is None:
                raise ValueError(f"no {target.shape} was found there. {AGAIN}")
            first = place <= min(group.told, default=place)
            group.correct(target.number, place, made.last)
            self._runs.correct_together(group, place, first)
            return
        first = place <= min(target.clicks)
        target.correct(wish, place)
        ways = (True, False) if first else (False,)
        self._runs.all += [TrackingRun(target, place, backward, self._reader, frame) for backward in ways]

    def _forget(self, target: FileTarget) -> None:
        self._trials.pop(target.number, None)
        self._groups.forget(target.number)
        self.targets = {number: other for number, other in self.targets.items() if other is not target}
        self._runs.forget(target)
        self._changes += 1 + target.version
