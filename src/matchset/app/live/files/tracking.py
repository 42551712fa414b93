"""Follows targets through a whole file in the background, from their clicks forward and backward: `FileTracking`."""

import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

import msgspec

from matchset.app.closing import Closing
from matchset.app.live.files.exact_reader import ExactReader
from matchset.app.live.files.file_target import FileTarget
from matchset.app.live.files.frame_list import FrameList
from matchset.app.live.files.messages import Correct
from matchset.app.live.targets.messages import Diameter, Drop, FieldOfView, Hold, Marker, Outline, Pick, Reread
from matchset.app.live.targets.placing import ball_of, camera_of
from matchset.app.live.targets.target import Target
from matchset.app.timing.durations import ShownTimes
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.tracking.track import Lost
from matchset.tracking.tracker import Tracker

Asked = Pick | Outline | Hold | Correct | Drop | Reread | Diameter | Marker | FieldOfView


class TrackingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a file is tracked in the background.

    Parameters
    ----------
    targets : int
        At most; each keeps 2 kB of answers a frame. Chosen by hand: a list that fits on a screen.
    wishes : int
        Clicks that wait at most; more are refused.
    trial : int
        Frames after a first click in one of which the target must be found, or the click was on nothing. Chosen by
        hand.
    rate_over : float
        Over what time the rate is taken, s. Chosen by hand: figures that can be read.
    """

    targets: int = 8
    wishes: int = 64
    trial: int = 30
    rate_over: float = 1.0


class Run:
    """The way of a target from a click on, in one direction.

    Parameters
    ----------
    target : FileTarget
    click : int
        Place of the frame in which it was clicked.
    backward : bool
    reader : ExactReader

    Attributes
    ----------
    seconds : float
        Computing time of the last frame, s.
    """

    def __init__(self, target: FileTarget, click: int, backward: bool, reader: ExactReader) -> None:
        self.target, self.click, self.backward = target, click, backward
        self.place, self.seconds = click, 0.0
        self._begin, self._reader = target.clicks[click], reader
        self._tracker: Tracker[Any] | None = None
        self._turn = 0.0
        self._frames: Iterator[Frame] | None = None

    def over(self, frames: FrameList) -> bool:
        """Whether there is nothing left to do: the end has come, or another click decides from here on."""
        target = self.target
        if self.place < 0 or (self.place >= len(frames) and frames.complete):
            return True
        return target.clicks.get(self.click) is not self._begin or not target.decides(self.click, self.place)

    def step(self) -> None:
        """Follow the target into the next frame."""
        frame = self._next()
        if self._tracker is None:
            self._tracker, self._turn = Target(self.target.number, self._begin, frame).tracker, 2.0 * frame.time
        mirrored = Frame(frame.image, self._turn - frame.time, frame.index) if self.backward else frame
        begin = time.thread_time()
        answer = self._tracker.update(mirrored)
        self.seconds = time.thread_time() - begin
        if self.backward and self.place != self.click:
            answer = msgspec.structs.replace(answer, time=frame.time)
        if not self.backward or self.place != self.click:  # in the frame of the click the way forward counts
            self.target.put(self.place, answer)
        self.place += -1 if self.backward else 1

    def _next(self) -> Frame:
        if not self.backward:
            return self._reader.frame(self.place)
        if self._frames is None:
            self._frames = self._reader.backward(self.click)
        return next(self._frames)


class FileTracking(Closing):
    """Follows targets in a thread of its own; the newest click first.

    Parameters
    ----------
    reader : ExactReader
        For this thread alone.
    frames : FrameList
    place_of : callable
        From the number of a picture that was shown to the place of its frame.
    note : callable
        Told what a person should know.
    parameters : TrackingParameters, optional

    Attributes
    ----------
    targets : dict of int to FileTarget
        Replaced, never changed, so any thread may look.
    camera : CameraModel or None
    version : int
        Changes whenever something else is known.
    """

    def __init__(
        self,
        reader: ExactReader,
        frames: FrameList,
        place_of: Callable[[int], int],
        note: Callable[[str], None],
        parameters: TrackingParameters | None = None,
    ) -> None:
        self._reader, self._frames, self._place_of, self._note = reader, frames, place_of, note
        self._parameters = parameters or TrackingParameters()
        self.targets: dict[int, FileTarget] = {}
        self.camera: CameraModel | None = None
        self.size = (0, 0)
        self._changes = self._numbers = 0
        self._runs: list[Run] = []
        self._done: deque[float] = deque()
        self._computing = ShownTimes()
        self._wishes: queue.Queue[Asked] = queue.Queue(self._parameters.wishes)
        self._stop, self._news = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="matchset file", daemon=True)
        self._thread.start()

    def ask(self, wish: Asked) -> None:
        """Ask for something; done before the next frame. What cannot be done is a note on the page."""
        try:
            self._wishes.put_nowait(wish)
            self._news.set()
        except queue.Full:
            self._note("too many clicks at once: some were left out")

    @property
    def version(self) -> int:
        """Changes whenever something else is known."""
        return self._changes + sum(target.version for target in self.targets.values())

    @property
    def rate(self) -> float | None:
        """Frames per second that are tracked now; None while nothing is."""
        over, now = self._parameters.rate_over, time.monotonic()
        recent = [done for done in list(self._done) if done > now - over]
        return len(recent) / over if self.busy and recent else None

    @property
    def computing(self) -> dict[str, float]:
        """What a frame took so far, ms: median, mean, percentile_95, worst; empty before the first."""
        return self._computing.in_ms

    @property
    def busy(self) -> bool:
        """Whether something is being tracked."""
        return bool(self._runs) or not self._wishes.empty()

    def close(self) -> None:
        """End the thread."""
        self._stop.set()
        self._news.set()
        self._thread.join()
        self._reader.close()

    def _run(self) -> None:
        while not self._stop.is_set():
            self._grant()
            run = self._next_run()
            if run is None:
                self._news.wait(0.05 if self._runs or not self._frames.complete else None)
                self._news.clear()
                continue
            try:
                run.step()
            except (ValueError, OSError) as error:
                self._note(str(error))
                self._runs.remove(run)
                if not run.target.known:
                    self._forget(run.target)
                continue
            self._count(run)

    def _next_run(self) -> Run | None:
        """Return the newest run that can go on; those that are over are removed."""
        self._runs = [run for run in self._runs if not run.over(self._frames)]
        ready = (run for run in reversed(self._runs) if run.place < len(self._frames))
        return next(ready, None)

    def _count(self, run: Run) -> None:
        self._computing.add(run.seconds)
        self._done.append(now := time.monotonic())
        while self._done[0] < now - self._parameters.rate_over:
            self._done.popleft()
        target, passed = run.target, run.place - run.click
        if not run.backward and passed == self._parameters.trial and len(target.clicks) == 1:
            self._judge(target, run.place)

    def _judge(self, target: FileTarget, place: int) -> None:
        """Give a target up that was not found at once."""
        answer = target.answer(place - 1)
        if isinstance(answer, Lost) and target.last_found(place) is None:
            self._note(
                f"no {target.shape} was found there: {answer.reason}. Click on its middle, or draw along its rim"
            )
            self._forget(target)

    def _grant(self) -> None:
        """Do what was asked for."""
        while not self._stop.is_set():
            try:
                wish = self._wishes.get_nowait()
            except queue.Empty:
                return
            try:
                self._do(wish)
            except ValueError as error:
                self._note(str(error))
            self._changes += 1

    def _do(self, wish: Asked) -> None:
        if isinstance(wish, Pick | Outline):
            self._begin(wish)
        elif isinstance(wish, Hold):
            self._place_of(wish.sequence)  # every frame of a video can be read again
        elif isinstance(wish, FieldOfView):
            self.use(camera_of(wish, *self.size))
        else:
            target = self._target(wish.target)
            if isinstance(wish, Correct):
                self._correct(target, wish)
            elif isinstance(wish, Drop):
                self._forget(target)
            elif isinstance(wish, Diameter):
                target.locate(self.camera, ball_of(wish))
            elif isinstance(wish, Reread):
                self._reread(target, wish)
            else:
                raise ValueError("markers are looked for in a camera's pictures, not in a video: matchset locate does")

    def use(self, camera: CameraModel | None) -> None:
        """Take another camera model; from any thread."""
        self.camera = camera
        self._changes += 1
        for target in self.targets.values():
            target.locate(camera, target.ball)

    def _target(self, number: int) -> FileTarget:
        found = self.targets.get(number)
        if found is None:
            raise ValueError(f"there is no target {number} any more")
        return found

    def _begin(self, wish: Pick | Outline) -> None:
        if len(self.targets) >= self._parameters.targets:
            raise ValueError(f"{self._parameters.targets} targets are enough: drop one first")
        place = self._place_of(wish.sequence)
        self._follow(self._numbers + 1, wish, place, None)
        self._numbers += 1

    def _follow(self, number: int, click: Pick | Outline, place: int, ball: BallTarget | None) -> None:
        """Follow a target from its first click on, both ways."""
        made = Target(number, click, self._reader.frame(place))
        target = FileTarget(number, click, place)
        target.locate(self.camera, ball)
        target.color, target.readings = made.tracker.color, made.readings
        self.targets = {**self.targets, number: target}
        self._runs += [Run(target, place, True, self._reader), Run(target, place, False, self._reader)]
        if made.note:
            self._note(made.note)

    def _reread(self, target: FileTarget, wish: Reread) -> None:
        """Follow something else that the first click may mean; what was found of it is forgotten, and later clicks."""
        place = min(target.clicks)
        click = target.clicks[place]
        if not isinstance(click, Pick):
            raise ValueError(f"{target.name} was not clicked: there is nothing else that it may mean")
        self._follow(target.number, msgspec.structs.replace(click, reading=wish.reading), place, target.ball)
        self._runs = [run for run in self._runs if run.target is not target]
        self._changes += 1 + target.version

    def _correct(self, target: FileTarget, wish: Correct) -> None:
        place = self._place_of(wish.sequence)
        click = Pick(wish.sequence, wish.x, wish.y, target.shape)
        Target(target.number, click, self._reader.frame(place))  # refuses what cannot be followed
        first = place <= min(target.clicks)
        target.correct(wish, place)
        ways = (True, False) if first else (False,)
        self._runs += [Run(target, place, backward, self._reader) for backward in ways]

    def _forget(self, target: FileTarget) -> None:
        self.targets = {number: other for number, other in self.targets.items() if other is not target}
        self._runs = [run for run in self._runs if run.target is not target]
        self._changes += 1 + target.version
