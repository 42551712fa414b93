"""The annotated video: `FilmWriter` writes it in a thread, while the next frames are tracked."""

import queue
import threading
from importlib.util import find_spec
from pathlib import Path

import msgspec

from matchset.app.disk import SPACE, FreeSpace, SpaceParameters, UnfinishedFileError, name_beside
from matchset.app.films.codecs import Encoder, Film, Picture, codecs_for
from matchset.app.films.ffmpeg_encoder import has_ffmpeg, open_ffmpeg_encoder
from matchset.app.films.opencv_encoder import OpencvEncoder, count_pictures
from matchset.app.films.pyav_encoder import open_pyav_encoder
from matchset.media.closing import Closing
from matchset.numeric.copies import NotCopied


def quick_ending() -> str:
    """Return the ending of films that are packed fastest and shown by browsers: H.264 where there is one, else VP8."""
    return ".mp4" if find_spec("av") is not None or has_ffmpeg() else ".webm"


class FilmWriterParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How films are written.

    Parameters
    ----------
    waiting : int
        Pictures that wait for the encoder. More evens out longer pauses and is lost if the program is killed; fewer
        make the tracker wait. Chosen by: `python -m benchmarks.lost.killed`, decision 092.
    space : SpaceParameters
        How much of the disk is left free.
    small : bool
        See `Film`.
    """

    waiting: int = 4
    space: SpaceParameters = SPACE
    small: bool = False


class FilmWriter(NotCopied, Closing):
    """Writes a video in its own thread, since encoding a frame takes longer than tracking one.

    A film that exists is overwritten by `close`; one without a picture is removed. If the disk is full, or nearly, the
    film ends there, whole; what comes after that is counted, and `close` raises.

    Parameters
    ----------
    path : Path
        Where, ending in .mp4 (H.264), .webm (VP8) or .avi (Motion JPEG). Packed by PyAV, if it is installed; else an
        .mp4 by the program `ffmpeg`, if there is one; else by OpenCV (an .mp4 as MPEG-4).
    fps : float
        Frames per second.
    size : tuple of two ints
        Width and height of the pictures, px.
    live : bool
        Whether the frames come from a camera, which does not wait.
    parameters : FilmWriterParameters, optional

    Attributes
    ----------
    note : str
        What the user should know about the file; empty if nothing.

    Raises
    ------
    ValueError
        If the extension is another, or the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        fps: float,
        size: tuple[int, int],
        live: bool = False,
        parameters: FilmWriterParameters | None = None,
    ) -> None:
        codecs_for(path)
        self.path, self._size, self._beside = path, size, name_beside(path)
        parameters = parameters or FilmWriterParameters()
        # OpenCV reports a file without write permission as a codec that cannot be opened.
        try:
            self._beside.open("wb").close()
            self._space = FreeSpace(path, parameters.space)
        except OSError as error:
            raise ValueError(f"cannot write {path}: {error.strerror}") from error
        self._encoder = _encoder(Film(self._beside, fps, size, live, parameters.small))
        self.note = self._encoder.note
        self._error: Exception | None = None
        self._offered, self._closed = 0, False
        self._pictures: queue.Queue[Picture | None] = queue.Queue(parameters.waiting)
        self._thread = threading.Thread(target=self._run, name="matchset recorder", daemon=True)
        self._thread.start()

    def write(self, picture: Picture) -> None:
        """Append a BGR picture; the caller must not change it afterwards. A full disk is no error here."""
        if (picture.shape[1], picture.shape[0]) != self._size:
            raise ValueError(f"a picture of {self.path} must have {self._size} px, got {picture.shape[1::-1]}")
        self._offered += 1
        self._pictures.put(picture)

    @property
    def failure(self) -> Exception | None:
        """Why nothing more is written; None while all is well."""
        return self._error

    @property
    def waiting(self) -> int:
        """How many pictures wait for the encoder."""
        return self._pictures.qsize()

    def close(self) -> None:
        """Encode what is in the queue and close the file.

        Raises
        ------
        UnfinishedFileError
            If the disk was full: says how many pictures the file holds.
        ValueError
            If the film could not be written for another reason.
        """
        if self._closed:
            return
        self._closed = True
        self._pictures.put(None)
        self._thread.join()
        if not self._offered:
            self._beside.unlink(missing_ok=True)  # nothing was filmed: what was there before stays
        elif self._beside != self.path:
            self._beside.replace(self.path)
        if isinstance(self._error, OSError):
            content = f"{count_pictures(self.path)} of {self._offered} pictures"
            raise UnfinishedFileError(self._error, self.path, content) from self._error
        if self._error is not None:
            raise ValueError(f"cannot write {self.path}: {self._error}") from self._error

    def _run(self) -> None:
        while (picture := self._pictures.get()) is not None:
            if self._error is None:
                self._try(picture)
        if self._error is None:
            self._finish()

    def _try(self, picture: Picture) -> None:
        """Encode a picture; any error is kept: `write` must not wait for a thread that has ended."""
        try:
            if self._space.left < 0:
                raise self._space.error
            self._encoder.write(picture)
        except Exception as error:
            self._finish()
            self._error = error

    def _finish(self) -> None:
        try:
            self._encoder.close()
        except Exception as error:
            self._error = error


def _encoder(film: Film) -> Encoder:
    try:
        return open_pyav_encoder(film) or open_ffmpeg_encoder(film) or OpencvEncoder(film)
    except OSError as error:
        raise ValueError(f"cannot write {film.path}: {error.strerror}") from error
