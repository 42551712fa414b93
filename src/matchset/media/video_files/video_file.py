"""A video file: every frame, in decode order, with a time that runs forward."""

import functools
import math
from collections.abc import Callable
from pathlib import Path

import cv2
import msgspec

from matchset.image.errors import MissingFileError
from matchset.image.frame import Frame
from matchset.media.capture import Capture, open_capture, unpack
from matchset.media.upright.view import ANY, View, Wish
from matchset.media.video_files.container import Container, look_into
from matchset.media.video_files.file_clock import FileClock
from matchset.media.video_files.file_view import file_view
from matchset.media.video_files.pyav_capture import has_pyav, open_pyav, stated_fields
from matchset.media.video_files.recorded import Recorded
from matchset.media.video_files.stream_choice import choose_stream
from matchset.media.video_files.upright_capture import UprightCapture
from matchset.numeric.imports import advice

Opener = Callable[[str], Capture | None]

MOST_FRAMES = 1e9  # format: OpenCV's count of a file without a duration is a meaningless, large number
MASK, FIRST, LAST = 0xFFFFFFFF, 0x20, 0x7E  # format: 32 bits of four printable ASCII letters
CONVERT = "convert it, for instance with ffmpeg -i IN -c:v libx264 OUT.mp4"
PYAV = advice("av")


class VideoFileParameters(msgspec.Struct, frozen=True):
    """When a video file is believed, and when it ends.

    Chosen by hand; `tests/media/test_video_file.py` would show a change.

    Parameters
    ----------
    probe_frames : int
        Frames whose time stamps are read before the stamps are used.
    failures_past_end, failures_before_end : int
        Failures in a row that mean the end of the file: past its announced length, and before it.
    end_periods : float
        Frame periods by which the last time stamp may fall short of the announced duration of a whole file. The last
        frame lasts one; half a one more is for rounding.
    """

    probe_frames: int = 16
    failures_past_end: int = 8
    failures_before_end: int = 1000
    end_periods: float = 1.5


DEFAULT = VideoFileParameters()


class VideoFile(Recorded):
    """A video file.

    OpenCV says False to a broken frame and at the end of the file alike, but goes on behind a broken frame
    when asked again. So a failure is the end only when nothing comes after it; each failure before a success
    was a broken frame. Pictures that change in size are not noticed: OpenCV brings all to the first size.
    Where OpenCV decodes no frame, PyAV is asked, if it is installed; it leaves each picture its size.

    Parameters
    ----------
    path : Path
        The file.
    fps : float or None
        Given, times are index / fps; otherwise they are the file's time stamps, see `FileClock`.
    wish : Wish, optional

    Attributes
    ----------
    view : View
        What is done to every picture.
    opener : callable
        What decodes it, and hands out its pictures in this view.
    damaged : int
        Frames whose decoder reported errors; known where PyAV decodes.
    stated : str or None
        Which field comes first, or "frames", by its header.
    stamp : float
        Time stamp of the frame that was decoded last, s, as the decoder says it.

    Raises
    ------
    ValueError
        If the file is missing, cannot be read, is no video, or no frame of it decodes.
    """

    def __init__(self, path: Path, fps: float | None, wish: Wish = ANY) -> None:
        self.path, self._wish = path, wish
        check_readable(path)
        self._container = look_into(path)
        if self._container.encrypted:
            raise ValueError(f"{path} is encrypted: it can only be decoded with its key")
        self._choice = choose_stream(path, self._container.tracks, wish.stream)
        self._first = None
        number = self._choice.number
        self.stated = stated_fields(str(path), number)
        by_pyav = (
            number > 0 or wish.damaged is not None or self.stated in ("top", "bottom")
        )  # OpenCV 5 decodes no fields
        if by_pyav and not has_pyav():
            raise ValueError(f"OpenCV reads the first video stream alone, and does not tell errors: {PYAV}")
        codec = None if by_pyav else self._begin(open_capture, fps)
        tried: str | None = None
        if self._first is None and (by_pyav or codec is not None):
            if codec is not None:
                self.close()
            looking = functools.partial(open_pyav, stream=number, looks=wish.damaged is not None)
            tried = self._begin(looking if by_pyav else open_pyav, fps)
        if self._first is None:
            if tried is not None:
                self.close()
            raise ValueError(_words_without_frame(path, self._container, codec or tried, tried is not None))
        self.shape: tuple[int, ...] = self._first.image.shape

    def _begin(self, opener: Opener, fps: float | None) -> str | None:
        """Open the file and decode its first frame; the name of the codec, None if it does not open."""
        self.broken, self.damaged, self._next, self._latest = 0, 0, 0, 0.0
        self._notes: list[str] = []
        self._first = None
        capture = opener(str(self.path))
        if capture is None or not capture.isOpened():
            return None
        self.view = file_view(capture, self._container.tracks, self._choice.number, self._wish)
        self._capture, self.stamp = UprightCapture(capture, self.view), math.nan
        self.opener = functools.partial(_open_upright, opener, self.view)
        count, stated = capture.get(cv2.CAP_PROP_FRAME_COUNT), capture.get(cv2.CAP_PROP_FPS)
        self._clock = FileClock(_first_stamps(opener(str(self.path))), stated, fps)
        self.fps = self._clock.rate
        self._announced = int(count) if 0 < count < MOST_FRAMES else None
        self._duration = count / stated if self._announced is not None and stated > 0.0 else math.inf
        self.length = self._frames_to_expect()
        self._first = self._decode()
        return _codec_of(capture)

    def _frames_to_expect(self) -> int | None:
        """Announced number of frames; an estimate where it was guessed with a rate that the stamps contradict."""
        measured = self._clock.measured
        if self._announced is None or self._container.counts_frames or self._clock.agree or measured is None:
            return self._announced
        return max(1, round(min(self._duration * measured, MOST_FRAMES)))

    @property
    def warnings(self) -> list[str]:
        """What is not as it should be, so far, one sentence each."""
        return [*self._choice.notes, *self.view.notes, *self._clock.warnings, *self._notes]

    def _decode(self) -> Frame | None:
        unread = 0 if self._announced is None else self._announced - self._next
        misses = 0
        while misses < self.failures_from(self._next):
            image = unpack(self._capture) if self._capture.grab() else None
            if image is None:
                misses += 1
                continue
            index = self._next + misses
            self._next = index + 1
            self.broken += misses
            self.stamp = stamp = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            self._latest = max(self._latest, stamp)
            time, damaged = self._clock.time(index, stamp), self._capture.damaged
            self.damaged += damaged
            if not damaged or self._wish.damaged is not False:
                return Frame(image, time, index, damaged)
            unread, misses = unread - misses - 1, 0
        self._note_early_end(unread)
        return None

    def failures_from(self, index: int) -> int:
        """Return how many pictures that do not decode, from a frame on, mean that the file has ended before it."""
        unread = 0 if self._announced is None else self._announced - index
        return min(max(unread + 1, DEFAULT.failures_past_end), DEFAULT.failures_before_end)

    def _note_early_end(self, unread: int) -> None:
        """Note that the file ends before it should, where its container says when that is."""
        kind = self._container
        short = self._latest + DEFAULT.end_periods * self._clock.period < self._duration
        if unread > 0 and (kind.counts_frames or (kind.counts_ticks and short)):
            if self.length == self._announced:
                self._notes.append(f"the file announces {self._announced} frames, it ends after {self._next}")
            else:
                self._notes.append(f"the file announces {self._duration:.2f} s, it ends at {self._latest:.2f} s")
        elif kind.cut and (unread > 0 or not kind.counts_ticks):  # some AVI writers state a few bytes too many
            self._notes.append(f"the file is cut off, it ends after {self._next} frames")

    def time_of(self, index: int, stamp: float) -> float:
        """Return the time, s, of a frame that was decoded by another opening of the file, after all those before it."""
        return self._clock.time(index, stamp)

    def close(self) -> None:
        """Let go of the file."""
        self._capture.release()


