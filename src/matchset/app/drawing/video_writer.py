"""The annotated video: `Recorder` writes it in a thread, while the next frames are tracked.

The frame rate of a WebM file is changed in place afterwards. OpenCV gives libvpx a deadline of one second per frame,
and libvpx searches longer unless a frame lasts as long. So VP8 is encoded as if one frame per second were shown, 4 to 6
times as fast at equal size and quality (decision 007), and then the duration of the file's time unit is corrected.
"""

import contextlib
import os
import queue
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.closing import Closing
from matchset.image.capture import hushed
from matchset.numeric.copies import NotCopied

Picture = npt.NDArray[np.uint8]


class Codec(msgspec.Struct, frozen=True):
    """A video codec: its FourCC, and its usual name."""

    fourcc: str
    name: str


VP9 = Codec("vp09", "VP9")
MPEG4 = Codec("mp4v", "MPEG-4")
VP8 = Codec("VP80", "VP8")
MJPEG = Codec("MJPG", "Motion JPEG")
CODECS = {".mp4": (VP9, MPEG4), ".webm": (VP8,), ".avi": (MJPEG,)}
"""Codecs by file extension, best first. OpenCV's wheels write no H.264; browsers play VP9 and VP8 only."""

NOTES = {
    VP9.name: "{path} is packed as VP9, which is slow; a name that ends in .webm is some 20 times as fast",
    MPEG4.name: "{path} is packed as MPEG-4: players show it, browsers do not; .webm plays in both",
}
"""What the user should know about a codec."""

_QUEUE_LENGTH = 8  # format: pictures that wait for the encoder; more would only use memory
_ENCODING_FPS = 1.0  # format: the frame rate that OpenCV is told while it encodes VP8
_TIME_UNIT_ID = b"\x2a\xd7\xb1"  # format: EBML id of TimestampScale
_FRAME_DURATION_ID = b"\x23\xe3\x83"  # format: EBML id of DefaultDuration
_TIME_UNIT_NS = 1_000_000  # format: FFmpeg's time unit in WebM
_HEAD_BYTES = 4096  # format: the ids are in the first bytes of a file


class Recorder(NotCopied, Closing):
    """Writes a video in its own thread, since encoding a frame takes longer than tracking one.

    Parameters
    ----------
    path : Path
        Where, ending in .mp4 (VP9, or MPEG-4 where OpenCV cannot), .webm (VP8, some
        twenty times as fast) or .avi.
    fps : float
        Frames per second.
    size : tuple of two ints
        Width and height of the pictures, px.
    live : bool
        Whether the frames come from a camera: then .mp4 is MPEG-4, since VP9 would not keep up.

    Attributes
    ----------
    note : str
        What the user should know about the file; empty if nothing.

    Raises
    ------
    ValueError
        If the extension is another, or the file cannot be written.
    """

    def __init__(self, path: Path, fps: float, size: tuple[int, int], live: bool = False) -> None:
        codecs = codecs_for(path)
        if live and MPEG4 in codecs:
            codecs = (MPEG4,)
        self.path, self._size = path, size
        # OpenCV reports a file without write permission as a codec that cannot be opened.
        try:
            path.open("wb").close()
        except OSError as error:
            raise ValueError(f"cannot write {path}: {error.strerror}") from error
        self._fps = fps
        self._writer, self._codec = _open(path, codecs, fps, size)
        self.note = NOTES.get(self._codec.name, "").format(path=path)
        self._error: Exception | None = None
        self._pictures: queue.Queue[Picture | None] = queue.Queue(_QUEUE_LENGTH)
        self._thread = threading.Thread(target=self._run, name="matchset recorder", daemon=True)
        self._thread.start()

    def write(self, picture: Picture) -> None:
        """Append a BGR picture; the caller must not change it afterwards."""
        if (picture.shape[1], picture.shape[0]) != self._size:
            raise ValueError(f"a picture of {self.path} must have {self._size} px, got {picture.shape[1::-1]}")
        self._pictures.put(picture)

    def close(self) -> None:
        """Encode what is in the queue and close the file."""
        if self._thread.is_alive():
            self._pictures.put(None)
            self._thread.join()
        if self._writer.isOpened():
            self._writer.release()
            if self._codec is VP8:
                set_frame_rate(self.path, self._fps)
        if self._error is not None:
            error, self._error = self._error, None
            raise ValueError(f"cannot write {self.path}: {error}") from error

    def _run(self) -> None:
        while (picture := self._pictures.get()) is not None:
            if self._error is None:
                try:
                    self._writer.write(picture)
                except Exception as error:  # any error: `write` must not wait for a thread that has ended
                    self._error = error


def codecs_for(path: Path) -> tuple[Codec, ...]:
    """Return the codecs to try for a file's extension; ValueError if there are none."""
    try:
        return CODECS[path.suffix.lower()]
    except KeyError:
        raise ValueError(f"a video's name must end in {', '.join(CODECS)}, got {str(path)!r}") from None


def _open(path: Path, codecs: tuple[Codec, ...], fps: float, size: tuple[int, int]) -> tuple[cv2.VideoWriter, Codec]:
    for codec in codecs:
        with hushed, _silent_stderr():
            rate = _ENCODING_FPS if codec is VP8 else fps
            writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*codec.fourcc), rate, size)
        if writer.isOpened():
            return writer, codec
    path.unlink(missing_ok=True)
    raise ValueError(f"OpenCV cannot write {path}: no codec for {path.suffix} at {size[0]} x {size[1]} px")


@contextlib.contextmanager
def _silent_stderr() -> Iterator[None]:
    """Discard what OpenCV's libraries print to stderr while they open a file."""
    sys.stderr.flush()
    kept = os.dup(2)
    try:
        with Path(os.devnull).open("wb") as null:
            os.dup2(null.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def set_frame_rate(path: Path, fps: float) -> None:
    """Correct the frame rate of a WebM file that was encoded at 1 frame/s.

    Parameters
    ----------
    path : Path
        The file: WebM as FFmpeg writes it, with a time unit of 1 ms.
    fps : float
        Frames per second.

    Raises
    ------
    ValueError
        If it is another kind of file.
    """
    with path.open("r+b") as file:
        head = file.read(_HEAD_BYTES)
        at, size = _element(head, _TIME_UNIT_ID)
        if int.from_bytes(head[at : at + size]) != _TIME_UNIT_NS:
            raise ValueError(f"{path} does not count in milliseconds")
        file.seek(at)
        file.write(round(_TIME_UNIT_NS * _ENCODING_FPS / fps).to_bytes(size))
        if _FRAME_DURATION_ID in head:
            at, size = _element(head, _FRAME_DURATION_ID)
            file.seek(at)
            file.write(round(1e9 / fps).to_bytes(size))


def _element(head: bytes, name: bytes) -> tuple[int, int]:
    """Return where the value of an EBML element begins, and its length."""
    at = head.find(name)
    if at < 0 or at + len(name) >= len(head):
        raise ValueError("this is no WebM file of FFmpeg's")
    # A length below 127 is one byte with its highest bit set.
    return at + len(name) + 1, head[at + len(name)] & 0x7F
