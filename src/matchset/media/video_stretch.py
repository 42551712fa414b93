"""A part of a video file, read from a jump on: `VideoStretch`, and what it knows of its frames, `StretchMark`.

After a jump nothing says the number of a frame for sure. So a stretch notes time stamps and check sums of its pictures;
a stretch before it, which overlaps it, has the same pictures, and by them the numbers.
"""

from collections.abc import Callable
from typing import Any

import cv2
import msgspec

from matchset.image.frame import Frame
from matchset.media.capture import Capture, unpack
from matchset.media.frame_list import StampedVideo, checksum


class StretchParameters(msgspec.Struct, frozen=True):
    """How a file is left and entered in the middle.

    Parameters
    ----------
    cycle : int
        After a jump frames are left out up to a multiple of so many: what a tracker does in every third frame, and by
        turns within sixty (`AdaptationParameters.sweep`), it then does in the same frames as one that has read all.
        1: none is left out.
    """

    cycle: int = 60


PARAMETERS = StretchParameters()


class StretchMark(msgspec.Struct, frozen=True, array_like=True):
    """What is known of a frame of a stretch.

    Parameters
    ----------
    index : int
        Its number as it was taken for; exact in the first stretch.
    stamp : float
        Its time stamp in the file, s.
    time : float
        `Frame.time`, s.
    checksum : int
        Of its picture.
    """

    index: int
    stamp: float
    time: float
    checksum: int


class VideoStretch(StampedVideo):
    """A video file from one time on to another one.

    Parameters
    ----------
    source : str
    begin, end : float
        From when, s in the file's time stamps, to when it is read; 0: from its first frame.
    noted : callable
        Takes the `StretchMark` of every frame that is handed out.
    closing : callable, optional
        Called when the video is closed.
    first : int
        Number of the frame from which on cycles are counted: that of a click.
    options
        As of `Video`.

    Raises
    ------
    ValueError
        If the source is no video file, or its frames are taken apart into half-frames.
    """

    def __init__(
        self,
        source: str,
        begin: float,
        end: float,
        noted: Callable[[StretchMark], None],
        closing: Callable[[], None] = lambda: None,
        first: int = 0,
        **options: Any,
    ) -> None:
        self._closing, self._first = closing, first
        super().__init__(source, **options)
        recording = self.recording
        if recording is None:
            self.close()
            raise ValueError(f"{source} cannot be read in stretches: it is no video file, or taken apart into fields")
        self._end, self._noted, self._recording = end, noted, recording
        self._capture: Capture | None = None
        self._index = -1
        if begin > 0.0:
            self._capture = recording.opener(str(recording.path))
            there = self._capture is not None and self._capture.set(cv2.CAP_PROP_POS_MSEC, 1000.0 * begin)
            if not there:
                self.close()
                raise ValueError(f"{source}: nothing can be read from {begin:.1f} s on")

    def __next__(self) -> Frame:
        """Return the next frame of the stretch."""
        frame = super().__next__() if self._capture is None else self._after_jump(self._capture)
        stamp = self._recording.stamp
        if stamp >= self._end:
            raise StopIteration
        self._noted(StretchMark(frame.index, stamp, frame.time, checksum(frame.image)))
        return frame

    def _after_jump(self, capture: Capture) -> Frame:
        """Return the next frame that decodes, counted from the first one, whose number its time stamp says about."""
        recording, failures, begun = self._recording, 0, self._index >= 0
        while failures < recording.failures_from(self._index - failures + 1):  # as one that has read all
            grabbed = capture.grab()
            stamp = capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            self._index = round(stamp * (self.fps or 1.0)) if self._index < 0 else self._index + 1
            begun = begun or (self._index - self._first) % PARAMETERS.cycle == 0
            image = unpack(capture) if grabbed and begun else None
            failures = 0 if grabbed and not begun else failures + 1
            if image is not None:
                recording.stamp = stamp
                time = recording.time_of(self._index, stamp)
                return Frame(image, time, self._index, pixel_aspect=self.pixel_aspect)
        raise StopIteration

    def close(self) -> None:
        """Let go of the file."""
        capture: Capture | None = getattr(self, "_capture", None)
        if capture is not None:
            capture.release()
        self._closing()
        super().close()
