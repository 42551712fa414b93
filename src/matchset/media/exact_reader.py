"""Any frame of a file, exactly as a plain reading delivers it: `ExactReader`, and `KeptPictures` for the last ones.

OpenCV goes to a time in a file, but not always to the frame that is there: rates vary, stamps are equal, pictures after
a jump may be damaged. So a jump lands before the wanted frame, is believed only where the time stamp names one frame,
and each picture is compared with the check sum of the plain reading. Where that fails the file is read from its
beginning.
"""

import math
import sys
from collections import OrderedDict
from collections.abc import Callable, Iterator
from typing import Protocol

import cv2
import msgspec

from matchset.image.frame import Frame
from matchset.media.capture import Capture, unpack
from matchset.media.closing import Closing
from matchset.media.frame_list import FrameList, StampedVideo, checksum


class ReaderParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a file is read out of order, and how much memory that takes.

    Parameters
    ----------
    near : int
        Frames up to which decoding goes on rather than jumping. Chosen by hand: a jump decodes 16 frames and more
        from the last key picture on.
    before : tuple of int
        How many frames before the wanted one a jump goes, one after the other until one is exact. The last ones
        serve files whose stated rate is wrong. Chosen by hand.
    failures : int
        Frames to which no jump led, after which none is tried any more unless more jumps led somewhere: such a file is
        read from its beginning.
    kept_mb : float
        Memory for the pictures shown last, MB. More: more steps back without decoding; 200 are 32 of 1080p.
    ahead_mb : float
        Memory for the pictures that are read forward to be handed out backward, MB. More: faster for long distances
        between key pictures; 250 are 40 of 1080p.
    behind : int
        Pictures before the wanted one that are kept with it on the way back. Chosen by hand: 16 steps back are
        one jump.
    """

    near: int = 64
    before: tuple[int, ...] = (2, 40, 400)
    failures: int = 3
    kept_mb: float = 200.0
    ahead_mb: float = 250.0
    behind: int = 16


DEFAULT = ReaderParameters()
MB = 1_000_000  # format: bytes


class AstrayError(Exception):
    """A way through the file does not lead to the frames of the plain reading."""


class InterruptedReadingError(Exception):
    """Something else is wanted more than the frame that was being looked for."""


class ForwardReading(Protocol):
    """A way through a file, forward only.

    Attributes
    ----------
    place : int
        Of the frame that comes next.
    """

    place: int

    def take(self, place: int) -> Frame:
        """Return a frame from `self.place` on; raises AstrayError if it is not the one of the plain reading."""
        ...

    def close(self) -> None:
        """Close the file."""
        ...


class FromBeginning:
    """Reads a file from its beginning; a folder of pictures from any of them."""

    def __init__(self, video: StampedVideo, frames: FrameList, check: Callable[[], None]) -> None:
        self.place, self.video, self._frames, self._check = 0, video, frames, check

    def take(self, place: int) -> Frame:
        """Return a frame."""
        frame = None
        while self.place <= place:
            self._check()
            frame = next(self.video, None)
            self.place += 1
            if frame is None:
                break
        if frame is None or checksum(frame.image) != self._frames[place].checksum:
            raise AstrayError
        return frame

    def close(self) -> None:
        """Close the file."""
        self.video.close()


class FromJump:
    """Reads on from where a jump has led.

    Parameters
    ----------
    capture : Capture
        An open file.
    stamp : float
        Where to go, s.
    frames : FrameList
    check : callable
        Called before each frame; raises what ends the reading.

    Raises
    ------
    AstrayError
        If nothing says which frame is there.
    """

    def __init__(self, capture: Capture, stamp: float, frames: FrameList, check: Callable[[], None]) -> None:
        self._capture, self._frames, self._check, self._grabbed = capture, frames, check, True
        there = capture.set(cv2.CAP_PROP_POS_MSEC, 1000.0 * stamp) and capture.grab()
        place = frames.with_stamp(self._stamp) if there else None
        if place is None:
            raise AstrayError
        self.place = place

    @property
    def _stamp(self) -> float:
        return self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0

    def take(self, place: int) -> Frame:
        """Return a frame."""
        if place < self.place:
            raise AstrayError
        while True:
            self._check()
            self._grab()
            self.place += 1
            if self.place > place:
                break
        mark, image = self._frames[place], unpack(self._capture)
        if image is None or checksum(image) != mark.checksum:
            raise AstrayError
        return Frame(image, mark.time, mark.index)

    def _grab(self) -> None:
        """Decode the next frame; those that did not decode in the plain reading are passed over."""
        if self._grabbed:
            self._grabbed = False
            return
        mark = self._frames[self.place]
        before = self._frames[self.place - 1].index if self.place else -1
        for _ in range(mark.index - before):
            if self._capture.grab() and (self._stamp == mark.stamp or math.isnan(mark.stamp)):
                return
        raise AstrayError

    def close(self) -> None:
        """Leave the file open: the next jump goes on with it."""


class ExactReader(Closing):
    """Reads any frame that is in the list. For one thread.

    Parameters
    ----------
    open_source : callable
        Opens the file.
    frames : FrameList
        May grow meanwhile.
    parameters : ReaderParameters, optional

    Attributes
    ----------
    jumped, failed : int
        Frames to which a jump led, and to which none did.
    interrupted : callable
        Whether something else is wanted more; asked before each frame that is decoded.
    """

    def __init__(
        self, open_source: Callable[[], StampedVideo], frames: FrameList, parameters: ReaderParameters = DEFAULT
    ) -> None:
        self._open, self._frames, self._parameters = open_source, frames, parameters
        self._way: ForwardReading | None = None
        self._capture: Capture | None = None
        self.jumped = self.failed = 0
        self.interrupted: Callable[[], bool] = lambda: False

    def frame(self, place: int) -> Frame:
        """Return the frame at a place.

        Raises
        ------
        ValueError
            If the file is not the one any more that was read before.
        InterruptedReadingError
            If something else is wanted more; asked again, it goes on from where it came.
        """
        before = self._way
        for way in self._ways(place):
            try:
                frame = way.take(place)
            except AstrayError:
                way.close()
                continue
            except InterruptedReadingError:
                self._way = way
                raise
            self.jumped += isinstance(way, FromJump) and way is not before
            self._way = way
            return frame
        raise ValueError(f"frame {self._frames[place].index} is not what it was before: was the file changed?")

    def stretch(self, begin: int, end: int) -> Iterator[Frame]:
        """Yield the frames from a place up to another one, which is left out."""
        for place in range(begin, end):
            yield self.frame(place)

    def backward(self, begin: int) -> Iterator[Frame]:
        """Yield the frames from a place down to the first one."""
        end, size = begin + 1, 1
        while end > 0:
            frames = list(self.stretch(max(end - size, 0), end))
            end -= len(frames)
            size = max(1, int(self._parameters.ahead_mb * MB / frames[0].image.nbytes))
            while frames:
                yield frames.pop()

    def close(self) -> None:
        """Close the file."""
        if self._way is not None:
            self._way.close()
        if self._capture is not None:
            self._capture.release()
        self._way = self._capture = None

    def _ways(self, place: int) -> Iterator[ForwardReading]:
        """Yield ways to a frame: on from here, by a jump, from the beginning."""
        way = self._way
        jumps = self.failed < max(self._parameters.failures, self.jumped)
        from_beginning = isinstance(way, FromBeginning) and not jumps
        if way is not None and way.place <= place <= way.place + (place if from_beginning else self._parameters.near):
            yield way
        if way is not None:
            way.close()
            self._way = None
        if place > self._parameters.near and jumps:
            for before in self._parameters.before:
                jumped = self._jump(max(place - before, 0))
                if jumped is not None:
                    yield jumped
            self.failed += 1
        beginning = FromBeginning(self._open(), self._frames, self._check)
        if beginning.video.go_to(self._frames[place].index):
            beginning.place = place
        yield beginning

    def _check(self) -> None:
        if self.interrupted():
            raise InterruptedReadingError

    def _jump(self, place: int) -> FromJump | None:
        capture = self._opened()
        if capture is None:
            return None
        try:
            return FromJump(capture, self._frames[place].stamp, self._frames, self._check)
        except AstrayError:
            return None

    def _opened(self) -> Capture | None:
        """Return the file, opened to jump in; None if that cannot be."""
        if self._capture is None:
            with self._open() as video:
                recording = video.recording
            if recording is None:
                self.failed = sys.maxsize
                return None
            self._capture = recording.opener(str(recording.path))
        return self._capture


class KeptPictures:
    """The frames that were shown last, and those just before one to which a person stepped back.

    Parameters
    ----------
    reader : ExactReader
    parameters : ReaderParameters, optional
    """

    def __init__(self, reader: ExactReader, parameters: ReaderParameters = DEFAULT) -> None:
        self._reader, self._parameters = reader, parameters
        self._kept: OrderedDict[int, Frame] = OrderedDict()
        self._last = 0

    def frame(self, place: int) -> Frame:
        """Return the frame at a place."""
        back, self._last = place < self._last, place
        if place not in self._kept:
            begin = max(place - self._parameters.behind, 0) if back else place
            for number, frame in enumerate(self._reader.stretch(begin, place + 1), start=begin):
                self._keep(number, frame)
        self._kept.move_to_end(place)
        return self._kept[place]

    def __len__(self) -> int:
        return len(self._kept)

    def _keep(self, place: int, frame: Frame) -> None:
        self._kept[place] = frame
        self._kept.move_to_end(place)
        most = max(1, int(self._parameters.kept_mb * MB / frame.image.nbytes))
        while len(self._kept) > most:
            self._kept.popitem(last=False)
