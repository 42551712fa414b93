"""The annotated video of a run, where nobody asked for one reduced and of limited length: `RunFilm`."""

import math
from pathlib import Path

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.films.video_writer import FilmWriter, FilmWriterParameters
from matchset.media.closing import Closing

Picture = npt.NDArray[np.uint8]


class FilmParameters(msgspec.Struct, frozen=True):
    """How large and long a video is that nobody asked for; `--video` gives all of it.

    Parameters
    ----------
    pixels : int
        Most pixels of a picture: encoding takes time in proportion to them, 5 ms of H.264 or 10 ms of VP8 at 640 x 480.
        As many as leave 480 x 848 and smaller ones as they are. Chosen by hand.
    pictures : int
        Most pictures: more take time and space in proportion. Chosen by hand, 100 s at 30 pictures a second.
    """

    pixels: int = 450_000
    pictures: int = 3000


PARAMETERS = FilmParameters()


class RunFilm(Closing):
    """A video whose pictures are reduced, and which may end before the run does.

    Parameters
    ----------
    path : Path
        Where.
    fps : float
        Pictures per second.
    size : tuple of two ints
        Width and height of the pictures that come, px.
    live : bool
        Whether they come from a camera.
    limits : FilmParameters or None
        None: at full size, to the end.
    small : bool
        See `Film`.

    Attributes
    ----------
    note, ending : str
        What the user should know about it; empty if nothing. The second one is known at the end.
    """

    def __init__(
        self,
        path: Path,
        fps: float,
        size: tuple[int, int],
        live: bool = False,
        limits: FilmParameters | None = None,
        small: bool = False,
    ) -> None:
        self.path, self._limits, self._count = path, limits, 0
        scale = 1.0 if limits is None else min(1.0, math.sqrt(limits.pixels / (size[0] * size[1])))
        width, height = (max(2 * round(0.5 * scale * side), 2) for side in size)
        self._size = size if scale == 1.0 else (width, height)
        self._given = size
        self._recorder = FilmWriter(path, fps, self._size, live, FilmWriterParameters(small=small))
        self.note, self.ending = self._recorder.note, ""

    def write(self, picture: Picture) -> None:
        """Append a BGR picture."""
        self._count += 1
        if self._limits is not None and self._count > self._limits.pictures:
            self.ending = f"{self.path} ends after {self._limits.pictures} frames: --video FILE writes all of them"
            return
        if self._size != self._given:
            picture = np.asarray(cv2.resize(picture, self._size, interpolation=cv2.INTER_AREA), np.uint8)
        self._recorder.write(picture)

    def close(self) -> None:
        """Finish the file."""
        self._recorder.close()
