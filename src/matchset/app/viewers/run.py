"""Frames of a run on their way, written for viewers: `viewed`."""

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Protocol, TypeVar

import msgspec

from matchset.app.disk import SPACE, FreeSpace, SpaceParameters, UnfinishedFileError
from matchset.app.pictures.run_pictures import DrawnFrame
from matchset.app.run_folder import output_file
from matchset.app.viewers.options import ViewerOptions
from matchset.app.viewers.viewed_frame import ViewedFrame, viewed_frame
from matchset.camera.camera_model import CameraModel
from matchset.media.closing import Closing, close_all
from matchset.numeric.arguments import require_within

Viewed = TypeVar("Viewed", bound=DrawnFrame)
"""One frame of a run."""


class ViewerParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How files for viewers are written.

    Parameters
    ----------
    quality : int
        Of their JPEGs, 1 to 100: more is truer and larger. Chosen as for the bags of the page: 90, at which a
        picture of 640 x 480 takes 60 to 100 kB.
    space : SpaceParameters
        How much of the disk is left free.
    """

    quality: int = 90
    space: SpaceParameters = SPACE

    def __post_init__(self) -> None:
        require_within(self, {"quality": (1, 100)})


class ViewerFile(Protocol):
    """What writes frames to a file of its own."""

    def write(self, seen: ViewedFrame) -> None:
        """Append a frame."""
        ...

    def close(self) -> None:
        """Finish the file."""
        ...

    def discard(self) -> None:
        """Delete what was written; what was there before stays."""
        ...


class GuardedFile(Closing):
    """A file that ends, whole, where its disk is full or nearly so; the run goes on. Without a frame there is none.

    Parameters
    ----------
    path : Path
    open_file : callable
        Opens it.
    parameters : ViewerParameters

    Raises
    ------
    OSError
        If it cannot be opened; by `close`, as `UnfinishedFileError`, if it ended before the run.
    """

    def __init__(self, path: Path, open_file: Callable[[], ViewerFile], parameters: ViewerParameters) -> None:
        self._path, self._space = path, FreeSpace(path, parameters.space)
        self._file = open_file()
        self._error: OSError | None = None
        self._written = self._offered = 0

    def write(self, seen: ViewedFrame) -> None:
        """Append a frame, if there is still room."""
        self._offered += 1
        if self._error is not None:
            return
        try:
            if self._space.left < 0:
                raise self._space.error
            self._file.write(seen)
            self._written += 1
        except OSError as error:
            self._error = error

    def close(self) -> None:
        """Finish the file."""
        content = f"{self._written} of {self._offered} frames"
        try:
            if self._written:
                self._file.close()
            else:
                self._file.discard()
        except OSError as error:
            self._error, content = self._error or error, f"at most {content}"
        if self._error is not None:
            raise UnfinishedFileError(self._error, self._path, content) from self._error


def viewed(
    frames: Iterable[Viewed],
    options: ViewerOptions,
    source: tuple[str, bool],
    located: tuple[CameraModel, float] | None = None,
    parameters: ViewerParameters | None = None,
) -> Iterator[Viewed]:
    """Pass the frames of a run on, and write them for the viewers that are asked for.

    Parameters
    ----------
    frames : iterable of DrawnFrame
    options : ViewerOptions
    source : tuple of str and bool
        What is read, which is never overwritten; and whether other files may be.
    located : tuple of CameraModel and float, optional
        Where targets are located: the camera, and their diameter, m.
    parameters : ViewerParameters, optional
    """
    if not options.files:
        yield from frames
        return
    chosen = parameters or ViewerParameters()
    files: list[GuardedFile] = []
    try:
        for path, open_file in _openers(options, source, located):
            files.append(GuardedFile(path, open_file, chosen))  # those before one that fails are closed
        for each in frames:
            seen = viewed_frame(each, chosen.quality)
            for file in files:
                file.write(seen)
            yield each
    finally:
        close_all(*(file.close for file in files))


def _openers(
    options: ViewerOptions, source: tuple[str, bool], located: tuple[CameraModel, float] | None
) -> Iterator[tuple[Path, Callable[[], ViewerFile]]]:
    """Yield the files that are asked for, and what opens each."""
    name, force = source
    if options.mcap is not None:
        from matchset.app.viewers.foxglove_file import FoxgloveFile

        mcap = output_file(options.mcap, force, name)
        yield mcap, lambda: FoxgloveFile(mcap, *(located or ()))
    if options.rerun is not None:
        from matchset.app.viewers.rerun_file import RerunFile

        rerun = output_file(options.rerun, force, name)
        yield rerun, lambda: RerunFile(rerun, *(located or ()))
