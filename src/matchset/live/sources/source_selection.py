"""Changes what is shown, in a thread of its own, since to open a camera may take seconds: `SourceSelection`."""

import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

from matchset.image.errors import LinkError
from matchset.live.feed import Feed
from matchset.live.sources.found_sources import Source, Sources, find_sources
from matchset.media.closing import Closing


class SourceSelection(Closing):
    """What there is, and which of it is shown.

    Parameters
    ----------
    folder : Path
        Whose videos are offered.
    make : callable
        Makes the feed of a source; raises ValueError where that cannot be.
    show : callable
        Shows a feed; it belongs to whom it was given.
    busy : callable, optional
        Returns why nothing else may be shown now; empty if it may.

    Attributes
    ----------
    stopped : threading.Event
        Set when it is closed: what takes long ends then.
    shown : Source or None
    opening : Source or None
        What is being opened.
    sources : Sources
        What was found last.
    fault : str
        Why what was asked for last cannot be shown.
    """

    def __init__(
        self,
        folder: Path,
        make: Callable[[Source], Feed],
        show: Callable[[Feed | None], None],
        busy: Callable[[], str] = lambda: "",
    ) -> None:
        self._folder, self._make, self._show, self._busy = folder, make, show, busy
        self._thread = ThreadPoolExecutor(1, "matchset sources")
        self._looking: Future[None] | None = None
        self._lock = threading.Lock()
        self.stopped = threading.Event()
        self.shown: Source | None = None
        self.opening: Source | None = None
        self.sources, self.fault = Sources([]), ""

    @property
    def busy(self) -> str:
        """Why nothing else may be shown now; empty if it may."""
        return self._busy()

    def look(self) -> None:
        """Look again what there is; does not wait."""
        if self._looking is None or self._looking.done():
            self._looking = self._thread.submit(self._look)

    def show(self, source: Source) -> "Future[None]":
        """Show a source in place of that which is shown; does not wait. A later one wins.

        Raises
        ------
        ValueError
            If what is shown must not be left now, such as a flight.
        """
        if words := self._busy():
            raise ValueError(words)
        with self._lock:
            self.opening, self.fault = source, ""
        change = self._thread.submit(self._change, source)
        change.add_done_callback(_tell)
        return change

    def _look(self) -> None:
        self.sources = find_sources(self._folder)

    def _change(self, source: Source) -> None:
        if self.opening is not source:  # another one was asked for meanwhile
            return
        try:
            if self.shown is not None and self.shown.origin == source.origin:
                self._clear()  # one device cannot be opened twice
            self._change_to(self._make(source), source)
        except (ValueError, LinkError, OSError) as error:
            self.fault = str(error) if source.name in str(error) else f"{source.name}: {error}"
        except Exception as error:
            self.fault = f"{source.name}: {type(error).__name__}: {error}"
            raise
        finally:
            with self._lock:
                if self.opening is source:
                    self.opening = None

    def _change_to(self, feed: Feed, source: Source) -> None:
        if words := self._busy():  # it took off meanwhile
            feed.close()
            raise ValueError(words)
        self._show(feed)
        self.shown = source

    def _clear(self) -> None:
        self.shown = None
        self._show(None)

    def close(self) -> None:
        """End the thread; what is shown belongs to others."""
        self.stopped.set()
        self._thread.shutdown(cancel_futures=True)


def _tell(change: "Future[None]") -> None:
    """Print an error that nobody expected."""
    error = None if change.cancelled() else change.exception()
    if error is not None:
        traceback.print_exception(error)
