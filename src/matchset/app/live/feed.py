"""What the page shows, and what its parts are made of: `Feed`, `Stream`, `Panel`."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import msgspec

from matchset.app.closing import Closing
from matchset.app.live.wire.messages import Up
from matchset.app.live.wire.state import State
from matchset.image.frame import Frame

News = Callable[[int], None]
"""Told the number of a stream that has a new picture, from any thread; never waits."""


class Seen(NamedTuple):
    """A picture with what is known of it.

    Attributes
    ----------
    frame : Frame or None
        None as long as the source has none.
    state : State
    """

    frame: Frame | None
    state: State


class Stream(Protocol):
    """Pictures of one camera."""

    @property
    def seen(self) -> Seen:
        """The newest picture."""
        ...


class Panel:
    """One part of the page, on the server's side. All methods are called in the server's thread and must not wait.

    Attributes
    ----------
    name : str
        Under which the page finds its state: the panel of the page with this name is shown while there is one.
    messages : tuple of types
        Messages of the page that it takes.
    """

    name: str
    messages: tuple[type[Up], ...] = ()

    def take(self, message: Any, page: str) -> None:
        """Do what a page asks for.

        Parameters
        ----------
        message : Up
            One of `messages`.
        page : str
            Which page asks; empty for a program.

        Raises
        ------
        ValueError
            If it cannot be done: the page shows why.
        """
        raise NotImplementedError

    def state(self) -> msgspec.Struct | None:
        """Return what the page shows; None: nothing but that the panel is there. Read ten times a second."""
        return None

    def downloads(self) -> dict[str, Path]:
        """Files that the page may load, by their names there."""
        return {}

    def left(self, page: str) -> None:
        """Note that a page is gone."""


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
