"""Every frame of a file, as one plain reading found it: number, time, time stamp and a check sum (`FrameList`)."""

import bisect
import math
import zlib
from array import array

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.frame import Frame
from matchset.media.video import Video
from matchset.media.video_files.image_folder import ImageFolder
from matchset.media.video_files.video_file import VideoFile

SAMPLES = 16_384  # format: pixels of a picture that its check sum reads; of 1080p it takes half a millisecond
SEVERAL = -1  # format: place of a time stamp that more than one frame has


class StampedVideo(Video):
    """A video that says what the decoder said of the last frame."""

    @classmethod
    def of(cls, video: Video) -> "StampedVideo":
        """Open the file of a video once more, from its beginning, its pictures in the same view."""
        return cls(video._given, **video._opening())

    @property
    def recording(self) -> VideoFile | None:
        """The video file of whose pictures the frames are; None if they are of a folder or a bag, or half-frames."""
        return self._source if isinstance(self._source, VideoFile) and self.fields == "frames" else None

    @property
    def stamp(self) -> float:
        """Time stamp of the last frame in its file, s; NaN if there is none."""
        recording = self.recording
        return math.nan if recording is None else recording.stamp

    def go_to(self, index: int) -> bool:
        """Go on with the picture of this index, if it is a folder of whole pictures; returns whether it is one."""
        if self.fields != "frames" or not isinstance(self._source, ImageFolder):
            return False
        self._source.go_to(index)
        return True


class FrameMark(msgspec.Struct, frozen=True):
    """What is known of a frame.

    Parameters
    ----------
    index : int
        `Frame.index`; larger than that of the frame before by more than 1 where frames did not decode.
    time : float
        `Frame.time`, s.
    stamp : float
        Time stamp in the file, s.
    checksum : int
        Of its picture, see `checksum`.
    """

    index: int
    time: float
    stamp: float
    checksum: int


class FrameList:
    """Frames by their place, 0, 1, 2 ...: those that decode. One thread appends, all may read.

    Attributes
    ----------
    complete : bool
        Whether the reading has come to the end.
    """

    def __init__(self) -> None:
        self._indices, self._times = array("q"), array("d")
        self._stamps, self._checksums = array("d"), array("L")
        self._places: dict[float, int] = {}
        self.complete = False

    def append(self, frame: Frame, stamp: float) -> None:
        """Note the next frame."""
        place = len(self._checksums)
        self._places[stamp] = SEVERAL if stamp in self._places else place
        self._indices.append(frame.index)
        self._times.append(frame.time)
        self._stamps.append(stamp)
        self._checksums.append(checksum(frame.image))  # last: it counts

    def __len__(self) -> int:
        return len(self._checksums)

    def __getitem__(self, place: int) -> FrameMark:
        return FrameMark(self._indices[place], self._times[place], self._stamps[place], self._checksums[place])

    def indices(self, count: int) -> npt.NDArray[np.int64]:
        """Return the indices of the first frames, (count,)."""
        return np.array(self._indices[:count], np.int64)

    def with_stamp(self, stamp: float) -> int | None:
        """Return the place of the frame with this time stamp; None unless there is exactly one."""
        place = self._places.get(stamp, SEVERAL)
        return None if place == SEVERAL else place

    def with_index(self, index: int) -> int:
        """Return the place of the frame with this index, or of the next one that decodes; the last one at most."""
        return min(bisect.bisect_left(self._indices, index, 0, len(self)), max(len(self) - 1, 0))

    def at_time(self, time: float) -> int:
        """Return the place of the frame that is shown at a time, s: the last one that is not later."""
        return max(bisect.bisect_right(self._times, time, 0, len(self)) - 1, 0)


def checksum(image: npt.NDArray[np.uint8]) -> int:
    """Return a check sum of every n-th pixel of a picture."""
    step = max(1, math.isqrt(image.shape[0] * image.shape[1] // SAMPLES))
    return zlib.crc32(image[::step, ::step].tobytes())
