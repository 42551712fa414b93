"""The loop behind the page: reads a source, follows the targets, leaves the newest answer in a box (`Vision`)."""

import functools
import threading
import time
from collections import deque
from collections.abc import Callable

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.timing.durations import ShownTimes
from matchset.camera.camera_model import CameraModel
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.live.feed import News, StreamPicture
from matchset.live.targets.followed_targets import FollowedTargets
from matchset.live.targets.messages import Wish
from matchset.live.targets.waiting import WaitingWishes
from matchset.live.vision.kept_frames import KeptFrames
from matchset.live.wire.state import State, TargetState
from matchset.media.closing import Closing
from matchset.media.video import Video


class VisionParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How the loop runs.

    Parameters
    ----------
    retry : float
        Time between attempts to open a source that is gone, s. Chosen by hand: a person who plugs a camera in again
        does not wait longer.
    rate_over : int
        Frames over which the rate of the loop is taken. Chosen by hand: a second.
    wishes : int
        Clicks that wait at most; one more, and the oldest is given up.
    closing : float
        The longest that closing waits for a source that is stuck in its driver or in the network, s; it is closed when
        it answers. Chosen by hand: what a person waits for Ctrl-C.
    """

    retry: float = 1.0
    rate_over: int = 30
    wishes: int = 64
    closing: float = 2.0


class Vision(Closing):
    """Reads a source in a thread of its own, at its own rate, whoever looks.

    Parameters
    ----------
    open_source : callable
        Opens the source; called again where it is gone. A stream opens itself again first, see `Video`.
    camera : CameraModel, optional
    news : callable, optional
        Called in the thread after each new picture; must not wait.
    note : callable, optional
        Called with what a person should know.
    parameters : VisionParameters, optional

    Attributes
    ----------
    seen : StreamPicture
        The newest picture.
    kept : KeptFrames
    followed : FollowedTargets
        What was clicked; for the thread of the pictures alone.
    """

    def __init__(
        self,
        open_source: Callable[[], Video],
        camera: CameraModel | None = None,
        news: News | None = None,
        note: Callable[[str], None] | None = None,
        parameters: VisionParameters | None = None,
    ) -> None:
        self._open, self._news, self._note = open_source, news or (lambda _: None), note or (lambda _: None)
        self._parameters = parameters or VisionParameters()
        self.seen, self.kept = (
            StreamPicture(None, State(0, 0, 0.0, 0, 0, fault="the source is being opened")),
            KeptFrames(),
        )
        self._sequence = 0
        self._size: tuple[int, int, int] | None = None
        self.followed = FollowedTargets(self.kept, self._note)
        self.followed.locate(camera)
        self._computing = ShownTimes()
        self._done: deque[float] = deque(maxlen=self._parameters.rate_over)
        self._wishes: WaitingWishes[Wish | Callable[[], None]] = WaitingWishes(self._parameters.wishes)
        self._stop, self._again = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="matchset live", daemon=True)
        self._thread.start()

    @property
    def camera(self) -> CameraModel | None:
        """What is known of the camera."""
        return self.followed.camera

    def mask(self, target: int, sequence: int) -> npt.NDArray[np.uint8]:
        """Return what the color model of a target takes for it in a kept picture: (h, w), 255 there, 0 elsewhere.

        Raises
        ------
        ValueError
            If there is no such target or picture.
        """
        image = self.kept.since(sequence)[0].image
        return self.followed.target(target).tracker.color.for_image(image).mask(image)

    def ask(self, wish: Wish | Callable[[], None]) -> None:
        """Ask for something; done before the next picture. What cannot be done is a note on the page."""
        given_up = self._wishes.put(wish)
        if given_up is not None:
            self.followed.clicks.leave_out(given_up)

    def use(self, camera: CameraModel | None) -> None:
        """Use another camera model from the next picture on; None: it is not known."""
        self.ask(functools.partial(self._use, camera))

    def reopen(self) -> None:
        """Have the source opened again, such as with other settings; does not wait."""
        self._again.set()

    def close(self) -> None:
        """End the thread; the source is closed, if need be later: see `VisionParameters.closing`."""
        self._stop.set()
        self._thread.join(self._parameters.closing)
        self.followed.close()

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                self._again.clear()
                with self._open() as source:
                    self.followed.restart()
                    self._computing.clear()
                    ended = self._read(source)
                if ended:
                    self._fault("the video has ended")
                    return
            except (LinkError, ValueError) as error:
                words = str(error).rstrip(".")
                ending = "" if words.endswith("?") else "."
                self._fault(f"{words}{ending} It is tried again every {self._parameters.retry:g} s")
                self._grant()
                self._stop.wait(self._parameters.retry)

    def _read(self, source: Video) -> bool:
        """Take the pictures of a source; returns whether it has ended by itself."""
        for frame in source.until(functools.partial(self._leaves, source)):
            self._take(source, frame)
        return not self._leaves(source)

    def _leaves(self, source: Video) -> bool:
        """Whether to leave a source; of one that is lost, and opens itself again, the page is told meanwhile."""
        if source.lost:
            if self.seen.state.fault != source.lost:
                self._fault(source.lost)
            self._grant()
        return self._stop.is_set() or self._again.is_set()

    def _fault(self, words: str) -> None:
        """Show the last picture, and in words what is wrong; the targets stay, to be found again."""
        if self._stop.is_set():
            return
        self._sequence += 1
        gone = [target.without_picture("no picture comes") for target in self.followed.targets]
        state = msgspec.structs.replace(
            self.seen.state, sequence=self._sequence, fault=words, targets=gone, fps=None, crowd=None
        )
        self._done.clear()
        self.seen = StreamPicture(self.seen.frame, state, camera=self.camera)
        self._news(0)

    def _check_size(self, source: Video) -> None:
        """Forget what belongs to pictures of another size: another camera, or another setting."""
        if self._size == (source.width, source.height, source.channels):
            return
        if self._size is not None:
            self._note(f"the pictures are {source.width} x {source.height} px now")
            if self.followed.targets:
                self._note("what was followed is forgotten: click again")
            self.followed.clear()
            self.kept.clear()
        self._size = source.width, source.height, source.channels
        try:
            self._use(self.camera)
        except ValueError as error:
            self._note(str(error))
            self._use(None)

    def _use(self, camera: CameraModel | None) -> None:
        """Locate with another camera model.

        Raises
        ------
        ValueError
            If it is that of pictures of another size.
        """
        if camera is not None and self._size is not None:
            camera.check(self._size[:2])
        self.followed.locate(camera)

    def _follow(self, frame: Frame) -> list[TargetState]:
        """Follow the targets into a picture, and count what that took."""
        begin = time.thread_time()  # of this thread only: others pack the pictures meanwhile
        targets = self.followed.update(frame)
        if targets:
            self._computing.add(time.thread_time() - begin)
        return targets

    def _take(self, source: Video, frame: Frame) -> None:
        self._check_size(source)
        self._grant()
        targets = self._follow(frame)
        self._sequence += 1
        self._done.append(time.monotonic())
        span = self._done[-1] - self._done[0]
        state = State(
            sequence=self._sequence,
            index=frame.index,
            time=frame.time,
            width=source.width,
            height=source.height,
            targets=targets,
            camera_fps=source.fps,
            fps=(len(self._done) - 1) / span if span > 0.0 else None,
            dropped=source.dropped,
            age=time.monotonic() - frame.time if source.live else 0.0,
            computing=self._computing.in_ms,
            live=source.live,
            crowd=self.followed.crowd,
        )
        self.kept.add(self._sequence, frame)
        followed = self.followed.targets
        poses = {target.number: target.pose for target in followed if target.pose is not None}
        names = {target.number: target.parameters for target in followed}
        self.seen = StreamPicture(frame, state, poses, self.camera, names)
        self._news(0)

    def _grant(self) -> None:
        """Do what was asked for."""
        while (wish := self._wishes.take()) is not None:
            try:
                if callable(wish):
                    wish()
                else:
                    self.followed.do(wish)
            except ValueError as error:
                self._note(str(error))
