"""What all pages of a server look at: the feed, its panels, and what a person should know (`Session`)."""

import threading
from collections import deque
from collections.abc import Callable
from pathlib import Path

import msgspec

from matchset.live.feed import Feed, Listener, Panel, Receiver, Stream, StreamPicture, ThumbnailPanel
from matchset.live.late_wishes import LateWishes
from matchset.live.targets.clicks import CROWDED
from matchset.live.wire.messages import Kernels, PageMessage
from matchset.live.wire.state import SessionState
from matchset.media.closing import Closing


class SessionParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much is told.

    Parameters
    ----------
    notes : int
        Notes that are kept for the page. Chosen by hand: what a phone shows without scrolling.
    late : int
        Clicks that wait for the compiler at most. Chosen by hand: as many targets as are followed.
    """

    notes: int = 5
    late: int = 8


class Session(Closing):
    """Holds what is shown.

    Parameters
    ----------
    panels : sequence of Panel, optional
        Those that are there whatever is shown.
    listeners : sequence of Listener, optional
        Told of each picture that is shown.
    refusal : callable, optional
        Returns why what needs compiled code cannot be done yet; empty if it can. Whoever compiles calls `go_on`.
    parameters : SessionParameters, optional
    """

    def __init__(
        self,
        panels: tuple[Panel, ...] = (),
        listeners: tuple[Listener, ...] = (),
        refusal: Callable[[Kernels], str] | None = None,
        parameters: SessionParameters | None = None,
    ) -> None:
        limits = parameters or SessionParameters()
        self._own, self._listeners = panels, listeners
        self._late = LateWishes(refusal or (lambda _: ""), limits.late)
        self._notes: deque[tuple[str, int]] = deque(maxlen=limits.notes)
        self._feed: Feed | None = None
        self._lock = threading.Lock()

    def add(self, panel: Panel) -> None:
        """Add a panel that is there whatever is shown; before the server begins."""
        self._own = (*self._own, panel)

    def listen(self, listener: Listener) -> None:
        """Tell somebody else of each picture that is shown; before the server begins."""
        self._listeners = (*self._listeners, listener)

    def show(self, feed: Feed | None) -> None:
        """Show another feed; the one before is closed. It belongs to the session from here on."""
        for listener in self._listeners:
            listener.changed(feed)
        with self._lock:
            before, self._feed = self._feed, feed
        self._late.forget()
        if before is not None:
            before.close()
            for listener in self._listeners:
                listener.changed(feed)  # the threads of the one before have told their last pictures by now

    def hear(self, number: int) -> StreamPicture | None:
        """Tell the listeners of the newest picture of a stream; called in the thread of its loop, by its `News`.

        Returns
        -------
        StreamPicture or None
            That picture; None if there is no such stream any more.
        """
        streams = self.streams
        if number >= len(streams):
            return None
        seen = streams[number].seen
        for listener in self._listeners:
            listener.hear(number, seen)
        return seen

    @property
    def streams(self) -> tuple[Stream, ...]:
        """The streams of pictures, by their numbers."""
        feed = self._feed
        return () if feed is None else tuple(feed.streams)

    @property
    def panels(self) -> tuple[Panel, ...]:
        """All panels that there are now."""
        feed = self._feed
        return self._own if feed is None else (*self._own, *feed.panels)

    @property
    def busy(self) -> str:
        """Why nothing else may be shown now, in words; empty: it may."""
        feed = self._feed
        return "" if feed is None else feed.busy

    def note(self, words: str) -> None:
        """Tell something to everybody who looks; what is said again is counted."""
        count = 1
        if self._notes and self._notes[-1][0] == words:
            count += self._notes.pop()[1]
        self._notes.append((words, count))

    def take(self, message: PageMessage, page: str) -> None:
        """Do what a page asks for, or keep it until the code that it needs has been compiled: see `go_on`.

        Raises
        ------
        ValueError
            If it cannot be done; says why.
        """
        if message.replaces and self.busy:
            raise ValueError(self.busy)
        panel = self._taker(message)
        words, given_up = self._late.keep(message, page)
        if given_up is not None:
            self._taker(given_up[0]).refused(given_up[0], CROWDED)
        if words:
            self.note(words)
            panel.waits(message)
        else:
            panel.take(message, page)

    def go_on(self) -> None:
        """Do what has waited for code that is there now."""
        for message, page in self._late.take():
            try:
                self._taker(message).take(message, page)
            except ValueError as error:
                self.note(str(error))

    def _taker(self, message: PageMessage) -> Panel:
        """Return the panel that takes a message; ValueError if there is none."""
        panel = next((panel for panel in self.panels if isinstance(message, panel.messages)), None)
        if panel is None:
            raise ValueError(f"{type(message).__name__.lower()}: there is nothing here that could do this")
        return panel

    def put(self, upload: str, name: str, data: bytes) -> None:
        """Take a file that a page sends.

        Raises
        ------
        ValueError
            If nothing takes such a file, or it is not what it should be.
        """
        for panel in self.panels:
            if upload in panel.uploads:
                panel.put(upload, name, data)
                return
        raise ValueError(f"nothing here takes a file for {upload[:60]!r}")

    def receive(self, upload: str, name: str, length: int) -> Receiver | None:
        """Take a large file that a page sends; None if nothing takes a large file of this kind.

        Raises
        ------
        ValueError
            If it cannot be taken; says why.
        """
        found = (panel.receive(upload, name, length) for panel in self.panels)
        return next((receiver for receiver in found if receiver is not None), None)

    def thumbnail(self, key: str) -> bytes:
        """Return a small picture of what a panel offers, a JPEG; ValueError if there is none."""
        for panel in self.panels:
            if isinstance(panel, ThumbnailPanel):
                return panel.thumbnail(key)
        raise ValueError("nothing here has pictures to choose from")

    def left(self, page: str) -> None:
        """Note that a page is gone."""
        for panel in self.panels:
            panel.left(page)

    def state(self) -> SessionState:
        """Return what pages are told."""
        feed = self._feed
        return SessionState(
            kind="" if feed is None else feed.kind,
            title="" if feed is None else feed.title,
            streams=len(self.streams),
            panels={panel.name: panel.state() for panel in self.panels},
            notes=[words if count == 1 else f"{words} ({count} times)" for words, count in self._notes],
        )

    def downloads(self) -> dict[str, Path]:
        """Return the files that pages may load, by name."""
        return {name: path for panel in self.panels for name, path in panel.downloads().items()}

    def close(self) -> None:
        """Close the feed."""
        self.show(None)