def _open_upright(opener: Opener, view: View, path: str) -> Capture | None:
    """Open a file once more, to be seen in this view."""
    capture = opener(path)
    return None if capture is None else UprightCapture(capture, view)


def _first_stamps(probe: Capture | None) -> list[float]:
    """Time stamps of the first frames, s, by a look of its own at the file."""
    if probe is None:
        return []
    stamps = [probe.get(cv2.CAP_PROP_POS_MSEC) / 1000.0 for _ in range(DEFAULT.probe_frames) if probe.grab()]
    probe.release()
    return stamps


def _codec_of(capture: Capture) -> str:
    """FOURCC of the codec, such as h264 or AV01; empty if there is none."""
    code = capture.get(cv2.CAP_PROP_FOURCC)
    letters = (int(code) & MASK if math.isfinite(code) else 0).to_bytes(4, "little")
    return letters.decode("ascii", "replace").strip() if all(FIRST <= letter <= LAST for letter in letters) else ""


def _words_without_frame(path: Path, container: Container, codec: str | None, tried_pyav: bool) -> str:
    """Say why there is no frame, and what to do."""
    if not container.indexed:
        return f"{path} is cut off or was never finished: an MP4 without its index (moov); copy or record it again"
    if codec is None and container.cut:
        return f"{path} is cut off, and OpenCV cannot read what is left: copy or record it again"
    if codec is None:
        return f"not a video that OpenCV can read: {path}"
    name = "AV1 (AV01)" if codec.upper() == "AV01" else codec or "unknown"
    what = f"no frame of {path} could be decoded, its codec is {name}"
    if tried_pyav:
        return f"{what}: it is encrypted or damaged"
    if name.startswith("AV1"):
        return f"{what}: {PYAV}, or {CONVERT}"
    return f"{what}: it is encrypted, damaged, or needs another decoder: {PYAV}, or {CONVERT}"


def check_readable(path: Path) -> None:
    """Refuse a file that is missing (MissingFileError), empty or may not be read (ValueError), with its path."""
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except FileNotFoundError:
        raise MissingFileError(f"no such file: {path}") from None
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from None
    if empty:
        raise ValueError(f"the file is empty: {path}")
