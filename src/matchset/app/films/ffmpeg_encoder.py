"""Films packed as H.264 by the program `ffmpeg`, where it is on the path and PyAV is not installed: `FfmpegEncoder`.

The file is an MP4 in fragments, so that a killed program or a full disk leaves all but the end. The program runs in a
session of its own: Ctrl-C is for matchset, which ends the film when its frame is done.
"""

import contextlib
import errno
import functools
import os
import shutil
import subprocess
import tempfile

import numpy as np

from matchset.app.films.codecs import EVEN, Film, Picture
from matchset.app.films.packing import PACKING

ENCODERS = ("libx264", "libopenh264")  # format: names of FFmpeg's encoders of H.264 that need no graphics card
_FULL = "No space left on device"


def open_ffmpeg_encoder(film: Film) -> "FfmpegEncoder | None":
    """Begin a film; None if it is no .mp4, there is no program `ffmpeg`, or it has no encoder of H.264."""
    program = shutil.which("ffmpeg")
    if film.path.suffix.lower() != ".mp4" or program is None:
        return None
    encoder = _encoder_of(program)
    return None if encoder is None else FfmpegEncoder(film, program, encoder)


def has_ffmpeg() -> bool:
    """Whether there is a program `ffmpeg` that packs H.264."""
    program = shutil.which("ffmpeg")
    return program is not None and _encoder_of(program) is not None


@functools.cache
def _encoder_of(program: str) -> str | None:
    """Ask the program which encoder of H.264 it has."""
    try:
        asked = subprocess.run([program, "-hide_banner", "-encoders"], capture_output=True, timeout=10.0, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    words = asked.stdout.decode(errors="replace").split()
    return next((name for name in ENCODERS if name in words), None)


class FfmpegEncoder:
    """Packs a film with the program `ffmpeg`; implements `matchset.app.films.codecs.Encoder`.

    Parameters
    ----------
    film : Film
    program, encoder : str
        The program, and which of its encoders.
    """

    def __init__(self, film: Film, program: str, encoder: str) -> None:
        self.note, self._film = "", film
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the film
        width, height = film.size
        read = ["-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{width}x{height}", "-r", f"{film.fps}", "-i", "pipe:0"]
        pack = ["-an", "-c:v", encoder, *PACKING.words(encoder, film.small), "-pix_fmt", "yuv420p", "-threads", "1"]
        even = ["-vf", f"pad=ceil(iw/{EVEN})*{EVEN}:ceil(ih/{EVEN})*{EVEN}"] if width % EVEN or height % EVEN else []
        pieces = ["-movflags", "frag_keyframe+empty_moov+default_base_moof", "-flush_packets", "1"]
        pieces += ["-frag_duration", f"{1e6 * PACKING.piece:.0f}"]
        self._process = subprocess.Popen(
            [program, "-hide_banner", "-loglevel", "error", *read, *pack, *even, *pieces, "-y", f"file:{film.path}"],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=self._said,
            start_new_session=True,
        )

    def write(self, picture: Picture) -> None:
        """Append a picture."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(np.ascontiguousarray(picture).data)
        except BrokenPipeError:
            self._end()

    def close(self) -> None:
        """Finish the file."""
        try:
            self._end()
        finally:
            self._said.close()

    def _end(self) -> None:
        """Let the program end; OSError if it failed, with what it said last."""
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        if self._process.wait() == 0:
            return
        self._said.seek(0)
        lines = self._said.read().decode(errors="replace").strip().splitlines()
        if any(_FULL in line for line in lines):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        raise OSError(errno.EIO, f"ffmpeg: {lines[-1] if lines else 'it ended'}")
