"""A video file: every frame, in decode order, with a time that runs forward."""

import math
from itertools import pairwise
from pathlib import Path

import cv2
import msgspec

from matchset.image.capture import open_capture, unpack
from matchset.image.frame import Frame

DEFAULT_FPS = 30.0  # format: of a file that states no usable frame rate


class VideoFileParameters(msgspec.Struct, frozen=True):
    """When a video file is believed, and when it ends.

    Chosen by hand; `tests/image/test_video_file.py` would show a change.

    Parameters
    ----------
    probe_frames : int
        Frames whose time stamps are read before the stamps are used.
    failures_past_end, failures_before_end : int
        Failures in a row that mean the end of the file: past its announced length, and before it.
    """

    probe_frames: int = 16
    failures_past_end: int = 8
    failures_before_end: int = 1000


DEFAULT = VideoFileParameters()


class Recording:
    """A video file.

    OpenCV says False to a broken frame and at the end of the file alike, but goes on behind a broken frame
    when asked again. So a failure is the end only when nothing comes after it; each failure before a success
    was a broken frame. Pictures that change in size are not noticed: OpenCV brings all to the first size.

    Parameters
    ----------
    path : Path
        The file.
    fps : float or None
        Given, times are index / fps; otherwise they are the file's time stamps, or index / the file's rate
        where those do not run forward (OpenCV hands out the stamps of some H.264 files out of order).

    Raises
    ------
    ValueError
        If the file is missing, cannot be read, is no video, or no frame of it decodes.
    """

    live = False
    dropped = 0

    def __init__(self, path: Path, fps: float | None) -> None:
        self.path, self.broken = path, 0
        self.warnings: list[str] = []
        check_readable(path)
        self._capture = open_capture(str(path))
        if not self._capture.isOpened():
            raise ValueError(f"not a video that OpenCV can read: {path}")
        count, rate = self._capture.get(cv2.CAP_PROP_FRAME_COUNT), self._capture.get(cv2.CAP_PROP_FPS)
        self.length = int(count) if 0 < count < 1e9 else None
        known = 0 < rate <= 1000
        self.fps = fps or (rate if known else DEFAULT_FPS)
        if fps is None and not known:
            self.warnings.append(f"the file states no usable frame rate, {DEFAULT_FPS:g} fps is assumed")
        self._stamped = fps is None and self._stamps_run_forward()
        self._next, self._start, self._last = 0, (0, 0.0), -math.inf
        self._first = self._decode()
        if self._first is None:
            self.close()
            raise ValueError(f"no frame of {path} could be decoded")
        self.shape = self._first.image.shape

    def _stamps_run_forward(self) -> bool:
        """Whether the stamps of the first frames increase; told by a second look at the file."""
        probe = open_capture(str(self.path))
        stamps = [probe.get(cv2.CAP_PROP_POS_MSEC) for _ in range(DEFAULT.probe_frames) if probe.grab()]
        probe.release()
        if all(early < late for early, late in pairwise(stamps)):
            return True
        self.warnings.append(f"time stamps out of order: times are frame number / {self.fps:g} fps")
        return False

    def read(self) -> Frame | None:
        """Next frame that decodes, or None at the end."""
        if self._first is not None:
            frame, self._first = self._first, None
            return frame
        return self._decode()

    def _decode(self) -> Frame | None:
        unread = 0 if self.length is None else self.length - self._next
        for misses in range(min(max(unread + 1, DEFAULT.failures_past_end), DEFAULT.failures_before_end)):
            image = unpack(self._capture) if self._capture.grab() else None
            if image is not None:
                index = self._next + misses
                self._next = index + 1
                self.broken += misses
                return Frame(image, self._time(index), index)
        if unread > 0:
            self.warnings.append(f"the file announces {self.length} frames, it ends after {self._next}")
        return None

    def _time(self, index: int) -> float:
        """Time of the frame just decoded, s; always later than the one before."""
        if self._stamped:
            stamp = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            if math.isfinite(stamp) and stamp > self._last:
                self._start, self._last = (index, stamp), stamp
                return stamp
            self._stamped = False
            self.warnings.append(f"time stamps stop running forward at frame {index}: {self.fps:g} fps from there")
        self._last = self._start[1] + (index - self._start[0]) / self.fps
        return self._last

    def close(self) -> None:
        """Let go of the file."""
        self._capture.release()


def check_readable(path: Path) -> None:
    """Refuse a file that is missing, empty or may not be read (ValueError with its path)."""
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except FileNotFoundError:
        raise ValueError(f"no such file: {path}") from None
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from None
    if empty:
        raise ValueError(f"the file is empty: {path}")
