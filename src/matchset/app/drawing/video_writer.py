"""The annotated video: `Recorder` writes it while the next frames are tracked."""

import contextlib
import os
import queue
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.webm import PACKING_FPS, set_frame_rate
from matchset.image.capture import hushed

Picture = npt.NDArray[np.uint8]


class Codec(msgspec.Struct, frozen=True):
    """A way to pack a video: its four letters for OpenCV, and what people call it."""

    fourcc: str
    name: str


VP9 = Codec("vp09", "VP9")
MPEG4 = Codec("mp4v", "MPEG-4")
VP8 = Codec("VP80", "VP8")
MJPEG = Codec("MJPG", "Motion JPEG")
CODECS = {".mp4": (VP9, MPEG4), ".webm": (VP8,), ".avi": (MJPEG,)}
"""By a file's ending, best first. OpenCV's wheels write no H.264; browsers play VP9 and VP8 only."""

NOTES = {
    VP9.name: "{path} is packed as VP9, which is slow; a name that ends in .webm is some 20 times as fast",
    MPEG4.name: "{path} is packed as MPEG-4: players show it, browsers do not; .webm plays in both",
}
"""What to tell the user of a codec."""

_WAITING = 8


class Recorder:
    """Writes a video in a thread of its own, since packing a frame takes longer than tracking one.

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
        What a user should know about the file; empty if nothing.

    Raises
    ------
    ValueError
        If the ending is another, or the file cannot be written.
    """

    def __init__(self, path: Path, fps: float, size: tuple[int, int], live: bool = False) -> None:
        codecs = codecs_for(path)
        if live and MPEG4 in codecs:
            codecs = (MPEG4,)
        self.path, self._size = path, size
        # OpenCV reports a file that it may not write as a codec that does not open.
        try:
            path.open("wb").close()
        except OSError as error:
            raise ValueError(f"cannot write {path}: {error.strerror}") from error
        self._fps = fps
        self._writer, self._codec = _open(path, codecs, fps, size)
        self.note = NOTES.get(self._codec.name, "").format(path=path)
        self._error: Exception | None = None
        self._pictures: queue.Queue[Picture | None] = queue.Queue(_WAITING)
        self._thread = threading.Thread(target=self._run, name="matchset recorder", daemon=True)
        self._thread.start()

    def write(self, picture: Picture) -> None:
        """Append a BGR picture; the caller must not change it any more."""
        if (picture.shape[1], picture.shape[0]) != self._size:
            raise ValueError(f"a picture of {self.path} must have {self._size} px, got {picture.shape[1::-1]}")
        self._pictures.put(picture)

    def close(self) -> None:
        """Pack what is waiting and finish the file."""
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
                except Exception as error:  # whatever it is, `write` must not wait for a thread that has died
                    self._error = error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def codecs_for(path: Path) -> tuple[Codec, ...]:
    """Return the codecs to try for a file's ending; ValueError where there are none."""
    try:
        return CODECS[path.suffix.lower()]
    except KeyError:
        raise ValueError(f"a video's name must end in {', '.join(CODECS)}, got {str(path)!r}") from None


def _open(path: Path, codecs: tuple[Codec, ...], fps: float, size: tuple[int, int]) -> tuple[cv2.VideoWriter, Codec]:
    for codec in codecs:
        with hushed, _silent_stderr():
            rate = PACKING_FPS if codec is VP8 else fps
            writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*codec.fourcc), rate, size)
        if writer.isOpened():
            return writer, codec
    path.unlink(missing_ok=True)
    raise ValueError(f"OpenCV cannot write {path}: no codec for {path.suffix} at {size[0]} x {size[1]} px")


@contextlib.contextmanager
def _silent_stderr() -> Iterator[None]:
    """Swallow what OpenCV prints past its own log while it opens a file."""
    sys.stderr.flush()
    kept = os.dup(2)
    try:
        with Path(os.devnull).open("wb") as nothing:
            os.dup2(nothing.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
