"""Films packed by PyAV (the extra `av`), piece by piece: a killed program or a full disk leaves all but the end.

The files are streams: WebM in short clusters, MP4 with H.264 in short fragments that become an ordinary MP4 at the end,
AVI by single pictures. Every piece is given to the operating system at once. libvpx and libx264 are told to keep up.
"""

from fractions import Fraction
from typing import Any

import numpy as np

from matchset.app.disk import WholeFile
from matchset.app.films.codecs import EVEN, Film, Picture, codecs_for
from matchset.app.films.packing import PACKING

# format: FFmpeg's names of codecs, best first, container and layout of the pixels by ending
FORMATS = {
    ".mp4": (("libx264", "libopenh264", "mpeg4"), "mp4", "yuv420p"),
    ".webm": (("libvpx",), "webm", "yuv420p"),
    ".avi": (("mjpeg",), "avi", "yuvj420p"),
}
_FINEST = 100_000  # format: largest denominator of a frame rate in a file


def open_pyav_encoder(film: Film) -> "PyavEncoder | None":
    """Begin a film; None if PyAV is not installed, or has no codec for it.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    try:
        import av
    except ImportError:
        return None
    codecs_for(film.path)
    try:
        return PyavEncoder(film)
    except av.FFmpegError:
        return None


class PyavEncoder:
    """Packs a film with PyAV; implements `matchset.app.films.codecs.Encoder`.

    Parameters
    ----------
    film : Film

    Raises
    ------
    OSError
        If the file cannot be written.
    ValueError
        If PyAV has no codec for it.
    """

    def __init__(self, film: Film) -> None:
        import av

        codecs, container, pixels = FORMATS[film.path.suffix.lower()]
        codec = next((each for each in codecs if each in av.codecs_available), codecs[-1])
        self._av: Any = av
        self.note, self._count = "", 0
        rate = Fraction(film.fps).limit_denominator(_FINEST)
        self._file = WholeFile(film.path, beside=False)  # the recorder's own
        try:
            self._container: Any = av.open(self._file, "w", format=container, options=_pieces(container))
            stream: Any = self._container.add_stream(codec, rate=rate, options=PACKING.options(codec, film.small))
            stream.width, stream.height = (side + side % EVEN if container == "mp4" else side for side in film.size)
            stream.pix_fmt, stream.codec_context.thread_count = pixels, 1
            self._container.start_encoding()
        except BaseException:
            self._file.close()
            raise
        self._stream = stream

    def write(self, picture: Picture) -> None:
        """Append a picture."""
        missing = self._stream.height - picture.shape[0], self._stream.width - picture.shape[1]
        if any(missing):
            picture = np.pad(picture, ((0, missing[0]), (0, missing[1]), (0, 0)), mode="edge")
        frame = self._av.VideoFrame.from_ndarray(picture, format="bgr24")
        frame.pts, self._count = self._count, self._count + 1
        self._mux(frame)

    def close(self) -> None:
        """Finish the file."""
        try:
            if self._count:  # FFmpeg crashes where the end of an .mp4 without pictures does not fit on the disk
                self._finish()
        finally:
            self._file.close()
        if self._file.error is not None:
            raise self._file.error

    def _finish(self) -> None:
        try:
            self._mux(None)
        finally:
            self._container.close()  # once, also after an error: FFmpeg crashes if it shall write the end again
        self._file.mark()

    def _mux(self, frame: Any) -> None:
        for packet in self._stream.encode(frame):
            self._container.mux(packet)
        self._file.mark()


def _pieces(container: str) -> dict[str, str]:
    """Options of one of FFmpeg's containers."""
    if container == "webm":
        return {"flush_packets": "1", "cluster_time_limit": f"{1000.0 * PACKING.piece:.0f}"}
    if container == "mp4":
        fragments = {"movflags": "hybrid_fragmented+frag_keyframe", "frag_duration": f"{1e6 * PACKING.piece:.0f}"}
        return {"flush_packets": "1"} | fragments
    return {"flush_packets": "1"}
