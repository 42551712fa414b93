"""The way of a target of a recorded video from a click on, forward or backward: `TrackingRun`."""

import time
from collections import deque
from collections.abc import Iterator

import msgspec

from matchset.app.backward.mirrored import FrameFollower, MirroredTracker
from matchset.image.frame import Frame
from matchset.live.files.file_target import FileTarget
from matchset.live.targets.target import ClickedTarget
from matchset.media.exact_reader import ExactReader, InterruptedReadingError
from matchset.media.frame_list import FrameList


class TrackingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a file is tracked in the background.

    Parameters
    ----------
    targets : int
        At most; each keeps 2 kB of answers a frame. Chosen by hand: a list that can be read.
    wishes : int
        Clicks that wait at most; more are refused.
    rate_over : float
        Over what time the rate is taken, s. Chosen by hand: figures that can be read.
    """

    targets: int = 20
    wishes: int = 64
    rate_over: float = 1.0


class FrameWalk:
    """Reads the frames of a video one after the other, forward or backward.

    Parameters
    ----------
    reader : ExactReader
    place : int
        Of the first one.
    backward : bool
    first : Frame, optional
        That one, where it is there.
    """

    def __init__(self, reader: ExactReader, place: int, backward: bool, first: Frame | None = None) -> None:
        self._reader, self._begin, self._backward, self._first = reader, place, backward, first
        self._frames: Iterator[Frame] | None = None

    def next(self, place: int) -> Frame:
        """Return the frame of a place, the next one of its way; raises InterruptedReadingError."""
        if self._first is not None:
            frame, self._first = self._first, None
            return frame
        if not self._backward:
            return self._reader.frame(place)
        if self._frames is None:
            self._frames = self._reader.backward(place)
        try:
            return next(self._frames)
        except InterruptedReadingError:
            self._frames = None
            raise


class TrackingRun:
    """The way of a target from a click on, in one direction.

    Parameters
    ----------
    target : FileTarget
    click : int
        Place of the frame in which it was clicked.
    backward : bool
    reader : ExactReader
    frame : Frame, optional
        That of the click, where it is there.

    Attributes
    ----------
    seconds : float
        Computing time of the last frame, s.
    began : float
        Time of the frame of the click, s.
    count : int
        How many targets are followed.
    """

    def __init__(
        self, target: FileTarget, click: int, backward: bool, reader: ExactReader, frame: Frame | None = None
    ) -> None:
        self.target, self.click, self.backward = target, click, backward
        self.place, self.seconds = click, 0.0
        self._begin, self._walk = target.clicks[click], FrameWalk(reader, click, backward, frame)
        self._tracker: FrameFollower | None = None
        self.began = 0.0
        self.count = 1

    def over(self, frames: FrameList) -> bool:
        """Whether there is nothing left to do: the end has come, or another click decides from here on."""
        target = self.target
        if self.place < 0 or (self.place >= len(frames) and frames.complete):
            return True
        return target.clicks.get(self.click) is not self._begin or not target.decides(self.click, self.place)

    def begin_with(self, tracker: FrameFollower) -> None:
        """Take a tracker that was made for the click, and has seen nothing yet; only for the way forward."""
        self._tracker = tracker

    def step(self) -> None:
        """Follow the target into the next frame; raises InterruptedReadingError if something is wanted more."""
        frame = self._walk.next(self.place)
        if self._tracker is None:
            tracker = ClickedTarget(self.target.number, self._begin, frame).tracker
            self._tracker = MirroredTracker(tracker) if self.backward else tracker
        if self.place == self.click:
            self.began = frame.time
        begin = time.thread_time()
        answer = self._tracker.update(frame)
        self.seconds = time.thread_time() - begin
        if not self.backward or self.place != self.click:  # in the frame of the click the way forward counts
            self.target.put(self.place, answer)
        self.place += -1 if self.backward else 1


class RecentCount:
    """Counts what was done lately; any thread may ask.

    Parameters
    ----------
    over : float
        Over what time, s.
    """

    def __init__(self, over: float) -> None:
        self._over = over
        self._done: deque[tuple[float, int]] = deque()

    def add(self, count: int) -> None:
        """Note that so many were done now."""
        now = time.monotonic()
        self._done.append((now, count))
        while self._done[0][0] < now - self._over:
            self._done.popleft()

    @property
    def rate(self) -> float:
        """How many per second."""
        now = time.monotonic()
        return sum(count for done, count in list(self._done) if done > now - self._over) / self._over
