"""All pictures of a run: the annotated video, an animation of it, and the summary (`RunPictures`)."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.cli_options import ShownOptions
from matchset.app.course.log import Course
from matchset.app.drawing.picture_file import write_picture
from matchset.app.films.video_writer import quick_ending
from matchset.app.pictures.animation import Animation
from matchset.app.pictures.film import PARAMETERS, RunFilm
from matchset.app.pictures.summary import Summary
from matchset.app.run_folder import output_file
from matchset.image.frame import Frame
from matchset.media.closing import Closing, close_all
from matchset.media.video import Video

Picture = npt.NDArray[np.uint8]

DEFAULT_FPS = 30.0  # format: frame rate of an annotated video whose source has none


class DrawnFrame(Protocol):
    """What is needed of a frame of a run."""

    @property
    def frame(self) -> Frame | None:
        """The frame; None if it could not be decoded."""
        ...

    @property
    def answer(self) -> Any:
        """The tracker's answer: a `Track` or `Lost`, or what the summary draws."""
        ...

    @property
    def row(self) -> Any:
        """Its row in the table."""
        ...


Drawn = TypeVar("Drawn", bound=DrawnFrame)


class CourseLog(Protocol):
    """What notes the numbers of every frame."""

    @property
    def course(self) -> Course:
        """Those so far."""
        ...


class RunOptions(Protocol):
    """What is needed of the options of a command that reads a video."""

    @property
    def source(self) -> str:
        """What is read."""
        ...

    @property
    def video(self) -> Path | None:
        """The annotated video in full."""
        ...

    @property
    def shown(self) -> ShownOptions:
        """Other pictures."""
        ...

    @property
    def to_stdout(self) -> bool:
        """Whether rows go to another program, and no picture is wanted that nobody asked for."""
        ...

    @property
    def force(self) -> bool:
        """Whether files may be overwritten."""
        ...


class WantedPictures(msgspec.Struct, frozen=True):
    """Which pictures are asked for.

    Parameters
    ----------
    folder : Path
        Of the run.
    name : str
        Of the video there that nobody asked for, and of the summary: "track".
    source : str
        What is read.
    fps : float or None
        Of the source, frames per second.
    live : bool
        Whether it is a camera or a stream: then only what is asked for is written.
    video : Path or None
        Of the video in full, if one is asked for.
    gif : Path or None
        Of the animated picture.
    none : bool
        Neither a video nor a summary that nobody asked for.
    force : bool
        Whether files may be overwritten.
    summary : str
        Name of the summary.
    small : bool
        Whether the noise of the video in full may be smoothed, see `Film`.
    """

    folder: Path
    name: str
    source: str
    fps: float | None = None
    live: bool = False
    video: Path | None = None
    gif: Path | None = None
    none: bool = False
    force: bool = False
    summary: str = "summary.png"
    small: bool = False

    @classmethod
    def of(cls, options: RunOptions, name: str, folder: Path, video: Video) -> "WantedPictures":
        """Take what the options of a command ask for, of a video that is open."""
        return cls(
            folder,
            name,
            options.source,
            fps=video.fps,
            live=video.live,
            video=options.video,
            gif=options.shown.gif,
            none=options.shown.no_video or options.to_stdout,
            force=options.force,
        )


class RunPictures(Closing, Generic[Drawn]):
    """Draws the frames of a run and writes its pictures.

    Parameters
    ----------
    wanted : WantedPictures
    size : tuple of two ints
        Of the annotated pictures, px.
    paint : callable
        From a frame and its answer, one after the other, to the annotated picture.
    log : CourseLog, optional
        Of the same frames; the summary shows it.
    summary : Summary, optional
        What draws the summary, if not one of a single shape.

    Attributes
    ----------
    files : list of Path
        What is written; complete after `close`.
    """

    def __init__(
        self,
        wanted: WantedPictures,
        size: tuple[int, int],
        paint: Callable[[Frame, Drawn], Picture],
        log: CourseLog | None = None,
        summary: Summary | None = None,
    ) -> None:
        self._wanted, self._paint, self._log, self.files = wanted, paint, log, list[Path]()
        fps, unasked = wanted.fps or DEFAULT_FPS, not wanted.none and not wanted.live
        self._animation: Animation | None = None
        if wanted.gif is not None:
            self._animation = Animation(output_file(wanted.gif, wanted.force, wanted.source), fps)
            self.files.append(wanted.gif)
        self._film: RunFilm | None = None
        if wanted.video is not None:
            path = output_file(wanted.video, wanted.force, wanted.source)
            self._film = RunFilm(path, fps, size, wanted.live, small=wanted.small)
        elif unasked:
            self._film = RunFilm(wanted.folder / (wanted.name + quick_ending()), fps, size, limits=PARAMETERS)
        if self._film is not None:
            self._tell(self._film.note)
            self.files.append(self._film.path)
        self._summary = (summary or Summary()) if unasked else None

    def add(self, drawn: Drawn) -> None:
        """Take the next answered frame."""
        frame = drawn.frame
        if self._summary is not None:
            self._summary.append(frame, drawn.answer, drawn.row)
        if frame is None:
            return
        if self._film is not None or self._animation is not None:
            picture = self._paint(frame, drawn)
            if self._animation is not None:
                self._animation.append(picture)
            if self._film is not None:
                self._film.write(picture)

    def close(self) -> None:
        """Write what is still to be written; the video last, since it takes longest and can fail."""
        closers = [self._write_summary]
        if self._animation is not None:
            closers.append(self._animation.close)
        if self._film is not None:
            closers.append(self._close_film)
        close_all(*closers)

    def _write_summary(self) -> None:
        summary, self._summary = self._summary, None
        if summary is None or summary.is_empty:
            return
        path = self._wanted.folder / self._wanted.summary
        course = None if self._log is None else self._log.course
        write_picture(path, summary.picture(Path(self._wanted.source).name, course))
        self.files.append(path)

    def _close_film(self) -> None:
        film, self._film = self._film, None
        if film is not None:
            film.close()
            self._tell(film.ending)

    def _tell(self, note: str) -> None:
        if note:
            print("note: " + note, file=sys.stderr)
