"""What the page shows, and what its parts are made of: `Feed`, `Stream`, `Panel`; who is told of it: `Listener`."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol, runtime_checkable

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.live.wire.messages import PageMessage
from matchset.live.wire.state import State
from matchset.localization.pose import Pose
from matchset.media.closing import Closing
from matchset.tracking.track import Lost

News = Callable[[int], None]
"""Told the number of a stream that has a new picture, from any thread; never waits."""


class StreamPicture(NamedTuple):
    """A picture with what is known of it.

    Attributes
    ----------
    frame : Frame or None
        None as long as the source has none.
    state : State
    poses : mapping of int to Pose or Lost
        Of the targets whose diameter is known, by `TargetState.id`, if the camera is known.
    camera : CameraModel or None
    parameters : mapping of int to tuple of str
        Names of the parameters of each target's shape, by `TargetState.id`; those of a circle where there are none.
    """

    frame: Frame | None
    state: State
    poses: Mapping[int, "Pose | Lost[Pose]"] = MappingProxyType({})
    camera: CameraModel | None = None
    parameters: Mapping[int, tuple[str, ...]] = MappingProxyType({})


class Stream(Protocol):
    """Pictures of one camera."""

    @property
    def seen(self) -> StreamPicture:
        """The newest picture."""
        ...


@runtime_checkable
class MaskedStream(Protocol):
    """A stream that can show what it takes for a target."""

    def mask(self, target: int, sequence: int) -> npt.NDArray[np.uint8]:
        """Return a picture of that, (h, w): 255 where target; called in any thread, ValueError if it cannot be made.

        Parameters
        ----------
        target : int
            Number of the target.
        sequence : int
            Of the picture.
        """
        ...


@runtime_checkable
class ChartedStream(Protocol):
    """A stream that knows the course of a target over all of its pictures."""

    def course(self, target: int) -> msgspec.Struct:
        """Return it, as JSON will have it; called in any thread, ValueError if there is no such target."""
        ...


class Receiver(Protocol):
    """A large file that a page sends, part by part; the calls come one after the other, in any thread."""

    def write(self, data: bytes) -> None:
        """Take the next part; ValueError if it is too much."""
        ...

    def finish(self) -> None:
        """Use it: it is whole; ValueError if it is not what it should be."""
        ...

    def drop(self) -> None:
        """Delete it."""
        ...


@runtime_checkable
class ThumbnailPanel(Protocol):
    """A panel that has small pictures of what it offers."""

    def thumbnail(self, key: str) -> bytes:
        """Return one, a JPEG; called in any thread, ValueError if there is none."""
        ...


class Panel:
    """One part of the page, on the server's side. All methods are called in the server's thread and must not wait.

    Attributes
    ----------
    name : str
        Under which the page finds its state: the panel of the page with this name is shown while there is one.
    messages : tuple of types
        Messages of the page that it takes.
    uploads : tuple of str
        Kinds of files that it takes.
    """

    name: str
    messages: tuple[type[PageMessage], ...] = ()
    uploads: tuple[str, ...] = ()

    def take(self, message: Any, page: str) -> None:
        """Do what a page asks for.

        Parameters
        ----------
        message : PageMessage
            One of `messages`.
        page : str
            Which page asks; empty for a program.

        Raises
        ------
        ValueError
            If it cannot be done: the page shows why.
        """
        raise NotImplementedError

    def waits(self, message: Any) -> None:
        """Note that one of its messages is done later, when the code that it needs has been compiled."""

    def refused(self, message: Any, words: str) -> None:
        """Note that one of its messages will not be done, and why."""

    def put(self, upload: str, name: str, data: bytes) -> None:
        """Take a file that a page sends.

        Parameters
        ----------
        upload : str
            One of `uploads`.
        name : str
            What its owner calls it; not to be used as a path.
        data : bytes
            `UPLOAD` at most.

        Raises
        ------
        ValueError
            If it is not what it should be: the page shows why.
        """
        raise NotImplementedError

    def receive(self, upload: str, name: str, length: int) -> Receiver | None:  # noqa: ARG002
        """Take a large file that the page itself sends.

        Parameters
        ----------
        upload : str
            A kind of file.
        name : str
            What its owner calls it; not to be used as a path.
        length : int
            Bytes.

        Returns
        -------
        Receiver or None
            None if it takes no large file of this kind.

        Raises
        ------
        ValueError
            If it does not take this one: the page shows why.
        """
        return None

    def state(self) -> msgspec.Struct | None:
        """Return what the page shows; None: nothing but that the panel is there. Read ten times a second."""
        return None

    def downloads(self) -> dict[str, Path]:
        """Files that the page may load, by their names there."""
        return {}

    def left(self, page: str) -> None:
        """Note that a page is gone."""


class Listener(Protocol):
    """Is told of each picture that a session shows, such as a recording. No method waits."""

    def hear(self, stream: int, seen: StreamPicture) -> None:
        """Take a new picture of a stream, in the thread of its loop: each one, in their order.

        Parameters
        ----------
        stream : int
        seen : StreamPicture
            The frame is not changed any more. A `StreamPicture` with the frame of the one before is no new picture.
        """
        ...

    def changed(self, feed: "Feed | None") -> None:
        """Note that another feed will be shown now, in any thread; again when the one before has ended."""
        ...


class Feed(Closing):
    """A source that is shown: its streams of pictures, and the panels that belong to it.

    Attributes
    ----------
    kind : str
        "camera", "file" or "flight".
    title : str
        Its name, for people.
    streams : sequence of Stream
    panels : sequence of Panel
    """

    kind: str
    title: str
    streams: Sequence[Stream]
    panels: Sequence[Panel]

    @property
    def busy(self) -> str:
        """Why something else cannot be shown now; empty if it can."""
        return ""
