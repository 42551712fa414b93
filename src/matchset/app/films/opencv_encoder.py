"""Films packed by OpenCV, where PyAV is not installed: `OpencvEncoder`.

The frame rate of a WebM file is changed in place. OpenCV gives libvpx a deadline of one second per frame, and libvpx
searches longer unless a frame lasts as long. So VP8 is encoded as if one frame per second were shown, 4 to 6 times as
fast at equal size and quality (decision 007), and the duration of the file's time unit is corrected: as soon as it is
on the disk, so that a film whose program was killed plays at its rate, and once more at the end.
"""

import contextlib
import errno
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2

from matchset.app.films.codecs import MJPEG, MPEG4, VP8, Film, FilmCodec, Picture, codecs_for
from matchset.app.films.noise_smoother import NoiseSmoother
from matchset.media.capture import hushed, opencv_name
from matchset.numeric.imports import advice

MPEG4_NOTE = (
    "the .mp4 is packed as MPEG-4: players show it, browsers do not, and if the program is killed nothing of it can be "
    f"read: use .webm; for H.264 install ffmpeg, or {advice('av')}"
)
_ENCODING_FPS = 1.0  # format: the frame rate that OpenCV is told while it encodes VP8
_TIME_UNIT_ID = b"\x2a\xd7\xb1"  # format: EBML id of TimestampScale
_FRAME_DURATION_ID = b"\x23\xe3\x83"  # format: EBML id of DefaultDuration
_TIME_UNIT_NS = 1_000_000  # format: FFmpeg's time unit in WebM
_HEAD_BYTES = 4096  # format: the ids are in the first bytes of a file
_BUFFERED = 1 << 20  # format: bytes; FFmpeg keeps a quarter of this back, and OpenCV says nothing if it does not fit


class OpencvEncoder:
    """Packs a film with OpenCV; implements `matchset.app.films.codecs.Encoder`.

    Parameters
    ----------
    film : Film

    Raises
    ------
    ValueError
        If no codec of the file's ending can be opened.
    """

    def __init__(self, film: Film) -> None:
        codecs = codecs_for(film.path)
        opencv_name(str(film.path))
        self._film = film
        self._writer, self._codec = _open(film, codecs)
        self.note = MPEG4_NOTE if self._codec is MPEG4 else ""
        self._smoother = NoiseSmoother() if film.small else None  # OpenCV passes no options to its encoders
        self._count, self._rated, self._nearly_full = 0, self._codec is not VP8, False

    def write(self, picture: Picture) -> None:
        """Append a picture."""
        if self._smoother is not None:
            picture = self._smoother.smooth(picture)
        with hushed:
            self._writer.write(picture)
        self._count += 1
        self._nearly_full |= shutil.disk_usage(self._film.path.parent).free < _BUFFERED
        if not self._rated and self._film.path.stat().st_size > 0:
            set_frame_rate(self._film.path, self._film.fps)
            self._rated = True

    def close(self) -> None:
        """Finish the file; OSError if pictures are missing in it."""
        with hushed:
            self._writer.release()
        if self._codec is VP8 and self._film.path.stat().st_size > 0:
            set_frame_rate(self._film.path, self._film.fps)
        if not self._is_whole():
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _is_whole(self) -> bool:
        """Whether all pictures are in the file: OpenCV does not say what it could not write."""
        path = self._film.path
        if not self._nearly_full and _stated_count(path) == self._count and (self._codec is not MJPEG or _ends(path)):
            return True
        return count_pictures(self._film.path) >= self._count


def _ends(path: Path) -> bool:
    """Whether an AVI file is as long as it says: chunks "RIFF", each with its length."""
    end, place = path.stat().st_size, 0
    with path.open("rb") as file:
        while place < end:
            file.seek(place)
            place += 8 + int.from_bytes(file.read(8)[4:], "little")
    return place == end


def _stated_count(path: Path) -> int:
    """Read from the beginning of a film how many pictures it has; anything if its end is missing."""
    with hushed, _silent_stderr():
        film = cv2.VideoCapture(str(path))
        count = film.get(cv2.CAP_PROP_FRAME_COUNT)
        film.release()
    return round(count)


def count_pictures(path: Path) -> int:
    """Count the pictures of a film that can be read."""
    with hushed, _silent_stderr(), _name_in_utf8(path) as name:
        film, count = cv2.VideoCapture(name), 0
        while film.grab():
            count += 1
        film.release()
    return count


@contextlib.contextmanager
def _name_in_utf8(path: Path) -> Iterator[str]:
    """Yield a name under which OpenCV can open a file, whatever it is called."""
    with path.open("rb") as file:
        try:
            name = opencv_name(str(path))
        except ValueError:
            name = f"/dev/fd/{file.fileno()}"
        yield name


def _open(film: Film, codecs: tuple[FilmCodec, ...]) -> tuple[cv2.VideoWriter, FilmCodec]:
    for codec in codecs:
        rate = _ENCODING_FPS if codec is VP8 else film.fps
        with hushed, _silent_stderr():
            writer = cv2.VideoWriter(str(film.path), cv2.VideoWriter.fourcc(*codec.fourcc), rate, film.size)
        if writer.isOpened():
            return writer, codec
    film.path.unlink(missing_ok=True)
    width, height = film.size
    raise ValueError(f"OpenCV cannot write {film.path}: no codec for {film.path.suffix} at {width} x {height} px")


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
    """Correct the frame rate of a WebM file that was encoded at 1 frame/s; again does no harm.

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
        unit = round(_TIME_UNIT_NS * _ENCODING_FPS / fps)
        if int.from_bytes(head[at : at + size]) not in (_TIME_UNIT_NS, unit):
            raise ValueError(f"{path} does not count in milliseconds")
        file.seek(at)
        file.write(unit.to_bytes(size))
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
