"""The way of a target of a recorded video from a click on, forward or backward: `TrackingRun`."""

import time
from collections.abc import Iterator

from matchset.app.backward.mirrored import FrameFollower, MirroredTracker
from matchset.image.frame import Frame
from matchset.live.files.file_target import FileTarget
from matchset.live.targets.target import ClickedTarget
from matchset.media.exact_reader import ExactReader, InterruptedReadingError
from matchset.media.frame_list import FrameList


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
    """

    def __init__(
        self, target: FileTarget, click: int, backward: bool, reader: ExactReader, frame: Frame | None = None
    ) -> None:
        self.target, self.click, self.backward, self._first = target, click, backward, frame
        self.place, self.seconds = click, 0.0
        self._begin, self._reader = target.clicks[click], reader
        self._tracker: FrameFollower | None = None
        self.began = 0.0
        self._frames: Iterator[Frame] | None = None

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
        frame = self._next()
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

    def _next(self) -> Frame:
        if self._first is not None:
            frame, self._first = self._first, None
            return frame
        if not self.backward:
            return self._reader.frame(self.place)
        if self._frames is None:
            self._frames = self._reader.backward(self.place)
        try:
            return next(self._frames)
        except InterruptedReadingError:
            self._frames = None
            raise
